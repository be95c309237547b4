// Runs the parts of a substep in chunks on the worker threads.
#include "sweeper.h"

#include <algorithm>
#include <atomic>

#include "kernels/prefetch.h"
#include "step/watched_sweep.h"

namespace motley {
namespace {

/// Bodies per chunk: a few microseconds of streaming.
constexpr std::int64_t rows_per_chunk = BodyRows::rows_per_chunk;

}  // namespace

Sweeper::Sweeper(StageRunner& runner, Layout& layout)
    : runner_(runner), layout_(layout), workspaces_(static_cast<std::size_t>(runner.workers()))
{
}

void Sweeper::make_room()
{
    for (FigureWorkspace& workspace : workspaces_)
        workspace.make_room(layout_.figures, layout_.contact_tables());
}

void Sweeper::transfer(ConstraintKernels::Transfer ConstraintKernels::*kernel)
{
    const TransferList& transfers = layout_.transfers();
    runner_.run(static_cast<std::int64_t>(transfers.tiles.size()), [&](std::int64_t i) {
        const TransferTile& tile = transfers.tiles[static_cast<std::size_t>(i)];
        for (std::int32_t p = tile.first_part; p < tile.last_part; ++p) {
            const TransferTile::Part& part = transfers.parts[static_cast<std::size_t>(p)];
            const ConstraintData& data = layout_.data(part.type);
            for (std::int32_t block = part.begin; block < part.end; ++block) {
                if (block + 1 < part.end) prefetch_constraints(kernel, part.streams, data, block + 1);
                (part.kernels->*kernel)(layout_.context, part.streams, data, block, block + 1);
            }
        }
    });
}

void Sweeper::integrate(BodyKernels::Move BodyKernels::*kernel)
{
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const BodyKernels::Move move = layout_.kernels().bodies[kind].*kernel;
        if (move == nullptr) continue;
        const auto& ranges = layout_.rows(kind);
        runner_.run(static_cast<std::int64_t>(ranges.size()), [&](std::int64_t i) {
            const RowRange& range = ranges[static_cast<std::size_t>(i)];
            move(layout_.context, range.begin, range.end);
        });
    }
}

namespace {

void run_chunk(const KernelContext& context, const KernelTable& kernels, const SweepChunk& chunk,
               ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    const ConstraintKernels::Sweep sweep = chunk.kernels->*kernel;
    if (sweep == nullptr) return;
    const bool solves = kernel == &ConstraintKernels::solve || kernel == &ConstraintKernels::relax;
    const auto run = [&](std::int32_t begin, std::int32_t end) {
        if (solves && context.measure != Measure::nothing) {
            watched_sweep(context, kernels, chunk.streams, sweep, chunk.kernels->impulse_floats, begin, end);
        } else {
            sweep(context, chunk.streams, begin, end);
        }
    };
    if (at_least == Sweeper::every_block) {
        run(chunk.begin, chunk.end);
        return;
    }
    const auto runs = [&](std::int32_t block) {
        return chunk.finished[block] == 0 && (at_least == 0 || chunk.wanted[block] >= at_least);
    };
    for_each_run(chunk.begin, chunk.end, runs, run);
}

void run_chunks(const KernelContext& context, const KernelTable& kernels, std::span<const SweepChunk> chunks,
                ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    for (const SweepChunk& chunk : chunks) run_chunk(context, kernels, chunk, kernel, at_least);
}

}  // namespace

/// Whether a sweep leaves out a chunk because ExactContacts solves it. Measuring sweeps leave out nothing.
bool Sweeper::is_left_out(const SweepChunk& chunk, ConstraintKernels::Sweep ConstraintKernels::*kernel) const
{
    const bool solves = kernel == &ConstraintKernels::solve || kernel == &ConstraintKernels::relax;
    return leaves_out_contacts_ && solves && chunk.type < contact_type_count &&
           layout_.context.measure == Measure::nothing;
}

void Sweeper::run_unless_left_out(std::span<const SweepChunk> chunks,
                                  ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    for (const SweepChunk& chunk : chunks) {
        if (!is_left_out(chunk, kernel))
            run_chunk(layout_.context, layout_.kernels(), chunk, kernel, at_least);
    }
}

void Sweeper::sweep_beside_patches(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    // The overflow runs first and in order, so that the constraints of the colours are solved last.
    const SweepLists& sweeps = layout_.sweeps();
    run_unless_left_out(sweeps.of_colour(overflow_colour), kernel, at_least);
    for (int colour = 0; colour < parallel_colours; ++colour) {
        const std::span<const SweepChunk> chunks = sweeps.of_colour(colour);
        runner_.run(static_cast<std::int64_t>(chunks.size()), [&](std::int64_t i) {
            run_unless_left_out(chunks.subspan(static_cast<std::size_t>(i), 1), kernel, at_least);
        });
    }
}

