// Joints that lock axes of a frame on b to those of a frame on a: one row for each axis, all rows of a joint solved at
// once.
//
//   point          C = d,  d = p_b - p_a        rows [-1, [r_a]x, 1, -[r_b]x]
//   plane, line    C = e . d, e = x; y and z of a            [-e, -(r_a + d) x e, e, r_b x e]
//   all            C = 2 vec(q_a* q_b), w >= 0               [0, -G, 0, G], G = (w - [v]x) F_a^T
//   swing          C = (y_a . x_b, z_a . x_b)                [0, -g, 0, g], g = x_b x y_a, x_b x z_a
//   perpendicular  C = x_a . y_b                             [0, -g, 0, g], g = y_b x x_a
//
// p, r: anchors and their arms; x, y, z: axes of the frames of a and b; q_a, q_b: rotations of the frames;
// (v, w) = q_a* q_b; F_a: the matrix of q_a. The lever of a ends at b's anchor (r_a + d, not r_a), because e turns with
// a. Swing has a second, false solution half a turn away, x_a . x_b < 0, which no small motion reaches.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/carried_arms.h"
#include "maths/lane_softness.h"
#include "maths/small_system.h"
#include "motley/core/constraints/frame_joint_definition.h"
#include "motley/core/invalid_input.h"
#include "stores/if_needed.h"

namespace motley {

constexpr int rows_of(LinearLock lock)
{
    return static_cast<int>(lock);
}
constexpr int rows_of(AngularLock lock)
{
    return static_cast<int>(lock);
}

template <LinearLock linear_lock, AngularLock angular_lock>
struct FrameJoint : ConstraintTraits {
    using Definition = FrameJointDefinition<linear_lock, angular_lock>;
    static constexpr bool needs_bodies_that_turn = true;
    static constexpr int linear_rows = rows_of(linear_lock);
    static constexpr int angular_rows = rows_of(angular_lock);
    static constexpr int rows = linear_rows + angular_rows;
    static constexpr bool pulls_at_arms = linear_rows > 0;
    static constexpr bool has_torque = angular_rows > 0;
    static constexpr int equality_count = rows;
    static constexpr bool locks_point = linear_lock == LinearLock::point;

    template <class Real>
    struct Parameters {
        Vec3<Real> position_a;
        Real hertz;
        Quat<Real> rotation_a;
        Vec3<Real> position_b;
        Real damping_ratio;
        Quat<Real> rotation_b;
    };
    template <class Real>
    struct Memory {
        Real lambda[rows];  ///< N s of the linear rows, N m s of the angular ones
    };
    static constexpr bool has_arms = linear_rows > 0;
    static constexpr bool has_axes = linear_lock == LinearLock::plane || linear_lock == LinearLock::line;
    static constexpr bool has_turns = angular_rows > 0;

    template <class Real>
    struct Anchors {
        Vec3<Real> arm_a, arm_b, separation;
    };
    template <class Real>
    struct Arms {
        Vec3<Real> a, b;  ///< both to one point: b's anchor, or the middle of the anchors for a point lock
    };
    template <class Real, int count>
    struct Axes {
        Vec3<Real> axis[count];
    };
    /// What a sweep reads of a row.
    template <class Real>
    struct InSweep : LaneSoftness<Real> {
        [[no_unique_address]] IfNeeded<locks_point, ArmWeights<Real>> weights;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        // When the step began, in the world.
        [[no_unique_address]] IfNeeded<has_arms, Anchors<Real>> start;
        [[no_unique_address]] IfNeeded<has_axes || has_turns, Quat<Real>, 1> start_frame_a;
        [[no_unique_address]] IfNeeded<has_turns, Quat<Real>, 2> start_frame_b;
        InSweep<Real> in_sweep;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        [[no_unique_address]] IfNeeded<has_arms, Arms<Real>> arm;
        [[no_unique_address]] IfNeeded<has_axes, Axes<Real, has_axes ? linear_rows : 1>, 1> linear;  ///< e
        [[no_unique_address]] IfNeeded<has_turns, Axes<Real, has_turns ? angular_rows : 1>, 2>
            angular;                      ///< g
        SmallFactor<Real, rows> factors;  ///< of K
        Real error[rows];                 ///< C
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real lambda[rows];
    };

