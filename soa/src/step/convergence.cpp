// Islands by union-find; residuals and wanted sweeps by block.
#include "step/convergence.h"
#include "maths/bit_cast.h"
#include "stores/joint_store.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace motley {
namespace {

/// Calls visit(chunk, block) for each block, in order.
template <class Visit>
void for_each_block(const SweptChunks& swept, const Visit& visit)
{
    swept.for_each([&](const SweepChunk& chunk) {
        for (std::int32_t block = chunk.begin; block < chunk.end; ++block) visit(chunk, block);
    });
}
/// The same for each block that is not finished.
template <class Visit>
void for_each_unfinished(const SweptChunks& swept, const Visit& visit)
{
    for_each_block(swept, [&](const SweepChunk& chunk, std::int32_t block) {
        if (chunk.finished[block] == 0) visit(chunk, block);
    });
}
/// Calls visit(chunk, block, lane) for each contact of discs.
template <class Visit>
void for_each_lane(std::span<const SweepChunk> discs, const Visit& visit)
{
    for (const SweepChunk& chunk : discs) {
        for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
            for (int lane = 0; lane < chunk.streams.counts[block]; ++lane) visit(chunk, block, lane);
        }
    }
}

constexpr std::int32_t unseen = -1;

/// Numbers that are not negative are ordered like their bits, and a NaN comes after all of them, once its sign is
/// removed, which processors set differently.
constexpr std::int32_t all_but_sign = 0x7FFFFFFF;
std::int32_t bits_of(float value)
{
    return bit_cast<std::int32_t>(value) & all_but_sign;
}
/// Compares integers, because a compiler may vectorize a maximum of integers, but not one of floats.
std::int32_t largest_bits(const float* values, int count)
{
    std::array<std::int32_t, block_lanes> bits;
    std::memcpy(bits.data(), values, sizeof(bits));
    for (int lane = count; lane < block_lanes; ++lane) bits[static_cast<std::size_t>(lane)] = 0;
    std::int32_t largest = 0;
    for (const std::int32_t b : bits) largest = std::max(largest, b & all_but_sign);
    return largest;
}

const float* speeds_of(const SweepChunk& chunk, std::int32_t block)
{
    return chunk.streams.residuals + (2 * static_cast<std::int64_t>(block) + 1) * block_lanes;
}

}  // namespace

ResidualSum sum_residuals(const SweptChunks& swept)
{
    ResidualSum sum;
    std::int32_t largest = 0;
    for_each_unfinished(swept, [&](const SweepChunk& chunk, std::int32_t block) {
        const float* speeds = speeds_of(chunk, block);
        const int count = chunk.streams.counts[block];
        for (int lane = 0; lane < count; ++lane) {
            const auto speed = static_cast<double>(speeds[lane]);
            sum.energy += static_cast<double>(speeds[lane - block_lanes]);
            sum.squares += speed * speed;
            largest = std::max(largest, bits_of(speeds[lane]));
        }
        sum.constraints += count;
    });
    sum.largest = static_cast<double>(bit_cast<float>(largest));
    return sum;
}

void Convergence::tie(std::span<const Placement> placements)
{
    for (const Placement& placement : placements) {
        if (!placement.is_gap() && !placement.is_left_out()) bodies_.tie(placement.a, placement.b);
    }
}

void Convergence::tie(std::span<const SweepChunk> discs)
{
    for_each_lane(discs, [&](const SweepChunk& chunk, std::int32_t block, int lane) {
        const BlockBodies& bodies = chunk.streams.bodies[block];
        bodies_.tie(row_at(chunk.kind_a, bodies.a[lane]), row_at(chunk.kind_b, bodies.b[lane]));
    });
}

void Convergence::find_islands(const KernelContext& context, std::span<const Placement> joints,
                               std::span<const Placement> contacts, const SweptChunks& swept)
{
    bodies_.reset([&](BodyKind kind) { return context.bodies[static_cast<int>(kind)].size; });
    tie(joints);
    tie(contacts);
    tie(swept.discs);
    bodies_.flatten();
    worst_.assign(bodies_.size(), unseen);
    islands_ = 0;
    count(joints);
    count(contacts);
    count(swept.discs);
    unfinished_ = islands_;
    name_islands(swept);
}

void Convergence::count(std::span<const Placement> placements)
{
    for (const Placement& placement : placements) {
        if (placement.is_left_out()) continue;
        count(bodies_.root(placement.a.kind() == BodyKind::fixed ? placement.b : placement.a));
    }
}

