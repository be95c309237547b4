// Every joint type between every pair of kinds of bodies that turn, pair by pair in a row, tumbling under gravity.
#pragma once

#include "mixed_scene.h"

namespace motley::testing {

/// Types of joint between frames; the number chooses the type.
inline constexpr int frame_joint_types = 13;

inline ConstraintId add_frame_joint(Scene& scene, int type, BodyId a, BodyId b, const JointFrame& frame_a,
                                    const JointFrame& frame_b)
{
    const auto locks = [&]<class Definition>(Definition joint, JointStiffness stiffness = {}) {
        joint = {a, b, frame_a, frame_b, stiffness};
        return scene.add_joint(joint);
    };
    const auto drive = [&]<DriveAxis axis>(DriveDefinition<axis> joint) {
        joint.body_a = a;
        joint.body_b = b;
        joint.frame_a = frame_a;
        joint.frame_b = frame_b;
        return scene.add_joint(joint);
    };
    switch (type) {
        case 0:
            return locks(FixedDefinition{});
        case 1:
            return locks(HingeDefinition{});
        case 2:
            return locks(SliderDefinition{});
        case 3:
            return locks(PointOnPlaneDefinition{});
        case 4:
            return locks(PointOnLineDefinition{});
        case 5:
            return locks(RotationLockDefinition{});
        case 6:
            return locks(ParallelAxesDefinition{});
        case 7:
            return locks(PerpendicularAxesDefinition{});
        case 8:
            return locks(FixedDefinition{}, {3, 0.2F});
        case 9:
            return drive(SlideDriveDefinition{.lower = -0.2F, .upper = 0.3F});
        case 10:
            return drive(TwistDriveDefinition{.lower = -0.4F, .motor_speed = 3, .motor_max_force = 0.2F});
        case 11:
            return drive(TwistDriveDefinition{.spring_hertz = 2, .spring_damping_ratio = 0.1F});
        default:
            return scene.add_joint(SwingLimitDefinition{a, b, frame_a, frame_b, 0.3F});
    }
}

class JointScene {
  public:
    Scene scene;

    JointScene()
    {
        Random random(77);
        const auto r = [&] { return static_cast<float>(random.symmetric()); };
        int place = 0;
        for (int type = 0; type < frame_joint_types; ++type) {
            for (int kind_a = 1; kind_a < 5; ++kind_a) {
                for (int kind_b = 1; kind_b < 5; ++kind_b) {
                    if (kind_a > 2 && kind_b > 2) continue;
                    const double x = 3.0 * place++;
                    // A planar body cannot follow a partner that tumbles: with one, all turn about z.
                    const bool flat = kind_a == 1 || kind_b == 1;
                    const BodyId a = add(kind_a, {x, 0, 0}, flat, random);
                    const BodyId b = add(kind_b, {x + 0.8, 0.1, 0}, flat, random);
                    // Both frames where b is half way, turned alike: satisfied at the start.
                    JointFrame frame{{0.4F, 0.05F, 0}, {0.3F * r(), 0.3F * r(), r(), 1}};
                    if (flat) frame.rotation.x = frame.rotation.y = 0;
                    JointFrame other = frame;
                    other.position = {-0.4F, -0.05F, 0};
                    add_frame_joint(scene, type, a, b, frame, other);
                    // Drives and limits stand beside the joint that leaves them their axis.
                    if (type == 9) add_frame_joint(scene, 2, a, b, frame, other);
                    if (type == 10 || type == 11) add_frame_joint(scene, 1, a, b, frame, other);
                    if (type == 12)
                        scene.add_joint(BallSocketDefinition{a, b, frame.position, other.position});
                }
            }
        }
    }

  private:
    BodyId add(int kind, Vec3<double> at, bool in_plane, Random& random)
    {
        const auto r = [&] { return static_cast<float>(random.symmetric()); };
        BodyDefinition body;
        body.model = kind < 3 ? static_cast<BodyModel>(kind) : BodyModel::rigid;
        if (kind == 3) body.motion = BodyMotion::static_body;
        if (kind == 4) body.motion = BodyMotion::kinematic_body;
        body.position = at;
        body.mass = 2 + r();
        body.inertia = {0.2F, 0.02F, 0, 0.3F, 0, 0.25F};
        if (kind != 3) body.linear_velocity = {r(), r(), in_plane ? 0 : r()};
        if (kind != 3) body.angular_velocity = {in_plane ? 0 : r(), in_plane ? 0 : r(), r()};
        return scene.add_body(body);
    }
};

}  // namespace motley::testing
