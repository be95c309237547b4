// Batches: coloured constraints sorted into blocks of sixteen lanes, and cut into chunks of work for the threads.
//
// This is a counting sort in two passes over chunks of constraints, which any number of threads may share. The first
// pass counts how many constraints of each class and colour a chunk has; the counts say where each chunk's
// constraints begin. The second pass writes each constraint into its lane. The blocks of one colour are consecutive
// in memory, and so are their streams, so a sweep reads memory from front to back. The blocks of the patches come
// after them; each patch has colours of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/kernel_table.h"
#include "layout/colouring.h"
#include "stores/aligned_vector.h"

namespace motley {

/// Where a constraint belongs.
struct Placement {
    BodyRow a, b;
    std::int32_t constraint = 0;  ///< index in the list or store of its type
    std::uint8_t type = 0;
    std::uint8_t colour = no_colour;
    bool in_patch : 1 = false;   ///< the constraint is inside a patch: see Patches
    bool in_figure : 1 = false;  ///< a contact that a figure in lockstep solves: see Figures
    bool is_bad : 1 = false;     ///< a contact that failed the checks: it is left out
    /// A padding lane: `constraint` holds the bitwise complement of the index of a valid constraint, whose parameters
    /// the lane copies.
    [[nodiscard]] bool is_gap() const { return constraint < 0; }
    [[nodiscard]] bool is_left_out() const { return colour == left_out_colour; }
};

inline constexpr std::int32_t several_islands = -1;

/// Blocks begin ... end - 1 of one class and colour: the unit of work of a sweep.
struct SweepChunk {
    const ConstraintKernels* kernels;
    BlockStreams streams;
    std::int32_t begin, end;
    int type;
    BodyKind kind_a, kind_b;
    /// One entry per block, and null unless blocks are told apart (see BlockMarks). `finished`: 1 when no island
    /// of the block needs more sweeps. `islands`: the island of all its constraints, or several_islands. `wanted`:
    /// how many sweeps the host wants at least; 0 where it asked for none.
    std::uint8_t* finished = nullptr;
    std::int32_t* islands = nullptr;
    std::int32_t* wanted = nullptr;
};

/// By what blocks are told apart where sweeps are measured, or islands want different numbers of them.
struct BlockMarks {
    static constexpr std::size_t residuals_a_block = 2 * block_lanes;
    AlignedVector<float> residuals;
    AlignedVector<std::uint8_t> finished;
    AlignedVector<std::int32_t> islands, wanted;
    void make_room(std::size_t blocks);
    /// Points a chunk at these marks, where its block 0 is `first_block`.
    void mark(SweepChunk& chunk, std::size_t first_block);
};

/// The unit of work of prepare and store: a few blocks of each class and colour, from about the same stretch of the
/// host's list, so that its cache lines serve all colours.
struct TransferTile {
    struct Part {
        const ConstraintKernels* kernels;
        BlockStreams streams;
        int type;
        std::int32_t begin, end;
    };
    std::int32_t first_part, last_part;
};

/// Calls work(first, last) for each run of consecutive numbers in [begin, end) for which `takes` returns true.
template <class Takes, class Work>
void for_each_run(std::int32_t begin, std::int32_t end, const Takes& takes, const Work& work)
{
    for (std::int32_t next = begin; begin < end; begin = next) {
        while (begin < end && !takes(begin)) ++begin;
        for (next = begin; next < end && takes(next);) ++next;
        if (begin < next) work(begin, next);
    }
}
/// Calls work(first, last) for each piece of at most `most` numbers of [begin, end).
template <class Work>
void for_each_piece(std::int32_t begin, std::int32_t end, std::int32_t most, const Work& work)
{
    for (; begin < end; begin += most) work(begin, std::min(begin + most, end));
}
/// The same in pieces of about equal size. There is one piece, or a multiple of four, so that two or four threads get
/// equal shares and the shares of every colour and of the bodies end at about the same bodies. Pieces end at
/// multiples of `unit`.
template <int unit, class Work>
void for_each_even_piece(std::int32_t begin, std::int32_t end, std::int32_t most, const Work& work)
{
    const std::int64_t size = end - begin, pieces = size <= most ? 1 : (size + 4 * most - 1) / (4 * most) * 4;
    const std::int64_t first = begin;
    for (std::int64_t piece = 1; piece <= pieces; ++piece) {
        const auto last =
            piece == pieces ? end : static_cast<std::int32_t>((first + size * piece / pieces) / unit * unit);
        work(begin, last);
        begin = last;
    }
}

/// The chunks of one patch, colour after colour: the unit of work of a sweep in cache.
struct PatchChunks {
    std::int32_t first, last;
};
/// What a sweep runs over: chunks of each colour, of the overflow, and those of the patches.
struct SweepLists {
    static constexpr int patch_list = parallel_colours + 1;
    std::array<Array<SweepChunk>, patch_list + 1> lists;
    Array<PatchChunks> patches;
    std::uint32_t colours = 0;  ///< a bit for each colour in use, inside patches or outside

