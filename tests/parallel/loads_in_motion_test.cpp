// Heavy loads on light links that whirl, swing and float: whether the motion is kept, and not only the joints. Independent evidence:
// conservation of energy and of angular momentum, and m w^2 r.
#include <cmath>
#include <vector>

#include "level_arm.h"

namespace motley {
namespace {

using Vector = Vec3<double>;
using testing::g;
using testing::length;

constexpr double link = 0.2, load_mass = 10;

/// Cubes of 0.2 m in a row along x, joined by ball-sockets where they touch: loads of 10 kg at the end, or at both ends, and light
/// links.
struct Row {
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<double> masses;
    std::vector<ConstraintId> joints;

    void add(float mass, double x)
    {
        BodyDefinition body;
        body.position = {x, 0, 0};
        body.mass = mass;
        const float moment = mass * 0.04F / 6;
        body.inertia = {moment, 0, 0, moment, 0, moment};
        const BodyId before = bodies.empty() ? scene.ground() : bodies.back();
        bodies.push_back(scene.add_body(body));
        masses.push_back(static_cast<double>(mass));
        if (before == scene.ground()) return;
        join(before, {0.1F, 0, 0});
    }
    void join(BodyId a, Vec3<float> at)
    {
        joints.push_back(scene.add_joint(BallSocketDefinition{a, bodies.back(), at, {-0.1F, 0, 0}}));
    }
    /// Turns the whole row about z and the origin.
    void whirl(double speed)
    {
        for (const BodyId body : bodies)
            scene.set_velocity(body, {0, static_cast<float>(speed * scene.state(body).position.x), 0},
                               {0, 0, static_cast<float>(speed)});
    }
    [[nodiscard]] Vector angular_momentum() const
    {
        Vector sum{};
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const double moment = masses[i] * 0.04 / 6;
            sum = sum + testing::angular_momentum(scene.state(bodies[i]), masses[i],
                                                  Vector{moment, moment, moment});
        }
        return sum;
    }
    /// Kinetic, and potential from the lowest place that the row can hang to. Velocities are those of the middle of a substep, which
    /// moved positions by them: so are the heights here.
    [[nodiscard]] double energy(double gravity, double substep = 0) const
    {
        double sum = scene.errors().kinetic_energy;
        const double lowest = -link * (static_cast<double>(bodies.size()) - 0.5);
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const BodyState state = scene.state(bodies[i]);
            const double moved = substep * static_cast<double>(state.linear_velocity.y);
            sum += masses[i] * gravity * (state.position.y - moved / 2 - lowest);
        }
        return sum;
    }
};

/// So many light links from the origin, with a load at the end.
Row hanging(int links, float mass)
{
    Row row;
    for (int i = 0; i <= links; ++i) {
        row.add(i == links ? static_cast<float>(load_mass) : mass, link * (i + 0.5));
        if (i == 0) row.join(row.scene.ground(), {});
    }
    return row;
}
/// So many light links between two loads, with its middle in the origin.
Row floating(int links, float mass)
{
    Row row;
    for (int i = 0; i < links + 2; ++i)
        row.add(i == 0 || i == links + 1 ? static_cast<float>(load_mass) : mass,
                link * (i - 0.5 * (links + 1)));
    return row;
}

/// Which case it is.
::testing::Message named(int links, float mass, double speed, int substeps)
{
    return ::testing::Message() << links << " links of " << mass << " kg, " << speed << " rad/s, " << substeps
                                << " substeps";
}

