// A drive: limits, motor and spring on one coordinate C of two frames, which drive_coordinate.h has.
//
// A rotor of inertia I_r that is geared to C moves with the bodies along the row. With K = J M^-1 J^T and
// s = 1 / (1 + K I_r) an impulse along the row changes the speed by K s times the impulse, and the bodies get the share
// s of it. A change of the bodies' speed by other constraints since then is shared with the rotor first: the share s of
// it remains. A substep begins with the change of the rotor's speed in the last one, and takes I_r times it from the bodies.
//
// One row and up to three impulses along it: that of the motor, bounded by its force times the substep h; that of the
// spring, soft; and that of the limit, >= 0 at the lower end and <= 0 at the upper. They are solved one after another
// on a speed that each updates, so bodies are read and written once. Parts that a drive lacks are switched off by
// masks, so that drives with and without them share a block.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/drive_coordinate.h"
#include "maths/lane_softness.h"
#include "maths/limit.h"
#include "maths/locked_point.h"
#include "motley/core/constraints/drive_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

template <DriveAxis drive_axis>
struct Drive : ConstraintTraits {
    using Definition = DriveDefinition<drive_axis>;
    static constexpr bool needs_bodies_that_turn = true;
    using Coordinate = DriveCoordinate<drive_axis>;
    static constexpr bool slides = Coordinate::slides, is_euler = Coordinate::is_euler;
    static constexpr bool has_torque = !slides;
    static constexpr bool turns_about_points = !slides;
    static constexpr ActiveRow active_row = slides ? ActiveRow::linear : ActiveRow::angular;
    static constexpr bool has_motor = true;
    /// Few joints have Euler angles.
    static constexpr bool is_rare = is_euler;
    /// Replaces an infinite limit: too far to be reached, small enough for results to stay finite.
    static constexpr float far_away = 1e12F;
    static constexpr float half_turn = 3.14159265F;

    template <class Real>
    struct Parameters {
        typename Coordinate::template Frames<Real> frames;
        Real lower, upper;
        Real motor_speed, motor_max_force;
        Real spring_hertz, spring_damping_ratio;
        Real spring_stiffness, spring_damping;
        Real spring_target, spring_max_force;
        Real armature;
    };
    template <class Real>
    struct Memory {
        Real motor, spring, limit;  ///< N s or N m s
        /// m/s or rad/s, by which the joint is faster than its rotor: sweeps that have not converged leave them apart. A rotor
        /// that took the joint's speed when a step begins would gain energy out of nothing.
        Real rotor_lag;
        Real rotor_change;  ///< m/s or rad/s: what the last substep added to the rotor's speed
    };
    /// What a sweep reads of a row.
    template <class Real>
    struct InSweep {
        Real lower, upper;
        Real motor_speed, motor_max_impulse;
        Real spring_target, spring_max_impulse;
        Real spring_rate;
        Real armature;  ///< I_r
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        typename Coordinate::template Start<Real> start;
        SpringSoftness<Real> spring;
        InSweep<Real> in_sweep;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow : Coordinate::template Here<Real> {
        Real response, effective_mass;            ///< K s; its inverse, or more: see lengthen_step()
        Real share;                               ///< s
        Real spring_effective_mass, spring_kept;  ///< see SoftRow
        Real start_speed;                         ///< of the rotor when the substep began
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real limit, motor;  ///< all five in the order of ConstraintTraits::active_row
        Real spring;
        /// m/s or rad/s, of the rotor's speed in the substep. I_r times it is what the rotor took from the bodies.
        Real rotor_change;
        Real rotor_speed;  ///< m/s or rad/s, as the last sweep left it
    };

