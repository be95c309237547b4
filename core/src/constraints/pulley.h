// Pulley: one rope over two wheels that are fixed in the world.
//
//   C = |s_a| + ratio |s_b|, s = p - wheel, u = s / |s|     J = [u_a, r_a x u_a, ratio u_b, ratio r_b x u_b]
//   min <= C <= max as inequalities, C = min where they are equal
//
// p: anchors; r: their arms. A positive lambda lengthens the rope. That of a taut rope is negative: both bodies are
// pulled to their wheels, b with `ratio` times the force.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/limit.h"
#include "motley/core/constraints/pulley_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

struct Pulley : ConstraintTraits {
    using Definition = PulleyDefinition;
    static constexpr bool has_world_points = true;
    static constexpr bool is_rare = true;
    static constexpr float far_away = 1e12F;

    template <class Real>
    struct Parameters {
        Vec3<Real> anchor_a;
        Real ratio;
        Vec3<Real> anchor_b;
        Real min_length, max_length;
    };
    template <class Real>
    struct Memory {
        Real lambda;  ///< N s
    };
    /// One end of the rope.
    template <class Vector>
    struct End {
        Vector start_arm, start_rope;  ///< rope: from the wheel to the anchor
    };
    template <class Vector>
    struct EndNow {
        Vector arm, axis;  ///< axis: u_a or ratio u_b
    };
    /// What a sweep reads of a row.
    template <class Real>
    struct InSweep {
        Real min_length, max_length;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        End<PairVector<Real, a, b>> a_end, b_end;
        Real ratio;
        InSweep<Real> in_sweep;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        EndNow<PairVector<Real, a, b>> a_end, b_end;
        Real effective_mass, length;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real lambda;
    };

    static void validate(const Definition& pulley, const JointBodies& bodies)
    {
        check_anchor("PulleyDefinition.local_anchor_a", pulley.local_anchor_a, bodies.model_a,
                     bodies.fixed_a);
        check_anchor("PulleyDefinition.local_anchor_b", pulley.local_anchor_b, bodies.model_b,
                     bodies.fixed_b);
        check_world_point("PulleyDefinition.point_a", pulley.point_a);
        check_world_point("PulleyDefinition.point_b", pulley.point_b);
        check_range("PulleyDefinition.ratio", pulley.ratio, 1e-6F, 1e6F, "1e-6 to 1e6");
        check_length_range("PulleyDefinition", pulley.min_length, pulley.max_length);
    }
    static Parameters<float> parameters(const Definition& pulley)
    {
        return {pulley.local_anchor_a, pulley.ratio, pulley.local_anchor_b, pulley.min_length,
                std::fmin(pulley.max_length, far_away)};
    }

    static WorldPoints world_points(const Definition& pulley) { return {pulley.point_a, pulley.point_b}; }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& pulley, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        const FromWorldPoints<Real> from = start.from_world_points();
        using Vector = PairVector<Real, A::kind, B::kind>;
        const Vec3<Real> arm_a = to_world(pose.orientation_a, pulley.anchor_a);
        const Vec3<Real> arm_b = to_world(pose.orientation_b, pulley.anchor_b);
        impulse.lambda = Real(step.warm_start_scale) * memory.lambda;
        return Row<Real, A::kind, B::kind>{{to_space<Vector>(arm_a), to_space<Vector>(from.a + arm_a)},
                                           {to_space<Vector>(arm_b), to_space<Vector>(from.b + arm_b)},
                                           pulley.ratio,
                                           {pulley.min_length, pulley.max_length}};
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        build<Real>(row, substep, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        apply_impulse(a, substep.a_end.arm, impulse.lambda * substep.a_end.axis);
        apply_impulse(b, substep.b_end.arm, impulse.lambda * substep.b_end.axis);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& in_sweep, const Substep& substep,
                      Impulse& impulse, A& a, B& b)
    {
        const Real speed = dot(substep.a_end.axis, velocity_at(a, substep.a_end.arm)) +
                           dot(substep.b_end.axis, velocity_at(b, substep.b_end.arm));
        const Real wanted = range_impulse(step, substep.length, in_sweep.min_length, in_sweep.max_length,
                                          speed, substep.effective_mass, impulse.lambda);
        const Real change = wanted - impulse.lambda;
        impulse.lambda = wanted;
        apply_impulse(a, substep.a_end.arm, change * substep.a_end.axis);
        apply_impulse(b, substep.b_end.arm, change * substep.b_end.axis);
    }

    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const Real push = -(now.effective_mass *
                            beyond_range(now.length, row.in_sweep.min_length, row.in_sweep.max_length));
        apply_displacement(a, now.a_end.arm, push * now.a_end.axis);
        apply_displacement(b, now.b_end.arm, push * now.b_end.axis);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        return {impulse.lambda};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep& substep, const Impulse& impulse)
    {
        return {to_three(impulse.lambda * substep.b_end.axis), {Real(0), Real(0), Real(0)}};
    }

    /// Errors: how far the rope is too short or too long, from the present poses, in double.
    static JointReport report(const Definition& pulley, const Memory<float>& memory, const BodyState& a,
                              const BodyState& b)
    {
        const Vec3<double> rope_a =
            a.position + rotate(a.orientation, convert<double>(pulley.local_anchor_a)) - pulley.point_a;
        const Vec3<double> rope_b =
            b.position + rotate(b.orientation, convert<double>(pulley.local_anchor_b)) - pulley.point_b;
        const double length = std::sqrt(dot(rope_a, rope_a)) +
                              static_cast<double>(pulley.ratio) * std::sqrt(dot(rope_b, rope_b));
        JointReport report;
        report.error =
            static_cast<float>(std::fmax(0.0, std::fmax(static_cast<double>(pulley.min_length) - length,
                                                        length - static_cast<double>(pulley.max_length))));
        if (pulley.min_length == pulley.max_length) {
            report.state = JointState::active;
        } else if (memory.lambda != 0) {
            report.state = memory.lambda > 0 ? JointState::lower : JointState::upper;
        }
        return report;
    }

  private:
    /// Arm, direction (zero where the anchor is at the wheel) and length of one end of the rope now, times `ratio`.
    /// Adds the response of its body to k.
    template <class Real, class Vector, class Body>
    static Real build_end(const End<Vector>& end, const Real& ratio, const Body& body, EndNow<Vector>& now,
                          Real& k)
    {
        now.arm = turned(body, end.start_arm);
        const Vector rope = end.start_rope + translation<Vector>(body) + (now.arm - end.start_arm);
        const Real length2 = dot(rope, rope);
        const auto distinct = length2 > Real(1e-18F);
        const Real length = square_root(select(distinct, length2, Real(1)));
        now.axis = select(distinct, ratio / length, Real(0)) * rope;
        k = k + dot(now.axis, inverse_point_mass(body, now.arm) * now.axis);
        return select(distinct, ratio * length, Real(0));
    }
    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        Real k(0);
        const Real length_a = build_end(row.a_end, Real(1), a, substep.a_end, k);
        substep.length = length_a + build_end(row.b_end, row.ratio, b, substep.b_end, k);
        substep.effective_mass = inverse_or_zero(k);
    }
};

/// The constraint types of this header.
using PulleyTypes = TypeList<Pulley>;

}  // namespace motley
