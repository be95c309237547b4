// Splits a definition of six coordinates into joints.
#include "motley/core/six_dof.h"

#include <cmath>
#include <limits>
#include <string>

#include "motley/core/invalid_input.h"

namespace motley {
namespace {

constexpr float half_turn = 3.14159265F;

bool is_driven(const AxisSetup& axis)
{
    return axis.motor_max_force != 0 || axis.spring_hertz != 0 || axis.spring_stiffness != 0 ||
           axis.spring_damping != 0 || axis.armature != 0;
}
bool is_locked(const AxisSetup& axis)
{
    return axis.lower == 0 && axis.upper == 0 && !is_driven(axis);
}
bool is_free(const AxisSetup& axis)
{
    return std::isinf(axis.lower) && std::isinf(axis.upper) && !is_driven(axis);
}

/// The frame turned so that its x axis is its old axis `axis`, right-handed.
JointFrame turned_to(JointFrame frame, int axis)
{
    // By no, one and two thirds of a turn about (1, 1, 1), which take x to x, y and z.
    constexpr Quat<float> turns[3] = {{0, 0, 0, 1}, {0.5F, 0.5F, 0.5F, 0.5F}, {-0.5F, -0.5F, -0.5F, 0.5F}};
    frame.rotation = frame.rotation * turns[axis];
    return frame;
}

/// The frame turned about its x axis by a quarter turn, so that its y axis is its old z axis.
JointFrame turned_about_x(JointFrame frame)
{
    frame.rotation = frame.rotation * Quat<float>{0.70710678F, 0, 0, 0.70710678F};
    return frame;
}

/// How many of three coordinates are locked, and which one differs from the other two.
struct Locks {
    int count = 0, odd = 0;
    explicit Locks(const AxisSetup (&axes)[3])
    {
        for (const AxisSetup& axis : axes) count += is_locked(axis) ? 1 : 0;
        for (int i = 0; i < 3; ++i) {
            if (is_locked(axes[i]) == (count == 1)) odd = i;
        }
    }
};

/// Adds the joints one by one, and removes them again when one is refused.
class Assembler {
  public:
    Assembler(Scene& scene, const SixDofDefinition& joint)
        : scene_(scene), joint_(joint), linear_(joint.position), angular_(joint.rotation)
    {
    }

    std::vector<ConstraintId> assemble()
    {
        check_rotations();
        check_swing();
        try {
            lock();
            for (int axis = 0; axis < 3; ++axis) {
                if (!is_locked(joint_.position[axis])) drive<DriveAxis::slide>(joint_.position[axis], axis);
                if (!is_locked(joint_.rotation[axis])) drive_rotation(axis);
            }
            if (joint_.max_swing < half_turn) {
                ids_.push_back(scene_.add_joint(SwingLimitDefinition{
                    joint_.body_a, joint_.body_b, joint_.frame_a, joint_.frame_b, joint_.max_swing}));
            }
            if (ids_.empty())
                refuse("SixDofDefinition", "free in every coordinate", "something to hold or to drive");
        } catch (...) {
            for (const ConstraintId id : ids_) scene_.remove_joint(id);
            throw;
        }
        return ids_;
    }

  private:
    Scene& scene_;
    const SixDofDefinition& joint_;
    Locks linear_, angular_;
    std::vector<ConstraintId> ids_;

    void check_rotations() const
    {
        if (joint_.rotations != SixDofRotation::about_axes && joint_.rotations != SixDofRotation::euler)
            refuse("SixDofDefinition.rotations", static_cast<double>(joint_.rotations),
                   "about_axes or euler");
    }
    void check_swing() const
    {
        if (!(joint_.max_swing > 0 && joint_.max_swing <= half_turn * 1.0001F))
            refuse("SixDofDefinition.max_swing", joint_.max_swing, "> 0 to pi (rad)");
        if (joint_.max_swing < half_turn && is_locked(joint_.rotation[1]) && is_locked(joint_.rotation[2])) {
            refuse("SixDofDefinition.max_swing", joint_.max_swing,
                   "pi where the rotations about y and z are locked: there is no swing to limit");
        }
    }

