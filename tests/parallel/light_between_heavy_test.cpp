// A light body between heavy ones, floating freely. Independent evidence: conservation of momentum and angular
// momentum.
#include <array>

#include "rig.h"

namespace motley {
namespace {

using Vector = Vec3<double>;
using testing::length;

/// Three bodies joined by two hinges: 5 kg, m, 5 kg.
struct Links {
    Scene scene;
    std::array<BodyId, 3> bodies;
    std::array<double, 3> masses;

    explicit Links(double light) : masses{5, light, 5}
    {
        for (std::size_t i = 0; i < 3; ++i) {
            BodyDefinition body =
                testing::box({0.5 * static_cast<double>(i), 0, 0}, static_cast<float>(masses[i]));
            body.linear_velocity = {0, i == 0 ? 0.6F : i == 1 ? 0.3F : 0.0F, i == 2 ? 0.6F : 0.0F};
            bodies[i] = scene.add_body(body);
        }
        for (std::size_t i = 1; i < 3; ++i) {
            HingeDefinition hinge;
            hinge.body_a = bodies[i - 1];
            hinge.body_b = bodies[i];
            hinge.frame_a.position = {0.25F, 0, 0};
            hinge.frame_b.position = {-0.25F, 0, 0};
            hinge.frame_a.rotation = hinge.frame_b.rotation = testing::axis_along(static_cast<int>(i));
            scene.add_joint(hinge);
        }
    }
    [[nodiscard]] Vector momentum() const
    {
        Vector sum{};
        for (std::size_t i = 0; i < 3; ++i)
            sum = sum + masses[i] * convert<double>(scene.state(bodies[i]).linear_velocity);
        return sum;
    }
    [[nodiscard]] Vector angular_momentum() const
    {
        Vector sum{};
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector moments{static_cast<double>(0.1F), static_cast<double>(0.2F), 0.25};
            sum = sum + testing::angular_momentum(scene.state(bodies[i]), masses[i], masses[i] * moments);
        }
        return sum;
    }
};

TEST(LightBetweenHeavy, MomentumIsKept)
{
    for (const double light : {5e7, 5e5, 5e3, 5e1, 5.0, 5e-1, 5e-2, 5e-3, 5e-4, 5e-5, 5e-6, 5e-7}) {
        for (const int substeps : {4, 16}) {
            Links links(light);
            SolverSettings settings;
            settings.exact_joints = true;
            settings.substeps = substeps;
            Solver solver(settings);
            const Vector p = links.momentum();
            // A first, very short step makes the velocities satisfy the joints.
            solver.step(links.scene, 1e-6F);
            const Vector l = links.angular_momentum();
            StepReport report;
            for (int i = 0; i < 60; ++i) report = solver.step(links.scene, testing::frame_time);
            const double lost = length(links.momentum() - p) / length(p),
                         turned = length(links.angular_momentum() - l) / length(l);
            std::printf("%g kg, %d substeps: %.2g of p, %.2g of L, %d locks swept\n", light, substeps, lost,
                        turned, static_cast<int>(report.exact_joints_refused));
            // 960 substeps round four times as often as 240.
            const double most = substeps == 4 ? 1e-5 : 2e-5;
            EXPECT_LT(lost, most) << light << " kg, " << substeps;
            EXPECT_LT(turned, most) << light << " kg, " << substeps;
            const bool is_refused = light < 5.0 / 2000;
            EXPECT_EQ(report.exact_joints_refused, is_refused ? 2 : 0);
            EXPECT_EQ(report.first_light_body, is_refused ? links.bodies[1] : BodyId{});
        }
    }
}

TEST(LightBetweenHeavy, IsSolvedExactlyWhereTheWorldHoldsTheFigure)
{
    // Figures held by the world are never refused: their momentum is not conserved anyway, so light links may bear
    // any load.
    Links links(5e-6);
    BallSocketDefinition hook;
    hook.body_a = links.scene.ground();
    hook.body_b = links.bodies[0];
    hook.local_anchor_b = {-0.25F, 0, 0};
    hook.local_anchor_a = {-0.25F, 0, 0};
    links.scene.add_joint(hook);
    SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
    settings.exact_joints = true;
    EXPECT_EQ(Solver(settings).step(links.scene, testing::frame_time).exact_joints_refused, 0);
}

}  // namespace
}  // namespace motley
