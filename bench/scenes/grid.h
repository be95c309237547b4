// Nets and chains of ball-sockets: joints alone, no contacts, no people.
#pragma once

#include <cmath>

#include "../bench_scene.h"
#include "../random.h"

namespace motley::bench {

/// Joints under gravity along -y; no contacts.
class JointScene : public BenchScene {
  public:
    void adjust(SolverSettings& settings) const override { settings.gravity = {0, -9.81F, 0}; }
    void steer(double, Executor&) override {}
    std::span<const Contact> find_contacts(Executor&) override { return {}; }
    void observe(double, const Solver&) override {}
};

/// N x N bodies of 1 kg, unit spacing, neighbours tied midway, the top row static, a little out-of-plane speed.
class Grid final : public JointScene {
  public:
    explicit Grid(const RunOptions& options)
    {
        const int side =
            std::max(2, static_cast<int>(std::lround(std::sqrt(static_cast<double>(options.agents)))));
        Random random(options.seed);
        std::vector<BodyId> ids;
        for (int column = 0; column < side; ++column) {
            for (int row = 0; row < side; ++row) {
                BodyDefinition body;
                body.position = {static_cast<double>(column), -static_cast<double>(row), 0};
                body.inertia = {0.064F, 0, 0, 0.064F, 0, 0.064F};
                if (row == 0) {
                    body.motion = BodyMotion::static_body;
                } else {
                    body.linear_velocity.z = static_cast<float>(0.5 * random.symmetric());
                }
                ids.push_back(scene.add_body(body));
            }
        }
        const auto at = [&](int column, int row) {
            return ids[static_cast<std::size_t>(column * side + row)];
        };
        for (int column = 0; column < side; ++column) {
            for (int row = 1; row < side; ++row) {
                scene.add_joint(
                    BallSocketDefinition{at(column, row - 1), at(column, row), {0, -0.5F, 0}, {0, 0.5F, 0}});
                if (column == 0) continue;
                scene.add_joint(
                    BallSocketDefinition{at(column - 1, row), at(column, row), {0.5F, 0, 0}, {-0.5F, 0, 0}});
            }
        }
    }
};

/// Chains of 20 capsule-like bodies of 1 kg, 0.5 m apart, the first tied to the world, starting level.
class Chains final : public JointScene {
  public:
    explicit Chains(const RunOptions& options)
    {
        constexpr int links = 20;
        const auto chains = static_cast<int>(options.agents / links);
        for (int chain = 0; chain < chains; ++chain) {
            const double y = -(chain / 32), z = chain % 32;
            BodyId before = scene.ground();
            for (int i = 0; i < links; ++i) {
                BodyDefinition body;
                body.position = {0.25 + 0.5 * i, y, z};
                body.inertia = {0.005F, 0, 0, 0.02333F, 0, 0.02333F};
                const BodyId link = scene.add_body(body);
                const Vec3<float> on_before =
                    i == 0 ? Vec3<float>{0, static_cast<float>(y), static_cast<float>(z)}
                           : Vec3<float>{0.25F, 0, 0};
                scene.add_joint(BallSocketDefinition{before, link, on_before, {-0.25F, 0, 0}});
                before = link;
            }
        }
    }
};

}  // namespace motley::bench
