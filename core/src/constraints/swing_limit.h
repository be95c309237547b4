// Swing limit: the angle between two axes stays below a bound.
//
//   C = max - angle(x_a, x_b) >= 0,   J of the angle = [0, -n, 0, n],  n = x_a x x_b / |x_a x x_b|
//
// x_a and x_b are the x axes of the frames. Where they are parallel n has no direction; only a limit of zero is reached
// there.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/limit.h"
#include "maths/locked_point.h"
#include "motley/core/constraints/swing_limit_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

struct SwingLimit : ConstraintTraits {
    using Definition = SwingLimitDefinition;
    static constexpr bool needs_bodies_that_turn = true;
    static constexpr bool has_torque = true;
    static constexpr bool turns_about_points = true;
    static constexpr ActiveRow active_row = ActiveRow::angular;

    template <class Real>
    struct Parameters {
        Vec3<Real> axis_a;  ///< body frames
        Real max_angle;
        Vec3<Real> axis_b;
        Real padding;
    };
    template <class Real>
    struct Memory {
        Real limit;  ///< N m s, >= 0, against the swing
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        Vec3<Real> start_axis_a, start_axis_b;
        Real max_angle;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        Vec3<Real> normal;          ///< n
        Real effective_mass, room;  ///< K^-1 and C
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real limit;
    };

    static void validate(const Definition& limit, const JointBodies& bodies)
    {
        check_joint_frame("frame_a", limit.frame_a, bodies.model_a, bodies.fixed_a);
        check_joint_frame("frame_b", limit.frame_b, bodies.model_b, bodies.fixed_b);
        check_range("max_angle", limit.max_angle, 0, 3.14159275F, "0 to pi (rad)");
    }
    static Parameters<float> parameters(const Definition& limit)
    {
        return {axis_x(unit(limit.frame_a.rotation)), limit.max_angle, axis_x(unit(limit.frame_b.rotation)),
                0};
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& limit, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        impulse.limit = Real(step.warm_start_scale) * memory.limit;
        return Row<Real, A::kind, B::kind>{to_world(pose.orientation_a, limit.axis_a),
                                           to_world(pose.orientation_b, limit.axis_b), limit.max_angle};
    }

    template <class Real, class Row, class Impulse>
    static Real torque(const Row&, const Impulse& impulse)
    {
        return impulse.limit;
    }

    template <class Impulse, class Real>
    static void scale(Impulse& impulse, const Real& share)
    {
        impulse.limit = share * impulse.limit;
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        build<Real>(row, substep, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        push(substep, impulse.limit, a, b);
    }

    template <class Real, class Substep, class A, class B>
    static void lengthen_step(Substep& substep, const A& a, const Vec3<Real>& arm_a, const B& b,
                              const Vec3<Real>& arm_b)
    {
        const auto usable = substep.effective_mass > Real(0);
        const Real longer = effective_mass_at_point(substep.normal, a, arm_a, b, arm_b);
        substep.effective_mass = select(usable, longer, Real(0));
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row&, const Substep& substep, Impulse& impulse, A& a,
                      B& b)
    {
        const Real closing = dot(substep.normal, angular_of(a) - angular_of(b));  // dC/dt
        const Real wanted = maximum(
            limit_impulse(step, substep.room, closing, substep.effective_mass, impulse.limit), Real(0));
        push(substep, wanted - impulse.limit, a, b);
        impulse.limit = wanted;
    }

    /// Acts while it pushes inwards.
    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static ActingRow<Real> act(const StepConstants& step, const Row& row, const Substep&, Impulse& impulse,
                               const A& a, const B& b)
    {
        SubstepRow<Real, A::kind, B::kind> here;
        build<Real>(row, here, a, b);
        const Real none(0), limit(ActsBy::limit), before = impulse.limit;
        impulse.limit = maximum(before, none);
        const Real by = select(before > none, select(here.effective_mass > none, limit, none), none);
        // dC/dt is that of a relative to b.
        const Vec3<Real> along = -here.normal;
        return {{{none, none, none}, along, along, error_of_limit(step, here.room)},
                by,
                impulse.limit - before,
                here.effective_mass,
                -bearable_pull<Real>(step, a, b),
                Real(no_bound)};
    }
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        const Vec3<Real> turn = (now.effective_mass * minimum(now.room, Real(0))) * now.normal;
        displace(a, none, -turn);
        displace(b, none, turn);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        return {impulse.limit};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep& substep, const Impulse& impulse)
    {
        return {{Real(0), Real(0), Real(0)}, -(impulse.limit * substep.normal)};
    }

    /// Errors: how far x_b is outside of the cone, from the present poses, in double.
    static JointReport report(const Definition& limit, const Memory<float>& memory, const BodyState& a,
                              const BodyState& b)
    {
        const Vec3<double> x_a = axis_x(a.orientation * unit(convert<double>(limit.frame_a.rotation)));
        const Vec3<double> x_b = axis_x(b.orientation * unit(convert<double>(limit.frame_b.rotation)));
        const Vec3<double> n = cross(x_a, x_b);
        const double sine = std::sqrt(dot(n, n));
        JointReport report;
        report.angle_error = static_cast<float>(
            std::fmax(0.0, std::atan2(sine, dot(x_a, x_b)) - static_cast<double>(limit.max_angle)));
        if (memory.limit > 0) report.state = JointState::upper;
        return report;
    }

  private:
    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        const Vec3<Real> x_a = rotate(turn_of(a), row.start_axis_a),
                         x_b = rotate(turn_of(b), row.start_axis_b);
        const Vec3<Real> n = cross(x_a, x_b), difference = x_a - x_b, sum = x_a + x_b;
        const Real sine2 = dot(n, n);
        const auto has_direction = sine2 > Real(1e-8F);
        const Real scale =
            select(has_direction, Real(1) / square_root(select(has_direction, sine2, Real(1))), Real(0));
        substep.normal = scale * n;
        // The angle between unit vectors as twice the arc tangent of |x_a - x_b| / |x_a + x_b|: accurate also near 0
        // and pi, where its sine or its cosine alone loses digits.
        substep.room = row.max_angle - Real(2) * arc_tangent2(square_root(dot(difference, difference)),
                                                              square_root(dot(sum, sum)));
        const Real k = dot(substep.normal, over_inertia(a, substep.normal) + over_inertia(b, substep.normal));
        const auto usable = k > Real(rounding_share) * (angular_size(a) + angular_size(b));
        substep.effective_mass = select(usable, inverse_or_zero(k), Real(0));
    }

    /// A positive lambda acts against the swing.
    template <class Real, class Substep, class A, class B>
    static void push(const Substep& substep, const Real& lambda, A& a, B& b)
    {
        apply_turn(a, lambda * substep.normal);
        apply_turn(b, -(lambda * substep.normal));
    }
};

/// The constraint types of this header.
using SwingLimitTypes = TypeList<SwingLimit>;

}  // namespace motley