    template <LinearLock linear, AngularLock angular>
    void add_locks(const JointFrame& frame_a, const JointFrame& frame_b)
    {
        ids_.push_back(scene_.add_joint(FrameJointDefinition<linear, angular>{
            joint_.body_a, joint_.body_b, frame_a, frame_b, joint_.stiffness}));
    }
    /// `axis`, the coordinate that differs from the other two, becomes x of both frames.
    template <LinearLock linear, AngularLock angular>
    void add_locks(int axis)
    {
        add_locks<linear, angular>(turned_to(joint_.frame_a, axis), turned_to(joint_.frame_b, axis));
    }

    /// Locks positions and rotations by one joint if a type of joint has the rows of both, else by one for each.
    void lock()
    {
        const bool all = angular_.count == 3, hinge = angular_.count == 2;
        if (linear_.count == 3 && all) return add_locks<LinearLock::point, AngularLock::all>(0);
        if (linear_.count == 3 && hinge)
            return add_locks<LinearLock::point, AngularLock::swing>(angular_.odd);
        if (linear_.count == 2 && all) return add_locks<LinearLock::line, AngularLock::all>(linear_.odd);
        if (linear_.count == 3) {
            ids_.push_back(scene_.add_joint(BallSocketDefinition{
                joint_.body_a, joint_.body_b, joint_.frame_a.position, joint_.frame_b.position}));
        }
        if (linear_.count == 2) add_locks<LinearLock::line, AngularLock::none>(linear_.odd);
        if (linear_.count == 1) add_locks<LinearLock::plane, AngularLock::none>(linear_.odd);
        if (all) add_locks<LinearLock::none, AngularLock::all>(0);
        if (hinge) add_locks<LinearLock::none, AngularLock::swing>(angular_.odd);
        if (angular_.count != 1) return;
        if (joint_.rotations == SixDofRotation::euler) return drive_rotation(angular_.odd);
        // Rotation about z is locked by keeping y of b perpendicular to x of a, about y by keeping z of b perpendicular
        // to it, and about x by a drive that holds the twist.
        if (angular_.odd == 0) drive<DriveAxis::twist>(joint_.rotation[0], 0);
        if (angular_.odd == 1) {
            add_locks<LinearLock::none, AngularLock::perpendicular>(turned_about_x(joint_.frame_a),
                                                                    turned_about_x(joint_.frame_b));
        }
        if (angular_.odd == 2) add_locks<LinearLock::none, AngularLock::perpendicular>(0);
    }

    void drive_rotation(int axis)
    {
        if (joint_.rotations == SixDofRotation::euler) {
            drive<DriveAxis::euler>(joint_.rotation[axis], axis);
        } else {
            drive<DriveAxis::twist>(joint_.rotation[axis], axis);
        }
    }

    template <DriveAxis kind>
    void drive(const AxisSetup& axis, int which)
    {
        if (is_free(axis)) return;
        DriveDefinition<kind> drive;
        drive.body_a = joint_.body_a;
        drive.body_b = joint_.body_b;
        if constexpr (kind == DriveAxis::euler) {
            drive.frame_a = joint_.frame_a;
            drive.frame_b = joint_.frame_b;
            drive.angle = static_cast<EulerAngle>(which);
        } else {
            drive.frame_a = turned_to(joint_.frame_a, which);
            drive.frame_b = turned_to(joint_.frame_b, which);
        }
        drive.lower = axis.lower;
        drive.upper = axis.upper;
        drive.motor_speed = axis.motor_speed;
        drive.motor_max_force = axis.motor_max_force;
        drive.spring_hertz = axis.spring_hertz;
        drive.spring_damping_ratio = axis.spring_damping_ratio;
        drive.spring_stiffness = axis.spring_stiffness;
        drive.spring_damping = axis.spring_damping;
        drive.spring_target = axis.spring_target;
        drive.spring_max_force = axis.spring_max_force;
        drive.armature = axis.armature;
        ids_.push_back(scene_.add_joint(drive));
    }
};

}  // namespace

AxisSetup AxisSetup::free()
{
    const float infinity = std::numeric_limits<float>::infinity();
    return {.lower = -infinity, .upper = infinity};
}

std::vector<ConstraintId> add_six_dof(Scene& scene, const SixDofDefinition& definition)
{
    return Assembler(scene, definition).assemble();
}

}  // namespace motley