    static void validate(const Definition& joint, const JointBodies& bodies)
    {
        check_joint_frame("frame_a", joint.frame_a, bodies.model_a, bodies.fixed_a);
        check_joint_frame("frame_b", joint.frame_b, bodies.model_b, bodies.fixed_b);
        check_range("stiffness.hertz", joint.stiffness.hertz, 0, 1e6F, "0 (the solver's) or up to 1e6 (Hz)");
        check_range("stiffness.damping_ratio", joint.stiffness.damping_ratio, 0, 1e6F, "0 to 1e6");
    }
    static Parameters<float> parameters(const Definition& joint)
    {
        return {joint.frame_a.position, joint.stiffness.hertz,         unit(joint.frame_a.rotation),
                joint.frame_b.position, joint.stiffness.damping_ratio, unit(joint.frame_b.rotation)};
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& joint, const Memory<Real>& memory,
                        const A& a, const B& b, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        Row<Real, A::kind, B::kind> row;
        if constexpr (has_arms) {
            row.start.arm_a = to_world(pose.orientation_a, joint.position_a);
            row.start.arm_b = to_world(pose.orientation_b, joint.position_b);
            row.start.separation = pose.between + row.start.arm_b - row.start.arm_a;
        }
        if constexpr (has_axes || has_turns)
            row.start_frame_a = to_world(pose.orientation_a, joint.rotation_a);
        if constexpr (has_turns) row.start_frame_b = to_world(pose.orientation_b, joint.rotation_b);
        row.in_sweep = {softness_or(step, joint.hertz, joint.damping_ratio, step.joint), {}};
        if constexpr (locks_point) row.in_sweep.weights = arm_weights(a, b);
        for (int i = 0; i < rows; ++i) impulse.lambda[i] = Real(step.warm_start_scale) * memory.lambda[i];
        return row;
    }

    template <class Real, class Row, class Impulse>
    static Tension<Real> tension(const Row& row, const Impulse& impulse)
    {
        Vec3<Real> arm_a = row.start.arm_a, arm_b = row.start.arm_b, push{Real(0), Real(0), Real(0)};
        if constexpr (has_axes) {
            Vec3<Real> e[3];
            Real error[rows];
            linear_rows_of(row.start_frame_a, row.start.separation, e, error);
            for (int i = 0; i < linear_rows; ++i) push = push + impulse.lambda[i] * e[i];
            arm_a = arm_a + row.start.separation;
        } else {
            push = {impulse.lambda[0], impulse.lambda[1], impulse.lambda[2]};
            meet_half_way(arm_a, arm_b, row.start.separation);
        }
        return {arm_a, arm_b, -push, push};
    }

    template <class Real, class Row, class Impulse>
    static Real torque(const Row&, const Impulse& impulse)
    {
        Real sum(0);
        for (int i = linear_rows; i < rows; ++i) sum = sum + absolute(impulse.lambda[i]);
        return Real(0.5F) * sum;  // the rows turn half as far as each body
    }

    template <class Impulse, class Real>
    static void scale(Impulse& impulse, const Real& share)
    {
        for (int i = 0; i < rows; ++i) impulse.lambda[i] = share * impulse.lambda[i];
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        build(row, substep, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        push(
            substep, substep.arm, impulse.lambda, a, b,
            [](auto& body, const auto& linear, const auto& angular) { apply_wrench(body, linear, angular); });
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& in_sweep, const Substep& substep,
                      Impulse& impulse, A& a, B& b)
    {
        const LaneSoftness<Real> soft = softness_in(step, in_sweep);
        auto arm = substep.arm;
        if constexpr (locks_point) {
            if (step.moved_for > 0) carry_arms(step, in_sweep.weights, arm.a, arm.b, a, b);
        }
        Real change[rows];
        speeds(substep, arm, a, b, change);
        for (int i = 0; i < rows; ++i) change[i] = -(change[i] + soft.rate * substep.error[i]);
        solve_in_place(substep.factors, change);
        for (int i = 0; i < rows; ++i) {
            const Real held = impulse.lambda[i];
            impulse.lambda[i] = held + (soft.mass_scale * change[i] - soft.impulse_scale * held);
            change[i] = impulse.lambda[i] - held;  // as rounded: bodies get exactly what lambda gains
        }
        push(substep, arm, change, a, b, [](auto& body, const auto& linear, const auto& angular) {
            apply_wrench(body, linear, angular);
        });
    }

    /// A joint with a stiffness of its own is a spring, not a lock.
    static bool is_equality(const Definition& joint) { return joint.stiffness.hertz == 0; }
    static bool locks_place(const Definition& joint) { return linear_rows > 0 && is_equality(joint); }
    template <class Real, class Row, class A, class B>
    static void equality_rows(const Row& row, const A& a, const B& b, EqualityRow<Real>* out)
    {
        SubstepRow<Real, A::kind, B::kind> here;
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        Vec3<Real> e[3], lever_a[rows], lever_b[rows];
        locate(row, here, a, b, e, lever_a, lever_b);
        for (int i = 0; i < rows; ++i)
            out[i] = {i < linear_rows ? e[i < 3 ? i : 0] : none, lever_a[i], lever_b[i], here.error[i]};
    }

    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build(row, now, a, b);
        // Springs are forces, not positions.
        const auto own = row.in_sweep.is_own > Real(0);
        Real change[rows];
        for (int i = 0; i < rows; ++i) change[i] = select(own, Real(0), -now.error[i]);
        solve_in_place(now.factors, change);
        push(now, now.arm, change, a, b,
             [](auto& body, const auto& linear, const auto& angular) { displace(body, linear, angular); });
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        Memory<Real> memory;
        for (int i = 0; i < rows; ++i) memory.lambda[i] = impulse.lambda[i];
        return memory;
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep& substep, const Impulse& impulse)
    {
        return wrench_of(substep, impulse.lambda);
    }

