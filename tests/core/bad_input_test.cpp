// Promise 4: bad input is refused when it is given, with a message that names the field, the value and the valid
// range, and it changes nothing. One table line for each field and each way in which it can be wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "motley/motley.h"

namespace motley {
namespace {

const float nan = std::numeric_limits<float>::quiet_NaN();
const float infinity = std::numeric_limits<float>::infinity();

/// A scene with one body of each kind and a joint, whose hash and counts must survive every refusal.
struct Fixture {
    Scene scene;
    BodyId particle, planar, rigid, kinematic, stationary, removed;
    ConstraintId joint, removed_joint;

    Fixture()
    {
        const auto add = [&](BodyModel model, BodyMotion motion, double x) {
            BodyDefinition body;
            body.model = model;
            body.motion = motion;
            body.position.x = x;
            if (model == BodyModel::rigid && motion == BodyMotion::dynamic_body)
                body.angular_velocity = {0, 0, 1};
            return scene.add_body(body);
        };
        particle = add(BodyModel::particle, BodyMotion::dynamic_body, 1);
        planar = add(BodyModel::planar, BodyMotion::dynamic_body, 2);
        rigid = add(BodyModel::rigid, BodyMotion::dynamic_body, 3);
        kinematic = add(BodyModel::rigid, BodyMotion::kinematic_body, 4);
        stationary = add(BodyModel::rigid, BodyMotion::static_body, 5);
        removed = add(BodyModel::rigid, BodyMotion::dynamic_body, 6);
        joint = scene.add_joint(BallSocketDefinition{rigid, planar, {1, 0, 0}, {0, 0, 0}});
        removed_joint = scene.add_joint(BallSocketDefinition{rigid, stationary, {}, {}});
        scene.remove_joint(removed_joint);
        scene.remove_body(removed);
    }
};

struct Case {
    const char* what;
    std::function<void(Fixture&)> offend;
    const char* field;  ///< must stand in the message
    const char* value;  ///< likewise
};

void expect_refused(const Case& c)
{
    Fixture f;
    const std::uint64_t hash = f.scene.state_hash();
    const std::size_t bodies = f.scene.body_count(), joints = f.scene.joint_count();
    try {
        c.offend(f);
        ADD_FAILURE() << c.what << ": was accepted";
        return;
    } catch (const InvalidInput& refusal) {
        const std::string message = refusal.what();
        EXPECT_NE(message.find(c.field), std::string::npos) << c.what << ": " << message;
        EXPECT_NE(message.find(c.value), std::string::npos) << c.what << ": " << message;
        EXPECT_NE(message.find("expected"), std::string::npos) << c.what << ": " << message;
    }
    EXPECT_EQ(f.scene.state_hash(), hash) << c.what;
    EXPECT_EQ(f.scene.body_count(), bodies) << c.what;
    EXPECT_EQ(f.scene.joint_count(), joints) << c.what;
}

/// A case with one bad field in an otherwise good body.
Case body(const char* what, std::function<void(BodyDefinition&)> spoil, const char* field, const char* value)
{
    return {what,
            [spoil](Fixture& f) {
                BodyDefinition good;
                BodyDefinition bad = good;
                spoil(bad);
                // In a batch after a good body: either all bodies of a batch are added or none.
                const BodyDefinition both[2] = {good, bad};
                BodyId ids[2];
                f.scene.add_bodies(both, ids);
            },
            field, value};
}

TEST(BadInput, EveryFieldOfABodyIsCheckedAndABatchIsAllOrNone)
{
    const Case cases[] = {
        body(
            "model", [](auto& b) { b.model = static_cast<BodyModel>(7); }, "model", "7"),
        body(
            "motion", [](auto& b) { b.motion = static_cast<BodyMotion>(9); }, "motion", "9"),
        body(
            "position NaN", [](auto& b) { b.position.y = std::nan(""); }, "position.y", "nan"),
        body(
            "position infinite", [](auto& b) { b.position.x = HUGE_VAL; }, "position.x", "inf"),
        body(
            "position far", [](auto& b) { b.position.z = 1e13; }, "position.z", "1e+13"),
        body(
            "yaw", [](auto& b) { b.yaw = std::nan(""); }, "yaw", "nan"),
        body(
            "orientation zero",
            [](auto& b) {
                b.orientation = {0, 0, 0, 0};
            },
            "orientation", "0"),
        body(
            "orientation NaN", [](auto& b) { b.orientation.x = std::nan(""); }, "orientation", "nan"),
        body(
            "linear velocity", [](auto& b) { b.linear_velocity.z = nan; }, "linear_velocity.z", "nan"),
        body(
            "angular velocity", [](auto& b) { b.angular_velocity.x = infinity; }, "angular_velocity.x",
            "inf"),
        body(
            "mass zero", [](auto& b) { b.mass = 0; }, "mass", "0"),
        body(
            "mass negative", [](auto& b) { b.mass = -2; }, "mass", "-2"),
        body(
            "mass NaN", [](auto& b) { b.mass = nan; }, "mass", "nan"),
        body(
            "linear damping", [](auto& b) { b.linear_damping = -1; }, "linear_damping", "-1"),
        body(
            "linear damping NaN", [](auto& b) { b.linear_damping = nan; }, "linear_damping", "nan"),
        body(
            "angular damping", [](auto& b) { b.angular_damping = 2e6F; }, "angular_damping", "0 to 1e6"),
        body(
            "inertia zero", [](auto& b) { b.inertia.xx = 0; }, "inertia.xx", "0"),
        body(
            "inertia NaN", [](auto& b) { b.inertia.yz = nan; }, "inertia", "nan"),
        body(
            "inertia indefinite", [](auto& b) { b.inertia.xy = 2; }, "inertia", "positive definite"),
        body(
            "inertia against the triangle inequality", [](auto& b) { b.inertia = {1, 0, 0, 1, 0, 3}; },
            "inertia", "triangle"),
        body(
            "planar out of plane",
            [](auto& b) {
                b.model = BodyModel::planar;
                b.linear_velocity.z = 1;
            },
            "linear_velocity.z", "1"),
        body(
            "planar tilting",
            [](auto& b) {
                b.model = BodyModel::planar;
                b.angular_velocity.x = 1;
            },
            "angular_velocity.x", "1"),
        body(
            "planar inertia",
            [](auto& b) {
                b.model = BodyModel::planar;
                b.inertia.zz = -1;
            },
            "inertia.zz", "-1"),
        body(
            "particle spinning",
            [](auto& b) {
                b.model = BodyModel::particle;
                b.angular_velocity.y = 2;
            },
            "angular_velocity.y", "2"),
        body(
            "static moving",
            [](auto& b) {
                b.motion = BodyMotion::static_body;
                b.linear_velocity.x = 3;
            },
            "linear_velocity.x", "3"),
    };
    for (const Case& c : cases) expect_refused(c);
}

Case ball_socket(const char* what, std::function<void(BallSocketDefinition&, Fixture&)> spoil,
                 const char* field, const char* value)
{
    return {what,
            [spoil](Fixture& f) {
                BallSocketDefinition joint{f.rigid, f.planar, {}, {}};
                spoil(joint, f);
                f.scene.add_joint(joint);
            },
            field, value};
}

Case distance(const char* what, std::function<void(DistanceDefinition&, Fixture&)> spoil, const char* field,
              const char* value)
{
    return {what,
            [spoil](Fixture& f) {
                DistanceDefinition joint;
                joint.body_a = f.rigid;
                joint.body_b = f.planar;
                spoil(joint, f);
                f.scene.add_joint(joint);
            },
            field, value};
}

TEST(BadInput, EveryFieldOfAJointIsChecked)
{
    const Case cases[] = {
        ball_socket(
            "null body", [](auto& j, Fixture&) { j.body_a = {}; }, "body_a", "null"),
        ball_socket(
            "removed body", [](auto& j, Fixture& f) { j.body_b = f.removed; }, "body_b", "not alive"),
        ball_socket(
            "unknown body",
            [](auto& j, Fixture&) {
                j.body_b = {12345, 1};
            },
            "body_b", "12345"),
        ball_socket(
            "one body twice", [](auto& j, Fixture&) { j.body_b = j.body_a; }, "body_b", "same"),
        ball_socket(
            "nothing to move",
            [](auto& j, Fixture& f) {
                j.body_a = f.kinematic;
                j.body_b = f.stationary;
            },
            "body_b", "cannot move"),
        ball_socket(
            "anchor a", [](auto& j, Fixture&) { j.local_anchor_a.y = nan; }, "local_anchor_a.y", "nan"),
        ball_socket(
            "anchor b", [](auto& j, Fixture&) { j.local_anchor_b.x = infinity; }, "local_anchor_b.x", "inf"),
        ball_socket(
            "anchor far", [](auto& j, Fixture&) { j.local_anchor_b.z = 2e9F; }, "local_anchor_b.z", "2e+09"),
        ball_socket(
            "anchor of a particle",
            [](auto& j, Fixture& f) {
                j.body_b = f.particle;
                j.local_anchor_b.x = 1;
            },
            "local_anchor_b.x", "1"),
        distance(
            "null body", [](auto& j, Fixture&) { j.body_a = {}; }, "body_a", "null"),
        distance(
            "anchor a", [](auto& j, Fixture&) { j.local_anchor_a.x = nan; }, "local_anchor_a.x", "nan"),
        distance(
            "anchor b", [](auto& j, Fixture&) { j.local_anchor_b.y = nan; }, "local_anchor_b.y", "nan"),
        distance(
            "length negative", [](auto& j, Fixture&) { j.min_length = -0.3F; },
            "DistanceDefinition.min_length", "-0.3"),
        distance(
            "length NaN", [](auto& j, Fixture&) { j.max_length = nan; }, "DistanceDefinition.max_length",
            "nan"),
        distance(
            "lengths crossed", [](auto& j, Fixture&) { j.min_length = 2; }, "DistanceDefinition.min_length",
            "2"),
        distance(
            "hertz", [](auto& j, Fixture&) { j.spring_hertz = nan; }, "DistanceDefinition.spring_hertz",
            "nan"),
        distance(
            "damping", [](auto& j, Fixture&) { j.spring_damping_ratio = -1; },
            "DistanceDefinition.spring_damping_ratio", "-1"),
        distance(
            "spring stiffness", [](auto& j, Fixture&) { j.spring_stiffness = -2; },
            "DistanceDefinition.spring_stiffness", "-2"),
        distance(
            "spring damping", [](auto& j, Fixture&) { j.spring_damping = nan; },
            "DistanceDefinition.spring_damping", "nan"),
        distance(
            "two springs", [](auto& j, Fixture&) { j.spring_hertz = 3, j.spring_stiffness = 1; },
            "DistanceDefinition.spring_hertz", "3"),
        distance(
            "rest length", [](auto& j, Fixture&) { j.rest_length = -2; }, "DistanceDefinition.rest_length",
            "-2"),
        distance(
            "spring force", [](auto& j, Fixture&) { j.spring_max_force = -1; },
            "DistanceDefinition.spring_max_force", "-1"),
    };
    for (const Case& c : cases) expect_refused(c);
}

/// A case with one bad field in a joint between frames.
template <class Definition>
Case frames(const char* what, std::function<void(Definition&, Fixture&)> spoil, const char* field,
            const char* value)
{
    return {what,
            [spoil](Fixture& f) {
                Definition joint;
                joint.body_a = f.rigid;
                joint.body_b = f.planar;
                spoil(joint, f);
                f.scene.add_joint(joint);
            },
            field, value};
}

/// The fields that every joint between frames has.
template <class Definition>
void expect_frames_are_checked()
{
    using J = Definition;
    const Case cases[] = {
        frames<J>(
            "null body", [](J& j, Fixture&) { j.body_b = {}; }, "body_b", "null"),
        frames<J>(
            "a particle", [](J& j, Fixture& f) { j.body_a = f.particle; }, "frame_a", "particle"),
        frames<J>(
            "b particle", [](J& j, Fixture& f) { j.body_b = f.particle; }, "frame_b", "particle"),
        frames<J>(
            "position a", [](J& j, Fixture&) { j.frame_a.position.y = nan; }, "frame_a.position.y", "nan"),
        frames<J>(
            "position b", [](J& j, Fixture&) { j.frame_b.position.z = 2e9F; }, "frame_b.position.z", "2e+09"),
        frames<J>(
            "rotation a",
            [](J& j, Fixture&) {
                j.frame_a.rotation = {0, 0, 0, 0};
            },
            "frame_a.rotation", "0"),
        frames<J>(
            "rotation b", [](J& j, Fixture&) { j.frame_b.rotation.w = infinity; }, "frame_b.rotation", "inf"),
        frames<J>(
            "rotation NaN", [](J& j, Fixture&) { j.frame_b.rotation.x = nan; }, "frame_b.rotation", "nan"),
    };
    for (const Case& c : cases) expect_refused(c);
}

TEST(BadInput, EveryFieldOfAJointBetweenFramesIsChecked)
{
    expect_frames_are_checked<FixedDefinition>();
    expect_frames_are_checked<PointOnLineDefinition>();
    expect_frames_are_checked<TwistDriveDefinition>();
    expect_frames_are_checked<EulerDriveDefinition>();
    expect_frames_are_checked<SwingLimitDefinition>();
    expect_frames_are_checked<AngularServoDefinition>();
    using Hinge = HingeDefinition;
    using Slide = SlideDriveDefinition;
    using Twist = TwistDriveDefinition;
    using Swing = SwingLimitDefinition;
    using Servo = AngularServoDefinition;
    const Case cases[] = {
        frames<Hinge>(
            "hertz", [](Hinge& j, Fixture&) { j.stiffness.hertz = -1; }, "stiffness.hertz", "-1"),
        frames<Hinge>(
            "hertz NaN", [](Hinge& j, Fixture&) { j.stiffness.hertz = nan; }, "stiffness.hertz", "nan"),
        frames<Hinge>(
            "damping", [](Hinge& j, Fixture&) { j.stiffness.damping_ratio = -2; }, "stiffness.damping_ratio",
            "-2"),
        frames<Slide>(
            "lower above upper", [](Slide& j, Fixture&) { j.lower = 2, j.upper = 1; }, "lower", "2"),
        frames<Slide>(
            "lower NaN", [](Slide& j, Fixture&) { j.lower = nan; }, "lower", "nan"),
        frames<Slide>(
            "upper NaN", [](Slide& j, Fixture&) { j.upper = nan; }, "upper", "nan"),
        frames<Slide>(
            "upper far", [](Slide& j, Fixture&) { j.upper = 2e9F; }, "upper", "2e+09"),
        frames<Slide>(
            "lower infinite", [](Slide& j, Fixture&) { j.lower = infinity, j.upper = 1; }, "lower", "inf"),
        frames<Slide>(
            "speed", [](Slide& j, Fixture&) { j.motor_speed = infinity; }, "motor_speed", "inf"),
        frames<Slide>(
            "force", [](Slide& j, Fixture&) { j.motor_max_force = -1; }, "motor_max_force", "-1"),
        frames<Slide>(
            "spring hertz", [](Slide& j, Fixture&) { j.spring_hertz = nan; }, "spring_hertz", "nan"),
        frames<Slide>(
            "spring damping", [](Slide& j, Fixture&) { j.spring_damping_ratio = -1; }, "spring_damping_ratio",
            "-1"),
        frames<Slide>(
            "spring stiffness", [](Slide& j, Fixture&) { j.spring_stiffness = -2; }, "spring_stiffness",
            "-2"),
        frames<Slide>(
            "damper", [](Slide& j, Fixture&) { j.spring_damping = infinity; }, "spring_damping", "inf"),
        frames<Slide>(
            "rotor", [](Slide& j, Fixture&) { j.armature = -1; }, "armature", "-1"),
        frames<Slide>(
            "two springs", [](Slide& j, Fixture&) { j.spring_hertz = 3, j.spring_stiffness = 1; },
            "spring_hertz", "3"),
        frames<Slide>(
            "spring target", [](Slide& j, Fixture&) { j.spring_target = infinity; }, "spring_target", "inf"),
        frames<Slide>(
            "spring force", [](Slide& j, Fixture&) { j.spring_max_force = nan; }, "spring_max_force", "nan"),
        frames<Servo>(
            "hertz", [](Servo& j, Fixture&) { j.hertz = -1; }, "hertz", "-1"),
        frames<Servo>(
            "damping", [](Servo& j, Fixture&) { j.damping_ratio = nan; }, "damping_ratio", "nan"),
        frames<Servo>(
            "velocity", [](Servo& j, Fixture&) { j.target_velocity.y = infinity; }, "target_velocity.y",
            "inf"),
        frames<Servo>(
            "torque", [](Servo& j, Fixture&) { j.max_torque = -3; }, "max_torque", "-3"),
        frames<Twist>(
            "upper beyond pi", [](Twist& j, Fixture&) { j.upper = 4; }, "upper", "4"),
        frames<Twist>(
            "target beyond pi", [](Twist& j, Fixture&) { j.spring_target = -4; }, "spring_target", "-4"),
        frames<Swing>(
            "negative", [](Swing& j, Fixture&) { j.max_angle = -0.5F; }, "max_angle", "-0.5"),
        frames<Swing>(
            "beyond pi", [](Swing& j, Fixture&) { j.max_angle = 3.5F; }, "max_angle", "3.5"),
        frames<Swing>(
            "NaN", [](Swing& j, Fixture&) { j.max_angle = nan; }, "max_angle", "nan"),
    };
    for (const Case& c : cases) expect_refused(c);
}

/// Like frames(), for a joint without frames between a rigid and a planar body.
template <class Definition>
Case bodies(const char* what, std::function<void(Definition&, Fixture&)> spoil, const char* field,
            const char* value)
{
    return {what,
            [spoil](Fixture& f) {
                Definition joint;
                joint.body_a = f.rigid;
                joint.body_b = f.planar;
                spoil(joint, f);
                f.scene.add_joint(joint);
            },
            field, value};
}

TEST(BadInput, EveryFieldOfAServoATransmissionAndAPulleyIsChecked)
{
    using Servo = PointServoDefinition;
    using Gears = GearDefinition;
    using Rack = RackAndPinionDefinition;
    using Rope = PulleyDefinition;
    const Case cases[] = {
        bodies<Servo>(
            "anchor a", [](Servo& j, Fixture&) { j.local_anchor_a.x = nan; }, "local_anchor_a.x", "nan"),
        bodies<Servo>(
            "anchor of a particle",
            [](Servo& j, Fixture& f) { j.body_b = f.particle, j.local_anchor_b.y = 1; }, "local_anchor_b.y",
            "1"),
        bodies<Servo>(
            "hertz", [](Servo& j, Fixture&) { j.hertz = nan; }, "hertz", "nan"),
        bodies<Servo>(
            "damping", [](Servo& j, Fixture&) { j.damping_ratio = -1; }, "damping_ratio", "-1"),
        bodies<Servo>(
            "velocity", [](Servo& j, Fixture&) { j.target_velocity.z = nan; }, "target_velocity.z", "nan"),
        bodies<Servo>(
            "force", [](Servo& j, Fixture&) { j.max_force = -1; }, "max_force", "-1"),
        bodies<Gears>(
            "a particle", [](Gears& j, Fixture& f) { j.body_a = f.particle; }, "body_a", "particle"),
        bodies<Gears>(
            "b particle", [](Gears& j, Fixture& f) { j.body_b = f.particle; }, "body_b", "particle"),
        bodies<Gears>(
            "no axis",
            [](Gears& j, Fixture&) {
                j.axis_a = {0, 0, 0};
            },
            "axis_a", "0"),
        bodies<Gears>(
            "axis NaN", [](Gears& j, Fixture&) { j.axis_b.x = nan; }, "axis_b", "nan"),
        bodies<Gears>(
            "ratio", [](Gears& j, Fixture&) { j.ratio = infinity; }, "ratio", "inf"),
        bodies<Rack>(
            "travel", [](Rack& j, Fixture&) { j.travel = nan; }, "travel", "nan"),
        bodies<Rope>(
            "anchor b", [](Rope& j, Fixture&) { j.local_anchor_b.x = nan; }, "local_anchor_b.x", "nan"),
        bodies<Rope>(
            "point a", [](Rope& j, Fixture&) { j.point_a.z = 2e9; }, "point_a.z", "2e+09"),
        bodies<Rope>(
            "point b", [](Rope& j, Fixture&) { j.point_b.x = std::nan(""); }, "point_b.x", "nan"),
        bodies<Rope>(
            "ratio", [](Rope& j, Fixture&) { j.ratio = 0; }, "ratio", "0"),
        bodies<Rope>(
            "lengths crossed", [](Rope& j, Fixture&) { j.min_length = 3; }, "min_length", "3"),
        bodies<Rope>(
            "length NaN", [](Rope& j, Fixture&) { j.max_length = nan; }, "max_length", "nan"),
    };
    for (const Case& c : cases) expect_refused(c);
}

TEST(BadInput, EveryFieldOfAScrewIsChecked)
{
    using Screw = ScrewDefinition;
    const Case cases[] = {
        bodies<Screw>(
            "a particle", [](Screw& j, Fixture& f) { j.body_a = f.particle; }, "body_a", "particle"),
        bodies<Screw>(
            "b particle", [](Screw& j, Fixture& f) { j.body_b = f.particle; }, "body_b", "particle"),
        bodies<Screw>(
            "anchor a", [](Screw& j, Fixture&) { j.local_anchor_a.y = nan; }, "local_anchor_a.y", "nan"),
        bodies<Screw>(
            "anchor b", [](Screw& j, Fixture&) { j.local_anchor_b.x = 2e9F; }, "local_anchor_b.x", "2e+09"),
        bodies<Screw>(
            "no axis",
            [](Screw& j, Fixture&) {
                j.axis_a = {0, 0, 0};
            },
            "axis_a", "0"),
        bodies<Screw>(
            "pitch", [](Screw& j, Fixture&) { j.pitch = nan; }, "pitch", "nan"),
        bodies<Screw>(
            "pitch too large", [](Screw& j, Fixture&) { j.pitch = 2e6F; }, "pitch", "2000000"),
    };
    for (const Case& c : cases) expect_refused(c);
}

TEST(BadInput, AJointIsSaidAnewOnlyAsWhatItIs)
{
    const auto ball_socket = [](Fixture& f) { return BallSocketDefinition{f.rigid, f.planar, {}, {}}; };
    const Case cases[] = {
        {"null", [=](Fixture& f) { f.scene.set_joint({}, ball_socket(f)); }, "joint", "null"},
        {"removed", [=](Fixture& f) { f.scene.set_joint(f.removed_joint, ball_socket(f)); }, "joint",
         "removed"},
        {"type",
         [](Fixture& f) {
             f.scene.set_joint(f.joint, DistanceDefinition{f.rigid, f.planar});
         },
         "set_joint.definition", "another type"},
        {"bodies",
         [](Fixture& f) {
             f.scene.set_joint(f.joint, BallSocketDefinition{f.rigid, f.kinematic, {}, {}});
         },
         "set_joint.definition", "other bodies"},
        {"value",
         [=](Fixture& f) {
             BallSocketDefinition joint = ball_socket(f);
             joint.local_anchor_a.x = nan;
             f.scene.set_joint(f.joint, joint);
         },
         "local_anchor_a.x", "nan"},
    };
    for (const Case& c : cases) expect_refused(c);
}

TEST(BadInput, StaleHandlesAndWrongSizesAreRefused)
{
    const Vec3<float> v[2]{};
    const Vec3<float> bad[2] = {{0, 0, 0}, {nan, 0, 0}};
    Vec3<double> p[2];
    double yaw[1];
    const Case cases[] = {
        {"state", [](Fixture& f) { (void)f.scene.state(f.removed); }, "state.body", "not alive"},
        {"model", [](Fixture& f) { (void)f.scene.model({}); }, "model.body", "null"},
        {"motion", [](Fixture& f) { (void)f.scene.motion({}); }, "motion.body", "null"},
        {"remove", [](Fixture& f) { f.scene.remove_body(f.removed); }, "remove_bodies", "not alive"},
        {"remove the ground", [](Fixture& f) { f.scene.remove_body(f.scene.ground()); }, "remove_bodies",
         "ground"},
        {"remove twice",
         [](Fixture& f) {
             const BodyId two[2] = {f.rigid, f.rigid};
             f.scene.remove_bodies(two);
         },
         "remove_bodies", "twice"},
        {"remove a removed joint", [](Fixture& f) { f.scene.remove_joint(f.removed_joint); }, "remove_joint",
         "not alive"},
        {"force of a removed joint", [](Fixture& f) { (void)f.scene.joint_report(f.removed_joint); },
         "joint_report", "not alive"},
        {"add_bodies sizes",
         [](Fixture& f) {
             const BodyDefinition d[2];
             BodyId id[1];
             f.scene.add_bodies(d, id);
         },
         "ids.size()", "1"},
        {"set_pose NaN",
         [](Fixture& f) {
             f.scene.set_pose(f.rigid, {std::nan(""), 0, 0}, {0, 0, 0, 1}, 0);
         },
         "set_pose.position.x", "nan"},
        {"set_pose quaternion",
         [](Fixture& f) {
             f.scene.set_pose(f.rigid, {}, {0, 0, 0, 0}, 0);
         },
         "set_pose.orientation", "0"},
        {"set_pose yaw",
         [](Fixture& f) {
             f.scene.set_pose(f.planar, {}, {0, 0, 0, 1}, std::nan(""));
         },
         "set_pose.yaw", "nan"},
        {"set_pose ground",
         [](Fixture& f) {
             f.scene.set_pose(f.scene.ground(), {}, {0, 0, 0, 1}, 0);
         },
         "set_pose.body", "ground"},
        {"velocity NaN",
         [](Fixture& f) {
             f.scene.set_velocity(f.rigid, {nan, 0, 0}, {});
         },
         "linear_velocity.x", "nan"},
        {"velocity of a static body",
         [](Fixture& f) {
             f.scene.set_velocity(f.stationary, {1, 0, 0}, {});
         },
         "linear_velocity.x", "1"},
        {"force on a kinematic body",
         [](Fixture& f) {
             f.scene.set_force(f.kinematic, {1, 0, 0}, {});
         },
         "set_forces.bodies", "kinematic"},
        {"force NaN",
         [](Fixture& f) {
             f.scene.set_force(f.rigid, {0, nan, 0}, {});
         },
         "set_forces.forces.y", "nan"},
        {"torque infinite",
         [](Fixture& f) {
             f.scene.set_force(f.rigid, {}, {0, 0, infinity});
         },
         "set_forces.torques.z", "inf"},
        {"orientations sizes",
         [&](Fixture& f) {
             const BodyId two[2] = {f.rigid, f.planar};
             Quat<double> q[1];
             f.scene.read_orientations(two, q);
         },
         "read_orientations.orientations.size()", "1"},
        {"orientation of a removed body",
         [&](Fixture& f) {
             const BodyId two[2] = {f.rigid, f.removed};
             Quat<double> q[2];
             f.scene.read_orientations(two, q);
         },
         "read_orientations.bodies", "not alive"},
        {"joint reports sizes",
         [](Fixture& f) {
             const ConstraintId one[1] = {f.joint};
             JointReport reports[2];
             f.scene.read_joint_reports(one, reports);
         },
         "read_joint_reports.reports.size()", "2"},
        {"joint report of a removed joint",
         [](Fixture& f) {
             const ConstraintId two[2] = {f.joint, f.removed_joint};
             JointReport reports[2];
             f.scene.read_joint_reports(two, reports);
         },
         "read_joint_reports.joints", "not alive"},
        {"user data of a removed body", [](Fixture& f) { f.scene.set_user_data(f.removed, 1); },
         "set_user_data.body", "not alive"},
        {"sleep of a removed body", [](Fixture& f) { (void)f.scene.is_asleep(f.removed); }, "is_asleep.body",
         "not alive"},
        {"waking nobody", [](Fixture& f) { f.scene.wake({}); }, "wake.body", "null"},
        {"user data of nobody", [](Fixture& f) { (void)f.scene.user_data({}); }, "user_data.body", "null"},
        {"mass of a removed body",
         [](Fixture& f) {
             f.scene.set_mass(f.removed, 1, {1, 0, 0, 1, 0, 1});
         },
         "set_mass.body", "not alive"},
        {"mass of the ground",
         [](Fixture& f) {
             f.scene.set_mass(f.scene.ground(), 1, {1, 0, 0, 1, 0, 1});
         },
         "set_mass.body", "static"},
        {"mass of a kinematic body",
         [](Fixture& f) {
             f.scene.set_mass(f.kinematic, 1, {1, 0, 0, 1, 0, 1});
         },
         "set_mass.body", "kinematic"},
        {"damping of a removed body", [](Fixture& f) { f.scene.set_damping(f.removed, 1, 1); },
         "set_damping.body", "not alive"},
        {"damping of a kinematic body", [](Fixture& f) { f.scene.set_damping(f.kinematic, 1, 1); },
         "set_damping.body", "kinematic"},
        {"damping below 0", [](Fixture& f) { f.scene.set_damping(f.rigid, -1, 1); },
         "set_damping.linear_damping", "-1"},
        {"damping NaN", [](Fixture& f) { f.scene.set_damping(f.rigid, 1, nan); },
         "set_damping.angular_damping", "nan"},
        {"mass zero", [](Fixture& f) { f.scene.set_mass(f.particle, 0, {}); }, "set_mass.mass", "0"},
        {"mass NaN",
         [](Fixture& f) {
             f.scene.set_mass(f.rigid, nan, {1, 0, 0, 1, 0, 1});
         },
         "set_mass.mass", "nan"},
        {"inertia of a planar body",
         [](Fixture& f) {
             f.scene.set_mass(f.planar, 1, {1, 0, 0, 1, 0, -1});
         },
         "set_mass.inertia.zz", "-1"},
        {"inertia against the triangle inequality",
         [](Fixture& f) {
             f.scene.set_mass(f.rigid, 1, {1, 0, 0, 1, 0, 3});
         },
         "set_mass.inertia", "triangle"},
        {"inertia indefinite",
         [](Fixture& f) {
             f.scene.set_mass(f.rigid, 1, {1, 2, 0, 1, 0, 1});
         },
         "set_mass.inertia", "positive definite"},
        {"change of a removed body", [](Fixture& f) { f.scene.change_body(f.removed, {}); },
         "change_body.body", "not alive"},
        {"change of the null handle", [](Fixture& f) { f.scene.change_body({}, {}); }, "change_body.body",
         "null"},
        {"change of the ground", [](Fixture& f) { f.scene.change_body(f.scene.ground(), {}); },
         "change_body.body", "static"},
        {"change of a kinematic body",
         [](Fixture& f) { f.scene.change_body(f.kinematic, {.model = BodyModel::planar}); },
         "change_body.body", "kinematic"},
        {"change to no model",
         [](Fixture& f) { f.scene.change_body(f.rigid, {.model = static_cast<BodyModel>(3)}); },
         "BodyChange.model", "3"},
        {"change to an inertia below 0",
         [](Fixture& f) {
             f.scene.change_body(f.rigid, {.model = BodyModel::planar, .inertia = {1, 0, 0, 1, 0, -1}});
         },
         "BodyChange.inertia.zz", "-1"},
        {"change to an inertia against the triangle inequality",
         [](Fixture& f) {
             f.scene.change_body(f.planar, {.inertia = {1, 0, 0, 1, 0, 3}});
         },
         "BodyChange.inertia", "triangle"},
        {"change to an inertia that is not a number",
         [](Fixture& f) {
             f.scene.change_body(f.planar, {.inertia = {nan, 0, 0, 1, 0, 1}});
         },
         "BodyChange.inertia", "nan"},
        {"change of a body with an anchor off its centre to a particle",
         [](Fixture& f) { f.scene.change_body(f.rigid, {.model = BodyModel::particle}); },
         "change_body.body has a joint, slot 1: BallSocketDefinition.local_anchor_a.x", "1"},
        {"change of a disc to a rigid body",
         [](Fixture& f) {
             f.scene.set_disc(f.planar, {});
             f.scene.change_body(f.planar, {});
         },
         "BodyChange.model", "clear_disc"},
        {"change of a disc to a particle",
         [](Fixture& f) {
             f.scene.set_disc(f.planar, {});
             f.scene.change_body(f.planar, {.model = BodyModel::particle});
         },
         "BodyChange.model", "particle"},
        {"change to an inertia that spins the body up",
         [](Fixture& f) {
             f.scene.change_body(f.rigid, {.model = BodyModel::planar, .inertia = {0, 0, 0, 0, 0, 1e-20F}});
         },
         "BodyChange.inertia's angular velocity", "e+20"},
        {"revive a body that moves", [](Fixture& f) { f.scene.revive(f.rigid, {}, {}); }, "revive.body",
         "moves"},
        {"set_velocities sizes",
         [&](Fixture& f) {
             const BodyId one[1] = {f.rigid};
             f.scene.set_velocities(one, v);
         },
         "linear.size()", "2"},
        {"set_velocities second is bad",
         [&](Fixture& f) {
             const BodyId two[2] = {f.rigid, f.planar};
             f.scene.set_velocities(two, bad);
         },
         "linear_velocity.x", "nan"},
        {"set_forces sizes",
         [&](Fixture& f) {
             const BodyId one[1] = {f.rigid};
             f.scene.set_forces(one, v);
         },
         "forces.size()", "2"},
        {"read_positions sizes",
         [&](Fixture& f) {
             const BodyId one[1] = {f.rigid};
             f.scene.read_positions(one, p);
         },
         "positions.size()", "2"},
        {"read_yaws dead",
         [&](Fixture& f) {
             const BodyId one[1] = {f.removed};
             f.scene.read_yaws(one, yaw);
         },
         "read_yaws.bodies", "not alive"},
    };
    for (const Case& c : cases) expect_refused(c);
}

TEST(BadInput, EverySettingIsChecked)
{
    const auto refused = [](const char* field, auto spoil) {
        SolverSettings settings;
        spoil(settings);
        Solver solver;
        try {
            solver.set_settings(settings);
            ADD_FAILURE() << field << " was accepted";
        } catch (const InvalidInput& refusal) {
            EXPECT_NE(std::string(refusal.what()).find(field), std::string::npos) << refusal.what();
            EXPECT_EQ(solver.settings().substeps, SolverSettings{}.substeps);
        }
        EXPECT_THROW(Solver{settings}, InvalidInput);
    };
    refused("method", [](auto& s) { s.method = static_cast<Method>(9); });
    refused("drift_correction", [](auto& s) { s.drift_correction = static_cast<DriftCorrection>(9); });
    refused("substeps", [](auto& s) { s.substeps = 0; });
    refused("iterations", [](auto& s) { s.iterations = -1; });
    refused("relaxations", [](auto& s) { s.relaxations = -1; });
    refused("projections", [](auto& s) { s.projections = -1; });
    refused("tolerance", [](auto& s) { s.tolerance = -1; });
    refused("budget_ms", [](auto& s) { s.budget_ms = nan; });
    refused("sleep_speed", [](auto& s) { s.sleep_speed = -1; });
    refused("sleep_speed", [](auto& s) { s.sleep_speed = nan; });
    refused("sleep_speed", [](auto& s) {
        s.sleep_speed = 0.01F;
        s.method = Method::direct;
    });
    refused("exact_above_ratio", [](auto& s) { s.exact_above_ratio = 0.9F; });
    refused("exact_above_ratio", [](auto& s) { s.exact_above_ratio = nan; });
    refused("sleep_after", [](auto& s) { s.sleep_after = -1; });
    refused("sleep_after", [](auto& s) { s.sleep_after = infinity; });
    refused("gravity.x", [](auto& s) { s.gravity.x = nan; });
    refused("gravity.y", [](auto& s) { s.gravity.y = nan; });
    refused("gravity.z", [](auto& s) { s.gravity.z = infinity; });
    refused("contact_hertz", [](auto& s) { s.contact_hertz = -1; });
    refused("contact_damping_ratio", [](auto& s) { s.contact_damping_ratio = -1; });
    refused("push_out_speed", [](auto& s) { s.push_out_speed = 0; });
    refused("joint_hertz", [](auto& s) { s.joint_hertz = nan; });
    refused("joint_damping_ratio", [](auto& s) { s.joint_damping_ratio = -1; });
    refused("restitution_threshold", [](auto& s) { s.restitution_threshold = -1; });
    refused("baumgarte", [](auto& s) { s.baumgarte = 1.5F; });
    refused("penetration_slop", [](auto& s) { s.penetration_slop = nan; });
    EXPECT_THROW(Solver({}, {.threads = 0}), InvalidInput);
}

TEST(BadInput, EveryFieldOfAContactIsRefusedByTheStepWhichChangesNothing)
{
    struct ContactCase {
        std::function<void(Contact&, Fixture&)> spoil;
        const char* field;
        const char* value;
    };
    const ContactCase cases[] = {
        {[](Contact& c, Fixture&) { c.body_a = {}; }, "contacts[1].body_a", "null"},
        {[](Contact& c, Fixture& f) { c.body_b = f.removed; }, "contacts[1].body_b", "not alive"},
        {[](Contact& c, Fixture&) { c.body_b = c.body_a; }, "contacts[1].body_b", "same"},
        {[](Contact& c, Fixture& f) {
             c.body_a = f.kinematic;
             c.body_b = f.stationary;
         },
         "contacts[1].body_b", "cannot move"},
        {[](Contact& c, Fixture&) {
             c.normal = {0, 0, 0};
         },
         "contacts[1].normal", "0"},
        {[](Contact& c, Fixture&) {
             c.normal = {2, 0, 0};
         },
         "contacts[1].normal", "2"},
        {[](Contact& c, Fixture&) { c.normal.x = nan; }, "contacts[1].normal", "nan"},
        {[](Contact& c, Fixture&) { c.separation = nan; }, "contacts[1].separation", "nan"},
        {[](Contact& c, Fixture&) { c.arm_a.y = infinity; }, "contacts[1].arm_a.y", "inf"},
        {[](Contact& c, Fixture&) { c.arm_b.z = nan; }, "contacts[1].arm_b.z", "nan"},
        {[](Contact& c, Fixture&) { c.friction = -0.1F; }, "contacts[1].friction", "-0.1"},
        {[](Contact& c, Fixture&) { c.friction = infinity; }, "contacts[1].friction", "inf"},
        {[](Contact& c, Fixture&) { c.restitution = 1.5F; }, "contacts[1].restitution", "1.5"},
        {[](Contact& c, Fixture&) { c.restitution = nan; }, "contacts[1].restitution", "nan"},
        {[](Contact& c, Fixture&) { c.key = 1; }, "key", "twice"},
        {[](Contact& c, Fixture& f) {
             c.body_a = f.planar;
             c.body_b = f.stationary;
             c.normal = {0.6F, 0, 0.8F};
         },
         "contacts[1].normal.z", "0.8"},
    };
    for (const ContactCase& c : cases) {
        Fixture f;
        Contact good;
        good.body_a = f.rigid;
        good.body_b = f.particle;
        good.key = 1;
        good.normal = {1, 0, 0};
        Contact bad = good;
        bad.key = 2;
        c.spoil(bad, f);
        const Contact contacts[2] = {good, bad};
        SolverSettings settings;
        settings.gravity = {0, -10, 0};
        Solver solver(settings);
        const std::uint64_t hash = f.scene.state_hash();
        const StepReport report = solver.step(f.scene, 0.01F, contacts);
        EXPECT_EQ(report.status, StepStatus::refused) << c.field;
        EXPECT_NE(report.error.find(c.field), std::string::npos) << report.error;
        EXPECT_NE(report.error.find(c.value), std::string::npos) << report.error;
        EXPECT_EQ(f.scene.state_hash(), hash) << c.field;
        // The same solver continues as if the bad list had not been given.
        EXPECT_EQ(solver.step(f.scene, 0.01F, {contacts, 1}).status, StepStatus::done) << c.field;
    }
    Fixture f;
    Solver solver;
    for (const float dt : {-0.1F, 2.0F, nan, infinity}) {
        const StepReport report = solver.step(f.scene, dt);
        EXPECT_EQ(report.status, StepStatus::refused);
        EXPECT_NE(report.error.find("step.dt"), std::string::npos);
    }
}

}  // namespace
}  // namespace motley
