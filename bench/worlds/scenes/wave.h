// A push runs through a standing crowd: everyone within 5 m along its edge is given 150 N s.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"

namespace motley::bench {

class Wave final : public CrowdScene {
  public:
    static constexpr double radius = 0.2, gap = 0.02;  ///< m
    static constexpr double pushed_width = 5;          ///< m
    static constexpr double push = 150;                ///< N s each

    explicit Wave(const RunOptions& options)
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        people.contact_margin = static_cast<float>(2 * gap);
        // Triangular packing in a square.
        const double pitch = 2 * radius + gap, rank = std::sqrt(0.75) * pitch;
        const auto ranks = static_cast<int>(
            std::max(1.0, std::round(std::sqrt(static_cast<double>(options.agents) * pitch / rank))));
        const auto files = static_cast<int>(std::max<std::int64_t>(1, options.agents / ranks));
        const double middle = pitch * (files - 0.5) / 2;
        for (int i = 0; i < ranks; ++i) {
            for (int j = 0; j < files; ++j) {
                Agent agent;
                agent.radius = static_cast<float>(radius);
                const double y = pitch * (j + 0.5 * (i % 2));
                people.add(scene, agent, {rank * i, y});
                start_.push_back(rank * i);
                if (i > 0 || std::abs(y - middle) > pushed_width / 2) continue;
                const auto speed = static_cast<float>(push) / agent.mass;
                scene.set_velocity(people.agents.back().body, {speed, 0, 0}, {});
                pushed_ += push;
            }
        }
        share_out_contacts(options);
    }

    void steer(double, Executor& executor) override { people.observe(scene, executor); }

    void observe(double, const Solver&) override
    {
        for (const Touch& touch : people.touches(scene)) deepest_ = std::max(deepest_, -touch.separation);
    }

    [[nodiscard]] std::vector<Mark> marks() const override
    {
        const Motion now = motion();
        // Nobody acts from outside. Bound: rounding of the speeds of 10,000 people in 300 steps of 4 substeps.
        return {{"momentum along, off what was given (share)", std::abs(now.along / pushed_ - 1), 1e-5},
                {"momentum across (share)", std::abs(now.across / pushed_), 1e-5},
                {"overlap, deepest of all steps (share of radius)", deepest_ / radius, 0.01}};
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        const Motion now = motion();
        const double given = pushed_ * push / static_cast<double>(people.agents[0].mass) / 2;
        return {{"momentum along, off what was given (share)", now.along / pushed_ - 1},
                {"momentum across (share)", now.across / pushed_},
                {"kinetic energy left (%)", 100 * now.energy / given},
                {"people moved by 1 mm", static_cast<double>(now.moved)},
                {"depth that the wave has reached (m)", now.reached}};
    }

  private:
    struct Motion {
        double along = 0, across = 0, energy = 0, reached = 0;
        std::size_t moved = 0;
    };
    double pushed_ = 0;          ///< N s
    double deepest_ = 0;         ///< m
    std::vector<double> start_;  ///< m: x of each

    [[nodiscard]] Motion motion() const
    {
        Motion now;
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            const double mass = static_cast<double>(people.agents[i].mass);
            const BodyState state = scene.state(people.agents[i].body);
            const double x = static_cast<double>(state.linear_velocity.x),
                         y = static_cast<double>(state.linear_velocity.y);
            now.along += mass * x;
            now.across += mass * y;
            now.energy += 0.5 * mass * (x * x + y * y);
            if (state.position.x - start_[i] < 1e-3) continue;
            ++now.moved;
            now.reached = std::max(now.reached, start_[i]);
        }
        return now;
    }
};

}  // namespace motley::bench
