// A definition of six coordinates, taken apart into joints.
#include "motley/core/six_dof.h"

#include <cmath>
#include <limits>
#include <string>

#include "motley/core/invalid_input.h"

namespace motley {
namespace {

constexpr float half_turn = 3.14159265F;

bool is_locked(const AxisSetup& axis)
{
    return axis.lower == 0 && axis.upper == 0 && axis.motor_max_force == 0 && axis.spring_hertz == 0;
}
bool is_free(const AxisSetup& axis)
{
    return std::isinf(axis.lower) && std::isinf(axis.upper) && axis.motor_max_force == 0 &&
           axis.spring_hertz == 0;
}

/// The frame turned so that its x axis is its old axis `axis`, right-handed.
JointFrame turned_to(JointFrame frame, int axis)
{
    // (1, 1, 1) by a third of a turn, or two: x -> y -> z -> x.
    constexpr Quat<float> turns[3] = {{0, 0, 0, 1}, {0.5F, 0.5F, 0.5F, 0.5F}, {-0.5F, -0.5F, -0.5F, 0.5F}};
    frame.rotation = frame.rotation * turns[axis];
    return frame;
}

enum class Rotations { all_locked, twist_loose, all_loose };

Rotations rotations_of(const SixDofDefinition& joint)
{
    if (!(joint.max_swing >= 0 && joint.max_swing <= half_turn * 1.0001F))
        refuse("SixDofDefinition.max_swing", joint.max_swing, "0 to pi (rad)");
    if (joint.max_swing > 0) return Rotations::all_loose;
    if (joint.locks_swing_about_z) {
        refuse("SixDofDefinition.locks_swing_about_z", "true while max_swing is 0",
               "false: all of the swing is locked");
    }
    return is_locked(joint.twist) ? Rotations::all_locked : Rotations::twist_loose;
}

/// Adds the joints one by one, and takes them back when one is refused.
class Assembler {
  public:
    Assembler(Scene& scene, const SixDofDefinition& joint) : scene_(scene), joint_(joint) {}

    std::vector<ConstraintId> assemble()
    {
        try {
            const Rotations rotations = rotations_of(joint_);
            lock(rotations);
            for (int axis = 0; axis < 3; ++axis) {
                if (!is_locked(joint_.position[axis])) drive<DriveAxis::slide>(joint_.position[axis], axis);
            }
            if (rotations != Rotations::all_locked) drive<DriveAxis::twist>(joint_.twist, 0);
            if (rotations == Rotations::all_loose && joint_.max_swing < half_turn) {
                ids_.push_back(scene_.add_joint(SwingLimitDefinition{
                    joint_.body_a, joint_.body_b, joint_.frame_a, joint_.frame_b, joint_.max_swing}));
            }
            if (joint_.locks_swing_about_z) add_locks<LinearLock::none, AngularLock::perpendicular>();
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
    std::vector<ConstraintId> ids_;

    /// `axis`: the one that is not like the other two becomes x of both frames.
    template <LinearLock linear, AngularLock angular>
    void add_locks(int axis = 0)
    {
        ids_.push_back(scene_.add_joint(FrameJointDefinition<linear, angular>{
            joint_.body_a, joint_.body_b, turned_to(joint_.frame_a, axis), turned_to(joint_.frame_b, axis),
            joint_.stiffness}));
    }

    void lock(Rotations rotations)
    {
        int locked = 0, odd = 0;
        for (int axis = 0; axis < 3; ++axis) locked += is_locked(joint_.position[axis]) ? 1 : 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (is_locked(joint_.position[axis]) == (locked == 1)) odd = axis;
        }
        const bool all = rotations == Rotations::all_locked, swing = rotations == Rotations::twist_loose;
        // Where one joint has the rows of both, one joint; the axes of a slider's rail and its lock are its own.
        if (locked == 3 && all) return add_locks<LinearLock::point, AngularLock::all>();
        if (locked == 3 && swing) return add_locks<LinearLock::point, AngularLock::swing>();
        if (locked == 2 && all) return add_locks<LinearLock::line, AngularLock::all>(odd);
        if (locked == 3) {
            ids_.push_back(scene_.add_joint(BallSocketDefinition{
                joint_.body_a, joint_.body_b, joint_.frame_a.position, joint_.frame_b.position}));
        }
        if (locked == 2) add_locks<LinearLock::line, AngularLock::none>(odd);
        if (locked == 1) add_locks<LinearLock::plane, AngularLock::none>(odd);
        if (all) add_locks<LinearLock::none, AngularLock::all>();
        if (swing) add_locks<LinearLock::none, AngularLock::swing>();
    }

    template <DriveAxis kind>
    void drive(const AxisSetup& axis, int which)
    {
        if (is_free(axis)) return;
        DriveDefinition<kind> drive;
        drive.body_a = joint_.body_a;
        drive.body_b = joint_.body_b;
        drive.frame_a = turned_to(joint_.frame_a, which);
        drive.frame_b = turned_to(joint_.frame_b, which);
        drive.lower = axis.lower;
        drive.upper = axis.upper;
        drive.motor_speed = axis.motor_speed;
        drive.motor_max_force = axis.motor_max_force;
        drive.spring_hertz = axis.spring_hertz;
        drive.spring_damping_ratio = axis.spring_damping_ratio;
        drive.spring_target = axis.spring_target;
        drive.spring_max_force = axis.spring_max_force;
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
