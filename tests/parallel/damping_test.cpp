// Bodies that a medium slows. Independent evidence: with q = 1 / (1 + h c) and u = a / c, the closed form of n substeps
// v' = (v + h a) / (1 + h c), x' = x + h v' is v = u + (v_0 - u) q^n, x = x_0 + n h u + (v_0 - u) (1 - q^n) / c; the
// exponential that it approaches; the terminal speed a / c; and momenta, which decay as velocities do.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "every_way.h"
#include "rig.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;
using testing::length;
using Vector = Vec3<double>;

constexpr Vec3<float> gravity{0, -9.81F, 2};

struct Case {
    Method method;
    int substeps;
    float dt;
};

class Damping : public ::testing::TestWithParam<Case> {};

TEST_P(Damping, OfFreeBodiesIsTheClosedForm)
{
    const Case& of = GetParam();
    SolverSettings settings = testing::with_gravity(gravity);
    settings.method = of.method;
    settings.substeps = of.substeps;
    const int steps = static_cast<int>(std::lround(2 / of.dt)), n = steps * of.substeps;
    const double h = static_cast<double>(of.dt) / of.substeps;
    // The factor q of a substep is a float: its relative rounding error, and one of each velocity, add up.
    const double rounding = 1.2e-7 * n * 12;
    const Vec3<float> force{3, 1, -2}, velocity{1, 4, 0.5F};
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        // Seventeen bodies: sixteen are in one block of lanes, one is alone.
        Scene scene;
        std::vector<BodyId> bodies;
        const auto linear_of = [](int i) { return i % 3 == 0 ? 0.01F : i % 3 == 1 ? 1.0F : 50.0F; };
        for (int i = 0; i < 17; ++i) {
            BodyDefinition body{.model = model, .position = {3.0 * i, 0, 0}};
            body.mass = static_cast<float>(1 + i);
            body.linear_velocity = velocity;
            if (model == BodyModel::planar) body.linear_velocity.z = 0;
            if (model != BodyModel::particle) body.angular_velocity.z = 2;
            body.linear_damping = linear_of(i);
            body.angular_damping = 0.5F;
            bodies.push_back(scene.add_body(body));
            scene.set_force(bodies.back(), force, {});
        }
        Solver solver(settings);
        for (int step = 0; step < steps; ++step)
            ASSERT_EQ(solver.step(scene, of.dt).status, StepStatus::done);
        for (int i = 0; i < 17; ++i) {
            const double c = static_cast<double>(linear_of(i)), decayed = std::pow(1 + h * c, -n);
            Vector v = convert<double>(velocity),
                   u = 1 / c * (1.0 / (1 + i) * convert<double>(force) + convert<double>(gravity));
            if (model == BodyModel::planar) v.z = u.z = 0;
            const Vector left = v - u, at = Vector{3.0 * i, 0, 0} + n * h * u + (1 - decayed) / c * left;
            const BodyState state = scene.state(bodies[static_cast<std::size_t>(i)]);
            EXPECT_LT(length(convert<double>(state.linear_velocity) - (u + decayed * left)), rounding + 1e-5)
                << i;
            EXPECT_LT(length(state.position - at), 2 * rounding + 2e-5) << i;
            if (model == BodyModel::particle) continue;
            EXPECT_NEAR(static_cast<double>(state.angular_velocity.z), 2 * std::pow(1 + h * 0.5, -n),
                        rounding);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    , Damping,
    ::testing::Values(Case{Method::soft_step, 1, 1.0F / 60}, Case{Method::soft_step, 4, 1.0F / 60},
                      Case{Method::soft_step, 16, 1.0F / 240}, Case{Method::soft_step, 4, 1.0F / 10},
                      Case{Method::sequential_impulse, 4, 1.0F / 60}, Case{Method::direct, 4, 1.0F / 60}));

TEST(DampingOfBodies, ApproachesTheExponentialAsSubstepsBecomeShorter)
{
    constexpr double c = 3;
    const auto error = [](int substeps) {
        Scene scene;
        const BodyId body = scene.add_body({.linear_velocity = {10, 0, 0}, .linear_damping = 3});
        SolverSettings settings;
        settings.substeps = substeps;
        Solver solver(settings);
        testing::run(scene, solver, 1);
        return static_cast<double>(scene.state(body).linear_velocity.x) - 10 * std::exp(-c);
    };
    const double of_four = error(4);
    EXPECT_NEAR(of_four, 10 * std::exp(-c) * c * c / 240 / 2, 0.05 * of_four) << "c^2 h t / 2 of it";
    EXPECT_NEAR(error(16), of_four / 4, 0.03 * of_four);
}

TEST(DampingOfBodies, EndsAFallAtTheTerminalSpeed)
{
    for (const SolverSettings& settings : testing::every_way()) {
        Scene scene;
        const BodyId body = scene.add_body({.linear_damping = 5});
        Solver solver(settings);
        testing::run(scene, solver, 6);
        // Rounding v + h a (1.2e-7 m/s at most), the product with q, and q itself (6e-8 each) each count 1 / (h c) times.
        EXPECT_NEAR(scene.state(body).linear_velocity.y, -9.81F / 5, 1.2e-5F);
        const double before = scene.state(body).position.y;
        testing::run(scene, solver, 1);
        EXPECT_NEAR(scene.state(body).position.y - before, -9.81 / 5, 2e-5);
    }
}

/// A chain that tumbles freely. Equal damping of all bodies divides each velocity, and so both momenta, by 1 + h c; joints
/// keep them.
TEST(DampingOfBodies, LetsMomentaOfAFigureDecayAndReportsSay)
{
    constexpr float c = 0.8F;
    constexpr double mass = 2;
    for (const bool exact : {false, true}) {
        SolverSettings settings;
        settings.measures = true;
        settings.exact_joints = exact;
        Scene scene;
        std::vector<BodyId> links;
        for (int i = 0; i < 4; ++i) {
            BodyDefinition link = box({1.0 * i, 0, 0}, static_cast<float>(mass));
            link.linear_velocity = {1, 0.5F * static_cast<float>(i), 0};
            link.angular_velocity = {0.3F, 0, 0.5F};
            link.linear_damping = link.angular_damping = c;
            links.push_back(scene.add_body(link));
            if (i > 0)
                scene.add_joint(BallSocketDefinition{
                    links[static_cast<std::size_t>(i - 1)], links.back(), {0.5F, 0, 0}, {-0.5F, 0, 0}});
        }
        const auto spin = [&] {
            Vector sum{};
            for (const BodyId link : links)
                sum = sum + testing::angular_momentum(scene.state(link), mass, {0.2, 0.4, 0.5});
            return sum;
        };
        const Vector start = spin();
        const double decay = std::pow(1 + static_cast<double>(c) * static_cast<double>(frame_time) / 4, -4);
        Solver solver(settings);
        for (int step = 0; step < 120; ++step) {
            const StepMeasures measures = solver.step(scene, frame_time).measures;
            for (int i = 0; i < 3; ++i)
                ASSERT_NEAR(measures.after.momentum[i], decay * measures.before.momentum[i], 2e-5) << step;
        }
        // As without damping: sweeps and exact joints lose what rounding does.
        EXPECT_LT(length(spin() - std::pow(decay, 120) * start), 1e-5 * length(start));
    }
}

/// Figures of two boxes on a hinge, damped unequally.
std::vector<BodyId> add_figures(Scene& scene, int copies)
{
    Figure figure;
    BodyDefinition upper = box({0, 0, 0}, 3), lower = box({0, -1, 0}, 1);
    upper.linear_damping = 0.3F;
    upper.angular_damping = 4;
    lower.angular_damping = 0.7F;
    lower.angular_velocity = {0, 0, 3};
    HingeDefinition hinge{figure.add_body(upper), figure.add_body(lower)};
    hinge.frame_a = {{0, -0.5F, 0}, testing::axis_along(2)};
    hinge.frame_b = {{0, 0.5F, 0}, testing::axis_along(2)};
    figure.add_joint(hinge);
    // A spring beside the tree of exact joints: without one, a figure alone is solved in fewer sweeps than the swept one.
    TwistDriveDefinition spring{hinge.body_a, hinge.body_b, hinge.frame_a, hinge.frame_b};
    spring.spring_stiffness = 2;
    figure.add_joint(spring);
    std::vector<Placing> places;
    for (int i = 0; i < copies; ++i)
        places.push_back(
            {.position = {4.0 * i, 0, 0}, .linear_velocity = {0, 0.1F * static_cast<float>(i), 1}});
    return add_assembly(scene, figure, places);
}

TEST(DampingOfBodies, OfFiguresInLockstepHasTheBitsOfOrdinarySweepsWithEveryInstructionSetAndThreadCount)
{
    for (const bool exact : {false, true}) {
        SolverSettings settings = testing::with_gravity(gravity);
        settings.exact_joints = exact;
        const auto run = [&](const SolverSettings& how, const SolverOptions& options) {
            Scene scene;
            add_figures(scene, 16 + 5);
            Solver solver(how, options);
            std::vector<std::uint64_t> hashes;
            for (int step = 0; step < 60; ++step) {
                EXPECT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
                hashes.push_back(scene.state_hash());
            }
            return hashes;
        };
        const std::vector<std::uint64_t> scalar = run(settings, {.isa = Isa::scalar});
        EXPECT_EQ(run(testing::swept(settings), {}), scalar);
        for (const Isa isa : available_isas())
            EXPECT_EQ(run(settings, {.isa = isa}), scalar) << isa_name(isa);
        EXPECT_EQ(run(settings, {.threads = 2, .alone_below = 0}), scalar);
    }
}

TEST(DampingOfBodies, OfOneLeavesTheOthersTheirBits)
{
    for (const SolverSettings& settings : testing::every_way()) {
        Scene alone;
        for (int i = 0; i < 30; ++i) {
            BodyDefinition body;
            body.model = static_cast<BodyModel>(i % 3);
            body.position = {2.0 * i, 0, 0};
            body.linear_velocity = {0.1F * static_cast<float>(i), 1, 0};
            alone.add_body(body);
        }
        std::vector<BodyId> bodies;
        alone.read_bodies(bodies);
        Scene beside = alone;
        beside.add_body({.position = {0, 50, 0}, .linear_damping = 1});
        beside.add_body({.model = BodyModel::planar, .position = {0, 60, 0}, .angular_damping = 1});
        Solver one(settings), other(settings);
        for (int step = 0; step < 60; ++step) {
            one.step(alone, frame_time);
            other.step(beside, frame_time);
        }
        for (const BodyId body : bodies) {
            const BodyState one_state = alone.state(body), other_state = beside.state(body);
            EXPECT_EQ(length(one_state.position - other_state.position), 0);
            EXPECT_EQ(length(convert<double>(one_state.linear_velocity - other_state.linear_velocity)), 0);
        }
    }
}

TEST(DampingOfBodies, IsChangedInPlaceWithTheBitsOfBodiesThatWereAddedWithIt)
{
    for (const SolverSettings& settings : testing::every_way()) {
        Scene added, changed;
        const auto fill = [](Scene& scene, float linear, float angular) {
            for (int i = 0; i < 6; ++i) {
                BodyDefinition body;
                body.model = static_cast<BodyModel>(i % 3);
                body.position = {2.0 * i, 0, 0};
                body.linear_velocity = {1, 2, 0};
                if (i % 3 != 0) body.angular_velocity = {0, 0, 3};
                body.linear_damping = linear;
                body.angular_damping = angular;
                scene.add_body(body);
            }
        };
        fill(added, 0.4F, 2);
        fill(changed, 0, 1);
        const auto bodies_of = [](const Scene& scene) {
            std::vector<BodyId> bodies;
            scene.read_bodies(bodies);
            return bodies;
        };
        for (const BodyId body : bodies_of(changed)) changed.set_damping(body, 0.4F, 2);
        Scene read = load_scene(save_scene(changed));
        Solver one(settings), two(settings), three(settings);
        for (int step = 0; step < 60; ++step) {
            if (step == 30) {
                for (Scene* scene : {&added, &changed, &read}) scene->set_damping(bodies_of(*scene)[4], 0, 0);
            }
            one.step(added, frame_time);
            two.step(changed, frame_time);
            three.step(read, frame_time);
            ASSERT_EQ(changed.state_hash(), added.state_hash()) << step;
            ASSERT_EQ(read.state_hash(), added.state_hash()) << step;
        }
    }
}

}  // namespace
}  // namespace motley
