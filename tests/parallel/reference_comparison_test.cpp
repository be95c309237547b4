// Promise 2b: the lanes agree with the textbook in double. Every constraint, for every pair of body kinds that makes
// sense, in random scenes of one constraint, step after step; and a chain, solved in the same order. Independent
// evidence: core/reference, which shares no row with the lanes.
//
// Bound: a step in float rounds each of about 200 operations on numbers near `size` once, so it leaves the double
// step by at most about 200 x 6e-8 of it, amplified by the condition of K (below 30 here) where masses are inverted;
// errors of successive steps add up, and motions do not amplify them within the steps below.
#include <gtest/gtest.h>

#include "mixed_scene.h"
#include "motley/reference/world.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;
constexpr int steps = 30;
constexpr double bound_per_step = 200 * 6e-8 * 5;  // size: speeds below 5 m/s and rad/s

struct Twin {
    Scene scene;
    reference::World world;
    std::vector<BodyId> ids;

    int add(const BodyDefinition& definition)
    {
        ids.push_back(scene.add_body(definition));
        world.bodies.push_back(reference::Body::from(definition));
        return static_cast<int>(ids.size()) - 1;
    }
    /// The largest difference of positions and velocities.
    [[nodiscard]] double difference() const
    {
        double most = 0;
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const BodyState s = scene.state(ids[i]);
            const reference::Body& b = world.bodies[i];
            most = std::max(most, (Eigen::Vector3d(s.position.x, s.position.y, s.position.z) - b.position)
                                      .cwiseAbs()
                                      .maxCoeff());
            reference::Vector6 v;
            v << s.linear_velocity.x, s.linear_velocity.y, s.linear_velocity.z, s.angular_velocity.x,
                s.angular_velocity.y, s.angular_velocity.z;
            most = std::max(most, (v - b.velocity).cwiseAbs().maxCoeff());
        }
        return most;
    }
};

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
                                         .hertz = joint.hertz,
                                         .damping_ratio = joint.damping_ratio});
            run_joint(twin, settings, name + ", mode " + std::to_string(static_cast<int>(mode)));
        });
    }
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
