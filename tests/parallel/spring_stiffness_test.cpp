// Springs and dampers in N m/rad and N m s/rad, armatures (rotors), and torques through light bodies. Independent
// evidence: closed forms, and energy that must not grow.
#include <numbers>

#include "mixed_scene.h"
#include "swing.h"

namespace motley {
namespace {

using testing::axis_along;
using testing::box;
using testing::frame_time;

constexpr float pi = std::numbers::pi_v<float>;

/// Adds a hinge about z through both centres, and this drive on it.
ConstraintId hang_on(Scene& scene, BodyId a, BodyId b, TwistDriveDefinition drive)
{
    const JointFrame about_z{{}, axis_along(2)};
    scene.add_joint(HingeDefinition{a, b, about_z, about_z});
    drive.body_a = a;
    drive.body_b = b;
    drive.frame_a = drive.frame_b = about_z;
    return scene.add_joint(drive);
}

/// The most kinetic energy that a scene has after any of these steps.
double most_energy(Scene& scene, Solver& solver, int steps)
{
    double most = 0;
    for (int step = 0; step < steps; ++step) {
        const StepReport report = solver.step(scene, frame_time);
        EXPECT_EQ(report.status, StepStatus::done);
        EXPECT_EQ(report.bodies_contained, 0);
        most = std::max(most, scene.errors().kinetic_energy);
    }
    return most;
}

double angle_of(const BodyState& state)
{
    return 2 * std::atan2(state.orientation.z, state.orientation.w);
}

TEST(SpringStiffness, GivesByTorqueOverStiffnessWhateverHangsOnIt)
{
    for (const float mass : {1e-3F, 2.0F, 500.0F}) {
        Scene scene;
        const BodyId wheel = scene.add_body(box({0, 0, 0}, mass));
        // Damped critically: c = 2 sqrt(k I).
        const float k = 40, damping = 2 * std::sqrt(k * 0.25F * mass);
        const ConstraintId spring =
            hang_on(scene, scene.ground(), wheel, {.spring_stiffness = k, .spring_damping = damping});
        scene.set_force(wheel, {}, {0, 0, 6});
        Solver solver;
        testing::run(scene, solver, 20);
        EXPECT_NEAR(angle_of(scene.state(wheel)), 6.0 / 40, 1e-4) << mass;
        EXPECT_NEAR(scene.joint_report(spring).torque.z, -6, 6e-3) << mass;
    }
}

TEST(SpringStiffness, SwingsWithTheRootOfStiffnessOverInertia)
{
    Scene scene;
    const BodyId wheel = scene.add_body(box({0, 0, 0}));
    const float inertia = 0.5F, k = 4 * pi * pi * inertia;  // one swing a second
    hang_on(scene, scene.ground(), wheel, {.spring_stiffness = k, .spring_target = 0.5F});
    SolverSettings settings;
    settings.substeps = 32;
    Solver solver(settings);
    EXPECT_NEAR(testing::swing_period(scene, solver, wheel, 6), 1.0, 0.01);
}

TEST(SpringStiffness, SpringsInSeriesThroughALightBodyAddUp)
{
    // A frequency would be relative to the light body's inertia, and practically no spring for its neighbours. Sweeps
    // converge slowly through a body that is far lighter than those that its springs hold; the direct method does not
    // sweep.
    for (const float light : {1e-6F, 1e-3F, 1.0F}) {
        if (testing::is_sanitized && light != 1e-3F) continue;
        Scene scene;
        const BodyId between = scene.add_body(box({0, 0, 0}, light)), wheel = scene.add_body(box({0, 0, 0}));
        const ConstraintId first =
            hang_on(scene, scene.ground(), between, {.spring_stiffness = 30, .spring_damping = 3});
        const ConstraintId second =
            hang_on(scene, between, wheel, {.spring_stiffness = 60, .spring_damping = 6});
        scene.set_force(wheel, {}, {0, 0, 6});
        SolverSettings settings;
        if (light < 1e-3F) settings.method = Method::direct;
        Solver solver(settings);
        testing::run(scene, solver, 20);
        EXPECT_NEAR(angle_of(scene.state(between)), 6.0 / 30, 1e-3) << light;
        EXPECT_NEAR(angle_of(scene.state(wheel)), 6.0 / 30 + 6.0 / 60, 1e-3) << light;
        EXPECT_NEAR(scene.joint_report(first).torque.z, -6, 0.03) << light;
        EXPECT_NEAR(scene.joint_report(second).torque.z, -6, 0.03) << light;
    }
}

TEST(SpringStiffness, ADamperAloneSlowsByItsShareEachSubstep)
{
    // I (w' - w) = -h c w'.
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        Scene scene;
        BodyDefinition definition = box({0, 0, 0});
        definition.angular_velocity = {0, 0, 5};
        const BodyId wheel = scene.add_body(definition);
        hang_on(scene, scene.ground(), wheel, {.spring_damping = 2});
        SolverSettings settings;
        settings.method = method;
        Solver solver(settings);
        testing::run(scene, solver, 0.5);
        const double h = static_cast<double>(frame_time) / 4;
        EXPECT_NEAR(scene.state(wheel).angular_velocity.z, 5 * std::pow(1 + h * 2 / 0.5, -120), 2e-5)
            << static_cast<int>(method);
    }
}

TEST(SpringStiffness, OfASlideBearsAWeightByItsStiffness)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        Scene scene;
        const BodyId lift = scene.add_body(box({0, 0, 0}, 3));
        const JointFrame upright{{}, axis_along(1)};
        scene.add_joint(SliderDefinition{scene.ground(), lift, upright, upright});
        SlideDriveDefinition spring{.body_a = scene.ground(), .body_b = lift};
        spring.frame_a = spring.frame_b = upright;
        spring.spring_stiffness = 600;
        spring.spring_damping = 80;
        scene.add_joint(spring);
        SolverSettings settings = testing::with_gravity({0, -10, 0});
        settings.method = method;
        Solver solver(settings);
        testing::run(scene, solver, 5);
        EXPECT_NEAR(scene.state(lift).position.y, -3.0 * 10 / 600, 1e-4) << static_cast<int>(method);
    }
}

