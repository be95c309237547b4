// Flight under constant forces without contact. Independent evidence: x = x_0 + v_0 t + a t^2 / 2, for bodies and for
// the centres of mass of bodies that joints connect.
#include <gtest/gtest.h>

#include <vector>

#include "motley/motley.h"
#include "rig.h"

namespace motley {
namespace {

using Vector = Vec3<double>;
using testing::length;

constexpr Vec3<float> gravity{0, -9.81F, 0};

Vector flown(const Vector& start, const Vec3<float>& velocity, const Vec3<float>& acceleration,
             double seconds)
{
    return start + seconds * convert<double>(velocity) +
           0.5 * seconds * seconds * convert<double>(acceleration);
}

struct Case {
    Method method;
    int substeps;
    float dt;
};
std::vector<Case> all_cases()
{
    std::vector<Case> cases;
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct})
        for (const int substeps : {1, 4, 16})
            for (const float dt : {1.0F / 240, 1.0F / 60, 1.0F / 10}) cases.push_back({method, substeps, dt});
    return cases;
}

Solver solver_of(const Case& of, bool exact_joints = false)
{
    SolverSettings settings;
    settings.method = of.method;
    settings.substeps = of.substeps;
    settings.gravity = gravity;
    settings.exact_joints = exact_joints;
    return Solver(settings);
}

/// Steps for about two seconds, or a tenth of it under a sanitizer. Returns the exact time.
double fly(Scene& scene, Solver solver, float dt)
{
    const int steps = testing::long_run(static_cast<int>(2 / dt + 0.5F));
    for (int i = 0; i < steps; ++i) EXPECT_EQ(solver.step(scene, dt).status, StepStatus::done);
    return steps * static_cast<double>(dt);
}

/// Rounding of floats, m. Velocities up to 16 m/s are off by half a unit in the last place a substep, 4.8e-7 m/s,
/// with much the same sign in every substep; on average this acts for half of the two seconds. Displacements add as
/// much.
double rounding_of(const Case& of)
{
    const double substeps = 2 / static_cast<double>(of.dt) * of.substeps;
    return 2e-5 + 4.8e-7 * substeps;
}

class FreeFlight : public ::testing::TestWithParam<Case> {};

TEST_P(FreeFlight, OfBodiesIsExactWhateverTheStep)
{
    const Vec3<float> force{3, 1, -2}, velocity{1, 4, 0.5F};
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        // Seventeen bodies: sixteen are in one block of lanes, one is alone.
        Scene scene;
        std::vector<BodyId> bodies;
        for (int i = 0; i < 17; ++i) {
            BodyDefinition body;
            body.model = model;
            body.mass = static_cast<float>(1 + i);
            body.position = {3.0 * i, 0, 0};
            body.linear_velocity = velocity;
            if (model == BodyModel::planar) body.linear_velocity.z = 0;
            bodies.push_back(scene.add_body(body));
            scene.set_force(bodies.back(), force,
                            model == BodyModel::planar ? Vec3<float>{0, 0, 0.25F} : Vec3<float>{});
        }
        const double seconds = fly(scene, solver_of(GetParam()), GetParam().dt);
        for (int i = 0; i < 17; ++i) {
            const float over_mass = 1 / static_cast<float>(1 + i);
            Vec3<float> acceleration = over_mass * force + gravity, start_velocity = velocity;
            if (model == BodyModel::planar) acceleration.z = start_velocity.z = 0;
            const Vector truth = flown({3.0 * i, 0, 0}, start_velocity, acceleration, seconds);
            const BodyState state = scene.state(bodies[static_cast<std::size_t>(i)]);
            EXPECT_LT(length(state.position - truth), rounding_of(GetParam()))
                << static_cast<int>(model) << ' ' << i;
            if (model == BodyModel::planar) {
                EXPECT_NEAR(state.yaw,
                            0.5 * seconds * seconds * 0.25 / static_cast<double>(BodyDefinition{}.inertia.zz),
                            rounding_of(GetParam()));
            }
        }
    }
}

