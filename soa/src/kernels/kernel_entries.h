// What each file of kernels defines for its instruction set: functions that enter its kernels into a table made
// elsewhere. A table made there would need a constructor, a weak function compiled for that instruction set, which
// the linker could pick for the whole program.
#pragma once

#include "layout/block.h"

namespace motley {

/// Kernels are compiled in four shares, optimised for speed or for size.
enum class KernelShare {
    swept,  ///< run in every substep, for usual pairs (see is_usual): for speed
    /// Run at the start and end of a step, for usual pairs: with AVX2 for speed, else for size; not with AVX-512 (once_lanes_of).
    once,
    unusual,  ///< run in every substep, for the other pairs: for speed; not on every instruction set (rare_lanes_of)
    rare,  ///< run only with some settings, or at the start and end for the other pairs: for size; likewise
};

/// Enters the kernels of the types of one constraint header, by pair of body kinds: `pairs` is indexed by class_of,
/// counted from the first of these types.
template <Isa isa, KernelShare share, class Types>
void enter_constraint_kernels(ConstraintKernels* pairs);
/// Enters the kernels that integrate bodies, that measure what sweeps change, and that load and store copies of
/// figures.
template <Isa isa>
void enter_body_kernels(BodyKernels* kinds, FigureKernels& figures);
/// Enters the kernels of contacts of discs.
template <Isa isa>
void enter_disc_kernels(DiscKernels& discs);
/// Enters FigureKernels::factor and solve.
template <Isa isa>
void enter_tree_kernels(FigureKernels& figures);

// ---- what the kernels of all constraints share: one copy an instruction set, in bundle_kernels.cpp --------------------
//
// They take lanes from memory and leave them there, as fields of as many consecutive floats as the instruction set computes at
// once, because the types of lanes are unknown outside a file of kernels.

/// Loads the first `quads` quads (four floats each) of one table entry per lane. (g++ would show a host the specialisations for a
/// public type whose parameters are all public: these two.)
template <Isa isa>
[[gnu::visibility("hidden")]] void gather_quads(const float* table, std::int64_t stride,
                                                const std::int32_t* index, int quads, float* fields);
/// The reverse. Impulses that are not finite are stored as 0: a contained body must not spoil the step that revives
/// it. Given `present`, only lanes in which it is above 0 are stored.
template <Isa isa>
[[gnu::visibility("hidden")]] void scatter_finite_quads(const float* fields, int quads, float* table,
                                                        std::int64_t stride, const std::int32_t* index,
                                                        int count, const float* present);

/// x_b - x_a, three fields, subtracted in the precision of poses and then narrowed.
template <Isa isa>
void find_between(const BodyArrays& a, const std::int32_t* offsets_a, const BodyArrays& b,
                  const std::int32_t* offsets_b, float* between);
/// The yaws of planar bodies, wrapped to +-pi: one field.
template <Isa isa>
void load_yaws(const BodyArrays& arrays, const std::int32_t* offsets, float* yaws);
/// The orientations of rigid or fixed bodies: four fields.
template <Isa isa>
void load_rotations(const BodyArrays& arrays, const std::int32_t* offsets, float* rotations);

/// Stores a changed inertia of moving bodies, from the fields of a LaneBody, for this step. Runs when the step begins, so that
/// nothing has rotated yet and both tensors are equal.
template <Isa isa>
void store_inertia_of(const BodyArrays& arrays, const std::int32_t* offsets, const float* fields, int count);
/// Stores the result of a position solve of moving bodies, likewise. Inertia and angular velocity rotate with the body, so that
/// moving it takes no energy from it and gives it none, and so that an inertia that rotate_again() kept stays close to
/// that of the rows.
template <Isa isa>
void store_displaced_of(const BodyArrays& arrays, const std::int32_t* offsets, const float* fields,
                        int count);

/// The bodies of a block of a joint between rigid bodies, of which one may be fixed, in lanes as those of copies: see CopyBody.
struct BlockCopies {
    alignas(64) float a[most_body_floats * block_lanes];
    alignas(64) float b[most_body_floats * block_lanes];
};
template <Isa isa>
void load_block(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                BlockCopies& bodies);
/// Fixed bodies are not written.
template <Isa isa>
void store_block_velocities(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                            const BlockCopies& bodies);

}  // namespace motley