    static void validate(const Definition& drive, const JointBodies& bodies)
    {
        check_joint_frame("frame_a", drive.frame_a, bodies.model_a, bodies.fixed_a);
        check_joint_frame("frame_b", drive.frame_b, bodies.model_b, bodies.fixed_b);
        const float most = slides ? largest_length : half_turn;
        const char* range = slides ? "-1e9 to 1e9 (m) or infinite" : "-pi to pi (rad) or infinite";
        if (!std::isinf(drive.lower)) check_range("lower", drive.lower, -most, most, range);
        if (!std::isinf(drive.upper)) check_range("upper", drive.upper, -most, most, range);
        if (!(drive.lower <= drive.upper)) refuse("lower", drive.lower, "at most upper");
        if (is_euler && !(drive.angle >= EulerAngle::x && drive.angle <= EulerAngle::z))
            refuse("angle", static_cast<double>(drive.angle), "x, y or z");
        check_range("motor_speed", drive.motor_speed, -1e9F, 1e9F, "a finite value from -1e9 to 1e9");
        check_range("motor_max_force", drive.motor_max_force, 0, 1e12F, "a finite value from 0 to 1e12");
        check_range("spring_hertz", drive.spring_hertz, 0, 1e6F, "0 (no spring) or up to 1e6 (Hz)");
        check_range("spring_damping_ratio", drive.spring_damping_ratio, 0, 1e6F, "0 to 1e6");
        check_range("spring_stiffness", drive.spring_stiffness, 0, 1e12F,
                    slides ? "0 to 1e12 (N/m)" : "0 to 1e12 (N m/rad)");
        check_range("spring_damping", drive.spring_damping, 0, 1e12F,
                    slides ? "0 to 1e12 (N s/m)" : "0 to 1e12 (N m s/rad)");
        check_one_spring("spring_hertz", drive.spring_hertz, drive.spring_stiffness, drive.spring_damping);
        check_range("armature", drive.armature, 0, 1e10F, slides ? "0 to 1e10 (kg)" : "0 to 1e10 (kg m2)");
        check_range("spring_target", drive.spring_target, -most, most,
                    slides ? "-1e9 to 1e9 (m)" : "-pi to pi (rad)");
        check_bound("spring_max_force", drive.spring_max_force);
    }
    static bool locks_place(const Definition& drive) { return slides && drive.lower == drive.upper; }
    static Parameters<float> parameters(const Definition& drive)
    {
        return {Coordinate::frames_of(drive),
                std::fmax(drive.lower, -far_away),
                std::fmin(drive.upper, far_away),
                drive.motor_speed,
                drive.motor_max_force,
                drive.spring_hertz,
                drive.spring_damping_ratio,
                drive.spring_stiffness,
                drive.spring_damping,
                drive.spring_target,
                std::fmin(drive.spring_max_force, largest_force),
                drive.armature};
    }

    /// Of an Euler angle, whose axis depends on the pose, at most.
    static float rotor_load(const Definition& drive, const BodyStore& bodies)
    {
        if (drive.armature == 0) return 0;
        const auto response = [&](BodyId body, const JointFrame& frame) {
            const RigidMass mass = bodies.rigid_mass_of(bodies.row_of(body));
            if (slides) return mass.inverse_mass;
            if (is_euler) return trace(mass.inverse_inertia);
            const Vec3<float> axis = axis_x(unit(frame.rotation));
            return dot(axis, mass.inverse_inertia * axis);
        };
        return drive.armature *
               (response(drive.body_a, drive.frame_a) + response(drive.body_b, drive.frame_b));
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& drive, const Memory<Real>& memory,
                        const A& a, const B& b, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        Row<Real, A::kind, B::kind> row;
        row.start = Coordinate::start_of(drive.frames, start.pose());
        row.in_sweep.lower = drive.lower;
        row.in_sweep.upper = drive.upper;
        row.in_sweep.motor_speed = drive.motor_speed;
        row.in_sweep.motor_max_impulse = Real(step.substep) * drive.motor_max_force;
        row.in_sweep.spring_target = drive.spring_target;
        row.in_sweep.spring_max_impulse = Real(step.substep) * drive.spring_max_force;
        row.spring = spring_softness(step, drive.spring_hertz, drive.spring_damping_ratio,
                                     drive.spring_stiffness, drive.spring_damping);
        row.in_sweep.spring_rate = row.spring.rate;
        row.in_sweep.armature = drive.armature;
        const Real warm(step.warm_start_scale);
        impulse.motor = warm * memory.motor;
        impulse.spring = warm * memory.spring;
        impulse.limit = warm * memory.limit;
        impulse.rotor_change = warm * memory.rotor_change;
        SubstepRow<Real, A::kind, B::kind> here;
        build<Real>(row, here, a, b);
        impulse.rotor_speed = Coordinate::template speed<Real>(here, a, b) - memory.rotor_lag;
        return row;
    }

