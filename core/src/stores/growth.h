// How vectors are enlarged.
#pragma once

#include <cstddef>

namespace motley {

/// `count` and a quarter more: with this room, what grows a little each step allocates seldom.
constexpr std::size_t with_room_to_grow(std::size_t count)
{
    return count + count / 4;
}

/// Makes a vector at least `size` long, with room to grow. Each vector is judged by its own length: if memory runs out
/// between two that belong together, the next call still enlarges the second one.
template <class Vector>
void grow_to(Vector& values, std::size_t size)
{
    if (values.size() < size) values.resize(with_room_to_grow(size));
}
/// The same with this value for the new elements. (An overload: a fill is more code, and most callers need none.)
template <class Vector>
void grow_to(Vector& values, std::size_t size, const typename Vector::value_type& value)
{
    if (values.size() < size) values.resize(with_room_to_grow(size), value);
}
/// values.resize(size), with room for twice as much: for what may grow much from one step to the next.
template <class Vector>
void resize_with_room(Vector& values, std::size_t size)
{
    if (values.capacity() < size) values.reserve(2 * size);
    values.resize(size);
}
/// values.assign(size, value), with room to grow.
template <class Vector>
void assign_with_room(Vector& values, std::size_t size, const typename Vector::value_type& value)
{
    if (values.capacity() < size) values.reserve(with_room_to_grow(size));
    values.assign(size, value);
}
/// For a list that is filled anew in each step: if it has nearly used its room, makes more for the next time.
template <class Vector>
void keep_room(Vector& values)
{
    if (values.capacity() < values.size() + values.size() / 8) values.reserve(2 * values.size());
}
/// Reserves room for `more` elements, so that adding them cannot fail half-way. At least doubles the capacity when it
/// is too small, so that repeated calls stay cheap.
template <class Vector>
void make_room_for(Vector& values, std::size_t more)
{
    const std::size_t wanted = values.size() + more;
    if (values.capacity() < wanted)
        values.reserve(wanted < 2 * values.capacity() ? 2 * values.capacity() : wanted);
}

}  // namespace motley
