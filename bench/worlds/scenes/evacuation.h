// Everybody leaves a square room by one door. The flow tests the steering; what tests the solver is that nobody gets
// through a wall.
#pragma once

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/random.h"
#include "worlds/scenes/door_count.h"

namespace motley::bench {

class Evacuation final : public CrowdScene {
  public:
    static constexpr double default_door = 1.2;    ///< m
    static constexpr double density = 3;           ///< people per m2 at the start
    static constexpr double published_flow = 1.9;  ///< persons/(m s): a mean of many experiments

    explicit Evacuation(const RunOptions& options)
        : door_(options.door > 0 ? options.door : default_door),
          side_(std::max(std::sqrt(static_cast<double>(options.agents) / density), door_ + 2))
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        Random random(options.seed);
        const auto count = static_cast<std::size_t>(options.agents);
        const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
        const double pitch = side_ / static_cast<double>(columns);
        for (std::size_t i = 0; i < count; ++i) {
            Agent agent;
            agent.radius = static_cast<float>(0.20 * (1 + 0.08 * random.symmetric()));
            const double column = static_cast<double>(i % columns), row = static_cast<double>(i / columns);
            people.add(scene, agent,
                       {pitch * (0.5 + column) + 0.03 * random.symmetric() - side_ / 2,
                        pitch * (0.5 + row) + 0.03 * random.symmetric()});
        }
        const double half = side_ / 2;
        people.walls = {{{-half, 0}, {-door_ / 2, 0}},
                        {{door_ / 2, 0}, {half, 0}},
                        {{half, 0}, {half, side_}},
                        {{half, side_}, {-half, side_}},
                        {{-half, side_}, {-half, 0}}};
        people.steering = make_steering(options.steering);
        share_out_contacts(options);
    }

    void steer(double time, Executor& executor) override
    {
        time_ = time;
        people.observe(scene, executor);
        before_.resize(people.agents.size(), {{}, true});
        if (time > 0) watch_walls_and_door(time);
        leave();
        people.observe(scene, executor);
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            const Vec3<double>& p = people.positions[i];
            before_[i].at = {p.x, p.y};
            // People walk to the nearest point of the opening that their disc fits through, then straight on.
            const double half = std::max(0.0, door_ / 2 - static_cast<double>(people.agents[i].radius));
            const bool is_in_door = p.y <= 0 || (p.y < 0.2 && std::abs(p.x) <= half);
            people.agents[i].goal =
                is_in_door ? Vec2<double>{p.x, -5} : Vec2<double>{std::clamp(p.x, -half, half), 0.0};
        }
        people.steer(scene, executor);
    }

    void observe(double, const Solver&) override
    {
        for (const Touch& touch : people.touches(scene)) {
            deepest_ = std::max(deepest_, -touch.separation);
            strongest_ = std::max(strongest_, touch.force);
        }
    }

    [[nodiscard]] bool is_over(double) const override { return people.agents.empty(); }

    [[nodiscard]] std::vector<Figure> figures() const override
    {
        DoorCount count = count_;
        if (!people.agents.empty()) count.stop(time_);
        return {{"people through the door", static_cast<double>(count.passed())},
                {"flow (persons/s)", count.flow()},
                {"flow per width (persons/(m s))", count.flow() / door_},
                {"published flow per width (persons/(m s))", published_flow},
                {"clogs: nobody for more than 1 s", static_cast<double>(count.clogs())},
                {"clogged in all (s)", count.clogged()},
                {"longest without anybody (s)", count.longest()},
                {"overlap, deepest of all steps (% of radius)", 100 * deepest_ / 0.2},
                {"largest contact force of all steps (N)", strongest_}};
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        return {{"people through a wall", static_cast<double>(breaches_), 0}};
    }

  private:
    struct Before {
        Vec2<double> at;
        bool is_inside;
    };
    double door_, side_;  ///< m
    double time_ = 0;
    DoorCount count_;
    int breaches_ = 0;
    double deepest_ = 0, strongest_ = 0;
    std::vector<Before> before_;  ///< of each person, a step ago

    void watch_walls_and_door(double time)
    {
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            const Vec3<double>& p = people.positions[i];
            Before& before = before_[i];
            if (before.is_inside && (std::abs(p.x) > side_ / 2 || p.y > side_)) ++breaches_;
            if (before.at.y > 0 && p.y <= 0) {
                const double share = before.at.y / (before.at.y - p.y);
                const double x = before.at.x + share * (p.x - before.at.x);
                if (std::abs(x) > door_ / 2) ++breaches_;
                // Somebody pushed back is not counted twice.
                if (before.is_inside) count_.pass(time);
                before.is_inside = false;
            }
        }
    }
    void leave()
    {
        for (std::size_t i = people.agents.size(); i-- > 0;) {
            if (people.positions[i].y > -1.5) continue;
            people.remove(scene, i);
            before_[i] = before_.back();
            before_.pop_back();
        }
    }
};

}  // namespace motley::bench
