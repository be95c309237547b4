// Promise 2b: the lanes agree with the textbook in double. Every constraint in the type list, for every pair of body
// kinds that makes sense, in random scenes of one constraint, step after step; and a chain, solved in the same order.
// Independent evidence: core/reference, which shares no row with the lanes and whose rows are also checked here
// against finite differences of their C; and conservation laws. Where a bound limits an impulse both use the same
// formula in a sweep: the evidence for the direction of friction is in friction_direction_test.cpp. So they do where
// bodies carry arms along before relaxation: the evidence is in free_motion_test.cpp and relaxation_test.cpp.
//
// Bound: a step in float rounds each of about 200 operations on numbers of about `size` once, so it differs from the
// double step by at most about 200 x 6e-8 of that, amplified by the condition of K (below 30 here) where masses are
// inverted. Errors of successive steps add up; motions do not amplify them within the steps below.
#include <gtest/gtest.h>

#include "joint_cases.h"
#include "momentum_rounding.h"
#include "rig.h"
#include "twin.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;
constexpr int steps = testing::long_run(30);
using testing::Twin;

constexpr double bound_per_step = 200 * 6e-8 * 5;  // size: speeds below 5 m/s and rad/s

/// 0 particle, 1 planar, 2 rigid, 3 static, 4 kinematic.
BodyDefinition body_of(int kind, testing::Random& random)
{
    const auto r = [&] { return static_cast<float>(random.symmetric()); };
    BodyDefinition body;
    body.model = kind < 3 ? static_cast<BodyModel>(kind) : BodyModel::rigid;
    body.motion = kind == 3   ? BodyMotion::static_body
                  : kind == 4 ? BodyMotion::kinematic_body
                              : BodyMotion::dynamic_body;
    body.position = {random.symmetric(), random.symmetric(), kind == 1 ? 0 : random.symmetric()};
    body.mass = 2 + r();
    body.inertia = {0.5F, 0.05F, 0, 0.4F, 0.03F, 0.6F};
    if (kind != 3) body.linear_velocity = {r(), r(), kind == 1 ? 0 : r()};
    if (kind == 1) body.angular_velocity = {0, 0, r()};
    if (kind == 2 || kind == 4) body.angular_velocity = {r(), r(), r()};
    if (kind == 1) body.yaw = 3 * random.symmetric();
    if (kind > 1)
        body.orientation = {random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric()};
    return body;
}

/// A planar body and a static or kinematic one are solved in the plane. Motion of the latter out of the plane would
/// be ignored, so it has none.
void stay_in_plane(BodyDefinition& body, int kind)
{
    if (kind < 3) return;
    body.position.z = 0;
    body.orientation = {0, 0, 0.6, 0.8};
    body.linear_velocity.z = 0;
    body.angular_velocity.x = body.angular_velocity.y = 0;
}

std::vector<SolverSettings> every_way()
{
    SolverSettings soft;
    soft.gravity = {0.5F, -9.81F, 1};
    SolverSettings baumgarte = soft;
    baumgarte.method = Method::sequential_impulse;
    baumgarte.substeps = 1;
    baumgarte.iterations = 4;
    SolverSettings none = baumgarte, projection = baumgarte;
    none.drift_correction = DriftCorrection::none;
    projection.drift_correction = DriftCorrection::projection;
    return {soft, baumgarte, none, projection};
}

/// Calls claim(twin, random, settings, name) for two bodies of every pair of kinds and every way.
template <class Claim>
void for_every_pair(const Claim& claim)
{
    for (const SolverSettings& settings : every_way()) {
        for (int a = 0; a < 5; ++a) {
            for (int b = 0; b < 5; ++b) {
                if (a > 2 && b > 2) continue;
                for (int trial = 0; trial < testing::repeats(3); ++trial) {
                    testing::Random random(static_cast<std::uint64_t>(1000 + 100 * a + 10 * b + trial));
                    Twin twin;
                    BodyDefinition body_a = body_of(a, random), body_b = body_of(b, random);
                    if (a == 1) stay_in_plane(body_b, b);
                    if (b == 1) stay_in_plane(body_a, a);
                    twin.add(body_a);
                    twin.add(body_b);
                    const std::string name = "kinds " + std::to_string(a) + " and " + std::to_string(b) +
                                             ", method " + std::to_string(static_cast<int>(settings.method)) +
                                             ", correction " +
                                             std::to_string(static_cast<int>(settings.drift_correction));
                    claim(twin, random, settings, name, a, b);
                }
            }
        }
    }
}

