// The table of kernels that run over blocks of sixteen lanes (stores/lane_block.h). A block is of one constraint type
// and one pair of body kinds.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "maths/contact_surface.h"
#include "maths/step_constants.h"
#include "motley/soa/isa.h"
#include "scene/joint_pose.h"
#include "stores/disc_class.h"
#include "stores/lane_block.h"

namespace motley {

/// The most floats that a type may have in its Impulse.
inline constexpr int most_impulse_floats = 32;
/// The most floats that a body has per lane.
inline constexpr int most_body_floats = 20;

/// The constraints of a block: their indices in the list or store of the type.
struct alignas(64) BlockConstraints {
    std::int32_t lane[block_lanes];
};

/// Everything that a kernel reads and writes of one type and pair: blocks, and their streams of floats. Stream s of
/// block k starts at s + k * floats * 16; a field of a row is sixteen consecutive floats.
struct BlockStreams {
    BodyKind kind_a{}, kind_b{};  ///< of the bodies
    const BlockBodies* bodies = nullptr;
    const std::uint8_t* counts = nullptr;           ///< lanes of each block that are not padding
    const BlockConstraints* constraints = nullptr;  ///< read by prepare and store only
    float* rows = nullptr;                          ///< constant through a step
    float* substep_rows = nullptr;                  ///< made by warm_start each substep
    float* impulses = nullptr;
    float* sums = nullptr;       ///< over the substeps so far; null for contacts of a single substep
    float* residuals = nullptr;  ///< energies and speeds of LaneResidual; null unless they are measured
    /// Of contacts of copies: above 0 in lanes that have one, else 0; sixteen floats a block. Else null.
    const float* present = nullptr;
};

/// Where definitions and remembered impulses of a type lie, one entry per constraint.
struct ConstraintData {
    const float* parameters = nullptr;
    std::int64_t parameter_stride = 0;  ///< floats
    const float* memory_in = nullptr;
    const std::int32_t* memory_index =
        nullptr;                     ///< entry of memory_in by constraint; null: the constraint's own
    float* memory_out = nullptr;     ///< by constraint
    std::int64_t memory_stride = 0;  ///< floats
    float* step_out =
        nullptr;  ///< by constraint, the sum over all substeps: a Wrench for joints, for contacts as in memory_out
    std::int64_t step_stride = 0;               ///< floats
    const WorldPoints* world_points = nullptr;  ///< by constraint; null for types without
    const std::uint8_t* exchanged = nullptr;    ///< by contact: see ContactIntake; null for joints
    /// Of contacts from `first_surface` on; those before it, or all if it is null, have the default surface.
    const ContactSurface<float>* surfaces = nullptr;
    std::int32_t first_surface = 0;
};

/// A bit of a body's mask of joints, beside those of the colours and of the overflow: a joint whose rows are made once a
/// step, and not once a substep, acts on the body.
inline constexpr std::uint32_t start_rows_bit = 1U << 31;

/// Rows of one kind as the kernels see them.
struct BodyArrays {
    BodyKind kind{};
    float* velocity = nullptr;
    float* delta = nullptr;
    float* unpushed = nullptr;
    float* start_along = nullptr;  ///< see Flight, like is_jointed
    const std::uint8_t* is_jointed = nullptr;
    const std::uint32_t* joint_colours = nullptr;  ///< rigid bodies, by row, of their joints: see ColourMasks
    std::atomic<bool>* turned_far = nullptr;       ///< rigid bodies: see KernelContext
    const float* acceleration = nullptr;
    /// As velocity: by what a substep multiplies each component, and last in each row's first quad whether free flight
    /// keeps to its parabola (1 or 0). Null unless a body of the kind is damped.
    const float* decay = nullptr;
    float* world_inverse_inertia = nullptr;
    float* start_inverse_inertia = nullptr;
    const Sym3<float>* inverse_inertia = nullptr;  ///< in the body's frame
    BodyPose* pose = nullptr;
    Quat<PoseReal>* orientation = nullptr;
    std::int32_t size = 0;
    bool can_move = false;  ///< if false, kernels read these rows and never write them
};

/// Whether sweeps of solve and relax note each constraint's LaneResidual.
enum class Measure {
    nothing,
    while_solving,    ///< of what the sweep changes
    without_solving,  ///< of what a sweep would change; velocities and impulses stay as they are
};

/// A warm start without a sweep: as a substep begins, each body gets again the velocity change that its constraints
/// made in the last substep. Exact where M^-1 J^T is constant through the step (contacts of particles and planar
/// bodies); M is the mass matrix, J the Jacobian.
enum class Replay {
    nothing,
    next_time,     ///< only stores the velocities before any constraint acts
    last_substep,  ///< applies the change of the last substep, and stores again
};

struct KernelContext {
    StepConstants step;
    StepConstants relaxing;  ///< the same for sweeps that relax
    Measure measure = Measure::nothing;
    Replay replay = Replay::nothing;
    /// Contacts of discs need not be measured by `solve`: `prepare` has measured them, and after it every `relax`.
    bool discs_are_measured = false;
    bool bodies_are_far = false;  ///< they exceed a core's cache: sweeps prefetch those of the next block
    int width = 1;                ///< lanes of the kernels that sweep; those that prepare may be narrower
    BodyArrays bodies[body_kind_count];
    float largest_response = 0;  ///< 1/(kg m2): see BodyStore
    /// Set by prepare where a joint pulls harder than a substep can follow: then `stiffen` must be run. See
    /// tension.h.
    std::atomic<bool>* overloaded = nullptr;
    /// Set where bodies move: in this step a rigid body has turned so far that contacts have to look whether their
    /// responses have changed. See contact.h.
    std::atomic<bool>* turned_far = nullptr;
};

/// The kernels of one type and pair: each runs over blocks begin ... end - 1.
struct ConstraintKernels {
    using Sweep = void (*)(const KernelContext&, const BlockStreams&, std::int32_t begin, std::int32_t end);
    using Transfer = void (*)(const KernelContext&, const BlockStreams&, const ConstraintData&,
                              std::int32_t begin, std::int32_t end);
    Transfer prepare = nullptr;  ///< definitions and memory -> rows and impulses
    /// Increases, for this step, the inertia of bodies under heavy load (tension.h). Null for types that pull at no
    /// lever arm.
    Sweep stiffen = nullptr;
    Sweep warm_start = nullptr;
    Sweep solve = nullptr;
    Sweep relax = nullptr;
    Sweep restitute = nullptr;  ///< null for types that do not bounce
    Sweep project = nullptr;
    Sweep add_up = nullptr;    ///< adds the impulses of a finished substep to the sums
    Transfer store = nullptr;  ///< impulses and sums -> memory

