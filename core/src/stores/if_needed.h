// Members that only some instances of a template have: their placeholder takes no room in the others.
#pragma once

#include <type_traits>

namespace motley {

/// The placeholder. Tagged, because two members of the same empty type would each need an address of their own.
template <int tag>
struct Nothing {
};

/// The type of such a member: Part or a placeholder. The member must be marked [[no_unique_address]], and `tag` must
/// differ among the members of a struct.
template <bool has_it, class Part, int tag = 0>
using IfNeeded = std::conditional_t<has_it, Part, Nothing<tag>>;

}  // namespace motley