template <class Definition>
class EveryJoint : public ::testing::Test {
};
template <class List>
struct DefinitionsOf;
template <class... Types>
struct DefinitionsOf<TypeList<Types...>> {
    using type = ::testing::Types<typename Types::Definition...>;
};
TYPED_TEST_SUITE(EveryJoint, DefinitionsOf<JointTypes>::type);

/// Calls claim(twin, joint, settings, name) for every case of a type, pair of kinds and way; the twin has the bodies.
template <class Definition, class Claim>
void for_every_case(const Claim& claim)
{
    for_every_pair([&](const Twin& pair, testing::Random& random, const SolverSettings& settings,
                       const std::string& name, int a, int b) {
        if (!testing::fits<Definition>(a, b)) return;
        const auto cases = testing::JointCases<Definition>::of(
            testing::JointPlace(pair.scene, pair.ids[0], a, pair.ids[1], b, random));
        for (std::size_t i = 0; i < cases.size(); ++i) {
            Twin twin = pair;
            claim(twin, cases[i], settings, name + ", case " + std::to_string(i));
        }
    });
}

TYPED_TEST(EveryJoint, LanesAgreeWithTheReferenceForEveryPairAndMethod)
{
    for_every_case<TypeParam>(
        [](Twin& twin, const TypeParam& joint, const SolverSettings& settings, const std::string& name) {
            twin.add_joint(joint);
            Solver solver(settings);
            int last = steps;
            if constexpr (requires { testing::JointCases<TypeParam>::soft_steps_until_rest; }) {
                if (settings.method == Method::soft_step)
                    last = testing::JointCases<TypeParam>::soft_steps_until_rest;
            }
            for (int step = 1; step <= last; ++step) {
                solver.step(twin.scene, dt);
                twin.world.step(static_cast<double>(dt), settings, {});
                ASSERT_LT(twin.difference(), bound_per_step * step) << name << ", step " << step;
            }
        });
}

template <class Definition>
constexpr bool locks_point = std::is_same_v<Definition, BallSocketDefinition>;
template <AngularLock angular>
constexpr bool locks_point<FrameJointDefinition<LinearLock::point, angular>> = true;

TYPED_TEST(EveryJoint, JTimesVIsTheDerivativeOfC)
{
    // Central differences along the bodies' own motion, which have errors of epsilon^2 and 1e-16 / epsilon.
    constexpr double epsilon = 1e-6;
    for_every_case<TypeParam>(
        [](const Twin& twin, const TypeParam& joint, const SolverSettings&, const std::string& name) {
            const reference::Model model = reference::model_of(joint);
            const reference::Body &a = twin.world.bodies[0], &b = twin.world.bodies[1];
            const auto blocks_after = [&](double seconds) {
                reference::Body moved_a = a, moved_b = b;
                moved_a.advance(a.velocity, seconds);
                moved_b.advance(b.velocity, seconds);
                return model->blocks(moved_a, moved_b, false, model->travel(a, b, moved_a, moved_b));
            };
            const auto before = blocks_after(-epsilon), now = blocks_after(0), after = blocks_after(epsilon);
            Eigen::Matrix<double, 12, 1> velocity;
            velocity << a.velocity, b.velocity;
            for (std::size_t i = 0; i < now.size(); ++i) {
                // Both ends of a range use one row, for the nearer end, which may change at the middle of the range.
                if (before[i].side != after[i].side) continue;
                Eigen::VectorXd difference = (after[i].error - before[i].error) / (2 * epsilon);
                // The impulses of a locked point act midway between the anchors: its rows give the derivative of C in
                // a frame that turns with the mean of both spins.
                if constexpr (locks_point<TypeParam>) {
                    const Eigen::Vector3d spin = (a.velocity.tail<3>() + b.velocity.tail<3>()) / 2;
                    difference.topRows(3) -= spin.cross(Eigen::Vector3d(now[i].error.topRows(3)));
                }
                const Eigen::VectorXd analytic = now[i].side * (now[i].jacobian * velocity);
                // A motor has no C, and an infinite limit has no error.
                if (now[i].kind == reference::Block::Kind::motor || !now[i].error.allFinite()) continue;
                EXPECT_LT((difference - analytic).norm(), 1e-6 * (1 + analytic.norm()))
                    << name << ", block " << i;
            }
        });
}

