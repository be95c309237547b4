// What a type of joint is: the page to read before writing one.
//
// A joint is two files beside constraints/ball_socket.h, the plainest example: what a host says of it
// (x_definition.h, a struct with the two bodies, fields with units and defaults), and its maths (x.h, a struct as below).
// x.h ends with the list of its types, `using XTypes = TypeList<X>;`, whose name is then put into constraint_types.h, and
// x_definition.h into joint_definitions.h, and that is all: storage, handles, colouring, blocks,
// kernels of every instruction set and pair of bodies, reports and break limits follow from the list. Beside it go its
// formulas in double in core/reference/joint_models.cpp, and its cases in tests/joint_cases.h, without which the tests over
// the type list do not compile.
//
//   using Definition = ...;                                     what the host says
//   static constexpr bool has_restitution, recomputes_each_substep;
//   static constexpr bool needs_bodies_that_turn = true;        if particles make no sense
//   static constexpr bool is_rare = true;                       if few scenes have it: AVX-512 then runs it in lanes of AVX2, SSE2 in
//                                                             scalar ones
//   locks_place(definition) -> bool        if what it ties to the world can never fly freely
//   static constexpr bool only_pulls = true;                    if it is a force: its C is then no error of the scene
//   template <class Real> struct Parameters, Memory;            per joint: of the definition; from step to step
//   template <class Real, BodyKind a, BodyKind b>
//   struct Row, SubstepRow, Impulse;                            per joint in lanes: of a step; of a substep; accumulated
//
// What a sweep reads of a row is its member in_sweep; of a row without one all, or nothing if there is a substep row.
// All five are nothing but Reals, in line: Row<float> is one joint, Row<Lanes> a bundle. The functions are written once
// for every Real and every pair, with the operations of scalar.h, lane_body.h and wrench.h, and never branch on a lane:
//
//   validate(definition, bodies)          throws InvalidInput: field, value, valid range (joint_checks.h)
//   parameters(definition)                in the units of the lanes
//   prepare(step, parameters, memory, pose, a, b, impulse&) -> Row      once a step
//                                         with has_restitution: (..., memory, acceleration, pose, ...), of b beside a
//   tension<Real>(row, impulse) -> Tension                              if it pulls at the end of an arm: see tension.h
//   warm_start<Real>(step, row, substep&, impulse, a&, b&)              J and K^-1 where the bodies are now; J^T lambda
//   solve<Real>(step, swept row, substep, impulse&, a&, b&)             one sweep, as soft as `step` says: rigid to relax
//   project<Real>(step, row, substep, a&, b&)                           positions along J^T
//   remember<Real>(row, impulse) -> Memory                              or (row, impulse, a, b), to look at the bodies
//   wrench<Real>(row, substep, impulse) -> Wrench                       what the impulse is on b where it acts
//   report(definition, memory, state_a, state_b)                        errors and state, in double
//   equality_count, locks_point, is_equality(definition), equality_rows<Real>(row, a, b, rows*)
//                                         if it locks: its J and C row by row, for SolverSettings::exact_joints;
//                                         locks_point: three rows of a point along x, y and z, then others of turning alone
//   world_points(definition) -> WorldPoints                             if it has any; prepare then gets a WorldPose
#pragma once

#include <concepts>

#include "motley/core/body_store.h"
#include "motley/core/joint_checks.h"
#include "motley/core/joint_report.h"

namespace motley {

/// The part of the above that a compiler can ask for before a kernel is made; the rest it asks for there.
template <class Type>
concept JointType = requires(const typename Type::Definition& definition,
                             const typename Type::template Memory<float>& memory, const JointBodies& bodies,
                             const BodyState& state)
{
    definition.body_a;
    definition.body_b;
    {
        Type::has_restitution
        } -> std::convertible_to<bool>;
    {
        Type::recomputes_each_substep
        } -> std::convertible_to<bool>;
    typename Type::template Row<float, BodyKind::rigid, BodyKind::rigid>;
    typename Type::template SubstepRow<float, BodyKind::rigid, BodyKind::rigid>;
    typename Type::template Impulse<float, BodyKind::rigid, BodyKind::rigid>;
    Type::validate(definition, bodies);
    {
        Type::parameters(definition)
        } -> std::same_as<typename Type::template Parameters<float>>;
    {
        Type::report(definition, memory, state, state)
        } -> std::same_as<JointReport>;
};

}  // namespace motley
