// What a type of constraint is: the page to read before writing one.
//
// A joint is two files next to constraints/ball_socket.h, the simplest example: its definition by the host
// (x_definition.h, a struct with the two bodies, fields with units and defaults) and its maths (x.h, a struct that
// inherits ConstraintTraits and has the members below). x.h ends with the list of its types,
// `using XTypes = TypeList<X>;`. The name of that list is put into constraint_types.h and x_definition.h into
// joint_definitions.h, and that is all: storage, handles, colouring, blocks, kernels of every instruction set and pair
// of bodies, reports and break limits follow from the list. It also needs its formulas in double in
// core/reference/joint_models.cpp and its cases in tests/joint_cases.h, without which the tests over the type list do
// not compile.
//
//   using Definition = ...;                                     what the host says
//   template <class Real> struct Parameters, Memory;            a joint's: of its definition; from step to step
//   template <class Real, BodyKind a, BodyKind b>
//   struct Row, SubstepRow, Impulse;                            in lanes: of a step; of a substep; accumulated
//
// These five are nothing but Reals, in line: Row<float> is one joint, Row<Lanes> a bundle of them. What a sweep reads
// of a row is its member `in_sweep`; of a row without one all, or nothing if there is a substep row. SubstepRow may be
// empty.
//
// Functions of the host's side, in double or float, one joint at a time:
//
//   validate(definition, bodies)              throws InvalidInput: field, value, valid range (joint_checks.h)
//   parameters(definition)                    in the units of the lanes
//   report(definition, memory, state_a, state_b) -> JointReport       errors and state, from the poses now
//
// Functions of the lanes, in the order of a step. They are written once for every Real and every pair of bodies, with
// the operations of scalar.h, lane_body.h and wrench.h, and never branch on a lane. What is const is read, what is not
// is written:
//
//   once a step
//     prepare(start, parameters, memory, a, b, impulse&) -> Row       see StepStart; writes the impulses to start from
//     put_in_order(order, parameters& or memory&)                     of a contact: exchanges bodies a and b where order is -1
//     tension<Real>(row, impulse) -> Tension                          with pulls_at_arms: see tension.h
//   each substep
//     torque<Real>(row, impulse) -> Real                              with has_torque: norm of its angular impulses or more
//     scale(impulse&, share)                                          with has_torque: keeps a share of the impulses
//     prepare_substep<Real>(row, impulse, substep&, a, b)             J, C and K^-1 where the bodies are now
//     warm_start<Real>(row, substep, impulse, a&, b&)                 v += M^-1 J^T lambda
//     renew_response<Real>(row&, a, b)                                of a contact whose bodies turned far: K as it is now
//     solve<Real>(step, in_sweep, substep, impulse&, a&, b&)          one sweep, as soft as `step` says: rigid to relax
//     project<Real>(step, row, a&, b&)                                moves the bodies along J^T
//     wrench<Real>(row, substep, impulse) -> Wrench                   of a joint: its impulse on b where it acts
//   once a step
//     restitute<Real>(step, row, impulse&, a&, b&)                    with has_restitution
//     remember<Real>(row, impulse, end) -> Memory                     end.a() and end.b() are the bodies now
//   for SolverSettings::exact_joints, with equality_count
//     equality_rows<Real>(row, a, b, rows*)                           J and C, row by row
//   likewise, with an active_row
//     act<Real>(step, row, substep, impulse&, a, b) -> ActingRow      what acts now: there SubstepRow::effective_mass, or of a
//                                                                     spring spring_effective_mass and spring_kept, is 0,
//                                                                     so that sweeps leave it alone
//   likewise, each substep, with turns_about_points
//     lengthen_step<Real>(substep&, a, arm_a, b, arm_b)               where a point is locked: see locked_point.h
#pragma once

#include <concepts>
#include <type_traits>

#include "maths/contact_surface.h"
#include "maths/equality_row.h"
#include "maths/step_constants.h"
#include "maths/tension.h"
#include "maths/torque.h"
#include "maths/wrench.h"
#include "motley/core/joint_report.h"
#include "scene/joint_checks.h"
#include "scene/joint_pose.h"
#include "stores/body_store.h"

