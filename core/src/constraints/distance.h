// Distance: limits on, and a spring along, the line between two points.
//
//   C = |d|,  d = p_b - p_a,  u = d / |d|,   J = [-u, -(r_a x u), u, r_b x u]
//   min <= C <= max as inequalities, C = min where they are equal (a rod), and a soft C = rest (a spring)
//
// p: anchors; r: their arms. One row and up to two impulses along it, solved one after another on a speed that each
// updates. Parts that a joint lacks are switched off by masks, so that rods, ropes and springs share a block.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/carried_arms.h"
#include "maths/lane_softness.h"
#include "maths/limit.h"
#include "motley/core/constraints/distance_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

struct Distance : ConstraintTraits {
    using Definition = DistanceDefinition;
    static constexpr const char* name = "distance";
    static constexpr bool pulls_at_arms = true;

    /// Replaces an infinite limit: too far to be reached, small enough for results to stay finite.
    static constexpr float far_away = 1e12F;

    template <class Real>
    struct Parameters {
        Vec3<Real> anchor_a;
        Real min_length;
        Vec3<Real> anchor_b;
        Real max_length;
        Real spring_hertz, spring_damping_ratio;
        Real spring_stiffness, spring_damping;
        Real rest_length, spring_max_force;
    };
    template <class Real>
    struct Memory {
        Real spring, limit;  ///< N s along u on b
    };
    /// What a sweep reads of a row.
    template <class Real>
    struct InSweep {
        Real min_length, max_length;
        Real rest_length, spring_max_impulse;
        Real spring_rate;
        ArmWeights<Real> weights;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        PairVector<Real, a, b> start_arm_a, start_arm_b, start_between;
        SpringSoftness<Real> spring;
        InSweep<Real> in_sweep;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        PairVector<Real, a, b> arm_a, arm_b, axis;
        Real response, effective_mass;            ///< K and its inverse
        Real spring_effective_mass, spring_kept;  ///< see SoftRow
        Real length;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real spring, limit;
        PairVector<Real, a, b> push;  ///< N s on b in this substep; relaxation may push along another axis
    };

    static void validate(const Definition& joint, const JointBodies& bodies)
    {
        check_anchor("DistanceDefinition.local_anchor_a", joint.local_anchor_a, bodies.model_a,
                     bodies.fixed_a);
        check_anchor("DistanceDefinition.local_anchor_b", joint.local_anchor_b, bodies.model_b,
                     bodies.fixed_b);
        check_length_range("DistanceDefinition", joint.min_length, joint.max_length);
        check_range("DistanceDefinition.spring_hertz", joint.spring_hertz, 0, 1e6F,
                    "0 (no spring) or up to 1e6 (Hz)");
        check_range("DistanceDefinition.spring_damping_ratio", joint.spring_damping_ratio, 0, 1e6F,
                    "0 to 1e6");
        check_range("DistanceDefinition.spring_stiffness", joint.spring_stiffness, 0, 1e12F,
                    "0 to 1e12 (N/m)");
        check_range("DistanceDefinition.spring_damping", joint.spring_damping, 0, 1e12F, "0 to 1e12 (N s/m)");
        check_one_spring("DistanceDefinition.spring_hertz", joint.spring_hertz, joint.spring_stiffness,
                         joint.spring_damping);
        check_range("DistanceDefinition.rest_length", joint.rest_length, 0, largest_length, "0 to 1e9 (m)");
        check_bound("DistanceDefinition.spring_max_force", joint.spring_max_force);
    }
    static bool locks_place(const Definition& joint) { return joint.min_length == joint.max_length; }
    static Parameters<float> parameters(const Definition& joint)
    {
        return {joint.local_anchor_a,   joint.min_length,
                joint.local_anchor_b,   std::fmin(joint.max_length, far_away),
                joint.spring_hertz,     joint.spring_damping_ratio,
                joint.spring_stiffness, joint.spring_damping,
                joint.rest_length,      std::fmin(joint.spring_max_force, largest_force)};
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
        Row<Real, A::kind, B::kind> row;
        row.start_arm_a = to_space<Vector>(arm_a);
        row.start_arm_b = to_space<Vector>(arm_b);
        row.start_between = to_space<Vector>(pose.between + arm_b - arm_a);
        row.in_sweep.min_length = joint.min_length;
        row.in_sweep.max_length = joint.max_length;
        row.in_sweep.rest_length = joint.rest_length;
        row.in_sweep.spring_max_impulse = Real(step.substep) * joint.spring_max_force;
        row.spring = spring_softness(step, joint.spring_hertz, joint.spring_damping_ratio,
                                     joint.spring_stiffness, joint.spring_damping);
        row.in_sweep.spring_rate = row.spring.rate;
        row.in_sweep.weights = arm_weights(a, b);
        impulse.spring = Real(step.warm_start_scale) * memory.spring;
        impulse.limit = Real(step.warm_start_scale) * memory.limit;
        impulse.push = to_space<Vector>(Vec3<Real>{Real(0), Real(0), Real(0)});
        return row;
    }

