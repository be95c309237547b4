// Promise 2b: the lanes agree with the textbook in double. Every constraint, for every pair of body kinds that makes
// sense, in random scenes of one constraint, step after step; and a chain, solved in the same order. Independent
// evidence: core/reference, which shares no row with the lanes.
//
// Bound: a step in float rounds each of about 200 operations on numbers near `size` once, so it leaves the double
// step by at most about 200 x 6e-8 of it, amplified by the condition of K (below 30 here) where masses are inverted;
// errors of successive steps add up, and motions do not amplify them within the steps below.
#include <gtest/gtest.h>

#include "twin.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;
constexpr int steps = 30;
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

/// With a planar body a static or kinematic one makes a pair of the plane: what happens across it is not seen, so
/// nothing does.
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
                for (int trial = 0; trial < 3; ++trial) {
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

Vec3<float> anchor_of(int kind, int partner, testing::Random& random)
{
    const bool planar = (kind == 1 && partner != 0 && partner != 2) || (partner == 1 && kind >= 3);
    const auto r = [&] { return static_cast<float>(0.5 * random.symmetric()); };
    return kind == 0 ? Vec3<float>{} : Vec3<float>{r(), r(), planar ? 0 : r()};
}

Eigen::Vector3d eigen(const Vec3<float>& v)
{
    return {v.x, v.y, v.z};
}

void run_joint(Twin& twin, const SolverSettings& settings, const std::string& name)
{
    Solver solver(settings);
    for (int step = 1; step <= steps; ++step) {
        solver.step(twin.scene, dt);
        twin.world.step(static_cast<double>(dt), settings, {});
        ASSERT_LT(twin.difference(), bound_per_step * step) << name << ", step " << step;
    }
}

TEST(AgainstReference, BallSocketsAgreeForEveryPairAndMethod)
{
    for_every_pair([](Twin& twin, testing::Random& random, const SolverSettings& settings,
                      const std::string& name, int a, int b) {
        BallSocketDefinition joint{twin.ids[0], twin.ids[1], anchor_of(a, b, random),
                                   anchor_of(b, a, random)};
        twin.scene.add_joint(joint);
        twin.world.joints.push_back(
            {.a = 0, .b = 1, .local_a = eigen(joint.local_anchor_a), .local_b = eigen(joint.local_anchor_b)});
        run_joint(twin, settings, name);
    });
}

TEST(AgainstReference, RodsRopesAndSpringsAgreeForEveryPairAndMethod)
{
    for (const DistanceMode mode : {DistanceMode::rod, DistanceMode::rope, DistanceMode::spring}) {
        for_every_pair([mode](Twin& twin, testing::Random& random, const SolverSettings& settings,
                              const std::string& name, int a, int b) {
            DistanceDefinition joint{
                twin.ids[0], twin.ids[1], anchor_of(a, b, random), anchor_of(b, a, random), mode, 1.2F,
                2.0F,        0.3F};
            twin.scene.add_joint(joint);
            twin.world.joints.push_back({.kind = reference::Joint::Kind::distance,
                                         .a = 0,
                                         .b = 1,
                                         .local_a = eigen(joint.local_anchor_a),
                                         .local_b = eigen(joint.local_anchor_b),
                                         .mode = mode,
                                         .length = joint.length,
                                         .hertz = mode == DistanceMode::spring ? joint.hertz : 0,
                                         .damping_ratio = joint.damping_ratio});
            run_joint(twin, settings, name + ", mode " + std::to_string(static_cast<int>(mode)));
        });
    }
}

Eigen::Quaterniond eigen(const Quat<double>& q)
{
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z);
}
Quat<float> narrowed(const Eigen::Quaterniond& q)
{
    return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
            static_cast<float>(q.w())};
}

reference::Frame reference_frame(const JointFrame& f)
{
    return {eigen(f.position),
            Eigen::Quaterniond(f.rotation.w, f.rotation.x, f.rotation.y, f.rotation.z).normalized()};
}

