// The classes of contacts of discs, each of which has its own blocks and kernels.
#pragma once

#include <cstdint>

namespace motley {

/// What contacts are solved as, in the order in which a sweep visits them.
enum class DiscClass : std::uint8_t { smooth_pair, rough_pair, smooth_wall, rough_wall };
inline constexpr int disc_class_count = 4;
constexpr bool is_wall(DiscClass c)
{
    return c == DiscClass::smooth_wall || c == DiscClass::rough_wall;
}
constexpr bool is_rough(DiscClass c)
{
    return c == DiscClass::rough_pair || c == DiscClass::rough_wall;
}

}  // namespace motley