    [[nodiscard]] std::span<const SweepChunk> of_colour(int colour) const
    {
        return lists[static_cast<std::size_t>(colour)];
    }
    [[nodiscard]] std::span<const SweepChunk> of_patch(std::int64_t patch) const
    {
        const PatchChunks& range = patches[static_cast<std::size_t>(patch)];
        return {lists[patch_list].data() + range.first, lists[patch_list].data() + range.last};
    }
    void add(int colour, const SweepChunk& chunk)
    {
        lists[static_cast<std::size_t>(colour)].push_back(chunk);
        if (colour != overflow_colour) colours |= 1U << colour;
    }
    void add_to_patch(int colour, const SweepChunk& chunk)
    {
        lists[patch_list].push_back(chunk);
        colours |= 1U << colour;
    }
    /// Closes the patch that began at `first_chunk`. It may be empty.
    void close_patch(std::int32_t first_chunk) { patches.push_back({first_chunk, patch_chunks()}); }
    /// All chunks of all lists, numbered one after another: for callers that treat each chunk by itself, in any
    /// order.
    [[nodiscard]] std::int64_t chunk_count() const
    {
        std::size_t count = 0;
        for (const auto& chunks : lists) count += chunks.size();
        return static_cast<std::int64_t>(count);
    }
    [[nodiscard]] const SweepChunk& chunk(std::int64_t i) const
    {
        auto left = static_cast<std::size_t>(i);
        const auto* list = lists.data();
        for (; left >= list->size(); ++list) left -= list->size();
        return (*list)[left];
    }
    [[nodiscard]] std::int32_t patch_chunks() const
    {
        return static_cast<std::int32_t>(lists[patch_list].size());
    }
    void clear()
    {
        for (auto& chunks : lists) chunks.clear();
        patches.clear();
        colours = 0;
    }
};
/// All chunks that a step sweeps.
struct SweptChunks {
    const SweepLists& lists;
    std::span<const SweepChunk> discs;
    /// Calls visit(chunk) for each, always in the same order.
    template <class Visit>
    void for_each(const Visit& visit) const
    {
        for (const auto& chunks : lists.lists) {
            for (const SweepChunk& chunk : chunks) visit(chunk);
        }
        for (const SweepChunk& chunk : discs) visit(chunk);
    }
};
struct TransferList {
    Array<TransferTile::Part> parts;
    Array<TransferTile> tiles;
    /// Makes a tile of the parts from `first_part` on, if there are any.
    void close_tile(std::int32_t first_part)
    {
        const auto last_part = static_cast<std::int32_t>(parts.size());
        if (first_part < last_part) tiles.push_back({first_part, last_part});
    }
};

/// The blocks of the types [first_type, last_type), by class and colour.
class BatchSet {
  public:
    BatchSet(int first_type, int last_type);