/// A sling, without gravity.
TEST(LoadsInMotion, AreWhirledForEver)
{
    for (const bool by_default : {false, true}) {
        for (const int links : {1, 5}) {
            for (const float mass : {0.5F, 0.05F, 5e-3F, 5e-4F}) {
                for (const double speed : {1.0, 5.0}) {
                    for (const int substeps : {1, 4}) {
                        Row row = hanging(links, mass);
                        row.whirl(speed);
                        const double energy = row.energy(0);
                        const Vector before = row.angular_momentum();
                        Solver solver(by_default ? testing::by_default(substeps, {})
                                                 : testing::exact_joints(substeps, {}));
                        double pull = 0;
                        for (std::size_t i = 0; i < row.bodies.size(); ++i)
                            pull += row.masses[i] * speed * speed * row.scene.state(row.bodies[i]).position.x;
                        testing::run(row.scene, solver, 5);
                        // A step takes what it turns by for a straight line.
                        const double turned = speed / (60 * substeps);
                        const double most = 2 * turned * turned;
                        EXPECT_NEAR(row.energy(0) / energy, 1, most) << named(links, mass, speed, substeps);
                        EXPECT_LT(length(row.angular_momentum() - before), most * length(before))
                            << named(links, mass, speed, substeps);
                        const double force =
                            length(convert<double>(row.scene.joint_report(row.joints.front()).force));
                        std::printf("sling, %s: energy %.5f, force %.4f of the truth\n",
                                    named(links, mass, speed, substeps).GetString().c_str(),
                                    row.energy(0) / energy, force / pull);
                        EXPECT_NEAR(force / pull, 1, most + 0.003) << named(links, mass, speed, substeps);
                    }
                }
            }
        }
    }
}

/// A load that is let go beside the point at which its links hang, and falls into them and swings.
TEST(LoadsInMotion, SwingOnAfterAFall)
{
    for (const int links : {1, 5}) {
        for (const float mass : {0.5F, 0.05F, 5e-3F, 5e-4F}) {
            Row row = hanging(links, mass);
            const double energy = row.energy(g);
            Solver solver(testing::exact_joints(4));
            double most = 0;
            for (int i = 0; i < 300; ++i) {
                solver.step(row.scene, testing::frame_time);
                most = std::max(most, row.energy(g, 1.0 / 240));
            }
            std::printf("%d links of %g kg: %.3f of the energy after 5 s\n", links, static_cast<double>(mass),
                        row.energy(g, 1.0 / 240) / energy);
            EXPECT_LT(most, 1.01 * energy) << links << " links of " << mass << " kg";
            EXPECT_GT(row.energy(g, 1.0 / 240), 0.88 * energy) << links << " links of " << mass << " kg";
        }
    }
}

/// Two loads that circle each other on a chain, which is not straight.
TEST(LoadsInMotion, CircleEachOther)
{
    for (const int links : {1, 5, 20}) {
        for (const float mass : {0.5F, 0.05F, 5e-3F, 5e-4F}) {
            for (const double speed : {1.0, 5.0}) {
                for (const int substeps : {1, 4}) {
                    Row row = floating(links, mass);
                    row.whirl(speed);
                    for (std::size_t i = 0; i < row.bodies.size(); ++i) {
                        BodyState state = row.scene.state(row.bodies[i]);
                        const auto aside = static_cast<float>(i % 2 == 0 ? speed : -speed);
                        row.scene.set_velocity(
                            row.bodies[i],
                            state.linear_velocity + Vec3<float>{0, 0.1F * aside, 0.05F * aside},
                            state.angular_velocity + Vec3<float>{0.2F * aside, 0, 0});
                    }
                    Solver solver(testing::exact_joints(substeps, {}));
                    // A first, very short step makes the velocities satisfy the joints.
                    solver.step(row.scene, 1e-6F);
                    const double energy = row.energy(0);
                    const Vector before = row.angular_momentum();
                    double most = 0, turned = 0;
                    for (int i = 0; i < 300; ++i) {
                        solver.step(row.scene, testing::frame_time);
                        most = std::max(most, row.energy(0) / energy);
                        turned = std::max(turned, length(row.angular_momentum() - before) / length(before));
                    }
                    std::printf("%s: L changes by %.2g, energy ends at %.3f, most %.3f\n",
                                named(links, mass, speed, substeps).GetString().c_str(), turned,
                                row.energy(0) / energy, most);
                    EXPECT_LT(turned, 1e-4) << named(links, mass, speed, substeps);
                    EXPECT_GT(row.energy(0), 0.985 * energy) << named(links, mass, speed, substeps);
                    EXPECT_LT(most, 1.005) << named(links, mass, speed, substeps);
                }
            }
        }
    }
}

}  // namespace
}  // namespace motley
