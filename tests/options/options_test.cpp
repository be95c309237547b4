// The library as built with MOTLEY_FAST or with MOTLEY_FLOAT_POSITIONS: motion stays right within the bounds of an ordinary
// build, and what the option gives up is what it says. Independent evidence: a pendulum in closed form, the exact forces of
// a pushed row, and the sizes and the resolution of floats.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "stores/body_store.h"
#include "swing.h"

namespace motley {
namespace {

// Kernels that fuse are built for two instruction sets, so only those of planar bodies are.
#ifdef MOTLEY_FAST
constexpr bool fast = true;
constexpr BodyModel swinging = BodyModel::planar;
#else
constexpr bool fast = false;
constexpr BodyModel swinging = BodyModel::rigid;
#endif
#ifdef MOTLEY_FLOAT_POSITIONS
constexpr bool float_positions = true;
#else
constexpr bool float_positions = false;
#endif

constexpr double pi = 3.14159265358979323846, g = 9.81;

/// A body of 2 kg that hangs 1.5 m below a ball-socket at the origin.
struct Pendulum {
    static constexpr double length = 1.5, amplitude = 0.2;
    Scene scene;
    BodyId bob;
    ConstraintId joint;

    Pendulum()
    {
        BodyDefinition body = testing::box({length * std::sin(amplitude), -length * std::cos(amplitude), 0});
        body.model = swinging;
        body.orientation = {0, 0, std::sin(amplitude / 2), std::cos(amplitude / 2)};
        body.yaw = amplitude;
        bob = scene.add_body(body);
        joint = scene.add_joint(
            BallSocketDefinition{scene.ground(), bob, {}, {0, static_cast<float>(length), 0}});
    }
    static SolverSettings settings()
    {
        SolverSettings settings = testing::with_gravity({0, static_cast<float>(-g), 0});
        settings.substeps = 16;
        return settings;
    }
};

TEST(Options, APendulumSwingsAsItsClosedForm)
{
    // T = 2 pi sqrt((I / m + L^2) / (g L)) (1 + theta^2 / 16). Bound: one percent, as for an ordinary build.
    for (const Isa isa : available_isas()) {
        Pendulum pendulum;
        Solver solver(Pendulum::settings(), {.isa = isa});
        const double period = testing::swing_period(pendulum.scene, solver, pendulum.bob, 20);
        const double l = Pendulum::length;
        const double exact = 2 * pi * std::sqrt((0.25 + l * l) / (g * l)) *
                             (1 + Pendulum::amplitude * Pendulum::amplitude / 16);
        EXPECT_NEAR(period, exact, 0.01 * exact) << isa_name(isa);
        // It hangs by F / (m w^2) of the stiffest spring that a substep can follow: 0.25 / h.
        const double w = 2 * pi * 0.25 * 16 * 60;
        EXPECT_LT(pendulum.scene.joint_report(pendulum.joint).error, 1.5 * g / (w * w)) << isa_name(isa);
    }
}

/// Ten people in a row, each pushed towards a wall.
struct Row {
    static constexpr int people = 10;
    static constexpr double radius = 0.2, push = 50;  // m, N
    Scene scene;
    std::vector<BodyId> discs;

    Row()
    {
        for (int i = 0; i < people; ++i) {
            BodyDefinition disc;
            disc.model = BodyModel::planar;
            disc.mass = 80;
            disc.inertia.zz = 1.6F;
            disc.position = {radius * (2 * i + 1), 0, 0};
            discs.push_back(scene.add_body(disc));
            scene.set_force(discs.back(), {static_cast<float>(-push), 0, 0}, {});
        }
    }
    [[nodiscard]] std::vector<Contact> contacts() const
    {
        std::vector<Contact> list(people);
        for (std::size_t i = 0; i < list.size(); ++i) {
            const double front = i == 0 ? 0 : scene.state(discs[i - 1]).position.x + radius;
            list[i].body_a = i == 0 ? scene.ground() : discs[i - 1];
            list[i].body_b = discs[i];
            list[i].key = i;
            list[i].normal = {1, 0, 0};
            list[i].separation = static_cast<float>(scene.state(discs[i]).position.x - radius - front);
            list[i].arm_a = {i == 0 ? 0.0F : static_cast<float>(radius), 0, 0};
            list[i].arm_b = {static_cast<float>(-radius), 0, 0};
            list[i].friction = 0.3F;
        }
        return list;
    }
};

TEST(Options, APushedRowHandsOnWhatIsBehindIt)
{
    // Contact k from the back carries k F. Bound: one percent of the force on the wall, as for an ordinary build.
    for (const Isa isa : available_isas()) {
        Row row;
        SolverSettings settings;
        settings.substeps = 8;
        Solver solver(settings, {.isa = isa});
        for (int step = 0; step < 600; ++step)
            ASSERT_EQ(solver.step(row.scene, testing::frame_time, row.contacts()).status, StepStatus::done);
        for (int i = 0; i < Row::people; ++i) {
            const double force =
                static_cast<double>(row.scene.contact_impulses()[static_cast<std::size_t>(i)].normal) /
                static_cast<double>(row.scene.last_step());
            EXPECT_NEAR(force, Row::push * (Row::people - i), 0.01 * Row::push * Row::people)
                << isa_name(isa) << ", contact " << i;
        }
    }
}

std::uint64_t hash_on(Isa isa)
{
    Pendulum pendulum;
    Solver solver(Pendulum::settings(), {.isa = isa});
    for (int step = 0; step < 60; ++step) solver.step(pendulum.scene, testing::frame_time);
    return pendulum.scene.state_hash();
}

TEST(Options, OnlyFusedKernelsHaveOtherBitsOnAnotherInstructionSet)
{
    const std::uint64_t scalar = hash_on(Isa::scalar);
    for (const Isa isa : available_isas()) {
        // The scalar kernels are for any machine, which cannot fuse; those of AVX2 can.
        const bool fuses = fast && (isa == Isa::avx2 || isa == Isa::avx512);
        EXPECT_EQ(hash_on(isa) != scalar, fuses) << isa_name(isa);
    }
    if (fast && available_isas().size() == 1) GTEST_SKIP() << "this machine has no AVX2: nothing is fused";
}

TEST(Options, FloatPositionsHaveHalfTheBytesAndResolveAKilometreToSixHundredthsOfAMillimetre)
{
    EXPECT_EQ(sizeof(BodyPose), float_positions ? 16U : 32U);
    EXPECT_EQ(sizeof(Quat<PoseReal>), float_positions ? 16U : 32U);
    Scene scene;
    double most = 0;
    for (int i = 0; i < 100; ++i) {
        const double x = 1000 + 1e-6 * i;
        BodyDefinition definition = testing::box({x, 0, 0});
        definition.model = swinging;
        const BodyId body = scene.add_body(definition);
        most = std::max(most, std::abs(scene.state(body).position.x - x));
    }
    if (float_positions) {
        // Half a unit in the last place, 2^-14 m.
        EXPECT_GT(most, 1e-5);
        EXPECT_LE(most, 0.5 * 0x1p-14);
    } else {
        EXPECT_EQ(most, 0);
    }
}

}  // namespace
}  // namespace motley