    template <class Real, class Row, class Impulse>
    static Real torque(const Row& row, const Impulse& impulse)
    {
        // What a rotor takes from a light body is handed on by the rows at the body's other end, and these are warm started
        // too: so it counts as that of three joints.
        const Real of_rotor = Real(3) * row.in_sweep.armature * absolute(impulse.rotor_change);
        return Coordinate::length_of_axis(row.start) *
               maximum(absolute(to_bodies(row.in_sweep.armature, impulse)), of_rotor);
    }

    template <class Impulse, class Real>
    static void scale(Impulse& impulse, const Real& share)
    {
        impulse.motor = share * impulse.motor;
        impulse.spring = share * impulse.spring;
        impulse.limit = share * impulse.limit;
        impulse.rotor_change = share * impulse.rotor_change;
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse& impulse, Substep& substep, const A& a,
                                const B& b)
    {
        build<Real>(row, substep, a, b);
        substep.start_speed = impulse.rotor_speed;
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row& row, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        Coordinate::template push<Real>(substep, to_bodies(row.in_sweep.armature, impulse), a, b);
    }

    /// Of the motor and the limit. Not of the spring, whose softness is that of the two bodies alone, nor of a drive with a
    /// rotor, which shares impulses with these two.
    template <class Real, class Substep, class A, class B>
    static void lengthen_step(Substep& substep, const A& a, const Vec3<Real>& arm_a, const B& b,
                              const Vec3<Real>& arm_b)
    {
        const Real& alone = substep.effective_mass;
        const Real longer = effective_mass_at_point(substep.axis, a, arm_a, b, arm_b);
        const auto has_rotor = substep.share < Real(1);
        substep.effective_mass = select(alone > Real(0), select(has_rotor, alone, longer), alone);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& in_sweep, const Substep& substep,
                      Impulse& impulse, A& a, B& b)
    {
        const Real before = impulse.motor + impulse.spring + impulse.limit;
        Real speed = Coordinate::template speed<Real>(substep, a, b);
        const Real rotor_speed = substep.start_speed + impulse.rotor_change;
        const Real excess = speed - rotor_speed;
        const Real to_rotor = in_sweep.armature * substep.share * excess;
        speed = select(in_sweep.armature > Real(0), rotor_speed + substep.share * excess, speed);

        const auto change_to = [&](Real& held, const Real& wanted) {
            speed = speed + substep.response * (wanted - held);
            held = wanted;
        };
        change_to(
            impulse.spring,
            spring_impulse(
                SoftRow<Real>{in_sweep.spring_rate, substep.spring_effective_mass, substep.spring_kept},
                substep.value - in_sweep.spring_target, speed, impulse.spring, in_sweep.spring_max_impulse));
        const Real motor = impulse.motor - substep.effective_mass * (speed - in_sweep.motor_speed);
        change_to(impulse.motor,
                  maximum(minimum(motor, in_sweep.motor_max_impulse), -in_sweep.motor_max_impulse));
        change_to(impulse.limit, range_impulse(step, substep.value, in_sweep.lower, in_sweep.upper, speed,
                                               substep.effective_mass, impulse.limit));

        impulse.rotor_change = speed - substep.start_speed;
        impulse.rotor_speed = speed;
        Coordinate::template push<Real>(
            substep, substep.share * (impulse.motor + impulse.spring + impulse.limit - before) - to_rotor, a,
            b);
    }