/// Linear momentum, angular momentum about the origin, and kinetic energy of the reference's bodies.
struct Motion {
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
    double energy = 0;
    double squares = 0;  ///< of |m x v| + |I w|, for rounding_of_momenta()
};
Motion motion_of(const Twin& twin)
{
    Motion sum;
    for (std::size_t i = 0; i < twin.ids.size(); ++i) {
        const BodyState s = twin.scene.state(twin.ids[i]);
        const reference::Body& body = twin.world.bodies[i];
        const Eigen::Quaterniond turn(s.orientation.w, s.orientation.x, s.orientation.y, s.orientation.z);
        const Eigen::Vector3d x(s.position.x, s.position.y, s.position.z),
            v(s.linear_velocity.x, s.linear_velocity.y, s.linear_velocity.z),
            w(s.angular_velocity.x, s.angular_velocity.y, s.angular_velocity.z),
            spin = turn * (body.inertia * (turn.conjugate() * w));
        sum.momentum += body.mass * v;
        sum.angular += body.mass * x.cross(v) + spin;
        sum.energy += 0.5 * (body.mass * v.squaredNorm() + w.dot(spin));
        const double turning = body.mass * x.norm() * v.norm() + spin.norm();
        sum.squares += turning * turning;
    }
    return sum;
}

/// What two seconds of free flight changed.
struct Flight {
    double momentum = 0, angular = 0;  ///< the largest changes of momenta
    double angular_rounding = 0;       ///< what rounding may change
    double before = 0, highest = 0;    ///< kinetic energy after the first step, and the highest after it
    bool regular = true;
};
/// `parts`: steps are so many times shorter than dt.
template <class Definition>
Flight fly(const Twin& pair, const Definition& joint, int relaxations, int parts)
{
    Twin twin = pair;
    twin.add_joint(joint);
    constexpr int substeps = 8;
    Solver solver({.substeps = substeps, .relaxations = relaxations});
    // Half a second removes what the cases have of initial errors.
    for (int step = 0; step < 30; ++step) solver.step(twin.scene, dt);
    const Motion before = motion_of(twin);
    Flight flight;
    flight.before = before.energy;
    const double stores = 120 * parts * substeps * testing::stores_of(1, 1 + relaxations);
    for (int step = 0; step < 120 * parts; ++step) {
        EXPECT_EQ(solver.step(twin.scene, dt / static_cast<float>(parts)).status, StepStatus::done);
        const Motion now = motion_of(twin);
        flight.highest = std::max(flight.highest, now.energy);
        flight.momentum = std::max(flight.momentum, (now.momentum - before.momentum).norm());
        flight.angular = std::max(flight.angular, (now.angular - before.angular).norm());
        flight.angular_rounding =
            std::max(flight.angular_rounding, testing::rounding_of_momenta(stores, now.squares));
        if constexpr (requires { &testing::JointCases<Definition>::is_regular; }) {
            flight.regular =
                flight.regular && testing::JointCases<Definition>::is_regular(
                                      joint, twin.scene.state(twin.ids[0]), twin.scene.state(twin.ids[1]));
        }
    }
    return flight;
}

TYPED_TEST(EveryJoint, KeepsMomentaAndNeverAddsEnergyInFreeFlight)
{
    // Two tumbling bodies without external force. Without relaxation the impulses on both bodies are opposite and act
    // at one point, and the integration of turning bodies keeps their angular momentum: only rounding is left.
    // Relaxation acts on lever arms from before the bodies turned in the substep, except those of locks of a point, and
    // manifolds act on those from before the step, which is an error of first order in the step: a quarter in steps of a
    // quarter, or less than a half.
    // Implicit softness and gyroscopic terms only ever remove energy.
    using Cases = testing::JointCases<TypeParam>;
    constexpr bool keeps_arms_through_a_step = std::is_same_v<TypeParam, ManifoldDefinition>;
    int regular_cases = 0;
    for (int seed = 1; seed <= testing::repeats(5); ++seed) {
        testing::Random random(static_cast<std::uint64_t>(seed));
        Twin pair;
        pair.add(body_of(2, random));
        pair.add(body_of(2, random));
        const auto cases = Cases::of(testing::JointPlace(pair.scene, pair.ids[0], 2, pair.ids[1], 2, random));
        for (std::size_t i = 0; i < cases.size(); ++i) {
            const std::string name = "seed " + std::to_string(seed) + ", case " + std::to_string(i);
            const Flight plain = fly(pair, cases[i], 0, 1), relaxed = fly(pair, cases[i], 1, 1),
                         finer = fly(pair, cases[i], 1, 4);
            if (Cases::keeps != testing::Keeps::nothing) {
                // 960 substeps of relative 6e-8, and a few operations each.
                EXPECT_LT(plain.momentum, 2e-4) << name;
                EXPECT_LT(relaxed.momentum, 2e-4) << name;
            }
            if (!plain.regular || !relaxed.regular || !finer.regular) continue;
            ++regular_cases;
            if (Cases::keeps == testing::Keeps::both_momenta) {
                if (!keeps_arms_through_a_step) {
                    EXPECT_LT(plain.angular, plain.angular_rounding) << name;
                }
                EXPECT_LT(finer.angular,
                          (relaxed.angular + relaxed.angular_rounding) / 2 + finer.angular_rounding)
                    << name;
            }
            if (Cases::is_passive(cases[i])) {
                EXPECT_LT(relaxed.highest, 1.02 * relaxed.before) << name;
            }
        }
    }
    // A sanitizer's one seed may have none.
    if (!testing::is_sanitized) EXPECT_GE(regular_cases, 5) << "else nothing was tested";
}

