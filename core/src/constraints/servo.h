// Servos: a bounded, soft pull of a point to a point, or rotation of a frame into a frame, in all directions at once.
//
//   point    C = p_b - p_a            J = [-I, [r_a]x, I, -[r_b]x]
//   angular  C = 2 vec(q_a* q_b)      J = [0, -G, 0, G], G = (w I - [v]x) F_a^T, w >= 0
//
//   lambda -= mass_scale K^-1 (J v - speed + rate C) + impulse_scale lambda, |lambda| <= h max
//
// p: anchors; r: their arms; q_a, q_b: rotations of the frames; (v, w) = q_a* q_b; F_a: the matrix of q_a; speed: the
// target velocity; rate, mass_scale and impulse_scale: see Softness. Without a frequency a servo is a motor: rate 0,
// mass_scale 1, impulse_scale 0. A servo is a force, not a position: relaxation keeps its softness, and projection
// skips it. The bound is on the norm of force or torque, the same in every direction; at the bound it points against
// the error that remains (bounded_impulse.h).
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/bounded_impulse.h"
#include "maths/lane_softness.h"
#include "maths/small_system.h"
#include "motley/core/constraints/servo_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

/// What a sweep reads of a servo's row.
template <class Real>
struct ServoInSweep {
    Real max_impulse;
    LaneSoftness<Real> soft;
};

/// Checks what the definitions of both servos have in common.
template <class Definition>
void validate_servo(const Definition& servo, float most, const char* bound)
{
    check_range("hertz", servo.hertz, 0, 1e6F, "0 (velocity alone) or up to 1e6 (Hz)");
    check_range("damping_ratio", servo.damping_ratio, 0, 1e6F, "0 to 1e6");
    const float components[3] = {servo.target_velocity.x, servo.target_velocity.y, servo.target_velocity.z};
    const char* names[3] = {"target_velocity.x", "target_velocity.y", "target_velocity.z"};
    for (int i = 0; i < 3; ++i)
        check_range(names[i], components[i], -1e9F, 1e9F, "a finite value from -1e9 to 1e9");
    check_bound(bound, most);
}

struct PointServo : ConstraintTraits {
    using Definition = PointServoDefinition;
    static constexpr bool only_pulls = true;

    template <class Real>
    struct Parameters {
        Vec3<Real> anchor_a;
        Real hertz;
        Vec3<Real> anchor_b;
        Real damping_ratio;
        Vec3<Real> target_velocity;
        Real max_force;
    };
    template <class Real>
    struct Memory {
        Vec3<Real> push;  ///< N s on b
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        PairVector<Real, a, b> start_arm_a, start_arm_b, start_error, target_velocity;
        ServoInSweep<Real> in_sweep;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        PairVector<Real, a, b> arm_a, arm_b;
        PairSymmetric<Real, a, b> effective_mass;  ///< K^-1
        PairSymmetric<Real, a, b> stride;  ///< K / k_max: turns a step of K^-1 w into one of w / k_max
        PairVector<Real, a, b> bias;       ///< rate C - speed, m/s
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        PairVector<Real, a, b> push;
    };

    static void validate(const Definition& servo, const JointBodies& bodies)
    {
        check_anchor("PointServoDefinition.local_anchor_a", servo.local_anchor_a, bodies.model_a,
                     bodies.fixed_a);
        check_anchor("PointServoDefinition.local_anchor_b", servo.local_anchor_b, bodies.model_b,
                     bodies.fixed_b);
        validate_servo(servo, servo.max_force, "max_force");
    }
    static Parameters<float> parameters(const Definition& servo)
    {
        return {servo.local_anchor_a, servo.hertz,           servo.local_anchor_b,
                servo.damping_ratio,  servo.target_velocity, std::fmin(servo.max_force, largest_force)};
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& servo, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        using Vector = PairVector<Real, A::kind, B::kind>;
        const Vec3<Real> arm_a = to_world(pose.orientation_a, servo.anchor_a);
        const Vec3<Real> arm_b = to_world(pose.orientation_b, servo.anchor_b);
        impulse.push = Real(step.warm_start_scale) * to_space<Vector>(memory.push);
        return Row<Real, A::kind, B::kind>{
            to_space<Vector>(arm_a),
            to_space<Vector>(arm_b),
            to_space<Vector>(pose.between + arm_b - arm_a),
            to_space<Vector>(servo.target_velocity),
            {Real(step.substep) * servo.max_force,
             softness_or(step, servo.hertz, servo.damping_ratio, Softness{0, 1, 0})}};
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        substep.arm_a = turned(a, row.start_arm_a);
        substep.arm_b = turned(b, row.start_arm_b);
        const auto k = inverse_point_mass(a, substep.arm_a) + inverse_point_mass(b, substep.arm_b);
        substep.effective_mass = inverse(k);
        substep.stride = inverse_or_zero(largest_response(k)) * k;
        substep.bias =
            row.in_sweep.soft.rate * anchor_error(row.start_error, row.start_arm_a, row.start_arm_b,
                                                  substep.arm_a, substep.arm_b, a, b) -
            row.target_velocity;
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        apply_impulse(a, substep.arm_a, -impulse.push);
        apply_impulse(b, substep.arm_b, impulse.push);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants&, const Row& in_sweep, const Substep& substep, Impulse& impulse,
                      A& a, B& b)
    {
        const auto speed = velocity_at(b, substep.arm_b) - velocity_at(a, substep.arm_a) + substep.bias;
        const auto free = impulse.push - in_sweep.soft.mass_scale * (substep.effective_mass * speed) -
                          in_sweep.soft.impulse_scale * impulse.push;
        const auto cautious = impulse.push + substep.stride * (free - impulse.push);
        const auto wanted = bounded_impulse(free, cautious, in_sweep.max_impulse);
        const auto change = wanted - impulse.push;
        impulse.push = wanted;
        apply_impulse(a, substep.arm_a, -change);
        apply_impulse(b, substep.arm_b, change);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        return {to_three(impulse.push)};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep&, const Impulse& impulse)
    {
        return {to_three(impulse.push), {Real(0), Real(0), Real(0)}};
    }

