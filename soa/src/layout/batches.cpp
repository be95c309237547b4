// Counts constraints, opens and fills blocks.
#include "layout/batches.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "layout/patches.h"
#include "stores/atomic_ref.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// Overflow blocks that are searched for a free lane: enough to fill lanes from a few hubs (bodies with more
/// constraints than colours), few enough to search.
constexpr std::int32_t open_overflow_blocks = 8;
/// The least number of constraints per chunk when they are sorted: small enough that even a small crowd has a chunk
/// for each of many threads.
constexpr std::size_t placements_per_chunk = 1024;

}  // namespace

void BatchSet::Pool::make_room(std::int32_t blocks)
{
    grow_to(bodies, static_cast<std::size_t>(blocks));
    grow_to(who, static_cast<std::size_t>(blocks));
    grow_to(counts, static_cast<std::size_t>(blocks));
    grow_to(skipped, static_cast<std::size_t>(blocks));
}

/// Blocks behind those that the constraints of a colour fill.
void BatchSet::Pool::set_spare_aside()
{
    for (std::size_t colour = 0; colour < parallel_colours; ++colour) {
        const auto used = first_block[colour] + (constraints[colour] + block_lanes - 1) / block_lanes;
        std::fill(counts.begin() + used, counts.begin() + first_block[colour + 1], std::uint8_t{0});
        std::fill(skipped.begin() + used, skipped.begin() + first_block[colour + 1], skip_altogether);
    }
}

/// Makes lanes [first, 16) padding: the null bodies, and the parameters of a real constraint, so that no lane ever
/// computes with a zero normal.
void BatchSet::Pool::pad(std::size_t block, int first, std::int32_t constraint)
{
    std::fill(bodies[block].a + first, bodies[block].a + block_lanes, 0);
    std::fill(bodies[block].b + first, bodies[block].b + block_lanes, 0);
    std::fill(who[block].lane + first, who[block].lane + block_lanes, constraint);
    counts[block] = static_cast<std::uint8_t>(first);
    skipped[block] = skip_nothing;
}

void BatchSet::Pool::leave_gap(std::size_t block, int lane, std::int32_t constraint)
{
    bodies[block].a[lane] = bodies[block].b[lane] = 0;
    who[block].lane[lane] = constraint;
    counts[block] = std::min(counts[block], static_cast<std::uint8_t>(lane));
}

bool BatchSet::Pool::holds(std::size_t block, BodyRow a, BodyRow b) const
{
    const std::int32_t at_a = offset_of(a), at_b = offset_of(b);
    const BlockBodies& held = bodies[block];
    const bool same_kind = a.kind() == b.kind();
    for (int lane = 0; lane < counts[block]; ++lane) {
        // Fixed bodies may be shared. A moving body may be on either side where both sides are of its kind.
        if (a.kind() != BodyKind::fixed && (held.a[lane] == at_a || (same_kind && held.b[lane] == at_a)))
            return true;
        if (b.kind() != BodyKind::fixed && (held.b[lane] == at_b || (same_kind && held.a[lane] == at_b)))
            return true;
    }
    return false;
}

BatchSet::BatchSet(int first_type, int last_type)
    : first_class_(first_type * body_kind_count * body_kind_count),
      pools_(static_cast<std::size_t>((last_type - first_type) * body_kind_count * body_kind_count)),
      occurs_(pools_.size())
{
    used_.reserve(pools_.size());
}

std::span<const Placement> BatchSet::placements_of(std::int64_t chunk) const
{
    const std::size_t first = static_cast<std::size_t>(chunk) * per_chunk_;
    return placements_.subspan(first, std::min(per_chunk_, placements_.size() - first));
}

std::int64_t BatchSet::chunk_count() const
{
    return static_cast<std::int64_t>((placements_.size() + per_chunk_ - 1) / per_chunk_);
}

