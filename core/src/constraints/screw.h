// Screw: the motion of b along an axis x of a follows its rotation about that axis.
//
//   dC/dt = d(x . d)/dt - p x . (w_b - w_a),   d = p_b - p_a,  p = pitch / (2 pi)
//   J     = [-x, -(r_a + d) x x + p x, x, r_b x x - p x]
//
// p_a, p_b: anchors; r: their arms; w: angular velocities. The impulses on both bodies act at one point and along one
// axis, so linear and angular momentum are kept. No function of the poses counts turns, so C is accumulated from step
// to step, as in transmission.h.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/limit.h"
#include "motley/core/constraints/screw_definition.h"

namespace motley {

struct Screw : ConstraintTraits {
    using Definition = ScrewDefinition;
    static constexpr bool needs_bodies_that_turn = true;
    static constexpr bool is_rare = true;

    template <class Real>
    struct Parameters {
        Vec3<Real> anchor_a;  ///< body frames
        Real metres_a_radian;
        Vec3<Real> anchor_b;
        Real padding;
        Vec3<Real> axis_a;  ///< unit
    };
    template <class Real>
    struct Memory {
        Real lambda;  ///< N s along x on b
        Real error;   ///< C when the step ended, m
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        Vec3<Real> start_arm_a, start_arm_b, start_separation, start_axis;
        Real metres_a_radian, start_error;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        Vec3<Real> axis, lever_a, lever_b;
        Real effective_mass, error;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real lambda;
    };

    static void validate(const Definition& screw, const JointBodies& bodies)
    {
        check_turns("body_a", bodies.model_a, bodies.fixed_a);
        check_turns("body_b", bodies.model_b, bodies.fixed_b);
        check_anchor("local_anchor_a", screw.local_anchor_a, bodies.model_a, bodies.fixed_a);
        check_anchor("local_anchor_b", screw.local_anchor_b, bodies.model_b, bodies.fixed_b);
        check_direction("axis_a", screw.axis_a);
        check_range("pitch", screw.pitch, -1e6F, 1e6F, "-1e6 to 1e6 (m)");
    }
    static Parameters<float> parameters(const Definition& screw)
    {
        constexpr float turn = 6.28318531F;
        return {screw.local_anchor_a, screw.pitch / turn, screw.local_anchor_b, 0, unit(screw.axis_a)};
    }

    static bool locks_place(const Definition&) { return true; }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& screw, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        const Vec3<Real> arm_a = to_world(pose.orientation_a, screw.anchor_a),
                         arm_b = to_world(pose.orientation_b, screw.anchor_b);
        impulse.lambda = Real(start.step().warm_start_scale) * memory.lambda;
        return Row<Real, A::kind, B::kind>{arm_a,
                                           arm_b,
                                           pose.between + arm_b - arm_a,
                                           to_world(pose.orientation_a, screw.axis_a),
                                           screw.metres_a_radian,
                                           memory.error};
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        build<Real>(row, substep, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        push(substep, impulse.lambda, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row&, const Substep& substep, Impulse& impulse, A& a,
                      B& b)
    {
        const Real speed = dot(substep.axis, linear_of(b) - linear_of(a)) +
                           dot(substep.lever_b, angular_of(b)) - dot(substep.lever_a, angular_of(a));
        const Real wanted = lock_impulse(step, substep.error, speed, substep.effective_mass, impulse.lambda);
        push(substep, wanted - impulse.lambda, a, b);
        impulse.lambda = wanted;
    }

    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const Real lambda = -(now.effective_mass * now.error);
        displace(a, -(lambda * now.axis), -(lambda * now.lever_a));
        displace(b, lambda * now.axis, lambda * now.lever_b);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row& row, const Impulse& impulse, const End& end)
    {
        SubstepRow<Real, decltype(end.a())::kind, decltype(end.b())::kind> now;
        build<Real>(row, now, end.a(), end.b());
        return {impulse.lambda, now.error};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row& row, const Substep& substep, const Impulse& impulse)
    {
        const Vec3<Real> push = impulse.lambda * substep.axis;
        return {push, -(row.metres_a_radian * push)};
    }

    /// Errors: by how much b is ahead of its thread.
    static JointReport report(const Definition&, const Memory<float>& memory, const BodyState&,
                              const BodyState&)
    {
        return {.error = std::abs(memory.error), .state = JointState::active};
    }

  private:
    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        const Vec3<Real> arm_a = rotate(turn_of(a), row.start_arm_a),
                         arm_b = rotate(turn_of(b), row.start_arm_b), x = rotate(turn_of(a), row.start_axis);
        const Vec3<Real> gone =
            (to_three(b.delta) - to_three(a.delta)) + (arm_b - row.start_arm_b) - (arm_a - row.start_arm_a);
        const Vec3<Real> turn = row.metres_a_radian * x;
        substep.axis = x;
        substep.lever_a = cross(arm_a + row.start_separation + gone, x) - turn;
        substep.lever_b = cross(arm_b, x) - turn;
        // Sums of small numbers only: precision does not depend on how far b has slid or how often it has turned.
        substep.error = row.start_error + dot(x, gone) + dot(x - row.start_axis, row.start_separation) -
                        row.metres_a_radian * (turn_about(b, row.start_axis) - turn_about(a, row.start_axis));
        const Real k = dot(x, over_mass(a, x) + over_mass(b, x)) +
                       dot(substep.lever_a, over_inertia(a, substep.lever_a)) +
                       dot(substep.lever_b, over_inertia(b, substep.lever_b));
        const Real size = linear_size(a) + linear_size(b) +
                          row.metres_a_radian * row.metres_a_radian * (angular_size(a) + angular_size(b));
        substep.effective_mass = select(k > Real(rounding_share) * size, inverse_or_zero(k), Real(0));
    }

    template <class Real, class Substep, class A, class B>
    static void push(const Substep& substep, const Real& lambda, A& a, B& b)
    {
        apply_wrench(a, -(lambda * substep.axis), -(lambda * substep.lever_a));
        apply_wrench(b, lambda * substep.axis, lambda * substep.lever_b);
    }
};

/// The constraint types of this header.
using ScrewTypes = TypeList<Screw>;

}  // namespace motley
