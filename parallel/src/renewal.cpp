// See renewal.h.
#include "renewal.h"

#include <algorithm>

#include "stores/array.h"

namespace motley {
namespace {

std::span<float> velocities_of(const BodyArrays& arrays, int kind)
{
    if (!arrays.can_move) return {};
    const std::int64_t floats = std::int64_t{4} * quads_of(static_cast<BodyKind>(kind));
    return {arrays.velocity, static_cast<std::size_t>(floats * arrays.size)};
}

}  // namespace

void Renewal::begin()
{
    // A warm start with the opposite impulses takes the impulses out of the velocities.
    change_signs();
    sweeper_.sweep(&ConstraintKernels::warm_start);
    change_signs();
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const std::span<const float> velocities = velocities_of(layout_.context.bodies[kind], kind);
        unpushed_[static_cast<std::size_t>(kind)].assign(velocities.begin(), velocities.end());
    }
    sweeper_.sweep(&ConstraintKernels::warm_start);
}

void Renewal::renew()
{
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const auto& kept = unpushed_[static_cast<std::size_t>(kind)];
        std::copy(kept.begin(), kept.end(), velocities_of(layout_.context.bodies[kind], kind).begin());
    }
    sweeper_.sweep(&ConstraintKernels::warm_start);
}

void Renewal::change_signs()
{
    const auto change = [](std::span<const SweepChunk> chunks) {
        for (const SweepChunk& chunk : chunks) {
            const std::int64_t floats = std::int64_t{chunk.kernels->impulse_floats} * block_lanes;
            std::transform(chunk.streams.impulses + floats * chunk.begin,
                           chunk.streams.impulses + floats * chunk.end,
                           chunk.streams.impulses + floats * chunk.begin, [](float x) { return -x; });
        }
    };
    for (const Array<SweepChunk>& list : layout_.sweeps().lists) change(list);
    change(layout_.discs());
}

}  // namespace motley