    /// Errors: the distance of the anchors, from the present poses, in double.
    static JointReport report(const Definition& servo, const Memory<float>&, const BodyState& a,
                              const BodyState& b)
    {
        const Vec3<double> d = anchor_separation(a, b, servo.local_anchor_a, servo.local_anchor_b);
        return {.error = static_cast<float>(std::sqrt(dot(d, d))), .state = JointState::active};
    }
};

struct AngularServo : ConstraintTraits {
    using Definition = AngularServoDefinition;
    static constexpr bool only_pulls = true;
    static constexpr bool has_torque = true;
    static constexpr bool needs_bodies_that_turn = true;

    template <class Real>
    struct Parameters {
        Quat<Real> rotation_a, rotation_b;
        Vec3<Real> target_velocity;
        Real max_torque, hertz, damping_ratio;
    };
    template <class Real>
    struct Memory {
        Vec3<Real> turn;  ///< N m s along the rows
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        Quat<Real> start_frame_a, start_frame_b;
        Vec3<Real> target_velocity;
        ServoInSweep<Real> in_sweep;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        RotationRows<Real> rows;
        SmallFactor<Real, 3> factors;  ///< of K
        Sym3<Real> stride;             ///< I^-1 of both bodies over its k_max
        Real least_effective_mass;     ///< 1 / k_max
        Vec3<Real> half_turn;  ///< tangent of half the angle between the frames, along its axis, in frame a
        Vec3<Real> spin_bias;  ///< G^-1 bias, rad/s, world
        Real bias[3];          ///< rate C - speed
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Vec3<Real> turn;
    };

    static void validate(const Definition& servo, const JointBodies& bodies)
    {
        check_joint_frame("frame_a", servo.frame_a, bodies.model_a, bodies.fixed_a);
        check_joint_frame("frame_b", servo.frame_b, bodies.model_b, bodies.fixed_b);
        validate_servo(servo, servo.max_torque, "max_torque");
    }
    static Parameters<float> parameters(const Definition& servo)
    {
        return {unit(servo.frame_a.rotation),
                unit(servo.frame_b.rotation),
                servo.target_velocity,
                std::fmin(servo.max_torque, largest_force),
                servo.hertz,
                servo.damping_ratio};
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& servo, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        impulse.turn = Real(step.warm_start_scale) * memory.turn;
        return Row<Real, A::kind, B::kind>{
            to_world(pose.orientation_a, servo.rotation_a),
            to_world(pose.orientation_b, servo.rotation_b),
            servo.target_velocity,
            {Real(step.substep) * servo.max_torque,
             softness_or(step, servo.hertz, servo.damping_ratio, Softness{0, 1, 0})}};
    }

    template <class Real, class Row, class Impulse>
    static Real torque(const Row&, const Impulse& impulse)
    {
        return absolute(impulse.turn.x) + absolute(impulse.turn.y) + absolute(impulse.turn.z);
    }

