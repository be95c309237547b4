// Distance: a rod, a rope or a spring between two points.
//
//   C = |d| - L,  d = p_b - p_a,  u = d / |d|,   J = [-u, -(r_a x u), u, r_b x u]
//   rod C = 0; rope C <= 0 and lambda <= 0 (it only pulls); spring: soft with its own hertz and damping ratio
//
// One row whatever the pair; the mode is masks, not branches, so that all three share a block.
#pragma once

#include <cmath>
#include <limits>

#include "motley/core/constraints/distance_definition.h"
#include "motley/core/invalid_input.h"
#include "motley/core/joint_checks.h"
#include "motley/core/joint_pose.h"
#include "motley/core/joint_report.h"
#include "motley/core/lane_softness.h"

namespace motley {

struct Distance {
    using Definition = DistanceDefinition;
    static constexpr const char* name = "distance";
    static constexpr bool has_restitution = false;
    static constexpr bool recomputes_each_substep = true;

    template <class Real>
    struct Parameters {
        Vec3<Real> anchor_a;
        Real length;
        Vec3<Real> anchor_b;
        Real upper;          ///< largest lambda: 0 of a rope
        Real hertz;          ///< of a spring, 0 of rod and rope
        Real damping_ratio;  ///< of a spring
    };
    template <class Real>
    struct Memory {
        Real along;  ///< N s along u on b
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        PairVector<Real, a, b> start_arm_a, start_arm_b, start_between;
        Real length, upper;
        LaneSoftness<Real> soft;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        PairVector<Real, a, b> arm_a, arm_b, axis;
        Real mass, bias, mass_scale, impulse_scale;
        Real relax_bias, relax_mass_scale, relax_impulse_scale;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real along;
    };

    static void validate(const Definition& joint, const JointBodies& bodies)
    {
        check_anchor("DistanceDefinition.local_anchor_a", joint.local_anchor_a, bodies.model_a,
                     bodies.fixed_a);
        check_anchor("DistanceDefinition.local_anchor_b", joint.local_anchor_b, bodies.model_b,
                     bodies.fixed_b);
        check_range("DistanceDefinition.length", joint.length, 0, largest_length,
                    "a finite value from 0 to 1e9 (m)");
        if (joint.mode > DistanceMode::spring) {
            refuse("DistanceDefinition.mode", static_cast<double>(joint.mode), "rod, rope or spring");
        }
        if (joint.mode == DistanceMode::spring) {
            check_range("DistanceDefinition.hertz", joint.hertz, 1e-6F, 1e6F,
                        "a finite value from 1e-6 to 1e6 (Hz)");
            check_range("DistanceDefinition.damping_ratio", joint.damping_ratio, 0, 1e6F,
                        "a finite value from 0 to 1e6");
        }
    }
    static Parameters<float> parameters(const Definition& joint)
    {
        const bool spring = joint.mode == DistanceMode::spring;
        return {joint.local_anchor_a,
                joint.length,
                joint.local_anchor_b,
                joint.mode == DistanceMode::rope ? 0.0F : std::numeric_limits<float>::max(),
                spring ? joint.hertz : 0.0F,
                spring ? joint.damping_ratio : 0.0F};
    }

    template <class Real, class A, class B>
    static auto prepare(const StepConstants& step, const Parameters<Real>& joint, const Memory<Real>& memory,
                        const JointPose<Real, A::kind, B::kind>& pose, const A&, const B&,
                        Impulse<Real, A::kind, B::kind>& impulse)
    {
        using Vector = PairVector<Real, A::kind, B::kind>;
        const Vec3<Real> arm_a = to_world(pose.orientation_a, joint.anchor_a);
        const Vec3<Real> arm_b = to_world(pose.orientation_b, joint.anchor_b);
        Row<Real, A::kind, B::kind> row;
        row.start_arm_a = to_space<Vector>(arm_a);
        row.start_arm_b = to_space<Vector>(arm_b);
        row.start_between = to_space<Vector>(pose.between + arm_b - arm_a);
        row.length = joint.length;
        row.upper = joint.upper;
        row.soft = softness_or(step, joint.hertz, joint.damping_ratio, step.joint);
        impulse.along = Real(step.warm_start_scale) * memory.along;
        return row;
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const StepConstants& step, const Row& row, Substep& substep,
                           const Impulse& impulse, A& a, B& b)
    {
        substep.arm_a = turned(a, row.start_arm_a);
        substep.arm_b = turned(b, row.start_arm_b);
        const Real length = measure<Real>(row, substep.arm_a, substep.arm_b, a, b, substep.axis);
        substep.mass = mass_along<Real>(substep.arm_a, substep.arm_b, substep.axis, a, b);

        const Real error = length - row.length;
        const auto spring = row.soft.is_own > Real(0);
        // A slack rope is speculative: it may tighten to zero within the substep and no further.
        const auto slack = (row.upper < Real(1)) & (error < Real(0));
        const Real closing = Real(step.inverse_substep) * error;
        const Real soft_bias = row.soft.rate * error;
        substep.bias = select(slack, closing, soft_bias);
        substep.mass_scale = select(slack, Real(1), row.soft.mass_scale);
        substep.impulse_scale = select(slack, Real(0), row.soft.impulse_scale);
        // Relaxation takes the bias out of rods and taut ropes; a spring's softness is its physics and stays.
        substep.relax_bias = select(slack, closing, select(spring, soft_bias, Real(0)));
        substep.relax_mass_scale = select(spring, row.soft.mass_scale, Real(1));
        substep.relax_impulse_scale = select(spring, row.soft.impulse_scale, Real(0));

        const auto push = impulse.along * substep.axis;
        apply_impulse(a, substep.arm_a, -push);
        apply_impulse(b, substep.arm_b, push);
    }