    /// The limit acts once it is touched, while it pushes inwards harder than the motor alone; the motor acts while it has
    /// force left and does not arrive at the limit; and else the spring does, while it has force left. One row bears all
    /// three, so the impulse is all that of one; but sweeps solve a spring beside a limit that acts, or beside a motor, and a
    /// limit beside a spring. A rotor always acts; without StepConstants::exact_limits nothing else does.
    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static ActingRow<Real> act(const StepConstants& step, const Row& row, const Substep& substep,
                               Impulse& impulse, const A& a, const B& b)
    {
        SubstepRow<Real, A::kind, B::kind> here;
        build<Real>(row, here, a, b);
        const auto& drive = row.in_sweep;
        const Real none(0), one(1), limit(ActsBy::limit), motor(ActsBy::motor), spring(ActsBy::spring);
        const Bounds<Real> at = bounds_of(drive, here.value);
        const Real both = impulse.limit + impulse.motor, most = drive.motor_max_impulse;
        // Where the motor drives outwards and is there within a substep.
        const Real left = select(at.speed < none, at.room + Real(step.substep) * at.speed, one);
        const Real touches = select(left < none, one, absolute(impulse.limit));
        const Real pushes = select(drive.lower < drive.upper, at.inwards * both - at.motor_alone, one);
        const Real of_limit = select(touches > none, select(pushes > none, limit, none), none);
        const Real of_motor = select(absolute(both) < most, select(left < none, none, motor), none);
        const SoftRow<Real> soft{drive.spring_rate, here.spring_effective_mass, here.spring_kept};
        const Real strength =
            select(most > none, none, select(soft.effective_mass > none, drive.spring_max_impulse, none));
        const Real of_spring = select(absolute(impulse.spring) < strength, spring, none);
        const Real usable = step.exact_limits ? here.effective_mass : none;
        const Real of_others =
            select(usable > none, select(of_limit > none, of_limit, maximum(of_motor, of_spring)), none);
        const Real rotor = select(here.effective_mass > none, drive.armature, none);
        const Real by = maximum(of_others, select(rotor > none, Real(ActsBy::rotor), none));

        const auto is_usable = usable > none, by_spring = by > motor, by_motor = by > limit;
        const auto acts = (of_others > none) & (spring > of_others);
        // What does not act lets go: the motor and the spring keep what they may push.
        const Real kept = select(acts, both, maximum(minimum(both, most), -most));
        const Real by_limit = select(acts, select(by_motor, none, kept), none);
        const Real of_soft =
            maximum(minimum(impulse.spring, drive.spring_max_impulse), -drive.spring_max_impulse);
        const Real taken_back = (kept - both) + (of_soft - impulse.spring);
        impulse.limit = select(is_usable, by_limit, impulse.limit);
        impulse.motor = select(is_usable, kept - by_limit, impulse.motor);
        impulse.spring = select(is_usable, of_soft, impulse.spring);
        const Real error = select(drive.lower < drive.upper, at.inwards * error_of_limit(step, at.room),
                                  here.value - drive.lower);
        const Real speed =
            select(by_spring, -(soft.rate * (here.value - drive.spring_target)), drive.motor_speed);
        const Real give = select(by_spring, soft.give(), none);
        const Real given = give * impulse.spring - soft.rate * (here.value - substep.value);
        const Real no_more =
            select(by_spring, drive.spring_max_impulse, select(by_motor, most, Real(no_bound)));
        ActingRow<Real> out{{{none, none, none}, here.axis, here.axis, error, speed},
                            by,
                            select(is_usable, taken_back, none),
                            here.effective_mass,
                            -no_more,
                            no_more,
                            give,
                            select(by_spring, given, none),
                            rotor};
        if constexpr (slides) {
            out.row.linear = here.axis;
            out.row.lever_a = here.levers.a;
            out.row.lever_b = here.levers.b;
        } else {
            // A limit pulls where it pushes less than the motor alone.
            const Real pull = at.inwards * (at.motor_alone - bearable_pull<Real>(step, a, b));
            const Real by_limit_alone = select(by_motor, none, by);
            const auto may_pull = (drive.upper > drive.lower) & (by_limit_alone > Real(ActsBy::rotor));
            out.least = select(may_pull, select(at.inwards > none, pull, out.least), out.least);
            out.most = select(may_pull, select(at.inwards > none, out.most, pull), out.most);
        }
        return out;
    }
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const Real lambda = -(now.share * now.effective_mass *
                              beyond_range(now.value, row.in_sweep.lower, row.in_sweep.upper));
        Coordinate::template move<Real>(now, lambda, a, b);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row& row, const Impulse& impulse, const End& end)
    {
        const auto a = end.a();
        const auto b = end.b();
        SubstepRow<Real, decltype(a)::kind, decltype(b)::kind> now;
        build<Real>(row, now, a, b);
        const Real lag = Coordinate::template speed<Real>(now, a, b) - impulse.rotor_speed;
        const auto has_rotor = row.in_sweep.armature > Real(0);
        return {impulse.motor, impulse.spring, impulse.limit, select(has_rotor, lag, Real(0)),
                select(has_rotor, impulse.rotor_change, Real(0))};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row& row, const Substep& substep, const Impulse& impulse)
    {
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        const Vec3<Real> effort = to_bodies(row.in_sweep.armature, impulse) * substep.axis;
        return slides ? Wrench<Real>{effort, none} : Wrench<Real>{none, effort};
    }

