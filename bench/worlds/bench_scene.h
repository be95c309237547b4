// What a scene of the program is: a motley scene, the host's part around it, and the figures by which it is judged.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motley/motley.h"
#include "worlds/crowd.h"
#include "worlds/view.h"

namespace motley::bench {

/// The dials of a run as the command line gives them.
struct RunOptions {
    std::int64_t agents = 0;  ///< 0: the scene's default
    double seconds = 0;       ///< 0: the scene's default
    float dt = 1.0F / 60;
    SolverSettings settings{};
    SolverOptions solver{};
    bool lists_contacts =
        false;  ///< people: a host's neighbour search lists the contacts; else the library finds them
    float friction = -1;  ///< below 0: the scene's default
    double door = 0;      ///< m, width of the door, where there is one; 0: the scene's default
    double density = 0;   ///< people per m2, where the scene can choose; 0: the scene's default
    SteeringModel steering = SteeringModel::plain;
    bool torsos = false;  ///< people are capsules across the shoulders instead of discs
    std::uint64_t seed = 12345;
    int direct_every =
        0;  ///< steps between two comparisons with the simultaneous solution of the same step; 0: never
    std::string data{};  ///< bottleneck: the trajectory file; empty: the project's copy
};

/// The number by which a scene is judged when that is not overlap.
struct SceneError {
    const char* name;  ///< with its unit
    double value;
};

/// A line of the table at the end of a run: a name, with its unit in brackets, and its value.
using Figure = std::pair<std::string, double>;

/// What must hold in a run, by an exact law: `value` is at most `bound`.
struct Mark {
    std::string name;     ///< with its unit
    double value, bound;  ///< a value of NaN: the run ended before it could be measured
    [[nodiscard]] bool passes() const { return value <= bound; }
    [[nodiscard]] const char* verdict() const
    {
        if (std::isnan(value)) return "NOT MEASURED";
        return passes() ? "PASS" : "FAIL";
    }
};

class BenchScene {
  public:
    BenchScene() = default;
    BenchScene(const BenchScene&) = delete;
    BenchScene& operator=(const BenchScene&) = delete;
    virtual ~BenchScene() = default;

    Scene scene;
    /// Sets what the scene itself decides, such as gravity.
    virtual void adjust(SolverSettings&) const {}
    /// The host's work before a step at `time`: arrivals, departures, steering.
    virtual void steer(double time, Executor& executor) = 0;
    /// The host's neighbour search.
    virtual std::span<const Contact> find_contacts(Executor& executor) = 0;
    /// Called after each step.
    virtual void observe(double time, const Solver& solver) = 0;
    /// The error by which a sweep judges the scene; without one a sweep uses how deep people overlap.
    [[nodiscard]] virtual std::optional<SceneError> error() const { return {}; }
    /// The scene's own figures.
    [[nodiscard]] virtual std::vector<Figure> figures() const { return {}; }
    /// The laws that the scene must meet, with how well it has met them so far.
    [[nodiscard]] virtual std::vector<Mark> marks() const { return {}; }
    /// The people, for trajectories; null where there are none.
    [[nodiscard]] virtual Crowd* crowd() { return nullptr; }
    /// What a picture shows, as last observed; nothing where there are no people.
    [[nodiscard]] virtual std::optional<View> view() const { return {}; }
    /// True when there is nothing left to simulate.
    [[nodiscard]] virtual bool is_over(double) const { return false; }
};

/// A scene of people: Crowd does the steering and the search.
class CrowdScene : public BenchScene {
  public:
    void steer(double, Executor& executor) override
    {
        people.observe(scene, executor);
        people.steer(scene, executor);
    }
    std::span<const Contact> find_contacts(Executor& executor) override
    {
        return people.is_handed_over() ? people.find_seam_contacts() : people.find_contacts(scene, executor);
    }
    void observe(double, const Solver&) override {}
    [[nodiscard]] Crowd* crowd() override { return &people; }
    [[nodiscard]] std::optional<View> view() const override { return view_of(people, scene); }

  protected:
    Crowd people;
    /// Lets the library find the contacts of people and walls, unless the options want them listed.
    void share_out_contacts(const RunOptions& options)
    {
        people.are_torsos = options.torsos;
        if (!options.lists_contacts) people.hand_over(scene);
    }
};

/// What of RunOptions a scene follows beyond what all do.
struct SceneTakes {
    bool door = false, density = false, steering = false, torsos = false;
    bool listed = false;  ///< contacts can be listed by the host
    bool found = false;   ///< contacts can be found by the library
};

/// A scene in the program's list.
struct SceneEntry {
    const char* name;
    const char* description;
    std::int64_t agents;  ///< default; bodies where there are no people
    double seconds;       ///< default
    std::function<std::unique_ptr<BenchScene>(const RunOptions& options)> make;
    SceneTakes takes{};
};

/// All scenes; the list is in scenes.cpp.
std::span<const SceneEntry> scene_list();
/// Null when there is none of that name.
const SceneEntry* find_scene(const std::string& name);

}  // namespace motley::bench