void BatchSet::begin(std::span<const Placement> placements, bool has_patches)
{
    placements_ = placements;
    has_patches_ = has_patches;
    // A chunk's tables must not cost more than its constraints.
    per_chunk_ = has_patches ? Patches::contacts_a_patch : std::max(placements_per_chunk, keys());
    std::fill(occurs_.begin(), occurs_.end(), std::uint8_t{0});
    const std::size_t wanted = static_cast<std::size_t>(chunk_count()) * keys();
    grow_to(places_, wanted);
    if (!has_patches) return;
    grow_to(patch_places_, wanted);
    grow_to(patch_blocks_, wanted);
}

void BatchSet::count(std::int64_t chunk)
{
    const std::span<std::int32_t> across = of_chunk(places_, chunk);
    std::fill(across.begin(), across.end(), 0);
    std::span<std::int32_t> inside;
    if (has_patches_) {
        inside = of_chunk(patch_places_, chunk);
        std::fill(inside.begin(), inside.end(), 0);
    }
    for (const Placement& placement : placements_of(chunk)) {
        if (placement.is_left_out() || placement.in_figure) continue;
        ++(placement.in_patch ? inside : across)[key_of(placement)];
    }
    const auto counts = [](std::span<const std::int32_t> table, std::size_t pool) {
        const auto of_pool = table.subspan(pool * colours, colours);
        return std::accumulate(of_pool.begin(), of_pool.end(), 0) > 0;
    };
    for (std::size_t p = 0; p < pools_.size(); ++p) {
        if (counts(across, p) || (has_patches_ && counts(inside, p))) AtomicRef(occurs_[p]).store(1);
    }
}

/// Turns each chunk's counts of a class into the places where its constraints begin. Returns the number of each
/// colour.
std::array<std::int32_t, BatchSet::colours> BatchSet::add_up(std::size_t p)
{
    std::array<std::int32_t, colours> totals{};
    for (std::int64_t chunk = 0; chunk < chunk_count(); ++chunk) {
        const std::span<std::int32_t> places = of_chunk(places_, chunk).subspan(p * colours, colours);
        for (std::size_t colour = 0; colour < colours; ++colour)
            totals[colour] += std::exchange(places[colour], totals[colour]);
    }
    return totals;
}

void BatchSet::open(const KernelTable& kernels, bool adds_up, bool spare)
{
    adds_up_ = adds_up;
    used_.clear();
    for (std::size_t p = 0; p < pools_.size(); ++p) {
        if (occurs_[p] != 0) used_.push_back(p);
    }
    bool has_overflow = false;
    for (const std::size_t p : used_) {
        Pool& pool = pools_[p];
        const std::array<std::int32_t, colours> totals = add_up(p);
        std::int32_t blocks = 0;
        for (std::size_t colour = 0; colour < parallel_colours; ++colour) {
            pool.constraints[colour] = totals[colour];
            pool.first_block[colour] = blocks;
            blocks += (totals[colour] + block_lanes - 1) / block_lanes;
            if (spare && totals[colour] > 0) blocks += 1 + totals[colour] / (16 * block_lanes);
        }
        pool.overflow = totals[overflow_colour];
        pool.first_block[overflow_colour] = pool.first_block[colours] = blocks;
        has_overflow = has_overflow || pool.overflow > 0;
        pool.make_room(blocks);
        if (spare) pool.set_spare_aside();
    }
    if (has_overflow) place_overflow();
    for (const std::size_t p : used_) {
        Pool& pool = pools_[p];
        pool.all_blocks = pool.first_block[colours];
        if (has_patches_) open_patches(p);
        const ConstraintKernels& own = kernels.constraints[static_cast<std::size_t>(first_class_) + p];
        const std::size_t lanes = static_cast<std::size_t>(pool.all_blocks) * block_lanes;
        grow_to(pool.rows, lanes * static_cast<std::size_t>(own.row_floats));
        grow_to(pool.substep_rows, lanes * static_cast<std::size_t>(own.substep_floats));
        grow_to(pool.impulses, lanes * static_cast<std::size_t>(own.impulse_floats));
        if (adds_up_) grow_to(pool.sums, lanes * static_cast<std::size_t>(own.sum_floats));
    }
}