    /// Errors: how far C is beyond its limits, from the present poses, in double.
    static JointReport report(const Definition& drive, const Memory<float>& memory, const BodyState& a,
                              const BodyState& b)
    {
        const double value = Coordinate::value_of(drive, a, b);
        const double wrong = std::fmax(0.0, std::fmax(static_cast<double>(drive.lower) - value,
                                                      value - static_cast<double>(drive.upper)));
        JointReport report;
        (slides ? report.error : report.angle_error) = static_cast<float>(wrong);
        if (memory.limit != 0) {
            report.state = memory.limit > 0 ? JointState::lower : JointState::upper;
        } else if (drive.motor_max_force > 0 || drive.has_spring()) {
            report.state = JointState::active;
        }
        return report;
    }

  private:
    /// As seen from the inside of the range.
    template <class Real>
    struct Bounds {
        Real inwards;      ///< 1 where the lower limit is the nearer one, else -1
        Real room, speed;  ///< to the nearer limit, and of the motor, 0 without one
        Real motor_alone;  ///< impulse of the motor at its bound, below 0 where it drives outwards
    };
    template <class Real>
    static Bounds<Real> bounds_of(const InSweep<Real>& drive, const Real& value)
    {
        const Real above = value - drive.lower, below = drive.upper - value;
        const Real inwards = select(above < below, Real(1), Real(-1));
        const Real most = drive.motor_max_impulse;
        const Real speed = select(most > Real(0), inwards * drive.motor_speed, Real(0));
        return {inwards, minimum(above, below), speed, select(speed < Real(0), -most, most)};
    }
    /// What the bodies got of the impulses: the rotor took the rest.
    template <class Real, class Impulse>
    static Real to_bodies(const Real& armature, const Impulse& impulse)
    {
        return impulse.motor + impulse.spring + impulse.limit - armature * impulse.rotor_change;
    }
    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        Coordinate::locate(row.start, substep, a, b);
        substep.response = Coordinate::template response<Real>(substep, a, b);
        const Real size = Coordinate::template size<Real>(a, b);
        const auto usable = substep.response > Real(rounding_share) * size;
        const Real effective_mass = select(usable, inverse_or_zero(substep.response), Real(0));
        substep.share =
            select(usable, Real(1) / (Real(1) + substep.response * row.in_sweep.armature), Real(1));
        substep.response = substep.share * substep.response;
        substep.effective_mass = select(usable, effective_mass + row.in_sweep.armature, Real(0));
        const SoftRow<Real> spring = soft_row(row.spring, substep.response, substep.effective_mass);
        substep.spring_effective_mass = spring.effective_mass;
        substep.spring_kept = spring.kept;
    }
};

/// The constraint types of this header.
using DriveTypes = TypeList<Drive<DriveAxis::slide>, Drive<DriveAxis::twist>, Drive<DriveAxis::euler>>;

}  // namespace motley
