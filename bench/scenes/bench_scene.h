// What every scene of the bench is: something that fills a motley::Scene and does the host's part of a step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

/// What a scene may be told. Zero agents: the scene's own number.
struct SceneOptions {
    int agents = 0;
    float dt = 1.0F / 60;         ///< s
    float friction = 0;           ///< coefficient of every contact
    std::uint64_t seed = 1;       ///< of everything drawn by lot
    double seconds = 10;          ///< how long the run will be, for scenes that settle first
    std::filesystem::path data;   ///< folder of recorded data; empty: the one of the source tree
};

/// Host time of a step, s, apart from the solver's.
struct HostSeconds {
    double exchange = 0;  ///< reading positions and velocities, writing forces
    double steering = 0;
    double search = 0;
    [[nodiscard]] double total() const { return exchange + steering + search; }
};

/// One more line of a scene's result, beside what every scene reports.
struct Finding {
    std::string name;
    double value = 0;
    std::string unit;
    std::optional<double> expected{};  ///< from a law or an experiment
};

/// What a picture shows: discs coloured by a value, over straight lines.
struct Picture {
    struct Disc {
        Vec2<double> centre{};
        double radius = 0;
        double value = 0;
    };
    struct Line {
        Vec2<double> from{}, to{};
    };
    Vec2<double> low{}, high{};  ///< corners of the view, m
    std::vector<Disc> discs;
    std::vector<Line> lines;
    std::string legend;     ///< what the colours mean
    double full_scale = 1;  ///< value of the last colour
};

/// A scene in motion. Each step: prepare_step, Solver::step with the contacts it returned, observe_step.
class BenchScene {
  public:
    virtual ~BenchScene() = default;
    BenchScene() = default;
    BenchScene(const BenchScene&) = delete;
    BenchScene& operator=(const BenchScene&) = delete;

    [[nodiscard]] Scene& scene() { return scene_; }
    [[nodiscard]] const Scene& scene() const { return scene_; }

    /// Steers, searches, and returns the contacts of the step, valid until the next call.
    virtual std::span<const Contact> prepare_step(Executor& executor, HostSeconds& seconds) = 0;
    /// Measures after a step and lets people leave. Not timed. `second_half` is false while the run settles.
    virtual void observe_step(std::span<const Contact> contacts, bool second_half) = 0;
    /// True when nothing will happen any more.
    [[nodiscard]] virtual bool is_finished() const { return false; }
    /// Lines of the result that only this scene has.
    [[nodiscard]] virtual std::vector<Finding> findings() const { return {}; }
    /// The present state, coloured by what the last step's contacts or joints did.
    [[nodiscard]] virtual Picture picture(std::span<const Contact> contacts) const = 0;
    /// People (or bodies) and their positions when the present step was prepared, for trajectories.
    [[nodiscard]] virtual std::span<const int> numbers() const = 0;
    [[nodiscard]] virtual std::span<const Vec3<double>> positions() const = 0;
    /// The radius that overlaps are compared with, m; 0 for scenes without contacts.
    [[nodiscard]] virtual double nominal_radius() const { return 0; }

  protected:
    Scene scene_;
};

}  // namespace motley::bench