namespace motley {

/// What most types are. A type inherits this and says where it differs.
struct ConstraintTraits {
    /// Comes as a list each step, and not from a store: only the types of contact.h.
    static constexpr bool is_contact = false;
    static constexpr bool has_restitution = false;
    /// Not for particles, which have no axes.
    static constexpr bool needs_bodies_that_turn = false;
    /// Few scenes have many of it: AVX-512 then runs it in lanes of AVX2, SSE2 in scalar ones; between bodies of which none is
    /// rigid every instruction set does.
    static constexpr bool is_rare = false;
    /// Is a force: its distance from its target does not count as an error of the scene.
    static constexpr bool only_pulls = false;
    /// Pulls at the ends of arms, so that heavy loads make them stiff: has tension().
    static constexpr bool pulls_at_arms = false;
    /// Has angular impulses, of which light bodies bear only so many: has torque() and scale(). See torque.h.
    static constexpr bool has_torque = false;
    /// Has angular rows beside the locks of exact joints: has lengthen_step().
    static constexpr bool turns_about_points = false;
    /// Is defined by points of the world: has world_points(definition), and start.from_world_points().
    static constexpr bool has_world_points = false;
    /// Of types with a limit or motor that exact joints may hold: see equality_row.h. Such a type has act() and
    /// SubstepRow::effective_mass, and the first Real of Impulse is the impulse of the limit. With `has_motor` the next two are
    /// those of the motor and the spring, then come the change of the rotor's speed in the substep and that speed, and SubstepRow
    /// has spring_effective_mass and spring_kept.
    static constexpr ActiveRow active_row = ActiveRow::none;
    static constexpr bool has_motor = false;
    /// Rows of J that exact joints may lock.
    static constexpr int equality_count = 0;
    /// The first three of them hold a point on a point along x, y and z, and the others are only angular.
    static constexpr bool locks_point = false;

    /// Whether a joint of this definition locks its rows: exact joints then solve it.
    template <class Definition>
    static bool is_equality(const Definition&)
    {
        return false;
    }
    /// Of a joint with a rotor of inertia I_r, which exact joints hold (see equality_row.h): K I_r, by how many times the rotor is
    /// heavier than what it turns, with the response K of the two bodies alone. Else 0.
    template <class Definition>
    static float rotor_load(const Definition&, const BodyStore&)
    {
        return 0;
    }
    /// Whether a body that it ties to the world can never fly freely.
    template <class Definition>
    static bool locks_place(const Definition&)
    {
        return false;
    }
    /// Of types without a substep row.
    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row&, const Impulse&, Substep&, const A&, const B&)
    {
    }
    /// Of types that hold no position.
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row&, A&, B&)
    {
    }
};

/// What prepare() may ask of the start of a step, in addition to the bodies. Only what is asked for is computed.
template <class Start, class Real, BodyKind a, BodyKind b>
concept StepStart = requires(const Start& start, const LaneBody<Real, a>& body_a,
                             const LaneBody<Real, b>& body_b)
{
    {
        start.step()
        } -> std::same_as<const StepConstants&>;
    {
        start.pose()  // of the two bodies
        } -> std::same_as<JointPose<Real, a, b>>;
    {
        start.from_world_points()  // with has_world_points
        } -> std::same_as<FromWorldPoints<Real>>;
    {
        start.acceleration(body_a, body_b)  // of b relative to a by forces and gravity alone, m/s2
        } -> std::same_as<Vec3<Real>>;
    {
        start.surface()  // of body a, of contacts that bounce
        } -> std::same_as<ContactSurface<Real>>;
};

/// What JointStore requires of a joint type.
template <class Type>
concept JointType = std::is_base_of_v<ConstraintTraits, Type> &&
    requires(const typename Type::Definition& definition, const typename Type::template Memory<float>& memory,
             const JointBodies& bodies, const BodyState& state)
{
    definition.body_a;
    definition.body_b;
    Type::validate(definition, bodies);
    {
        Type::parameters(definition)
        } -> std::same_as<typename Type::template Parameters<float>>;
    {
        Type::report(definition, memory, state, state)
        } -> std::same_as<JointReport>;
};

/// What a kernel requires of a type for bodies of kinds `a` and `b` in lanes of `Real`.
template <class Type, class Start, class End, class Real, BodyKind a, BodyKind b>
concept ConstraintType = StepStart<Start, Real, a, b> && std::is_base_of_v<ConstraintTraits, Type> &&
    requires(const Start& start, const End& end, const StepConstants& step,
             const typename Type::template Parameters<Real>& parameters,
             const typename Type::template Memory<Real>& memory,
             const typename Type::template Row<Real, a, b>& row,
             typename Type::template SubstepRow<Real, a, b>& substep,
             const typename Type::template SubstepRow<Real, a, b>& built,
             typename Type::template Impulse<Real, a, b>& impulse, LaneBody<Real, a>& body_a,
             LaneBody<Real, b>& body_b, const LaneBody<Real, a>& at_a, const LaneBody<Real, b>& at_b)
{
    {
        Type::prepare(start, parameters, memory, at_a, at_b, impulse)
        } -> std::same_as<typename Type::template Row<Real, a, b>>;
    Type::template prepare_substep<Real>(row, impulse, substep, at_a, at_b);
    Type::template warm_start<Real>(row, built, impulse, body_a, body_b);
    Type::template project<Real>(step, row, body_a, body_b);
    {
        Type::template remember<Real>(row, impulse, end)
        } -> std::same_as<typename Type::template Memory<Real>>;
};

}  // namespace motley
