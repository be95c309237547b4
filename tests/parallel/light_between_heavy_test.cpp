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

    explicit Links(double light, float speed = 1) : masses{5, light, 5}
    {
        for (std::size_t i = 0; i < 3; ++i) {
            BodyDefinition body =
                testing::box({0.5 * static_cast<double>(i), 0, 0}, static_cast<float>(masses[i]));
            body.linear_velocity = {0,
                                    speed * (i == 0   ? 0.6F
                                             : i == 1 ? 0.3F
                                                      : 0.0F),
                                    i == 2 ? speed * 0.6F : 0};
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
    for (const double light :
         {5e7, 5e5, 5e3, 5e1, 5.0, 5e-1, 5e-2, 5e-3, 5e-4, 5e-5, 1e-5, 5e-6, 4e-6, 5e-7}) {
        for (const float speed : {1.0F, 10.0F}) {
            for (const int substeps : {1, 4, 16}) {
                const bool is_refused = light < 5.0 / 1e6;
                // What is swept is thrown apart when it moves fast, or far in a substep.
                if (is_refused && (speed > 1 || substeps == 1)) continue;
                Links links(light, speed);
                SolverSettings settings;
                settings.exact_joints = true;
                settings.substeps = substeps;
                Solver solver(settings);
                const Vector p = links.momentum();
                // A first, very short step makes the velocities satisfy the joints.
                solver.step(links.scene, 1e-6F);
                const Vector l = links.angular_momentum();
                const double energy = links.scene.errors().kinetic_energy;
                StepReport report;
                for (int i = 0; i < 60; ++i) report = solver.step(links.scene, testing::frame_time);
                const double lost = length(links.momentum() - p) / length(p),
                             turned = length(links.angular_momentum() - l) / length(l);
                std::printf("%g kg, %g times as fast, %d substeps: %.2g of p, %.2g of L, %d locks swept\n",
                            light, static_cast<double>(speed), substeps, lost, turned,
                            static_cast<int>(report.exact_joints_refused));
                EXPECT_EQ(report.exact_joints_refused, is_refused ? 2 : 0);
                EXPECT_EQ(report.first_light_body, is_refused ? links.bodies[1] : BodyId{});
                // 960 substeps round four times as often as 240.
                const double most = substeps == 16 ? 2e-5 : 1e-5;
                EXPECT_LT(lost, most) << light << " kg, " << speed << ", " << substeps;
                EXPECT_LT(turned, most) << light << " kg, " << speed << ", " << substeps;
                if (!is_refused) {
                    const double ends = links.scene.errors().kinetic_energy;
                    EXPECT_NEAR(ends, energy, 0.01 * energy) << light << " kg, " << speed << ", " << substeps;
                }
            }
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