void Sweeper::sweep_patches(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    const SweepLists& sweeps = layout_.sweeps();
    runner_.run(static_cast<std::int64_t>(sweeps.patches.size()),
                [&](std::int64_t patch) { run_unless_left_out(sweeps.of_patch(patch), kernel, at_least); });
}

void Sweeper::sweep(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    // Relaxation runs in the opposite order, so that a patch, solved last, can be moved and relaxed while it is in
    // cache.
    const bool patches_first = kernel == &ConstraintKernels::relax;
    if (patches_first) sweep_patches(kernel, at_least);
    sweep_beside_patches(kernel, at_least);
    if (!patches_first) sweep_patches(kernel, at_least);
    sweep_discs(kernel, at_least);
}

/// Band 0, then bands of odd number, then of even number. The order is that of solving also to relax: in the opposite
/// order a blow would be handed on from person to person less exactly, and p99 of overlaps would be a sixth larger.
void Sweeper::sweep_discs(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least)
{
    const std::int64_t bands = layout_.disc_bands();
    if (layout_.discs().empty() && region == nullptr) return;
    // The bodies of a band fit a core's first cache, and neighbours lie together.
    KernelContext at_hand = layout_.context;
    at_hand.bodies_are_far = false;
    const auto run = [&](std::int64_t band) {
        run_chunks(at_hand, layout_.kernels(), layout_.discs_of_band(band), kernel, at_least);
    };
    if (region != nullptr) return sweep_region(run);
    run(0);
    runner_.run(bands / 2, [&](std::int64_t i) { run(2 * i + 1); });
    runner_.run((bands - 1) / 2, [&](std::int64_t i) { run(2 * i + 2); });
}

/// Bands at the borders come first, so that velocities travel to the neighbours while the others are solved.
template <class Run>
void Sweeper::sweep_region(const Run& run)
{
    float* const velocities = layout_.context.bodies[static_cast<int>(BodyKind::planar)].velocity;
    const std::size_t first = region->first_band(), last = region->last_band();
    for (const std::size_t parity : {std::size_t{1}, std::size_t{0}}) {
        // The bands of this parity from `low` on, without the first and the last band of the region.
        const std::size_t low = first + 1 + ((first + 1) % 2 == parity ? 0 : 1);
        const std::size_t inner = low + 1 < last ? (last - low) / 2 : 0;
        if (first < last && first % 2 == parity) run(static_cast<std::int64_t>(first));
        if (first + 1 < last && (last - 1) % 2 == parity) run(static_cast<std::int64_t>(last - 1));
        region->send_velocities(velocities, parity);
        runner_.run(static_cast<std::int64_t>(inner),
                    [&](std::int64_t i) { run(static_cast<std::int64_t>(low) + 2 * i); });
        region->take_velocities(velocities, parity);
    }
}

void Sweeper::add_up()
{
    const SweepLists& sweeps = layout_.sweeps();
    runner_.run(sweeps.chunk_count(), [&](std::int64_t i) {
        const SweepChunk& chunk = sweeps.chunk(i);
        if (chunk.streams.sums != nullptr)
            chunk.kernels->add_up(layout_.context, chunk.streams, chunk.begin, chunk.end);
    });
    if (layout_.discs().empty()) return;
    runner_.run(layout_.disc_bands(), [&](std::int64_t band) {
        for (const SweepChunk& chunk : layout_.discs_of_band(band))
            chunk.kernels->add_up(layout_.context, chunk.streams, chunk.begin, chunk.end);
    });
}

void Sweeper::step_lone_figures(const Plan& plan)
{
    const std::span<const std::int32_t> lone = layout_.figures.lone();
    runner_.run(static_cast<std::int64_t>(lone.size()), [&](std::int64_t i, int worker) {
        const auto block = static_cast<std::size_t>(lone[static_cast<std::size_t>(i)]);
        FigureWorkspace& workspace = workspaces_[static_cast<std::size_t>(worker)];
        step_figure(layout_.context, layout_.kernels().figures,
                    workspace.take_in(layout_.figures, block, layout_.contact_tables()), layout_.data(),
                    plan);
    });
}

BatchSet::Count Sweeper::contacts_in_lockstep() const
{
    BatchSet::Count all;
    for (const FigureWorkspace& workspace : workspaces_) all += workspace.contacts_taken();
    return all;
}