/// Random frames on two bodies that turn, nearly where a joint wants them. With a planar body their axes lie in or
/// across the plane (`x_across`), as a host's would: between other axes rows depend on each other.
std::pair<JointFrame, JointFrame> random_frames(const Twin& twin, testing::Random& random, bool planar,
                                                bool x_across)
{
    const auto r = [&] { return random.symmetric(); };
    const auto narrow = [](const Eigen::Vector3d& v) {
        return Vec3<float>{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
    };
    const auto vector = [&](double size) {
        return Eigen::Vector3d(size * r(), size * r(), planar ? 0 : size * r());
    };
    const BodyState a = twin.scene.state(twin.ids[0]), b = twin.scene.state(twin.ids[1]);
    const Eigen::Quaterniond turn_a = eigen(a.orientation), turn_b = eigen(b.orientation);
    Eigen::Quaterniond world = Eigen::Quaterniond(r(), r(), r(), r()).normalized();
    Eigen::Vector3d tilt = vector(0.02);
    if (planar) {
        world = Eigen::AngleAxisd(3 * r(), Eigen::Vector3d::UnitZ());
        if (x_across) world = world * Eigen::AngleAxisd(-EIGEN_PI / 2, Eigen::Vector3d::UnitY());
        tilt = {0, 0, 0.02 * r()};
    }
    const JointFrame frame_a{narrow(vector(0.4)), narrowed(turn_a.conjugate() * world)};
    const Eigen::Vector3d anchor = Eigen::Vector3d(a.position.x, a.position.y, a.position.z) +
                                   turn_a * eigen(frame_a.position) + vector(0.02);
    const Eigen::Quaterniond tilted =
        Eigen::Quaterniond(1, tilt.x() / 2, tilt.y() / 2, tilt.z() / 2).normalized();
    return {
        frame_a,
        {narrow(turn_b.conjugate() * (anchor - Eigen::Vector3d(b.position.x, b.position.y, b.position.z))),
         narrowed(turn_b.conjugate() * tilted * world)}};
}

template <LinearLock linear, AngularLock angular>
void compare_frame_joints(const JointStiffness& stiffness)
{
    for_every_pair([&](Twin& twin, testing::Random& random, const SolverSettings& settings,
                       const std::string& name, int a, int b) {
        if (a == 0 || b == 0) return;
        FrameJointDefinition<linear, angular> joint{twin.ids[0], twin.ids[1], {}, {}, stiffness};
        std::tie(joint.frame_a, joint.frame_b) =
            random_frames(twin, random, a == 1 || b == 1, angular == AngularLock::swing);
        twin.scene.add_joint(joint);
        twin.world.joints.push_back({.kind = reference::Joint::Kind::frames,
                                     .a = 0,
                                     .b = 1,
                                     .hertz = stiffness.hertz,
                                     .damping_ratio = stiffness.damping_ratio,
                                     .frame_a = reference_frame(joint.frame_a),
                                     .frame_b = reference_frame(joint.frame_b),
                                     .linear = linear,
                                     .angular = angular});
        run_joint(twin, settings, name + ", hertz " + std::to_string(stiffness.hertz));
    });
}

/// A drive beside nothing: limits that are met within the steps, motors that reach their bound, springs.
template <DriveAxis axis>
void compare_drives(float lower, float upper, float speed, float force, float hertz)
{
    for_every_pair([&](Twin& twin, testing::Random& random, const SolverSettings& settings,
                       const std::string& name, int a, int b) {
        if (a == 0 || b == 0) return;
        DriveDefinition<axis> drive{.body_a = twin.ids[0], .body_b = twin.ids[1]};
        std::tie(drive.frame_a, drive.frame_b) =
            random_frames(twin, random, a == 1 || b == 1, axis == DriveAxis::twist);
        drive.lower = lower;
        drive.upper = upper;
        drive.motor_speed = speed;
        drive.motor_max_force = force;
        drive.spring_hertz = hertz;
        drive.spring_damping_ratio = 0.4F;
        drive.spring_target = 0.1F;
        twin.scene.add_joint(drive);
        twin.world.joints.push_back({.kind = reference::Joint::Kind::drive,
                                     .a = 0,
                                     .b = 1,
                                     .hertz = hertz,
                                     .damping_ratio = drive.spring_damping_ratio,
                                     .frame_a = reference_frame(drive.frame_a),
                                     .frame_b = reference_frame(drive.frame_b),
                                     .axis = axis,
                                     .lower = lower,
                                     .upper = upper,
                                     .motor_speed = speed,
                                     .motor_max_force = force,
                                     .spring_target = drive.spring_target});
        run_joint(twin, settings,
                  name + ", axis " + std::to_string(static_cast<int>(axis)) + ", from " +
                      std::to_string(lower) + " to " + std::to_string(upper));
    });
}

TEST(AgainstReference, DrivesAgreeForEveryPairOfBodiesThatTurn)
{
    const float free = std::numeric_limits<float>::infinity();
    compare_drives<DriveAxis::slide>(-0.05F, 0.1F, 0, 0, 0);
    compare_drives<DriveAxis::slide>(0.05F, 0.05F, 0, 0, 0);
    compare_drives<DriveAxis::slide>(-free, 0.2F, 2, 5, 0);
    compare_drives<DriveAxis::slide>(-free, free, 0, 1, 3);
    compare_drives<DriveAxis::twist>(-0.05F, 0.1F, 0, 0, 0);
    compare_drives<DriveAxis::twist>(0.05F, 0.05F, 0, 0, 0);
    compare_drives<DriveAxis::twist>(-free, 0.2F, 2, 0.5F, 0);
    compare_drives<DriveAxis::twist>(-free, free, 0, 0.1F, 3);
}

TEST(AgainstReference, FrameJointsAgreeForEveryPairOfBodiesThatTurn)
{
    for (const JointStiffness& stiffness : {JointStiffness{}, JointStiffness{5, 0.5F}}) {
        compare_frame_joints<LinearLock::point, AngularLock::all>(stiffness);
        compare_frame_joints<LinearLock::point, AngularLock::swing>(stiffness);
        compare_frame_joints<LinearLock::line, AngularLock::all>(stiffness);
        compare_frame_joints<LinearLock::plane, AngularLock::none>(stiffness);
        compare_frame_joints<LinearLock::line, AngularLock::none>(stiffness);
        compare_frame_joints<LinearLock::none, AngularLock::all>(stiffness);
        compare_frame_joints<LinearLock::none, AngularLock::swing>(stiffness);
        compare_frame_joints<LinearLock::none, AngularLock::perpendicular>(stiffness);
    }
}

TEST(AgainstReference, SwingLimitsAgreeForEveryPairOfBodiesThatTurn)
{
    for_every_pair([](Twin& twin, testing::Random& random, const SolverSettings& settings,
                      const std::string& name, int a, int b) {
        if (a == 0 || b == 0) return;
        SwingLimitDefinition limit{.body_a = twin.ids[0], .body_b = twin.ids[1], .max_angle = 0.1F};
        std::tie(limit.frame_a, limit.frame_b) = random_frames(twin, random, a == 1 || b == 1, false);
        twin.scene.add_joint(limit);
        twin.world.joints.push_back({.kind = reference::Joint::Kind::swing_limit,
                                     .a = 0,
                                     .b = 1,
                                     .length = limit.max_angle,
                                     .frame_a = reference_frame(limit.frame_a),
                                     .frame_b = reference_frame(limit.frame_b)});
        run_joint(twin, settings, name);
    });
}

TEST(AgainstReference, ContactsAgreeForEveryPairAndMethod)
{
    for (const float mu : {0.0F, 0.4F}) {
        for_every_pair([mu](Twin& twin, testing::Random& random, const SolverSettings& settings,
                            const std::string& name, int a, int b) {
            // The pair approaches along n; the geometry is replayed from the reference's positions, so that both see
            // the same list. Balls of radius 0.3 around each centre.
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
                contact.friction = mu;
                contact.restitution = mu > 0 ? 0.5F : 0;
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
        std::vector<reference::Joint> joints;
        for (int i = 0; i <= links; ++i) {
            BodyDefinition link = body_of(2, random);
            link.position = {0.5 * i, 0, 0};
            link.orientation = {0, 0, 0, 1};
            if (i == 0) link = BodyDefinition{.motion = BodyMotion::static_body};
            twin.add(link);
            if (i == 0) continue;
            const auto a = static_cast<std::size_t>(i - 1), b = static_cast<std::size_t>(i);
            twin.scene.add_joint(
                BallSocketDefinition{twin.ids[a], twin.ids[b], {0.25F, 0, 0}, {-0.25F, 0, 0}});
            joints.push_back({.a = i - 1, .b = i, .local_a = {0.25, 0, 0}, .local_b = {-0.25, 0, 0}});
        }
        // First fit along a chain gives colours 0, 1, 0, 1, ...
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
