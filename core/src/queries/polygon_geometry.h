// What a polygon holds.
#pragma once

#include <cstddef>
#include <string>

#include "motley/core/polygon.h"

namespace motley {

/// Calls work(ring, number): the outer ring is number 0.
template <class Work>
void for_each_ring(const Polygon& polygon, const Work& work)
{
    work(polygon.outer, std::size_t{0});
    for (std::size_t i = 0; i < polygon.holes.size(); ++i) work(polygon.holes[i], i + 1);
}

inline std::string ring_name(std::size_t number)
{
    return number == 0 ? "Polygon.outer" : "Polygon.holes[" + std::to_string(number - 1) + "]";
}

inline std::string point_name(std::size_t ring, std::size_t point)
{
    return ring_name(ring) + "[" + std::to_string(point) + "]";
}

/// Calls work(from, to, index) for each edge of a ring.
template <class Ring, class Work>
void for_each_edge(const Ring& ring, const Work& work)
{
    for (std::size_t i = 0; i < ring.size(); ++i) work(ring[i], ring[i + 1 < ring.size() ? i + 1 : 0], i);
}

/// Whether a ray from a point to the right crosses an odd number of edges of a ring.
template <class Ring>
bool is_inside(const Ring& ring, const Vec2<double>& point)
{
    bool inside = false;
    for_each_edge(ring, [&](const Vec2<double>& a, const Vec2<double>& b, std::size_t) {
        if ((a.y > point.y) == (b.y > point.y)) return;
        const double side = cross(b - a, point - a);
        if ((side > 0) == (b.y > a.y) && side != 0) inside = !inside;
    });
    return inside;
}
inline bool is_inside(const Polygon& polygon, const Vec2<double>& point)
{
    bool inside = false;
    for_each_ring(polygon, [&](const auto& ring, std::size_t) { inside ^= is_inside(ring, point); });
    return inside;
}

}  // namespace motley