/// A spring without limits between the centres of the ground and a body, N/m and N s/m.
DistanceDefinition spring_to(const Scene& scene, BodyId body, float stiffness, float damping = 0)
{
    DistanceDefinition spring{scene.ground(), body};
    spring.min_length = 0;
    spring.max_length = std::numeric_limits<float>::infinity();
    spring.spring_stiffness = stiffness;
    spring.spring_damping = damping;
    return spring;
}

/// It bears a weight, m g = k x, and swings with the root of k / m.
TEST(SpringStiffness, OfADistanceBearsAWeightAndSwings)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        for (const bool is_particle : {false, true}) {
            for (const float mass : {0.01F, 3.0F, 1000.0F}) {
                Scene scene;
                BodyDefinition definition = box({0, -2, 0}, mass);
                if (is_particle) definition.model = BodyModel::particle;
                const BodyId weight = scene.add_body(definition);
                DistanceDefinition spring = spring_to(scene, weight, 200 * mass, 20 * mass);
                spring.rest_length = 2;
                const ConstraintId joint = scene.add_joint(spring);
                SolverSettings settings = testing::with_gravity({0, -10, 0});
                settings.method = method;
                Solver solver(settings);
                testing::run(scene, solver, 5);
                EXPECT_NEAR(scene.state(weight).position.y, -2 - 10.0 / 200, 1e-4) << mass;
                EXPECT_NEAR(scene.joint_report(joint).force.y, 10 * mass, 1e-2 * static_cast<double>(mass));
            }
        }
    }
    Scene scene;
    const BodyId weight = scene.add_body(box({1.1, 0, 0}, 2));
    scene.add_joint(spring_to(scene, weight, 4 * pi * pi * 2));  // one swing a second
    SolverSettings settings;
    settings.substeps = 32;
    Solver solver(settings);
    // It has swung to the other side after half a second, and come back after one.
    testing::run(scene, solver, 0.5);
    EXPECT_NEAR(scene.state(weight).position.x, 0.9, 2e-3);
    testing::run(scene, solver, 0.5);
    EXPECT_NEAR(scene.state(weight).position.x, 1.1, 4e-3);
}

TEST(SpringStiffness, NoStiffnessIsTooMuchForASubstep)
{
    // A spring far stiffer than a substep can follow acts as a lock and adds no energy.
    Scene scene;
    BodyDefinition definition = box({0, 0, 0});
    definition.angular_velocity = {0, 0, 1};
    const BodyId wheel = scene.add_body(definition);
    hang_on(scene, scene.ground(), wheel, {.spring_stiffness = 1e12F});
    Solver solver;
    for (int step = 0; step < 600; ++step) {
        solver.step(scene, frame_time);
        ASSERT_LT(std::abs(scene.state(wheel).angular_velocity.z), 1.0F);
        ASSERT_LT(std::abs(angle_of(scene.state(wheel))), 1e-4);
    }
}

