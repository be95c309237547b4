// How room is made when something outgrows what it had.
#pragma once

#include <cstddef>

namespace motley {

/// Room for `count` and a quarter: what grows a little each step then allocates seldom.
constexpr std::size_t with_room_to_grow(std::size_t count)
{
    return count + count / 4;
}

/// Makes a vector at least so long, with room to grow. One by one: when memory runs out between two that belong together,
/// the next call finds the second one short.
template <class Vector>
void grow_to(Vector& values, std::size_t size)
{
    if (values.size() < size) values.resize(with_room_to_grow(size));
}
/// Room for so many more elements, so that adding them cannot fail half-way. Doubles, as adding one by one would.
template <class Vector>
void make_room_for(Vector& values, std::size_t more)
{
    const std::size_t wanted = values.size() + more;
    if (values.capacity() < wanted)
        values.reserve(wanted < 2 * values.capacity() ? 2 * values.capacity() : wanted);
}

}  // namespace motley
