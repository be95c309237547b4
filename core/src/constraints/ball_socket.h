// Ball-socket: a point of a stays on a point of b.
//
//   C = p_b - p_a = 0,   J = [-I, [r_a]x, I, -[r_b]x],   K = (1/m_a + 1/m_b) I - [r_a]x I_a^-1 [r_a]x - ...
//
// p: anchors; r: their arms; m: masses; I_a, I_b: inertias. Solved as a block, because Gauss-Seidel inside one joint
// does not converge for long levers. Two rows in the plane.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/carried_arms.h"
#include "motley/core/constraints/ball_socket_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

struct BallSocket : ConstraintTraits {
    using Definition = BallSocketDefinition;
    static constexpr const char* name = "ball-socket";
    static constexpr bool pulls_at_arms = true;
    static constexpr int equality_count = 3;
    static constexpr bool locks_point = true;

    template <class Real>
    struct Parameters {
        Vec3<Real> anchor_a, anchor_b;  ///< body frames
    };
    template <class Real>
    struct Memory {
        Vec3<Real> push;  ///< N s on b
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        PairVector<Real, a, b> start_arm_a, start_arm_b;  ///< when the step began
        PairVector<Real, a, b> start_error;
        ArmWeights<Real> in_sweep;  ///< what a sweep reads of a row
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        PairVector<Real, a, b> arm_a, arm_b;
        PairSymmetric<Real, a, b> effective_mass;  ///< K^-1
        PairVector<Real, a, b> error;              ///< C, m
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        PairVector<Real, a, b> push;
    };

    static void validate(const Definition& joint, const JointBodies& bodies)
    {
        check_anchor("BallSocketDefinition.local_anchor_a", joint.local_anchor_a, bodies.model_a,
                     bodies.fixed_a);
        check_anchor("BallSocketDefinition.local_anchor_b", joint.local_anchor_b, bodies.model_b,
                     bodies.fixed_b);
    }
    static Parameters<float> parameters(const Definition& joint)
    {
        return {joint.local_anchor_a, joint.local_anchor_b};
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& joint, const Memory<Real>& memory,
                        const A& a, const B& b, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        using Vector = PairVector<Real, A::kind, B::kind>;
        const Vec3<Real> arm_a = to_world(pose.orientation_a, joint.anchor_a);
        const Vec3<Real> arm_b = to_world(pose.orientation_b, joint.anchor_b);
        impulse.push = Real(step.warm_start_scale) * to_space<Vector>(memory.push);
        return Row<Real, A::kind, B::kind>{to_space<Vector>(arm_a), to_space<Vector>(arm_b),
                                           to_space<Vector>(pose.between + arm_b - arm_a), arm_weights(a, b)};
    }

    template <class Real, class Row, class Impulse>
    static Tension<Real> tension(const Row& row, const Impulse& impulse)
    {
        auto arm_a = row.start_arm_a, arm_b = row.start_arm_b;
        meet_half_way(arm_a, arm_b, row.start_error);
        return {to_three(arm_a), to_three(arm_b), to_three(-impulse.push), to_three(impulse.push)};
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        substep.arm_a = turned(a, row.start_arm_a);
        substep.arm_b = turned(b, row.start_arm_b);
        substep.error = anchor_error(row.start_error, row.start_arm_a, row.start_arm_b, substep.arm_a,
                                     substep.arm_b, a, b);
        meet_half_way(substep.arm_a, substep.arm_b, substep.error);
        substep.effective_mass =
            inverse(inverse_point_mass(a, substep.arm_a) + inverse_point_mass(b, substep.arm_b));
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        apply_impulse(a, substep.arm_a, -impulse.push);
        apply_impulse(b, substep.arm_b, impulse.push);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& weights, const Substep& substep, Impulse& impulse,
                      A& a, B& b)
    {
        auto arm_a = substep.arm_a, arm_b = substep.arm_b;
        if (step.moved_for > 0) carry_arms(step, weights, arm_a, arm_b, a, b);
        const auto speed =
            velocity_at(b, arm_b) - velocity_at(a, arm_a) + Real(step.joint.rate) * substep.error;
        const auto change = Real(step.joint.mass_scale) * -(substep.effective_mass * speed) -
                            Real(step.joint.impulse_scale) * impulse.push;
        impulse.push = impulse.push + change;
        apply_impulse(a, arm_a, -change);
        apply_impulse(b, arm_b, change);
    }

    /// For exact joints, which are between rigid and fixed bodies only.
    static bool is_equality(const Definition&) { return true; }
    static bool locks_place(const Definition&) { return true; }
    template <class Real, class Row, class A, class B>
    static void equality_rows(const Row& row, const A& a, const B& b, EqualityRow<Real>* rows)
    {
        Vec3<Real> arm_a = turned(a, row.start_arm_a), arm_b = turned(b, row.start_arm_b);
        const Vec3<Real> error =
            anchor_error(row.start_error, row.start_arm_a, row.start_arm_b, arm_a, arm_b, a, b);
        const Real zero(0), one(1);
        meet_half_way(arm_a, arm_b, error);
        rows[0] = {{one, zero, zero}, {zero, arm_a.z, -arm_a.y}, {zero, arm_b.z, -arm_b.y}, error.x};
        rows[1] = {{zero, one, zero}, {-arm_a.z, zero, arm_a.x}, {-arm_b.z, zero, arm_b.x}, error.y};
        rows[2] = {{zero, zero, one}, {arm_a.y, -arm_a.x, zero}, {arm_b.y, -arm_b.x, zero}, error.z};
    }

    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        auto arm_a = turned(a, row.start_arm_a);
        auto arm_b = turned(b, row.start_arm_b);
        const auto error =
            anchor_error(row.start_error, row.start_arm_a, row.start_arm_b, arm_a, arm_b, a, b);
        meet_half_way(arm_a, arm_b, error);
        const auto effective_mass = inverse(inverse_point_mass(a, arm_a) + inverse_point_mass(b, arm_b));
        const auto push = -(effective_mass * error);
        apply_displacement(a, arm_a, -push);
        apply_displacement(b, arm_b, push);
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

    /// Errors: |C|, from the present poses, in double.
    static JointReport report(const Definition& joint, const Memory<float>&, const BodyState& a,
                              const BodyState& b)
    {
        const Vec3<double> d = anchor_separation(a, b, joint.local_anchor_a, joint.local_anchor_b);
        return {.error = static_cast<float>(std::sqrt(dot(d, d))), .state = JointState::active};
    }
};

/// The constraint types of this header.
using BallSocketTypes = TypeList<BallSocket>;

}  // namespace motley