TEST(SpringStiffness, IsOneOfASixDofJointsCoordinates)
{
    Scene scene;
    const BodyId wheel = scene.add_body(box({0, 0, 0}));
    SixDofDefinition joint;
    joint.body_a = scene.ground();
    joint.body_b = wheel;
    joint.rotation[2] = {.spring_stiffness = 40, .spring_damping = 9};
    joint.rotation[2].lower = -1;
    joint.rotation[2].upper = 1;
    EXPECT_EQ(add_six_dof(scene, joint).size(), 2);
    scene.set_force(wheel, {}, {0, 0, 6});
    Solver solver;
    testing::run(scene, solver, 10);
    EXPECT_NEAR(angle_of(scene.state(wheel)), 6.0 / 40, 1e-3);
}

// ---- armature ----------------------------------------------------------------------------------------------------

TEST(Armature, AddsToTheInertiaThatATorqueMoves)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        for (const float rotor : {0.01F, 1.5F, 1e3F}) {
            Scene scene;
            const BodyId wheel = scene.add_body(box({0, 0, 0}));
            hang_on(scene, scene.ground(), wheel, {.armature = rotor});
            const float torque = 2 * (0.5F + rotor);
            scene.set_force(wheel, {}, {0, 0, torque});
            SolverSettings settings;
            settings.method = method;
            Solver solver(settings);
            testing::run(scene, solver, 1);
            EXPECT_NEAR(scene.state(wheel).angular_velocity.z, 2, 1e-3) << rotor;
        }
    }
}

TEST(Armature, OfALightLinkIsAllThatASpringSwings)
{
    // One swing a second, from the rotor's inertia almost alone: the link has a thousandth of it.
    Scene scene;
    const BodyId link = scene.add_body(box({0, 0, 0}, 2e-3F));
    const float rotor = 0.5F;
    hang_on(scene, scene.ground(), link,
            {.spring_stiffness = 4 * pi * pi * rotor, .spring_target = 0.5F, .armature = rotor});
    SolverSettings settings;
    settings.substeps = 32;
    Solver solver(settings);
    EXPECT_NEAR(testing::swing_period(scene, solver, link, 6), 1.0, 0.01);
}

TEST(Armature, OfTwoFloatingWheelsKeepsTheirAngularMomentumAndTheRotors)
{
    // The rotor turns with the difference of the two speeds, so that a torque on one body moves both:
    //   (I_1 + r) w_1' - r w_2' = 0,   -r w_1' + (I_2 + r) w_2' = T.
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        Scene scene;
        const BodyId one = scene.add_body(box({0, 0, 0}, 2)), two = scene.add_body(box({0, 0, 0}, 6));
        const double i_1 = 0.5, i_2 = 1.5, r = 4, torque = 3;
        hang_on(scene, one, two, {.armature = static_cast<float>(r)});
        scene.set_force(two, {}, {0, 0, static_cast<float>(torque)});
        SolverSettings settings;
        settings.method = method;
        Solver solver(settings);
        testing::run(scene, solver, 1);
        const double determinant = (i_1 + r) * (i_2 + r) - r * r;
        EXPECT_NEAR(scene.state(one).angular_velocity.z, r * torque / determinant, 1e-3);
        EXPECT_NEAR(scene.state(two).angular_velocity.z, (i_1 + r) * torque / determinant, 1e-3);
        EXPECT_NEAR(i_1 * static_cast<double>(scene.state(one).angular_velocity.z) +
                        i_2 * static_cast<double>(scene.state(two).angular_velocity.z),
                    torque, 1e-4);
    }
}

TEST(Armature, ReportsWhatItTakesFromTheBodies)
{
    Scene scene;
    const BodyId wheel = scene.add_body(box({0, 0, 0}));
    const ConstraintId drive = hang_on(scene, scene.ground(), wheel, {.armature = 1.5F});
    scene.set_force(wheel, {}, {0, 0, 4});
    Solver solver;
    testing::run(scene, solver, 1);
    // 4 N m on 2 kg m2 in all, of which the rotor has 1.5.
    EXPECT_NEAR(scene.joint_report(drive).torque.z, -1.5 * 2, 3e-3);
}