    template <class Real, class Row, class Impulse>
    static Tension<Real> tension(const Row& row, const Impulse& impulse)
    {
        const auto along = inverse_or_zero(square_root(dot(row.start_between, row.start_between))) *
                           ((impulse.spring + impulse.limit) * row.start_between);
        return {to_three(row.start_arm_a), to_three(row.start_arm_b), to_three(-along), to_three(along)};
    }

    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        build<Real>(row, substep, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep& substep, const Impulse& impulse, A& a, B& b)
    {
        push((impulse.spring + impulse.limit) * substep.axis, substep.arm_a, substep.arm_b, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& in_sweep, const Substep& substep,
                      Impulse& impulse, A& a, B& b)
    {
        const Real before = impulse.spring + impulse.limit;
        auto arm_a = substep.arm_a, arm_b = substep.arm_b, axis = substep.axis;
        auto held = impulse.push;
        if (step.moved_for > 0) {
            carry_line(step, in_sweep.weights, substep.length, axis, arm_a, arm_b, a, b);
        } else {
            held = before * axis;
        }
        Real speed = dot(axis, velocity_at(b, arm_b) - velocity_at(a, arm_a));
        const SoftRow<Real> soft{in_sweep.spring_rate, substep.spring_effective_mass, substep.spring_kept};
        const Real spring = spring_impulse(soft, substep.length - in_sweep.rest_length, speed, impulse.spring,
                                           in_sweep.spring_max_impulse);
        speed = speed + substep.response * (spring - impulse.spring);
        impulse.spring = spring;
        impulse.limit = range_impulse(step, substep.length, in_sweep.min_length, in_sweep.max_length, speed,
                                      substep.effective_mass, impulse.limit);
        const auto change = (impulse.spring + impulse.limit - before) * axis;
        impulse.push = held + change;
        push(change, arm_a, arm_b, a, b);
    }

    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const auto push = -(now.effective_mass *
                            beyond_range(now.length, row.in_sweep.min_length, row.in_sweep.max_length)) *
                          now.axis;
        apply_displacement(a, now.arm_a, -push);
        apply_displacement(b, now.arm_b, push);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        return {impulse.spring, impulse.limit};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep&, const Impulse& impulse)
    {
        return {to_three(impulse.push), {Real(0), Real(0), Real(0)}};
    }

    /// Errors: how far the length is beyond its limits, from the present poses, in double.
    static JointReport report(const Definition& joint, const Memory<float>& memory, const BodyState& a,
                              const BodyState& b)
    {
        const Vec3<double> d = anchor_separation(a, b, joint.local_anchor_a, joint.local_anchor_b);
        const double length = std::sqrt(dot(d, d));
        const double wrong = std::fmax(0.0, std::fmax(static_cast<double>(joint.min_length) - length,
                                                      length - static_cast<double>(joint.max_length)));
        JointReport report;
        report.error = static_cast<float>(wrong);
        if (joint.min_length == joint.max_length) {
            report.state = JointState::active;
        } else if (memory.limit != 0) {
            report.state = memory.limit > 0 ? JointState::lower : JointState::upper;
        } else if (joint.has_spring()) {
            report.state = JointState::active;
        }
        return report;
    }

  private:
    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        substep.arm_a = turned(a, row.start_arm_a);
        substep.arm_b = turned(b, row.start_arm_b);
        substep.length = measure<Real>(row, substep.arm_a, substep.arm_b, a, b, substep.axis);
        substep.response =
            dot(substep.axis,
                (inverse_point_mass(a, substep.arm_a) + inverse_point_mass(b, substep.arm_b)) * substep.axis);
        substep.effective_mass = inverse_or_zero(substep.response);
        const SoftRow<Real> spring = soft_row(row.spring, substep.response, substep.effective_mass);
        substep.spring_effective_mass = spring.effective_mass;
        substep.spring_kept = spring.kept;
    }
    template <class Vector, class A, class B>
    static void push(const Vector& impulse, const Vector& arm_a, const Vector& arm_b, A& a, B& b)
    {
        apply_impulse(a, arm_a, -impulse);
        apply_impulse(b, arm_b, impulse);
    }
    /// |d| and the unit axis; the x axis when the points coincide, so that a direction always exists.
    template <class Real, class Row, class Vector, class A, class B>
    static Real measure(const Row& row, const Vector& arm_a, const Vector& arm_b, const A& a, const B& b,
                        Vector& axis)
    {
        const Vector d =
            anchor_error(row.start_between, row.start_arm_a, row.start_arm_b, arm_a, arm_b, a, b);
        const Real length2 = dot(d, d);
        const auto distinct = length2 > Real(1e-18F);
        const Real length = square_root(select(distinct, length2, Real(1)));
        axis = (Real(1) / length) * d;
        axis.x = select(distinct, axis.x, Real(1));
        axis.y = select(distinct, axis.y, Real(0));
        if constexpr (requires { axis.z; }) axis.z = select(distinct, axis.z, Real(0));
        return select(distinct, length, Real(0));
    }
};

/// The constraint types of this header.
using DistanceTypes = TypeList<Distance>;

}  // namespace motley