    /// Errors: norms of the linear and the angular part of C, from the present poses, in double.
    static JointReport report(const Definition& joint, const Memory<float>&, const BodyState& a,
                              const BodyState& b)
    {
        const Quat<double> frame_a = a.orientation * unit(convert<double>(joint.frame_a.rotation));
        const Quat<double> frame_b = b.orientation * unit(convert<double>(joint.frame_b.rotation));
        const Vec3<double> d = anchor_separation(a, b, joint.frame_a.position, joint.frame_b.position);
        Vec3<double> linear[3], angular[3];
        double error[6] = {};
        linear_rows_of(frame_a, d, linear, error);
        angular_rows_of(frame_a, frame_b, angular, error + linear_rows);
        double linear_error = 0, angular_error = 0;
        for (int i = 0; i < rows; ++i)
            (i < linear_rows ? linear_error : angular_error) += error[i] * error[i];
        return {.error = static_cast<float>(std::sqrt(linear_error)),
                .angle_error = static_cast<float>(std::sqrt(angular_error)),
                .state = JointState::active};
    }

  private:
    template <class Real>
    static void linear_rows_of(const Quat<Real>& frame_a, const Vec3<Real>& d, Vec3<Real>* e, Real* error)
    {
        if constexpr (linear_lock == LinearLock::point) {
            e[0] = {Real(1), Real(0), Real(0)};
            e[1] = {Real(0), Real(1), Real(0)};
            e[2] = {Real(0), Real(0), Real(1)};
        } else if constexpr (linear_lock == LinearLock::line) {
            e[0] = axis_y(frame_a);
            e[1] = axis_z(frame_a);
        } else if constexpr (linear_lock == LinearLock::plane) {
            e[0] = axis_x(frame_a);
        }
        for (int i = 0; i < linear_rows; ++i) error[i] = dot(e[i], d);
    }
    template <class Real>
    static void angular_rows_of(const Quat<Real>& frame_a, const Quat<Real>& frame_b, Vec3<Real>* g,
                                Real* error)
    {
        if constexpr (angular_lock == AngularLock::all) {
            const RotationRows<Real> lock = rotation_rows(frame_a, frame_b, error);
            for (int i = 0; i < 3; ++i) g[i] = lock.axis[i];
        } else if constexpr (angular_lock == AngularLock::swing) {
            const Vec3<Real> x_b = axis_x(frame_b), y_a = axis_y(frame_a), z_a = axis_z(frame_a);
            g[0] = cross(x_b, y_a);
            g[1] = cross(x_b, z_a);
            error[0] = dot(y_a, x_b);
            error[1] = dot(z_a, x_b);
        } else if constexpr (angular_lock == AngularLock::perpendicular) {
            const Vec3<Real> x_a = axis_x(frame_a), y_b = axis_y(frame_b);
            g[0] = cross(y_b, x_a);
            error[0] = dot(x_a, y_b);
        }
    }

    /// J, row by row, and C where the bodies are now.
    template <class Real, class Row, class Substep, class A, class B>
    static void locate(const Row& row, Substep& substep, const A& a, const B& b, Vec3<Real> (&e)[3],
                       Vec3<Real> (&lever_a)[rows], Vec3<Real> (&lever_b)[rows])
    {
        Quat<Real> frame_a{};
        if constexpr (has_axes || has_turns) frame_a = turn_of(a) * row.start_frame_a;
        if constexpr (has_arms) {
            substep.arm.a = rotate(turn_of(a), row.start.arm_a);
            substep.arm.b = rotate(turn_of(b), row.start.arm_b);
            const Vec3<Real> d = anchor_error(row.start.separation, row.start.arm_a, row.start.arm_b,
                                              substep.arm.a, substep.arm.b, a, b);
            // Both impulses act at one point: the middle between the anchors, or b's anchor on a's line or plane.
            if constexpr (linear_lock == LinearLock::point) {
                meet_half_way(substep.arm.a, substep.arm.b, d);
            } else {
                substep.arm.a = substep.arm.a + d;
            }
            linear_rows_of(frame_a, d, e, substep.error);
            for (int i = 0; i < linear_rows; ++i) {
                if constexpr (has_axes) substep.linear.axis[i] = e[i];
                lever_a[i] = cross(substep.arm.a, e[i]);
                lever_b[i] = cross(substep.arm.b, e[i]);
            }
        }
        if constexpr (has_turns) {
            angular_rows_of(frame_a, turn_of(b) * row.start_frame_b, substep.angular.axis,
                            substep.error + linear_rows);
            for (int i = linear_rows; i < rows; ++i)
                lever_a[i] = lever_b[i] = substep.angular.axis[i - linear_rows];
        }
    }

