// Blocks of sixteen lanes, as the stores keep them: the bodies of up to sixteen constraints of one type, none of which
// shares a moving body with another. The number is sixteen on every instruction set (computed as 16 x 1, 4 x 4, 2 x 8
// or 1 x 16), so that blocks, their order and with them every bit of the result do not depend on the machine.
#pragma once

#include <cstdint>

#include "stores/body_store.h"

namespace motley {

inline constexpr int block_lanes = 16;

/// Blocks store where a body's row begins as an offset in pairs of floats. Eight bytes is the largest scale factor of
/// an x86 address, so kernels need no multiplication for each row that they load or store.
inline constexpr int offset_floats = 2;
constexpr std::int32_t offsets_a_row(BodyKind kind)
{
    return 4 / offset_floats * quads_of(kind);
}
inline std::int32_t offset_of(BodyRow row)
{
    return static_cast<std::int32_t>(row.row()) * offsets_a_row(row.kind());
}

inline BodyRow row_at(BodyKind kind, std::int32_t offset)
{
    return {kind, static_cast<std::uint32_t>(offset / offsets_a_row(kind))};
}

/// The bodies of a block. Lanes from the block's count on are padding: their bodies are the null rows, and they are
/// never stored.
struct alignas(64) BlockBodies {
    std::int32_t a[block_lanes];  ///< offset_of body a
    std::int32_t b[block_lanes];
};

}  // namespace motley