/// Nothing but bodies and rotors moves here, and joints between them cannot give energy. Sweeps couple the rotors to a link
/// of a five hundredth of their inertia only slowly, so that a rotor and its joint go at different speeds for many steps.
TEST(Armature, BesideALightLinkGivesNoEnergy)
{
    for (const bool exact : {false, true}) {
        for (const float rotor : {0.002F, 0.02F, 0.2F}) {
            Scene scene;
            const BodyId one = scene.add_body(box({0, 0, 0})),
                         link = scene.add_body(box({0.5, 0, 0}, 0.002F)),
                         two = scene.add_body(box({1, 0, 0}));
            const auto join = [&](BodyId a, BodyId b, int axis) {
                const JointFrame at_a{{0.25F, 0, 0}, axis_along(axis)},
                    at_b{{-0.25F, 0, 0}, axis_along(axis)};
                scene.add_joint(HingeDefinition{a, b, at_a, at_b});
                scene.add_joint(TwistDriveDefinition{
                    .body_a = a, .body_b = b, .frame_a = at_a, .frame_b = at_b, .armature = rotor});
            };
            join(one, link, 2);
            join(link, two, 1);
            scene.set_velocity(two, {0, 3, 2}, {6, -5, 8});
            // The most that the rotors may have at the start: those of joints as fast as the bodies.
            const double at_start =
                scene.errors().kinetic_energy + 0.5 * static_cast<double>(rotor) * (64 + 25);
            SolverSettings settings;
            settings.exact_joints = exact;
            Solver solver(settings);
            EXPECT_LT(most_energy(scene, solver, testing::long_run(1200)), at_start) << exact << " " << rotor;
        }
    }
}

/// A spring turns a rotor and, by a light link, an arm. All energy is that of the spring at the start, k 1^2 / 2.
TEST(Armature, WarmStartsDoNotThrowALightLink)
{
    for (const float rotor : {0.0F, 0.02F, 0.2F}) {
        Scene scene;
        const BodyId link = scene.add_body(box({0, 0, 0}, 0.002F)), arm = scene.add_body(box({0.5, 0, 0}));
        hang_on(scene, scene.ground(), link,
                {.spring_stiffness = 100, .spring_target = 1, .armature = rotor});
        scene.add_joint(FixedDefinition{link, arm, {{0.25F, 0, 0}}, {{-0.25F, 0, 0}}});
        Solver solver;
        EXPECT_LT(most_energy(scene, solver, 600), 0.5 * 100) << rotor;
    }
}

/// Two heavy bodies that are joined by two hinges with limits, and the cross between the hinges, like that of an ankle.
struct Universal {
    Scene scene;
    BodyId one, two;

    explicit Universal(float mass_of_cross)
    {
        one = scene.add_body(box({0, 0, 0}, 10));
        const BodyId cross = scene.add_body(box({0.5, 0, 0}, mass_of_cross));
        two = scene.add_body(box({1, 0, 0}, 10));
        join(one, cross, 2);
        join(cross, two, 1);
    }

  private:
    void join(BodyId a, BodyId b, int axis)
    {
        const JointFrame at_a{{0.25F, 0, 0}, axis_along(axis)}, at_b{{-0.25F, 0, 0}, axis_along(axis)};
        scene.add_joint(HingeDefinition{a, b, at_a, at_b});
        scene.add_joint(TwistDriveDefinition{
            .body_a = a, .body_b = b, .frame_a = at_a, .frame_b = at_b, .lower = -0.5F, .upper = 0.5F});
    }
};

/// The cross weighs nearly nothing. The limits bear all torques; they may take energy from what turns but never give any.
TEST(Torque, ThroughALightCrossGivesNoEnergy)
{
    for (const float mass : {0.1F, 1e-3F, 1e-5F}) {
        Universal joined(mass);
        joined.scene.set_velocity(joined.two, {0, 3, 2}, {6, -15, 18});
        const double at_start = joined.scene.errors().kinetic_energy;
        Solver solver;
        EXPECT_LT(most_energy(joined.scene, solver, 1200), 1.01 * at_start) << mass;
    }
}

/// The same from sixty starts.
void expect_no_energy_whatever_the_start(float mass_of_cross, const SolverSettings& settings)
{
    testing::Random random(1);
    for (int start = 0; start < testing::repeats(60); ++start) {
        Universal joined(mass_of_cross);
        const auto r = [&](float most) { return most * static_cast<float>(random.symmetric()); };
        joined.scene.set_velocity(joined.two, {r(3), r(3), r(3)}, {r(15), r(18), r(18)});
        const double at_start = joined.scene.errors().kinetic_energy;
        Solver solver(settings);
        EXPECT_LT(most_energy(joined.scene, solver, 1200), 1.01 * at_start)
            << settings.exact_joints << ", " << mass_of_cross << " kg, " << settings.substeps
            << " substeps, start " << start;
        EXPECT_LT(joined.scene.errors().joint_separation_max, 0.02);
    }
}