    /// The same over one block whose lanes are copies of a figure, with body a and body b already in lanes (see
    /// CopyBody). Null for pairs with a particle or planar body, for joints that bounce, and for contacts of two
    /// moving bodies. Contacts change nothing in lanes that have none (see BlockStreams::present).
    using CopiesSweep = void (*)(const KernelContext&, const BlockStreams&, std::int32_t block, float* body_a,
                                 float* body_b);
    CopiesSweep stiffen_copies = nullptr;
    CopiesSweep warm_start_copies = nullptr;
    CopiesSweep solve_copies = nullptr;
    CopiesSweep relax_copies = nullptr;
    CopiesSweep restitute_copies = nullptr;
    /// Writes EqualityRows, `equality_count` of them, sixteen floats a field. Null for types that lock nothing.
    using CopiesRows = void (*)(const BlockStreams&, std::int32_t block, const float* body_a,
                                const float* body_b, float* rows);
    CopiesRows equality_rows = nullptr;
    int equality_count = 0;
    /// The fields of these names of an ActingRow and its row, sixteen floats each. `rotor` is null in figures without rotors, whose
    /// `give` is at `give_of_all`.
    struct SoftLanes {
        float *give_of_all, *give, *rotor, *given, *speed, *least, *most;
    };
    /// Finds out what acts on the row of a limit, motor or spring, and writes its EqualityRow (0 where nothing does), with the
    /// speed that is left (speed - given), its ActsBy and SoftLanes, sixteen floats a field. What lets go is added to `taken_a`
    /// and `taken_b`, the six impulses on the bodies; null of fixed ones. Given `only`, nothing but the row is changed in lanes
    /// where that is 0. Null for types without such a row.
    void (*act)(const KernelContext&, const BlockStreams&, std::int32_t block, const float* body_a,
                const float* body_b, float* row, float* by, const SoftLanes& soft, float* taken_a,
                float* taken_b, const float* only) = nullptr;
    /// After warm_start: leaves the rows on which something acts to the tree.
    void (*set_aside)(const BlockStreams&, std::int32_t block, const float* by) = nullptr;
    int active_impulses = 0;  ///< how many impulses such a row has: see ConstraintTraits::active_row
    /// After warm_start, where the two bodies are held together at the point with these arms (three fields of sixteen floats):
    /// see locked_point.h. Null for types without such rows.
    void (*lengthen_steps)(const BlockStreams&, std::int32_t block, const float* body_a, const float* body_b,
                           const float* arm_a, const float* arm_b) = nullptr;