    /// Starts over with these constraints, which must stay where they are until fill() is done. With patches, every
    /// chunk is one patch.
    void begin(std::span<const Placement> placements, bool has_patches);
    [[nodiscard]] std::int64_t chunk_count() const;
    /// Counts the constraints of a chunk. Chunks may run on different threads.
    void count(std::int64_t chunk);
    /// After all chunks are counted: makes space for the blocks, and puts the overflow into its blocks, in order.
    /// `adds_up`: with space for sums over several substeps. `spare`: with blocks for constraints that come later.
    void open(const KernelTable& kernels, bool adds_up, bool spare);
    /// Puts the constraints of a chunk into their lanes. Chunks may run on different threads, unless there are
    /// padding lanes among them (Placement::is_gap).
    void fill(std::int64_t chunk);

    /// Block number `nth` of a class and colour. Pointers stay valid until the next begin().
    struct Block {
        BlockStreams streams;
        std::int32_t index;
        std::uint8_t* skipped;  ///< from which chunks the next cut() leaves it out: see below
    };
    static constexpr std::uint8_t skip_nothing = 0, skip_sweeps = 1, skip_altogether = 2;
    [[nodiscard]] Block block(int constraint_class, int colour, std::int32_t nth);

    /// A lane of a block without overflow. Once the blocks are filled, constraints may come and go one by one, unless there
    /// are patches: those of a class and colour that are in no figure have the last lanes of it, without gaps.
    struct Lane {
        std::int32_t constraint_class = -1, block = 0;
        std::uint8_t lane = 0, colour = no_colour;
        friend bool operator==(const Lane&, const Lane&) = default;
    };
    [[nodiscard]] bool has_overflow() const;
    [[nodiscard]] Placement placement_in(const Lane& lane) const;
    /// The constraint in a lane has this index in its store now.
    void set_constraint(const Lane& lane, std::int32_t constraint);
    /// The first lane of a class and colour that is free, for put(); none if there are no spare blocks left.
    [[nodiscard]] std::optional<Lane> take_free_lane(int constraint_class, std::uint8_t colour);
    /// The last lane that is not free, for end_block_at(), when what was in it has been put elsewhere.
    [[nodiscard]] Lane give_last_back(int constraint_class, std::uint8_t colour);
    /// Puts a constraint into a lane: one in use, or the first lane behind those in use.
    void put(const Lane& lane, const Placement& placement);
    /// Makes this lane and those behind it padding.
    void end_block_at(const Lane& lane);
    /// Calls visit(class, colour, block, bodies, constraints, lanes in use) for each block without overflow.
    template <class Visit>
    void for_each_block(const Visit& visit) const
    {
        for (const std::size_t p : used_) {
            const Pool& pool = pools_[p];
            for (std::uint8_t colour = 0; colour < parallel_colours; ++colour) {
                for (std::int32_t block = pool.first_block[colour]; block < pool.first_block[colour + 1U];
                     ++block) {
                    const auto b = static_cast<std::size_t>(block);
                    visit(first_class_ + static_cast<int>(p), colour, block, pool.bodies[b], pool.who[b],
                          int{pool.counts[b]});
                }
            }
        }
    }

    /// Appends this set's chunks to the lists. `tells_apart`: with space for the residuals, the islands and the
    /// wanted number of sweeps of each block. Pointers in them stay valid until the next begin().
    void cut(const KernelTable& kernels, bool tells_apart, SweepLists& sweeps, TransferList& transfers);

    /// What a report counts.
    struct Count {
        std::int64_t blocks = 0, constraints = 0, overflow = 0;
        double streamed_bytes = 0;  ///< by one sweep of solve

        void add_blocks(const ConstraintKernels& kernels, std::int64_t new_blocks,
                        std::int64_t new_constraints)
        {
            blocks += new_blocks;
            constraints += new_constraints;
            const int floats = kernels.swept_floats + kernels.impulse_floats + 2;  // two body indices
            streamed_bytes += 4.0 * floats * static_cast<double>(new_constraints);
        }
        void operator+=(const Count& other)
        {
            blocks += other.blocks;
            constraints += other.constraints;
            overflow += other.overflow;
            streamed_bytes += other.streamed_bytes;
        }
    };
    [[nodiscard]] Count count(const KernelTable& kernels) const;
    [[nodiscard]] bool has_blocks() const { return !used_.empty(); }
    [[nodiscard]] bool adds_up() const { return adds_up_; }
    [[nodiscard]] std::span<const Placement> placements() const { return placements_; }

