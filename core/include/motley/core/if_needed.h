// Parts that some rows lack: what stands in their place takes no room.
#pragma once

#include <type_traits>

namespace motley {

/// Tagged, since two members of one empty type would each need an address of their own.
template <int tag>
struct Nothing {
};

/// A member to be marked [[no_unique_address]]; `tag` tells it from others of the same struct.
template <bool has_it, class Part, int tag = 0>
using IfNeeded = std::conditional_t<has_it, Part, Nothing<tag>>;

}  // namespace motley
