// People who walk from goal to goal in a hall with pillars, on one scene or on several ranks. What a person does follows from
// the person's number, place and velocity, and from how many goals were reached, which Scene::user_data remembers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "motley/mpi/distributed_crowd.h"

namespace motley::testing {

struct WalkersOptions {
    int people = 3000;
    double spacing = 0.5;    ///< m
    float friction = 0;      ///< of every other person
    bool to_corner = false;  ///< all want to be in one corner
    float speed = 1.4F;      ///< m/s, wanted
    int walks_one_in = 1;    ///< the others stand; 0: nobody walks
};

class Walkers {
  public:
    explicit Walkers(const WalkersOptions& options) : options_(options)
    {
        const int columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(1.5 * options.people))));
        width = options.spacing * std::max(columns, 4);
        height = options.spacing * std::max((options.people + columns - 1) / columns, 4);
        for (int i = 0; i < options.people; ++i) {
            const auto number = static_cast<std::uint64_t>(i);
            DiscDefinition disc;
            disc.radius = static_cast<float>(0.2 * (1 + 0.1 * symmetric(number, 1)));
            disc.friction = i % 2 == 0 ? options.friction : 0;
            BodyDefinition body;
            body.model = BodyModel::planar;
            body.mass = static_cast<float>(75 + 20 * symmetric(number, 2));
            body.inertia.zz = 0.5F * body.mass * disc.radius * disc.radius;
            body.position = {options.spacing * (i % columns + 0.5) + 0.02 * symmetric(number, 3),
                             options.spacing * (i / columns + 0.5) + 0.02 * symmetric(number, 4), 0};
            numbers.push_back(number);
            bodies.push_back(body);
            discs.push_back(disc);
        }
    }

    std::vector<std::uint64_t> numbers;
    std::vector<BodyDefinition> bodies;
    std::vector<DiscDefinition> discs;
    double width = 0, height = 0;  ///< m

    void add_walls(Scene& scene) const
    {
        const std::vector<Vec2<double>> hall{{0, 0}, {width, 0}, {width, height}, {0, height}};
        scene.add_wall({.points = hall, .closed = true});
        for (int i = 1; i < 4; ++i) {
            const double x = width * i / 4, y = height * (i % 2 + 1) / 3, r = 0.15;
            const std::vector<Vec2<double>> pillar{{x - r, y}, {x, y - r}, {x + r, y}, {x, y + r}};
            scene.add_wall({.points = pillar, .closed = true, .friction = options_.friction});
        }
    }
    void steer(Scene& scene, std::span<const OwnPerson> people) const
    {
        for (const OwnPerson& person : people) {
            const BodyState state = scene.state(person.body);
            const std::uint64_t reached = scene.user_data(person.body);
            const Vec2<double> goal = goal_of(person.number, reached);
            const double x = goal.x - state.position.x, y = goal.y - state.position.y;
            const double distance = std::sqrt(x * x + y * y);
            if (distance < 1) scene.set_user_data(person.body, reached + 1);
            const bool walks = options_.walks_one_in > 0 &&
                               person.number % static_cast<std::uint64_t>(options_.walks_one_in) == 0;
            const auto wanted =
                walks ? static_cast<float>(1 / std::max(distance, 0.1)) * options_.speed : 0.0F;
            const float gain = bodies[person.number].mass / 0.5F;
            scene.set_force(person.body,
                            {gain * (wanted * static_cast<float>(x) - state.linear_velocity.x),
                             gain * (wanted * static_cast<float>(y) - state.linear_velocity.y), 0},
                            {});
        }
    }

  private:
    WalkersOptions options_;

    /// -1 to 1, of a person and a purpose.
    static double symmetric(std::uint64_t number, std::uint64_t purpose)
    {
        std::uint64_t bits = number * 0x9E3779B97F4A7C15ULL + purpose * 0xD1B54A32D192ED03ULL;
        bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9ULL;
        bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBULL;
        return static_cast<double>(bits >> 11) / 4503599627370496.0 - 1;
    }
    [[nodiscard]] Vec2<double> goal_of(std::uint64_t number, std::uint64_t reached) const
    {
        if (options_.to_corner) return {0.3, 0.3};
        return {width * (0.5 + 0.48 * symmetric(number, 2 * reached + 10)),
                height * (0.5 + 0.48 * symmetric(number, 2 * reached + 11))};
    }
};

/// The same on one scene, by one process.
class WalkersOnOneScene {
  public:
    Scene scene;
    std::vector<OwnPerson> people;

    WalkersOnOneScene(const Walkers& walkers, const SolverSettings& settings, const SolverOptions& options)
        : walkers_(walkers), solver_(settings, options)
    {
        walkers.add_walls(scene);
        std::vector<BodyId> ids(walkers.bodies.size());
        scene.add_bodies(walkers.bodies, ids);
        scene.set_discs(ids, {walkers.discs.data(), walkers.discs.size()});
        for (std::size_t i = 0; i < ids.size(); ++i) people.push_back({walkers.numbers[i], ids[i]});
    }
    StepReport step(float dt)
    {
        walkers_.steer(scene, people);
        return solve(dt);
    }
    StepReport solve(float dt) { return solver_.step(scene, dt); }
    /// What all bear, by number.
    [[nodiscard]] std::vector<BodyLoad> read_loads() const
    {
        std::vector<BodyLoad> loads(people.size());
        std::vector<BodyId> ids;
        std::vector<float> circumferences;
        for (const OwnPerson& person : people) {
            ids.push_back(person.body);
            circumferences.push_back(2 * std::numbers::pi_v<float> * walkers_.discs[person.number].radius);
        }
        scene.read_loads(ids, {}, std::span<BodyLoad>(loads), std::span<const float>(circumferences));
        return loads;
    }
    /// `number` is that of somebody there.
    void remove(std::uint64_t number)
    {
        const auto person = std::find_if(people.begin(), people.end(),
                                         [&](const OwnPerson& p) { return p.number == number; });
        scene.remove_body(person->body);
        people.erase(person);
    }
    [[nodiscard]] std::uint64_t hash() const
    {
        std::vector<std::uint64_t> numbers;
        std::vector<BodyId> ids;
        for (const OwnPerson& person : people) {
            numbers.push_back(person.number);
            ids.push_back(person.body);
        }
        return people_hash(scene, numbers, ids);
    }

  private:
    const Walkers& walkers_;
    Solver solver_;
};

}  // namespace motley::testing