template <class Work>
void Sweeper::for_each_touched_tree(const Work& work)
{
    const std::span<const std::int32_t> touched = layout_.figures.touched_trees();
    runner_.run(static_cast<std::int64_t>(touched.size()), [&](std::int64_t i) {
        const auto block = static_cast<std::size_t>(touched[static_cast<std::size_t>(i)]);
        work(layout_.figures.blocks()[block]);
    });
}

void Sweeper::prepare_touched_trees()
{
    for_each_touched_tree(
        [&](const FigureBlock& block) { prepare_tree(layout_.context, layout_.kernels().figures, block); });
}

void Sweeper::begin_touched_trees()
{
    for_each_touched_tree(
        [&](const FigureBlock& block) { begin_tree(layout_.context, layout_.kernels().figures, block); });
}

void Sweeper::lengthen_steps_beside_touched_trees()
{
    for_each_touched_tree([](const FigureBlock& block) { lengthen_steps(block); });
}

void Sweeper::solve_touched_trees(float rate)
{
    for_each_touched_tree([&](const FigureBlock& block) {
        solve_tree(layout_.context, layout_.kernels().figures, block, rate);
    });
}

void Sweeper::begin_islands(ExactContacts& contacts)
{
    runner_.run(contacts.islands(), [&](std::int64_t i) { contacts.begin(i); });
}

void Sweeper::solve_islands(ExactContacts& contacts, bool relaxes)
{
    runner_.run(contacts.islands(), [&](std::int64_t i) { contacts.solve(layout_.context, i, relaxes); });
}

template <class Work>
void Sweeper::for_each_free_group(const Work& work)
{
    constexpr std::int64_t groups_per_chunk = 64;
    const std::int64_t groups = layout_.groups.size();
    runner_.run((groups + groups_per_chunk - 1) / groups_per_chunk, [&](std::int64_t chunk) {
        const std::int64_t end = std::min((chunk + 1) * groups_per_chunk, groups);
        for (std::int64_t group = chunk * groups_per_chunk; group < end; ++group) work(group);
    });
}

void Sweeper::begin_free_groups()
{
    for_each_free_group([&](std::int64_t group) { layout_.groups.begin(layout_.context, group); });
}

void Sweeper::land_free_groups()
{
    for_each_free_group([&](std::int64_t group) { layout_.groups.land(layout_.context, group); });
}

std::int64_t Sweeper::commit(BodyStore& bodies, std::uint32_t& first_slot)
{
    std::atomic<std::int64_t> contained{0};
    std::atomic<std::uint32_t> lowest_slot{UINT32_MAX};
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const std::int64_t rows = layout_.context.bodies[kind].size;
        const auto in_lanes = layout_.kernels().bodies[kind].commit;
        const StepConstants& step = layout_.context.step;
        const BodyArrays& arrays = layout_.context.bodies[kind];
        const Flight flight{arrays.start_along, arrays.is_jointed, step.flight_excess, step.seconds,
                            step.gravity};
        const BodyRows& own = bodies.rows(static_cast<BodyKind>(kind));
        runner_.run((rows + rows_per_chunk - 1) / rows_per_chunk, [&](std::int64_t chunk) {
            if (!own.is_chunk_awake(chunk)) return;
            std::uint32_t slot = UINT32_MAX;
            int count = 0;
            const auto begin = static_cast<std::int32_t>(chunk * rows_per_chunk);
            const auto end = static_cast<std::int32_t>(std::min((chunk + 1) * rows_per_chunk, rows));
            static_assert(BodyRows::rows_per_group == block_lanes);
            for_each_piece(begin, end, block_lanes, [&](std::int32_t first, std::int32_t last) {
                if (!own.is_awake_beside(static_cast<std::uint32_t>(first))) return;
                // In lanes, or one at a time where the group has an unused row, is the last one, or has a body whose
                // state is not finite.
                if (in_lanes != nullptr && last - first == block_lanes && in_lanes(layout_.context, first))
                    return;
                count += bodies.commit(static_cast<BodyKind>(kind), static_cast<std::uint32_t>(first),
                                       static_cast<std::uint32_t>(last), flight, slot);
            });
            if (count == 0) return;
            contained += count;
            std::uint32_t lowest = lowest_slot.load();
            while (slot < lowest && !lowest_slot.compare_exchange_weak(lowest, slot)) {
            }
        });
    }
    first_slot = lowest_slot;
    return contained;
}

}  // namespace motley