    template <class Impulse, class Real>
    static void scale(Impulse& impulse, const Real& share)
    {
        impulse.turn = share * impulse.turn;
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        Real error[3], k[3][3];
        const Quat<Real> frame_a = turn_of(a) * row.start_frame_a, frame_b = turn_of(b) * row.start_frame_b;
        substep.rows = rotation_rows(frame_a, frame_b, error);
        for (int i = 0; i < 3; ++i) {
            const Vec3<Real>& g = substep.rows.axis[i];
            substep.bias[i] = row.in_sweep.soft.rate * error[i] - dot(g, row.target_velocity);
            const Vec3<Real> turn = over_inertia(a, g) + over_inertia(b, g);
            for (int j = 0; j <= i; ++j) k[i][j] = dot(turn, substep.rows.axis[j]);
        }
        const Real least = Real(rounding_share) * (angular_size(a) + angular_size(b));
        const Real floor[3] = {least, least, least};
        substep.factors = factor(k, floor);
        const Sym3<Real> response = angular_response(a) + angular_response(b);
        substep.least_effective_mass = inverse_or_zero(largest_response(response));
        substep.stride = substep.least_effective_mass * response;
        const Quat<Real> q = relative_rotation(frame_a, frame_b);
        // Where the frames are half a turn apart the rows are dependent and the tangent is infinite: it is bounded.
        substep.half_turn = Real(1) / maximum(q.w, Real(0.01F)) * Vec3<Real>{q.x, q.y, q.z};
        // G^-1 C is twice that tangent.
        substep.spin_bias =
            Real(2) * row.in_sweep.soft.rate * rotate(frame_a, substep.half_turn) - row.target_velocity;
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        push(substep, impulse.turn, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants&, const Row& in_sweep, const Substep& substep, Impulse& impulse,
                      A& a, B& b)
    {
        const Vec3<Real> speed = angular_of(b) - angular_of(a);
        Real change[3];
        for (int i = 0; i < 3; ++i) change[i] = dot(substep.rows.axis[i], speed) + substep.bias[i];
        solve_in_place(substep.factors, change);
        const Vec3<Real> free = impulse.turn -
                                in_sweep.soft.mass_scale * Vec3<Real>{change[0], change[1], change[2]} -
                                in_sweep.soft.impulse_scale * impulse.turn;
        // The bound is on the torque, which is shorter than lambda where the frames are far apart.
        const Vec3<Real> torque = torque_of(substep, free);
        const auto held_back = dot(torque, torque) > in_sweep.max_impulse * in_sweep.max_impulse;
        Vec3<Real> left =
            in_sweep.soft.mass_scale * substep.least_effective_mass * (speed + substep.spin_bias);
        if (stays_in_plane(a) && stays_in_plane(b)) left.x = left.y = Real(0);
        left = left + in_sweep.soft.impulse_scale * (substep.stride * torque_of(substep, impulse.turn));
        const Vec3<Real> next = select(held_back, impulse.turn - lambda_of(substep, left), free);
        const Vec3<Real> wanted = scale_within(torque_of(substep, next), in_sweep.max_impulse) * next;
        push(substep, wanted - impulse.turn, a, b);
        impulse.turn = wanted;
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        return {impulse.turn};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep& substep, const Impulse& impulse)
    {
        return {{Real(0), Real(0), Real(0)}, torque_of(substep, impulse.turn)};
    }

    /// Errors: the angle between the frames, from the present poses, in double.
    static JointReport report(const Definition& servo, const Memory<float>&, const BodyState& a,
                              const BodyState& b)
    {
        const Quat<double> frame_a = a.orientation * unit(convert<double>(servo.frame_a.rotation));
        const Quat<double> frame_b = b.orientation * unit(convert<double>(servo.frame_b.rotation));
        const Quat<double> q = relative_rotation(frame_a, frame_b);
        return {.angle_error =
                    static_cast<float>(2 * std::atan2(std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z), q.w)),
                .state = JointState::active};
    }

  private:
    template <class Real, class Substep>
    static Vec3<Real> torque_of(const Substep& substep, const Vec3<Real>& lambda)
    {
        return lambda.x * substep.rows.axis[0] + lambda.y * substep.rows.axis[1] +
               lambda.z * substep.rows.axis[2];
    }
    /// The lambda that makes a torque: G^-T times the torque. With s and c the vector and scalar part of the quaternion
    /// between the frames, G G^T = I - s s^T, so G^-T = (G G^T)^-1 G = (I + u u^T) G with u = s / c.
    template <class Real, class Substep>
    static Vec3<Real> lambda_of(const Substep& substep, const Vec3<Real>& torque)
    {
        const auto& axis = substep.rows.axis;
        const Vec3<Real> along{dot(axis[0], torque), dot(axis[1], torque), dot(axis[2], torque)};
        return along + dot(substep.half_turn, along) * substep.half_turn;
    }
    template <class Real, class Substep, class A, class B>
    static void push(const Substep& substep, const Vec3<Real>& lambda, A& a, B& b)
    {
        const Vec3<Real> turn = torque_of(substep, lambda);
        apply_turn(a, -turn);
        apply_turn(b, turn);
    }
};

/// The constraint types of this header.
using ServoTypes = TypeList<PointServo, AngularServo>;

}  // namespace motley