/// A cross down to a million times lighter than what it joins.
TEST(Torque, ThroughALightCrossGivesNoEnergyWhateverTheStart)
{
    for (const bool exact : {false, true}) {
        for (const float mass : {0.1F, 0.02F, 0.006F, 1e-3F, 1e-5F}) {
            for (const int substeps : {1, 4}) {
                SolverSettings settings;
                settings.substeps = substeps;
                settings.exact_joints = settings.exact_limits = exact;
                expect_no_energy_whatever_the_start(mass, settings);
            }
        }
    }
}

/// A cross of a hundredth of the mass of what it joins, also where sweeps hold the limits.
TEST(Torque, ThroughACrossGivesNoEnergyWhateverTheStart)
{
    for (const bool exact : {false, true}) {
        for (const int substeps : {1, 4}) {
            SolverSettings settings;
            settings.substeps = substeps;
            settings.exact_joints = exact;
            expect_no_energy_whatever_the_start(0.1F, settings);
        }
    }
}

/// A weld gives in translation by one frequency and in rotation by another, or by none: Hooke's law.
TEST(SpringStiffness, OfTranslationAndRotationApartIsAWelds)
{
    constexpr float linear_hertz = 2, angular_hertz = 3, mass = 2, force = 8, torque = 3;
    constexpr double inertia = 0.25 * mass;  // of a box about z
    const auto square_of = [](float hertz) {
        return std::pow(2 * std::numbers::pi * static_cast<double>(hertz), 2);
    };
    for (const bool slides : {false, true}) {
        for (const bool turns : {false, true}) {
            for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
                Scene scene;
                const BodyId plate = scene.add_body(box({1, 2, 0}, mass));
                const Weld weld = add_weld(scene, {.body_a = scene.ground(),
                                                   .body_b = plate,
                                                   .frame_a = {{1, 2, 0}},
                                                   .linear_hertz = slides ? linear_hertz : 0,
                                                   .angular_hertz = turns ? angular_hertz : 0});
                EXPECT_TRUE(scene.is_alive(weld.position));
                EXPECT_EQ(scene.is_alive(weld.rotation), slides || turns);
                scene.set_force(plate, {force, 0, 0}, {0, 0, torque});
                SolverSettings settings;
                settings.method = method;
                Solver solver(settings);
                testing::run(scene, solver, 10);
                const BodyState state = scene.state(plate);
                // A rigid part of soft_step is as stiff as a substep can follow: 0.25 / h.
                const double slid = force / (mass * square_of(slides ? linear_hertz : 60));
                if (slides || method == Method::soft_step) {
                    EXPECT_NEAR(state.position.x, 1 + slid, (slides ? 1e-3 : 1e-2) * slid);
                } else {
                    EXPECT_NEAR(state.position.x, 1, 1e-6);
                }
                EXPECT_NEAR(state.position.y, 2, 1e-6);
                const double turned = torque / (inertia * square_of(angular_hertz));
                EXPECT_NEAR(angle_of(state), turns ? turned : 0, turns ? 5e-3 * turned : 1e-3);
            }
        }
    }
}

/// What a weld refuses is not half added.
TEST(SpringStiffness, OfAWeldOutOfRangeIsRefusedByItsName)
{
    Scene scene;
    const BodyId plate = scene.add_body(box({}, 1));
    const WeldDefinition good{.body_a = scene.ground(), .body_b = plate, .linear_hertz = 1};
    const auto refusal_of = [&](WeldDefinition weld) -> std::string {
        try {
            add_weld(scene, weld);
        } catch (const InvalidInput& refused) {
            return refused.what();
        }
        return "";
    };
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    WeldDefinition weld = good;
    weld.linear_hertz = -1;
    EXPECT_EQ(refusal_of(weld), "WeldDefinition.linear_hertz is -1; expected 0 (rigid) or up to 1e6 (Hz)");
    weld = good;
    weld.angular_hertz = 2e6F;
    EXPECT_EQ(refusal_of(weld),
              "WeldDefinition.angular_hertz is 2000000; expected 0 (rigid) or up to 1e6 (Hz)");
    weld = good;
    weld.linear_damping_ratio = nan;
    EXPECT_EQ(refusal_of(weld), "WeldDefinition.linear_damping_ratio is nan; expected 0 to 1e6");
    weld = good;
    weld.angular_damping_ratio = -2;
    EXPECT_EQ(refusal_of(weld), "WeldDefinition.angular_damping_ratio is -2; expected 0 to 1e6");
    weld = good;
    weld.frame_b.rotation = {0, 0, 0, 0};
    EXPECT_NE(refusal_of(weld), "");
    weld = good;
    weld.frame_b.position = {2e9F, 0, 0};
    EXPECT_NE(refusal_of(weld), "");
    EXPECT_EQ(scene.joint_count(), 0U);
}

}  // namespace
}  // namespace motley
