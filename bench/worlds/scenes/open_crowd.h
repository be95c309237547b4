// N people, 5 per m2 unless the options say otherwise, in a walled square, each with a goal some metres away, and a new goal when it is reached.
#pragma once

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/random.h"

namespace motley::bench {

class OpenCrowd final : public CrowdScene {
  public:
    static constexpr double default_density = 5;  ///< people per m2

    explicit OpenCrowd(const RunOptions& options) : random_(options.seed)
    {
        const auto count = static_cast<std::size_t>(options.agents);
        const double density = options.density > 0 ? options.density : default_density;
        side_ = std::sqrt(static_cast<double>(count) / density);
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
        const double pitch = side_ / static_cast<double>(columns);
        for (std::size_t i = 0; i < count; ++i) {
            Agent agent;
            // Radius 0.20 m +- 8 %, as in a crowd of men and women.
            agent.radius = static_cast<float>(0.20 * (1 + 0.08 * random_.symmetric()));
            const Vec2<double> at{
                pitch * (0.5 + static_cast<double>(i % columns)) + 0.01 * random_.symmetric(),
                pitch * (0.5 + static_cast<double>(i / columns)) + 0.01 * random_.symmetric()};
            agent.goal = goal_near(at);
            people.add(scene, agent, at);
        }
        people.walls = {{{0, 0}, {side_, 0}},
                        {{side_, 0}, {side_, side_}},
                        {{side_, side_}, {0, side_}},
                        {{0, side_}, {0, 0}}};
        people.steering = make_steering(options.steering);
        share_out_contacts(options);
    }

    void steer(double time, Executor& executor) override
    {
        CrowdScene::steer(time, executor);
        // Each step checks one person in sixty for arrival: often enough for walks that take seconds.
        for (std::size_t i = turn_; i < people.agents.size(); i += 60) {
            const double dx = people.agents[i].goal.x - people.positions[i].x,
                         dy = people.agents[i].goal.y - people.positions[i].y;
            if (dx * dx + dy * dy < 1)
                people.agents[i].goal = goal_near({people.positions[i].x, people.positions[i].y});
        }
        turn_ = (turn_ + 1) % 60;
    }

  private:
    Random random_;
    double side_ = 0;
    std::size_t turn_ = 0;

    Vec2<double> goal_near(Vec2<double> at)
    {
        constexpr double walk = 20;  // m
        return {std::clamp(at.x + walk * random_.symmetric(), 0.3, side_ - 0.3),
                std::clamp(at.y + walk * random_.symmetric(), 0.3, side_ - 0.3)};
    }
};

}  // namespace motley::bench