    int row_floats = 0, substep_floats = 0, impulse_floats = 0, sum_floats = 0;
    int swept_floats = 0;  ///< of row and substep row, those that a sweep reads
};

/// The kernels of one kind of body, over rows begin ... end - 1.
struct BodyKernels {
    using Move = void (*)(const KernelContext&, std::int32_t begin, std::int32_t end);
    Move integrate_velocities = nullptr;  ///< null for fixed bodies
    Move begin_velocities = nullptr;      ///< the same for the first substep: also stores Flight::start_along
    Move integrate_positions = nullptr;
    Move integrate_on = nullptr;  ///< positions, then the velocities of the next substep, in one pass
    /// Integrates the positions of `count` bodies of this kind, in any rows. Null for fixed bodies.
    void (*integrate_listed)(const KernelContext&, const BodyRow* rows, std::int32_t count) = nullptr;
    /// BodyStore::commit of sixteen rows from `first` on. Returns false and does nothing unless each row is a body
    /// that can move and whose state is finite. Null for fixed bodies.
    bool (*commit)(const KernelContext&, std::int32_t first) = nullptr;
    // For sixteen bodies, see watched_sweep.h:
    /// Copies the bodies into at most most_body_floats fields of sixteen floats.
    void (*keep)(const BodyArrays&, const std::int32_t* offsets, float* kept) = nullptr;
    /// dv^T M dv, J, of the velocity change dv since keep() (M: mass matrix), and the inverse mass, 1/kg.
    void (*find_energy)(const BodyArrays&, const std::int32_t* offsets, const float* kept, float* energy,
                        float* inverse_mass) = nullptr;
    /// Restores the kept velocities of the first `count` bodies. Null for fixed bodies.
    void (*bring_back)(const BodyArrays&, const std::int32_t* offsets, const float* kept,
                       int count) = nullptr;
};

struct FigureBlock;
/// The kernels of a figure's bodies, and of all its locks at once, over the copies of a block: see figure.h.
struct FigureKernels {
    using Move = void (*)(const KernelContext&, const FigureBlock&);
    Move load = nullptr;   ///< rows -> lanes
    Move store = nullptr;  ///< lanes -> rows: velocities and deltas
    Move load_velocities = nullptr;
    Move store_velocities = nullptr;
    Move integrate_velocities = nullptr;
    Move integrate_positions = nullptr;
    /// Factors the tree; after equality_rows of each lock. `only`: null, or a number for each copy, 0 for those whose bodies are
    /// pulled at as before.
    void (*factor)(const FigureBlock&, const float* only) = nullptr;
    /// Finds the copies whose light bodies are under much more tension in this substep than in the last one: FigureShape::exceeding,
    /// FigureNode::tension. `substep` is its length, s; `rate` as of solve().
    void (*follow_tension)(const FigureBlock&, float substep, float rate) = nullptr;
    /// Changes velocities v and impulses so that J v + rate C = 0 for every lock (J: Jacobian, C: position error).
    void (*solve)(const FigureBlock&, float rate) = nullptr;
    /// The same in copies where FigureShape::exceeding is not 0; the others keep their bits.
    void (*correct)(const FigureBlock&, float rate) = nullptr;
};

/// The kernels of contacts of discs. Their rows are made by prepare_smooth and prepare_rough of pairs, and by
/// place_walls() of walls; nothing is stored, because their blocks are the scene's.
struct DiscKernels {
    std::array<ConstraintKernels, disc_class_count> classes;
    ConstraintKernels::Sweep prepare_smooth = nullptr, prepare_rough = nullptr;
    [[nodiscard]] ConstraintKernels& of(DiscClass c) { return classes[static_cast<std::size_t>(c)]; }
    [[nodiscard]] const ConstraintKernels& of(DiscClass c) const
    {
        return classes[static_cast<std::size_t>(c)];
    }
};

/// A constraint type with a pair of body kinds: the key of batches and kernels.
constexpr int class_of(int type, BodyKind a, BodyKind b)
{
    return (type * body_kind_count + static_cast<int>(a)) * body_kind_count + static_cast<int>(b);
}
constexpr int type_of(int constraint_class)
{
    return constraint_class / (body_kind_count * body_kind_count);
}
constexpr BodyKind kind_a_of(int constraint_class)
{
    return static_cast<BodyKind>(constraint_class / body_kind_count % body_kind_count);
}
constexpr BodyKind kind_b_of(int constraint_class)
{
    return static_cast<BodyKind>(constraint_class % body_kind_count);
}

}  // namespace motley
