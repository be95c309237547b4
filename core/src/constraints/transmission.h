// Transmissions: the motion of b follows the rotation of a. Gears (b turns), rack and pinion (b slides). With
// velocities v, angular velocities w and the unit axes e_a and e_b:
//
//   gear  dC/dt = w_b . e_b - ratio w_a . e_a       J = [0, -ratio e_a, 0, e_b]
//   rack  dC/dt = v_b . e_b - travel w_a . e_a      J = [0, -travel e_a, e_b, 0]
//
// No function of the poses has this derivative over more than a turn, so C is accumulated: the memory of the joint
// keeps it from step to step, and each step adds the motion of both bodies since it began. Only this small number is
// rounded, however many turns there were.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/limit.h"
#include "motley/core/constraints/transmission_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

/// The ratio of a definition.
inline float ratio_of(const GearDefinition& gear)
{
    return gear.ratio;
}
inline float ratio_of(const RackAndPinionDefinition& rack)
{
    return rack.travel;
}

template <class JointDefinition>
struct Transmission : ConstraintTraits {
    using Definition = JointDefinition;
    static constexpr bool needs_bodies_that_turn = true;
    static constexpr bool is_rare = true;
    static constexpr bool slides = std::is_same_v<Definition, RackAndPinionDefinition>;

    template <class Real>
    struct Parameters {
        Vec3<Real> axis_a;  ///< unit, body frames
        Real ratio;
        Vec3<Real> axis_b;
        Real padding;
    };
    template <class Real>
    struct Memory {
        Real lambda;  ///< N m s of a gear, N s of a rack
        Real error;   ///< C when the step ended, rad or m
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        Vec3<Real> start_axis_a, start_axis_b;
        Real ratio, start_error;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        Vec3<Real> axis_a, axis_b;  ///< axis_a is ratio e_a
        Real effective_mass, error;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real lambda;
    };

    static void validate(const Definition& joint, const JointBodies& bodies)
    {
        check_turns("body_a", bodies.model_a, bodies.fixed_a);
        check_turns("body_b", bodies.model_b, bodies.fixed_b);
        check_direction("axis_a", joint.axis_a);
        check_direction("axis_b", joint.axis_b);
        check_range(slides ? "travel" : "ratio", ratio_of(joint), -1e6F, 1e6F,
                    slides ? "-1e6 to 1e6 (m/rad)" : "-1e6 to 1e6");
    }
    static Parameters<float> parameters(const Definition& joint)
    {
        return {unit(joint.axis_a), ratio_of(joint), unit(joint.axis_b), 0};
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& joint, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        impulse.lambda = Real(step.warm_start_scale) * memory.lambda;
        return Row<Real, A::kind, B::kind>{to_world(pose.orientation_a, joint.axis_a),
                                           to_world(pose.orientation_b, joint.axis_b), joint.ratio,
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
        apply_turn(a, -(impulse.lambda * substep.axis_a));
        push_b(impulse.lambda * substep.axis_b, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row&, const Substep& substep, Impulse& impulse, A& a,
                      B& b)
    {
        const Real speed =
            dot(substep.axis_b, slides ? linear_of(b) : angular_of(b)) - dot(substep.axis_a, angular_of(a));
        const Real wanted = lock_impulse(step, substep.error, speed, substep.effective_mass, impulse.lambda);
        const Real change = wanted - impulse.lambda;
        impulse.lambda = wanted;
        apply_turn(a, -(change * substep.axis_a));
        push_b(change * substep.axis_b, b);
    }

    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const Real lambda = -(now.effective_mass * now.error);
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        displace(a, none, -(lambda * now.axis_a));
        if constexpr (slides) {
            displace(b, lambda * now.axis_b, none);
        } else {
            displace(b, none, lambda * now.axis_b);
        }
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row& row, const Impulse& impulse, const End& end)
    {
        return {impulse.lambda, error_now<Real>(row, end.a(), end.b())};
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep& substep, const Impulse& impulse)
    {
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        const Vec3<Real> effort = impulse.lambda * substep.axis_b;
        return slides ? Wrench<Real>{effort, none} : Wrench<Real>{none, effort};
    }

    /// Errors: by how much b is ahead of a.
    static JointReport report(const Definition&, const Memory<float>& memory, const BodyState&,
                              const BodyState&)
    {
        JointReport report;
        (slides ? report.error : report.angle_error) = std::abs(memory.error);
        report.state = JointState::active;
        return report;
    }

  private:
    template <class Real, class Row, class A, class B>
    static Real error_now(const Row& row, const A& a, const B& b)
    {
        Real of_b;
        if constexpr (slides) {
            of_b = dot(rotate(turn_of(b), row.start_axis_b), to_three(b.delta));
        } else {
            of_b = turn_about(b, row.start_axis_b);
        }
        return row.start_error + of_b - row.ratio * turn_about(a, row.start_axis_a);
    }

    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        substep.axis_a = row.ratio * rotate(turn_of(a), row.start_axis_a);
        substep.axis_b = rotate(turn_of(b), row.start_axis_b);
        substep.error = error_now<Real>(row, a, b);
        const Vec3<Real> turn_a = over_inertia(a, substep.axis_a);
        const Vec3<Real> move_b = slides ? over_mass(b, substep.axis_b) : over_inertia(b, substep.axis_b);
        const Real k = dot(substep.axis_a, turn_a) + dot(substep.axis_b, move_b);
        const Real size =
            row.ratio * row.ratio * angular_size(a) + (slides ? linear_size(b) : angular_size(b));
        const auto usable = k > Real(rounding_share) * size;
        substep.effective_mass = select(usable, inverse_or_zero(k), Real(0));
    }

    template <class Real, class B>
    static void push_b(const Vec3<Real>& impulse, B& b)
    {
        if constexpr (slides) {
            apply_wrench(b, impulse, Vec3<Real>{Real(0), Real(0), Real(0)});
        } else {
            apply_turn(b, impulse);
        }
    }
};

using Gear = Transmission<GearDefinition>;
using RackAndPinion = Transmission<RackAndPinionDefinition>;

/// The constraint types of this header.
using TransmissionTypes = TypeList<Gear, RackAndPinion>;

}  // namespace motley