TEST(AgainstReference, ContactsAgreeForEveryPairAndMethod)
{
    struct Touches {
        float friction, restitution;
    };
    for (const Touches touches : {Touches{0, 0}, {0.4F, 0}, {0, 0.5F}, {0.4F, 0.5F}}) {
        for_every_pair([touches](Twin& twin, testing::Random& random, const SolverSettings& settings,
                                 const std::string& name, int a, int b) {
            // The pair approaches along n. The contacts are computed from the reference's positions, so that both
            // solvers get the same list. Each body is a ball of radius 0.3.
            Solver solver(settings);
            Vec3<double> start = twin.scene.state(twin.ids[0]).position;
            start.x += 0.59;
            start.y += 0.1 * random.symmetric();
            if (a == 1 || b == 1) start.z = twin.scene.state(twin.ids[1]).position.z;
            twin.scene.set_pose(twin.ids[1], start, {0, 0, 0, 1}, 0);
            twin.world.bodies[1].position = {start.x, start.y, start.z};
            twin.world.bodies[1].orientation.setIdentity();
            const bool flat = is_planar_pair(a == 1   ? BodyKind::planar
                                             : a == 2 ? BodyKind::rigid
                                             : a == 0 ? BodyKind::particle
                                                      : BodyKind::fixed,
                                             b == 1   ? BodyKind::planar
                                             : b == 2 ? BodyKind::rigid
                                             : b == 0 ? BodyKind::particle
                                                      : BodyKind::fixed);
            for (int step = 1; step <= steps; ++step) {
                Eigen::Vector3d d = twin.world.bodies[1].position - twin.world.bodies[0].position;
                if (flat) d.z() = 0;
                const double distance = d.norm();
                const Eigen::Vector3d n = d / distance;
                Contact contact;
                contact.body_a = twin.ids[0];
                contact.body_b = twin.ids[1];
                contact.key = 7;
                contact.normal = {static_cast<float>(n.x()), static_cast<float>(n.y()),
                                  static_cast<float>(n.z())};
                contact.separation = static_cast<float>(distance - 0.6);
                contact.arm_a = 0.3F * contact.normal;
                contact.arm_b = -0.3F * contact.normal;
                contact.friction = touches.friction;
                contact.restitution = touches.restitution;
                const StepReport report = solver.step(twin.scene, dt, {&contact, 1});
                ASSERT_EQ(report.status, StepStatus::done) << report.error;
                twin.world.step(static_cast<double>(dt), settings, {{0, 1, contact}});
                ASSERT_LT(twin.difference(), bound_per_step * step) << name << ", step " << step;
            }
        });
    }
}

TEST(AgainstReference, AChainAgreesWhenSolvedInTheOrderOfItsColours)
{
    for (const SolverSettings& settings : every_way()) {
        Twin twin;
        testing::Random random;
        constexpr int links = 9;
        for (int i = 0; i <= links; ++i) {
            BodyDefinition link = body_of(2, random);
            link.position = {0.5 * i, 0, 0};
            link.orientation = {0, 0, 0, 1};
            if (i == 0) link = BodyDefinition{.motion = BodyMotion::static_body};
            twin.add(link);
            if (i == 0) continue;
            const auto a = static_cast<std::size_t>(i - 1), b = static_cast<std::size_t>(i);
            twin.add_joint(BallSocketDefinition{twin.ids[a], twin.ids[b], {0.25F, 0, 0}, {-0.25F, 0, 0}});
        }
        std::vector<reference::Joint> joints;
        joints.swap(twin.world.joints);
        // First fit along a chain gives the colours 0, 1, 0, 1, ...
        for (const std::size_t first : {0, 1}) {
            for (std::size_t i = first; i < joints.size(); i += 2) twin.world.joints.push_back(joints[i]);
        }
        Solver solver(settings);
        for (int step = 1; step <= steps; ++step) {
            solver.step(twin.scene, dt);
            twin.world.step(static_cast<double>(dt), settings, {});
            // Ten links amplify a difference at the root tenfold at the tip.
            ASSERT_LT(twin.difference(), 10 * bound_per_step * step)
                << "step " << step << " of method " << static_cast<int>(settings.method);
        }
    }
}

}  // namespace
}  // namespace motley