  private:
    static constexpr int colours = parallel_colours + 1;
    struct Pool {
        AlignedVector<BlockBodies> bodies;
        AlignedVector<BlockConstraints> who;
        AlignedVector<std::uint8_t> counts, skipped;
        AlignedVector<float> rows, substep_rows, impulses, sums;
        BlockMarks marks;                                          ///< only when blocks are told apart
        std::array<std::int32_t, colours + 1> first_block{};       ///< of each colour, and one past the last
        std::array<std::int32_t, parallel_colours> constraints{};  ///< of each colour
        std::int64_t overflow = 0;
        std::int32_t all_blocks = 0;  ///< including those of patches, which come last
        [[nodiscard]] std::uint8_t skips(std::int32_t block) const
        {
            return skipped[static_cast<std::size_t>(block)];
        }
        void make_room(std::int32_t blocks);
        void set_spare_aside();
        void set_lane(std::size_t block, int lane, const Placement& placement)
        {
            bodies[block].a[lane] = offset_of(placement.a);
            bodies[block].b[lane] = offset_of(placement.b);
            who[block].lane[lane] = placement.constraint;
        }
        void pad(std::size_t block, int first, std::int32_t constraint);
        void leave_gap(std::size_t block, int lane, std::int32_t constraint);
        [[nodiscard]] bool holds(std::size_t block, BodyRow a, BodyRow b) const;
    };

    int first_class_;
    Array<Pool> pools_;           ///< by class, from first_class_ on
    Array<std::uint8_t> occurs_;  ///< by class: 1 when a chunk has constraints of it
    Array<std::size_t> used_;     ///< classes with blocks, so that a step skips hundreds of empty ones
    std::span<const Placement> placements_;
    std::size_t per_chunk_ = 1;
    /// For each chunk, and in it for each class and colour: first the number of constraints, then the next free place
    /// of the colour.
    Array<std::int32_t> places_;
    /// The same for chunks that are patches. `patch_places_`: the number of constraints, then the next free place,
    /// counted in lanes of the class's blocks. `patch_blocks_`: the first block. A patch has no overflow, so the
    /// entry of the overflow colour marks the end of the class's blocks.
    Array<std::int32_t> patch_places_, patch_blocks_;
    bool has_patches_ = false, adds_up_ = false;

    [[nodiscard]] std::size_t pool_of(int constraint_class) const
    {
        return static_cast<std::size_t>(constraint_class - first_class_);
    }
    [[nodiscard]] Lane end_of(int constraint_class, std::uint8_t colour) const;
    [[nodiscard]] std::size_t keys() const { return pools_.size() * colours; }
    [[nodiscard]] std::size_t key_of(const Placement& placement) const
    {
        const int pool = class_of(placement.type, placement.a.kind(), placement.b.kind()) - first_class_;
        return static_cast<std::size_t>(pool * colours + placement.colour);
    }
    /// A chunk's part of a table with an entry for each chunk, class and colour.
    [[nodiscard]] std::span<std::int32_t> of_chunk(Array<std::int32_t>& table, std::int64_t chunk) const
    {
        return std::span(table).subspan(static_cast<std::size_t>(chunk) * keys(), keys());
    }
    [[nodiscard]] std::span<const Placement> placements_of(std::int64_t chunk) const;
    void place_overflow();
    [[nodiscard]] std::array<std::int32_t, colours> add_up(std::size_t p);
    void open_patches(std::size_t p);
    void finish_patch(std::int64_t chunk);
    void cut_patches(const KernelTable& kernels, bool tells_apart, SweepLists& sweeps,
                     TransferList& transfers);
    [[nodiscard]] BlockStreams streams(std::size_t pool);
    [[nodiscard]] SweepChunk sweep_chunk(const KernelTable& kernels, std::size_t pool, std::int32_t begin,
                                         std::int32_t end, bool tells_apart);
    [[nodiscard]] TransferTile::Part transfer_part(const KernelTable& kernels, std::size_t pool,
                                                   std::int32_t begin, std::int32_t end);
};

}  // namespace motley
