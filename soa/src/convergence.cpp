// Islands by union-find, residuals by block.
#include "convergence.h"

#include <algorithm>
#include <numeric>

namespace motley {
namespace {

/// Each block of the lists that still runs, in order.
template <class Visit>
void for_each_unfinished(const SweepLists& sweeps, const Visit& visit)
{
    for (const auto& chunks : sweeps) {
        for (const SweepChunk& chunk : chunks) {
            for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
                if (chunk.finished[block] == 0) visit(chunk, block);
            }
        }
    }
}

const float* speeds_of(const SweepChunk& chunk, std::int32_t block)
{
    return chunk.streams.residuals + (2 * static_cast<std::int64_t>(block) + 1) * block_lanes;
}

}  // namespace

ResidualSum sum_residuals(const SweepLists& sweeps)
{
    ResidualSum sum;
    for_each_unfinished(sweeps, [&](const SweepChunk& chunk, std::int32_t block) {
        const float* speeds = speeds_of(chunk, block);
        const int count = chunk.streams.counts[block];
        for (int lane = 0; lane < count; ++lane) {
            const auto speed = static_cast<double>(speeds[lane]);
            sum.energy += static_cast<double>(speeds[lane - block_lanes]);
            sum.squares += speed * speed;
            sum.largest = std::max(sum.largest, speed);
        }
        sum.constraints += count;
    });
    return sum;
}

std::int32_t Convergence::root_of(std::int32_t body)
{
    while (parent_[static_cast<std::size_t>(body)] != body) {
        std::int32_t& up = parent_[static_cast<std::size_t>(body)];
        up = parent_[static_cast<std::size_t>(up)];
        body = up;
    }
    return body;
}

void Convergence::tie(std::span<const Placement> placements)
{
    for (const Placement& placement : placements) {
        if (placement.a.kind() == BodyKind::fixed || placement.b.kind() == BodyKind::fixed) continue;
        const auto index = [&](BodyRow row) {
            return first_[static_cast<std::size_t>(row.kind())] + static_cast<std::int32_t>(row.row());
        };
        const std::int32_t a = root_of(index(placement.a)), b = root_of(index(placement.b));
        // The smaller index stays the root, so that an island's name does not depend on the order of its ties.
        parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
}

void Convergence::find_islands(const KernelContext& context, std::span<const Placement> joints,
                               std::span<const Placement> contacts)
{
    std::int32_t count = 0;
    for (std::size_t kind = 0; kind < moving_kinds; ++kind) {
        first_[kind] = count;
        count += context.bodies[kind].size;
    }
    parent_.resize(static_cast<std::size_t>(count));
    std::iota(parent_.begin(), parent_.end(), 0);
    tie(joints);
    tie(contacts);
    for (std::int32_t body = 0; body < count; ++body) parent_[static_cast<std::size_t>(body)] = root_of(body);
    worst_.assign(static_cast<std::size_t>(count), -1.0F);
    islands_ = 0;
    const auto note = [&](const Placement& placement) {
        const BodyRow moving = placement.a.kind() == BodyKind::fixed ? placement.b : placement.a;
        const std::int32_t body =
            first_[static_cast<std::size_t>(moving.kind())] + static_cast<std::int32_t>(moving.row());
        float& seen = worst_[static_cast<std::size_t>(parent_[static_cast<std::size_t>(body)])];
        islands_ += seen < 0 ? 1 : 0;
        seen = 0;
    };
    for (const Placement& placement : joints) note(placement);
    for (const Placement& placement : contacts) note(placement);
    unfinished_ = islands_;
}

std::int32_t Convergence::island_of(const SweepChunk& chunk, std::int32_t block, int lane) const
{
    const bool use_b = chunk.kind_a == BodyKind::fixed;
    const std::int32_t row =
        use_b ? chunk.streams.bodies[block].b[lane] : chunk.streams.bodies[block].a[lane];
    const auto kind = static_cast<std::size_t>(use_b ? chunk.kind_b : chunk.kind_a);
    return parent_[static_cast<std::size_t>(first_[kind] + row)];
}

void Convergence::start_over(const SweepLists& sweeps)
{
    for (const auto& chunks : sweeps) {
        for (const SweepChunk& chunk : chunks)
            std::fill(chunk.finished + chunk.begin, chunk.finished + chunk.end, std::uint8_t{0});
    }
    unfinished_ = islands_;
}

void Convergence::judge(const SweepLists& sweeps, float tolerance)
{
    std::fill(worst_.begin(), worst_.end(), -1.0F);
    for_each_unfinished(sweeps, [&](const SweepChunk& chunk, std::int32_t block) {
        const float* speeds = speeds_of(chunk, block);
        for (int lane = 0; lane < chunk.streams.counts[block]; ++lane) {
            float& worst = worst_[static_cast<std::size_t>(island_of(chunk, block, lane))];
            worst = std::max(worst, speeds[lane]);
        }
    });
    unfinished_ = std::count_if(worst_.begin(), worst_.end(), [&](float speed) { return speed > tolerance; });
    for_each_unfinished(sweeps, [&](const SweepChunk& chunk, std::int32_t block) {
        bool all = true;
        for (int lane = 0; lane < chunk.streams.counts[block]; ++lane)
            all = all && !(worst_[static_cast<std::size_t>(island_of(chunk, block, lane))] > tolerance);
        if (all) chunk.finished[block] = 1;
    });
}

}  // namespace motley