void Convergence::count(std::span<const SweepChunk> discs)
{
    for_each_lane(discs, [&](const SweepChunk& chunk, std::int32_t block, int lane) {
        count(island_of(chunk, block, lane));
    });
}

void Convergence::count(std::int32_t island)
{
    std::int32_t& seen = worst_[static_cast<std::size_t>(island)];
    islands_ += seen == unseen ? 1 : 0;
    seen = 0;
}

/// Most blocks are of one island only: then judge() needs no more than their worst lane.
void Convergence::name_islands(const SweptChunks& swept)
{
    for_each_block(swept, [&](const SweepChunk& chunk, std::int32_t block) {
        const std::int32_t first = island_of(chunk, block, 0);
        bool same = true;
        for (int lane = 1; lane < chunk.streams.counts[block]; ++lane)
            same = same && island_of(chunk, block, lane) == first;
        chunk.islands[block] = same ? first : several_islands;
    });
}

void Convergence::take_wishes(const SceneCore& scene, const SweptChunks& swept)
{
    most_wanted_ = 0;
    wanted_.assign(bodies_.size(), 0);
    for (const IslandIterations& asked : scene.island_iterations) {
        const std::int32_t island = bodies_.root(scene.bodies.row_of(asked.body));
        std::int32_t& wanted = wanted_[static_cast<std::size_t>(island)];
        wanted = std::max(wanted, asked.at_least);
    }
    std::array<const std::uint32_t*, constraint_type_count> slots{};
    scene.joints->for_each([&](const auto& store, int type) {
        slots[static_cast<std::size_t>(contact_type_count + type)] = store.slots.data();
    });
    for_each_block(swept, [&](const SweepChunk& chunk, std::int32_t block) {
        const std::uint32_t* slot_of = slots[static_cast<std::size_t>(chunk.type)];
        std::int32_t wanted = 0;
        for (int lane = 0; lane < chunk.streams.counts[block]; ++lane) {
            wanted = std::max(wanted, wanted_[static_cast<std::size_t>(island_of(chunk, block, lane))]);
            if (slot_of == nullptr) continue;  // contacts ask for no sweeps
            const std::uint32_t slot = slot_of[chunk.streams.constraints[block].lane[lane]];
            wanted = std::max<std::int32_t>(wanted, scene.joints->slots[slot].iterations);
        }
        chunk.wanted[block] = wanted;
        most_wanted_ = std::max(most_wanted_, wanted);
    });
}

std::int32_t Convergence::island_of(const SweepChunk& chunk, std::int32_t block, int lane) const
{
    const bool use_b = chunk.kind_a == BodyKind::fixed;
    const BlockBodies& bodies = chunk.streams.bodies[block];
    return bodies_.root(use_b ? row_at(chunk.kind_b, bodies.b[lane]) : row_at(chunk.kind_a, bodies.a[lane]));
}

void Convergence::start_over(const SweptChunks& swept)
{
    swept.for_each([](const SweepChunk& chunk) {
        std::fill(chunk.finished + chunk.begin, chunk.finished + chunk.end, std::uint8_t{0});
    });
    unfinished_ = islands_;
}

void Convergence::judge(const SweptChunks& swept, float tolerance)
{
    const std::int32_t most = bits_of(tolerance);
    std::fill(worst_.begin(), worst_.end(), unseen);
    const auto note = [&](std::int32_t island, std::int32_t speed) {
        std::int32_t& worst = worst_[static_cast<std::size_t>(island)];
        worst = std::max(worst, speed);
    };
    for_each_unfinished(swept, [&](const SweepChunk& chunk, std::int32_t block) {
        const float* speeds = speeds_of(chunk, block);
        const int count = chunk.streams.counts[block];
        if (chunk.islands[block] != several_islands) {
            note(chunk.islands[block], largest_bits(speeds, count));
            return;
        }
        for (int lane = 0; lane < count; ++lane) note(island_of(chunk, block, lane), bits_of(speeds[lane]));
    });
    unfinished_ =
        std::count_if(worst_.begin(), worst_.end(), [&](std::int32_t speed) { return speed > most; });
    const auto wants_more = [&](std::int32_t island) {
        return worst_[static_cast<std::size_t>(island)] > most;
    };
    for_each_unfinished(swept, [&](const SweepChunk& chunk, std::int32_t block) {
        bool more = false;
        if (chunk.islands[block] != several_islands) {
            more = wants_more(chunk.islands[block]);
        } else {
            for (int lane = 0; lane < chunk.streams.counts[block]; ++lane)
                more = more || wants_more(island_of(chunk, block, lane));
        }
        if (!more) chunk.finished[block] = 1;
    });
}

}  // namespace motley
