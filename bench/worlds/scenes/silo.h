// A packed slab between two side walls with friction, which take a share of the load as the walls of a silo do.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/scenes/rows.h"

namespace motley::bench {

/// Janssen's law (1895): with a ratio K of side to axial stress and a share mu of the side stress that acts as friction,
/// the axial stress at a depth z from the free end is f rho l (1 - exp(-z/l)), l = W/(2 mu K). K and mu mobilised are
/// measured in the run, so that the law tells whether the profile has its form; it is printed beside the stress and is no
/// mark. What must hold is that front and side walls together carry what everybody leans with, and Coulomb's cone.
class Silo final : public CrowdScene {
  public:
    static constexpr double radius = 0.2;
    static constexpr double force = 50;      ///< N each, towards -x
    static constexpr int people_a_row = 12;  ///< between the side walls
    static constexpr double width = 2 * radius * people_a_row + radius;
    static constexpr double pitch = 1.7320508075688772 * radius;

    explicit Silo(const RunOptions& options)
    {
        people.friction = options.friction < 0 ? 0.3F : options.friction;
        rows_ = static_cast<int>(std::max<std::int64_t>(8, options.agents / people_a_row));
        for (int row = 0; row < rows_; ++row) {
            for (int i = 0; i < people_a_row; ++i) {
                Agent agent;
                agent.radius = static_cast<float>(radius);
                people.add(scene, agent, {radius + pitch * row, radius * (1 + row % 2) + 2 * radius * i});
            }
        }
        const double length = pitch * rows_ + 1;
        people.walls = {{{0, -1}, {0, width + 1}}, {{-1, 0}, {length, 0}}, {{-1, width}, {length, width}}};
        share_out_contacts(options);
        axial_.resize(static_cast<std::size_t>(rows_));
    }

    void steer(double time, Executor& executor) override
    {
        people.observe(scene, executor);
        // Slowly: people who are let loose at once gain speed until they are packed, and what stops them is held by
        // friction from then on, which at the free end would point forward.
        const double now = force * std::min(1.0, time / loading);
        const std::vector<Vec3<float>> forces(people.agents.size(), {-static_cast<float>(now), 0, 0});
        scene.set_forces(people.bodies(), forces);
    }

    void observe(double time, const Solver&) override
    {
        if (time < settle) return;
        double front = 0, along = 0;  // N
        double pressing = 0;          // N: the normal forces
        double excess = 0;            // N: the most that friction has beyond its cone
        const std::vector<Touch> touches = people.touches(scene);
        for (const Touch& touch : touches) {
            deepest_ = std::max(deepest_, -touch.separation);
            pressing += touch.force;
            excess = std::max(excess,
                              std::abs(touch.friction) - static_cast<double>(people.friction) * touch.force);
            const double push_x = touch.force * static_cast<double>(touch.normal.x) -
                                  touch.friction * static_cast<double>(touch.normal.y);
            const auto row = static_cast<std::size_t>(touch.b) / people_a_row;
            if (touch.a < 0 && touch.wall == 0) {
                front += push_x;
                axial_[0] += push_x;
            } else if (touch.a < 0) {
                along += push_x;
                side_ += touch.force;
                rubbing_ += push_x;
            } else {
                // Who is in front carries the one behind: the stress between two rows counts for the row behind.
                const auto other = static_cast<std::size_t>(touch.a) / people_a_row;
                if (other != row) axial_[std::max(row, other)] += row > other ? push_x : -push_x;
            }
        }
        balance_.add((front + along) / (force * static_cast<double>(people.agents.size())) - 1);
        if (!touches.empty())
            cone_ = std::max(cone_, excess / (pressing / static_cast<double>(touches.size())));
        ++samples_;
    }

    [[nodiscard]] std::vector<Figure> figures() const override
    {
        if (samples_ == 0) return {};
        double axial = 0;  // N m, the force summed over the length
        for (const double a : axial_) axial += a * pitch;
        const double ratio = side_ / 2 * width / axial;  // of side to axial stress, K
        std::vector<Figure> figures{
            {"side stress over axial stress", ratio},
            {"share of the load that the side walls take (%)",
             100 * rubbing_ / samples_ / (force * static_cast<double>(people.agents.size()))}};
        if (people.friction <= 0) return figures;  // a slab: nothing to compare
        const double mu = rubbing_ / side_;
        const double density = people_a_row / (width * pitch);
        const double depth = width / (2 * mu * ratio);
        figures.emplace_back("friction mobilised at the side walls (share of mu)",
                             mu / static_cast<double>(people.friction));
        for (int part = 0; part < 5; ++part) {
            const auto row = static_cast<std::size_t>(rows_ * part / 5);
            const std::string where =
                fmt::format("{:.1f} m from the front", pitch * static_cast<double>(row));
            const double behind = pitch * (rows_ - static_cast<double>(row));
            const double janssen = density * force * depth * (1 - std::exp(-behind / depth));
            figures.emplace_back(fmt::format("stress {} (N/m)", where), axial_[row] / samples_ / width);
            figures.emplace_back(fmt::format("Janssen's stress {} (N/m)", where), janssen);
            figures.emplace_back(fmt::format("stress without side walls {} (N/m)", where),
                                 density * force * behind);
        }
        return figures;
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        if (samples_ == 0) return {};
        // Of the mean force and not of each contact's own: a contact that is about to part bears next to nothing.
        return {{"front and side walls off the whole load, rms per step (share)", balance_.root(), 0.02},
                {"friction beyond its cone, most (share of the mean contact force)", cone_, 1e-4},
                {"overlap, deepest of all steps (share of radius)", deepest_ / radius, 0.01}};
    }

  private:
    static constexpr double loading = 10,
                            settle = 14;  ///< s: until everybody leans fully, and before sampling
    int rows_ = 0;
    std::vector<double>
        axial_;  ///< N: the force between each row and the one before it, or the front wall; summed
    double side_ = 0, rubbing_ = 0;  ///< N: on the side walls, summed over the samples
    double cone_ = 0, deepest_ = 0;
    MeanSquare balance_;
    int samples_ = 0;
};

}  // namespace motley::bench