/// A chain is thrown and tumbles; a constant force pushes its first body sideways.
TEST_P(FreeFlight, OfWhatJointsTieTogetherIsExactInTheMiddle)
{
    for (const bool exact : {false, true}) {
        Scene scene;
        std::vector<BodyId> bodies;
        std::vector<double> masses;
        double mass = 0;
        Vector start{}, momentum{};
        for (int i = 0; i < 6; ++i) {
            BodyDefinition body;
            body.mass = static_cast<float>(1 + i % 3);
            body.position = {0.4 * i, 0, 0};
            body.linear_velocity = {1, 5 + 0.5F * static_cast<float>(i), 0};
            body.angular_velocity = {0, 0, 1.25F};
            bodies.push_back(scene.add_body(body));
            mass += static_cast<double>(body.mass);
            masses.push_back(static_cast<double>(body.mass));
            start = start + static_cast<double>(body.mass) * body.position;
            momentum = momentum + static_cast<double>(body.mass) * convert<double>(body.linear_velocity);
            if (i == 0) continue;
            BallSocketDefinition joint{
                bodies[static_cast<std::size_t>(i) - 1], bodies.back(), {0.2F, 0, 0}, {-0.2F, 0, 0}};
            scene.add_joint(joint);
        }
        const Vec3<float> force{0, 0, 4};
        scene.set_force(bodies[0], force, {});
        const double seconds = fly(scene, solver_of(GetParam(), exact), GetParam().dt);
        Vector middle{};
        for (std::size_t i = 0; i < bodies.size(); ++i)
            middle = middle + masses[i] / mass * scene.state(bodies[i]).position;
        const Vector truth =
            1 / mass * (start + seconds * momentum) +
            0.5 * seconds * seconds * (1 / mass * convert<double>(force) + convert<double>(gravity));
        // The impulses of joints cancel, up to the rounding of their bodies' velocities.
        EXPECT_LT(length(middle - truth), 4 * rounding_of(GetParam())) << "exact " << exact;
    }
}

/// A slack rope exerts no force: the ball flies freely until the rope is taut, and then not beyond it.
TEST_P(FreeFlight, EndsWhereTheRopeDoes)
{
    Scene scene;
    BodyDefinition body;
    body.linear_velocity = {2, 0, 0};
    const BodyId ball = scene.add_body(body);
    DistanceDefinition rope;
    rope.body_a = scene.ground();
    rope.body_b = ball;
    rope.min_length = 0;
    rope.max_length = 3;
    scene.add_joint(rope);
    Solver solver = solver_of(GetParam());
    double seconds = 0;
    for (; seconds + static_cast<double>(GetParam().dt) < 0.6; seconds += static_cast<double>(GetParam().dt))
        solver.step(scene, GetParam().dt);
    const Vector truth = flown({}, body.linear_velocity, gravity, seconds);
    ASSERT_LT(length(truth), 3);
    EXPECT_LT(length(scene.state(ball).position - truth), rounding_of(GetParam()));
    for (int i = 0; i * static_cast<double>(GetParam().dt) < 2; ++i) solver.step(scene, GetParam().dt);
    EXPECT_LT(length(scene.state(ball).position), 3.2);
}

INSTANTIATE_TEST_SUITE_P(Cases, FreeFlight, ::testing::ValuesIn(all_cases()), [](const auto& parameter) {
    const Case& of = parameter.param;
    return std::string(of.method == Method::soft_step ? "soft"
                       : of.method == Method::direct  ? "direct"
                                                      : "impulse") +
           "_" + std::to_string(of.substeps) + "_substeps_" +
           std::to_string(static_cast<int>(1 / of.dt + 0.5F)) + "_Hz";
});

}  // namespace
}  // namespace motley