    template <bool relax, class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants&, const Row& row, const Substep& substep, Impulse& impulse, A& a,
                      B& b)
    {
        const Real speed = dot(substep.axis, velocity_at(b, substep.arm_b) - velocity_at(a, substep.arm_a));
        const Real bias = relax ? substep.relax_bias : substep.bias;
        const Real mass_scale = relax ? substep.relax_mass_scale : substep.mass_scale;
        const Real impulse_scale = relax ? substep.relax_impulse_scale : substep.impulse_scale;
        const Real free =
            impulse.along - substep.mass * mass_scale * (speed + bias) - impulse_scale * impulse.along;
        const Real held = minimum(free, row.upper);
        const auto push = (held - impulse.along) * substep.axis;
        impulse.along = held;
        apply_impulse(a, substep.arm_a, -push);
        apply_impulse(b, substep.arm_b, push);
    }

    template <class Real, class Row, class Substep, class A, class B>
    static void project(const StepConstants&, const Row& row, const Substep&, A& a, B& b)
    {
        const auto arm_a = turned(a, row.start_arm_a);
        const auto arm_b = turned(b, row.start_arm_b);
        auto axis = arm_a;
        const Real length = measure<Real>(row, arm_a, arm_b, a, b, axis);
        const Real mass = mass_along<Real>(arm_a, arm_b, axis, a, b);
        // Springs are forces, not positions; a slack rope has nothing to mend.
        const Real wrong = select(row.soft.is_own > Real(0), Real(0), length - row.length);
        const Real error = select(row.upper > Real(0), wrong, maximum(wrong, Real(0)));
        const auto push = -(mass * error) * axis;
        apply_displacement(a, arm_a, -push);
        apply_displacement(b, arm_b, push);
    }

    template <class Real, class Row, class Impulse>
    static Memory<Real> remember(const Row&, const Impulse& impulse)
    {
        return {impulse.along};
    }

    /// What it did and how far off it is, from the poses now, in double.
    static JointReport report(const Definition& joint, const Memory<float>& memory, const BodyState& a,
                              const BodyState& b, double inverse_substep)
    {
        const Vec3<double> d = anchor_separation(a, b, joint.local_anchor_a, joint.local_anchor_b);
        const double length = std::sqrt(dot(d, d));
        const Vec3<double> axis = length > 1e-9 ? (1 / length) * d : Vec3<double>{1, 0, 0};
        const double wrong = length - static_cast<double>(joint.length);
        const bool is_wrong =
            joint.mode == DistanceMode::rod || (joint.mode == DistanceMode::rope && wrong > 0);
        JointReport report;
        report.force = convert<float>((inverse_substep * static_cast<double>(memory.along)) * axis);
        report.error = is_wrong ? static_cast<float>(std::abs(wrong)) : 0.0F;
        if (joint.mode != DistanceMode::rope) {
            report.state = JointState::active;
        } else if (memory.along < 0) {
            report.state = JointState::upper;
        }
        return report;
    }

  private:
    /// |d| and the unit axis; the x axis when the points coincide, so that a direction always exists.
    template <class Real, class Row, class Vector, class A, class B>
    static Real measure(const Row& row, const Vector& arm_a, const Vector& arm_b, const A& a, const B& b,
                        Vector& axis)
    {
        const Vector d = row.start_between + (translation<Vector>(b) - translation<Vector>(a)) +
                         (arm_b - row.start_arm_b) - (arm_a - row.start_arm_a);
        const Real length2 = dot(d, d);
        const auto distinct = length2 > Real(1e-18F);
        const Real length = square_root(select(distinct, length2, Real(1)));
        axis = (Real(1) / length) * d;
        axis.x = select(distinct, axis.x, Real(1));
        axis.y = select(distinct, axis.y, Real(0));
        if constexpr (requires { axis.z; }) axis.z = select(distinct, axis.z, Real(0));
        return select(distinct, length, Real(0));
    }
    template <class Real, class Vector, class A, class B>
    static Real mass_along(const Vector& arm_a, const Vector& arm_b, const Vector& axis, const A& a,
                           const B& b)
    {
        return inverse_or_zero(
            dot(axis, (inverse_point_mass(a, arm_a) + inverse_point_mass(b, arm_b)) * axis));
    }
};

}  // namespace motley