    /// J, its C and the factors of J M^-1 J^T where the bodies are now.
    template <class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        using Real = std::remove_cvref_t<decltype(row.in_sweep.rate)>;
        Vec3<Real> e[3], lever_a[rows], lever_b[rows];
        locate(row, substep, a, b, e, lever_a, lever_b);
        Real k[rows][rows];
        for (int i = 0; i < rows; ++i) {
            const Vec3<Real> turn_a = over_inertia(a, lever_a[i]), turn_b = over_inertia(b, lever_b[i]);
            for (int j = 0; j <= i; ++j) {
                k[i][j] = dot(turn_a, lever_a[j]) + dot(turn_b, lever_b[j]);
                if (i < linear_rows) k[i][j] = k[i][j] + dot(over_mass(a, e[i]) + over_mass(b, e[i]), e[j]);
            }
        }
        const Real linear_floor = Real(rounding_share) * (linear_size(a) + linear_size(b));
        const Real angular_floor = Real(rounding_share) * (angular_size(a) + angular_size(b));
        Real floor[rows];
        for (int i = 0; i < rows; ++i) floor[i] = i < linear_rows ? linear_floor : angular_floor;
        substep.factors = factor(k, floor);
    }

    /// J v, with these arms.
    template <class Real, class Substep, class Arm, class A, class B>
    static void speeds(const Substep& substep, const Arm& arm, const A& a, const B& b, Real (&speed)[rows])
    {
        if constexpr (has_arms) {
            const Vec3<Real> v =
                (linear_of(b) + cross(angular_of(b), arm.b)) - (linear_of(a) + cross(angular_of(a), arm.a));
            if constexpr (has_axes) {
                for (int i = 0; i < linear_rows; ++i) speed[i] = dot(substep.linear.axis[i], v);
            } else {
                speed[0] = v.x;
                speed[1] = v.y;
                speed[2] = v.z;
            }
        }
        if constexpr (has_turns) {
            const Vec3<Real> turn = angular_of(b) - angular_of(a);
            for (int i = linear_rows; i < rows; ++i)
                speed[i] = dot(substep.angular.axis[i - linear_rows], turn);
        }
    }

    /// The wrench of lambda at the point where the rows act.
    template <class Real, class Substep>
    static Wrench<Real> wrench_of(const Substep& substep, const Real (&lambda)[rows])
    {
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        Wrench<Real> wrench{none, none};
        if constexpr (has_turns) {
            for (int i = linear_rows; i < rows; ++i)
                wrench.turn = wrench.turn + lambda[i] * substep.angular.axis[i - linear_rows];
        }
        if constexpr (has_axes) {
            for (int i = 0; i < linear_rows; ++i)
                wrench.push = wrench.push + lambda[i] * substep.linear.axis[i];
        } else if constexpr (has_arms) {
            wrench.push = {lambda[0], lambda[1], lambda[2]};
        }
        return wrench;
    }
    /// Applies J^T lambda to both bodies, with these arms, by `apply(body, linear, angular)`.
    template <class Real, class Substep, class Arm, class A, class B, class Apply>
    static void push(const Substep& substep, const Arm& arm, const Real (&lambda)[rows], A& a, B& b,
                     const Apply& apply)
    {
        const Wrench<Real> wrench = wrench_of(substep, lambda);
        Vec3<Real> angular_a = wrench.turn, angular_b = wrench.turn;
        if constexpr (has_arms) {
            angular_a = angular_a + cross(arm.a, wrench.push);
            angular_b = angular_b + cross(arm.b, wrench.push);
        }
        apply(a, -wrench.push, -angular_a);
        apply(b, wrench.push, angular_b);
    }
};

template <class Definition>
struct FrameJointOf;
template <LinearLock linear, AngularLock angular>
struct FrameJointOf<FrameJointDefinition<linear, angular>> {
    using type = FrameJoint<linear, angular>;
};
/// The constraint types of this header.
using FrameJointTypes =
    TypeList<FrameJointOf<FixedDefinition>::type, FrameJointOf<HingeDefinition>::type,
             FrameJointOf<SliderDefinition>::type, FrameJointOf<PointOnPlaneDefinition>::type,
             FrameJointOf<PointOnLineDefinition>::type, FrameJointOf<RotationLockDefinition>::type,
             FrameJointOf<ParallelAxesDefinition>::type, FrameJointOf<PerpendicularAxesDefinition>::type>;

}  // namespace motley
