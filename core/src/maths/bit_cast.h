#pragma once

namespace motley {

/// std::bit_cast, which the standard library of Emscripten in Debian 12 does not have yet.
template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& from)
{
    return __builtin_bit_cast(To, from);
}

}  // namespace motley