/// Gives each colour of a class in each patch its blocks, patch after patch.
void BatchSet::open_patches(std::size_t p)
{
    Pool& pool = pools_[p];
    for (std::int64_t chunk = 0; chunk < chunk_count(); ++chunk) {
        const std::span<std::int32_t> places = of_chunk(patch_places_, chunk).subspan(p * colours, colours);
        const std::span<std::int32_t> first = of_chunk(patch_blocks_, chunk).subspan(p * colours, colours);
        for (std::size_t colour = 0; colour < colours; ++colour) {
            first[colour] = pool.all_blocks;
            pool.all_blocks +=
                (std::exchange(places[colour], pool.all_blocks * block_lanes) + block_lanes - 1) /
                block_lanes;
        }
    }
    pool.make_room(pool.all_blocks);
}

/// Puts the overflow of each class into blocks behind those of its colours: first fit among the last few blocks, so
/// that no block has a moving body twice.
void BatchSet::place_overflow()
{
    for (const Placement& placement : placements_) {
        if (placement.colour != overflow_colour) continue;
        Pool& pool = pools_[key_of(placement) / colours];
        std::int32_t& end = pool.first_block[colours];
        const auto blocks = static_cast<std::size_t>(end);
        auto block =
            static_cast<std::size_t>(std::max(pool.first_block[overflow_colour], end - open_overflow_blocks));
        while (block < blocks &&
               (pool.counts[block] == block_lanes || pool.holds(block, placement.a, placement.b)))
            ++block;
        if (block == blocks) {
            pool.make_room(++end);
            pool.pad(block, 0, placement.constraint);
        }
        pool.set_lane(block, pool.counts[block]++, placement);
    }
}

void BatchSet::fill(std::int64_t chunk)
{
    const std::span<std::int32_t> places = of_chunk(places_, chunk);
    std::span<std::int32_t> patch_places;
    if (has_patches_) patch_places = of_chunk(patch_places_, chunk);
    for (const Placement& placement : placements_of(chunk)) {
        if (placement.colour >= overflow_colour || placement.in_figure)
            continue;  // placed already, or left out
        const std::size_t key = key_of(placement);
        Pool& pool = pools_[key / colours];
        if (placement.in_patch) {
            const auto place = static_cast<std::size_t>(patch_places[key]++);
            pool.set_lane(place / block_lanes, static_cast<int>(place % block_lanes), placement);
            continue;
        }
        const std::int32_t place = places[key]++;
        const int lane = place % block_lanes;
        const auto block = static_cast<std::size_t>(pool.first_block[placement.colour] + place / block_lanes);
        if (placement.is_gap()) {
            pool.leave_gap(block, lane, ~placement.constraint);
            continue;
        }
        pool.set_lane(block, lane, placement);
        // The constraint in the first lane writes the padding, which no other chunk writes.
        if (lane == 0) {
            pool.pad(block, std::min(pool.constraints[placement.colour] - place, block_lanes),
                     placement.constraint);
        }
    }
    if (has_patches_) finish_patch(chunk);
}

/// Writes the counts and the padding of a patch's blocks.
void BatchSet::finish_patch(std::int64_t chunk)
{
    const std::span<std::int32_t> places = of_chunk(patch_places_, chunk);
    const std::span<std::int32_t> first = of_chunk(patch_blocks_, chunk);
    for (const std::size_t p : used_) {
        Pool& pool = pools_[p];
        for (std::size_t colour = 0; colour < parallel_colours; ++colour) {
            const std::size_t key = p * colours + colour;
            for (std::int32_t block = first[key]; block < first[key + 1]; ++block) {
                const auto b = static_cast<std::size_t>(block);
                pool.pad(b, std::min(places[key] - block * block_lanes, block_lanes), pool.who[b].lane[0]);
            }
        }
    }
}

bool BatchSet::has_overflow() const
{
    return std::any_of(used_.begin(), used_.end(), [&](std::size_t p) { return pools_[p].overflow > 0; });
}

}  // namespace motley
