// How much room is made when something outgrows what it had.
#pragma once

#include <cstddef>

namespace motley {

/// Room for `count` and a quarter: what grows a little each step then allocates seldom.
constexpr std::size_t with_room_to_grow(std::size_t count)
{
    return count + count / 4;
}

}  // namespace motley
