// Where two straight axes are nearest to each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "motley/core/vector.h"

namespace motley {

/// A straight axis from `from` to `from + along`, m, world.
struct Axis {
    Vec3<double> from{}, along{};
    [[nodiscard]] Vec3<double> at(double place) const { return from + place * along; }
};

/// A place on each of two axes, from 0, where the axis begins, to 1.
struct AxisPlaces {
    double on_a = 0, on_b = 0;
};

/// The place of an axis that is nearest to a point.
inline double nearest_place(const Axis& axis, const Vec3<double>& point)
{
    const double length2 = dot(axis.along, axis.along);
    if (!(length2 > 0)) return 0;
    return std::clamp(dot(point - axis.from, axis.along) / length2, 0.0, 1.0);
}

/// The nearest places of two axes (C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.9): those of the lines
/// through them where both are on the axes; else one of them is an end.
inline AxisPlaces nearest_places(const Axis& a, const Axis& b)
{
    const double aa = dot(a.along, a.along), bb = dot(b.along, b.along), ab = dot(a.along, b.along);
    if (!(aa > 0)) return {0, nearest_place(b, a.from)};
    if (!(bb > 0)) return {nearest_place(a, b.from), 0};
    const Vec3<double> apart = b.from - a.from;
    const double determinant = aa * bb - ab * ab;  // 0 of parallel axes: then any place will do
    const double on_line =
        determinant > 0 ? (dot(apart, a.along) * bb - dot(apart, b.along) * ab) / determinant : 0;
    const double on_b = nearest_place(b, a.at(std::clamp(on_line, 0.0, 1.0)));
    return {nearest_place(a, b.at(on_b)), on_b};
}

/// Pairs of places at which two axes may touch: the nearest places, or, where the axes are about parallel and lie side by
/// side, the ends of the stretch along which they do, so that one can rest on the other.
struct TouchingPlaces {
    std::array<AxisPlaces, 2> places{};
    int count = 0;
};
inline TouchingPlaces touching_places(const Axis& a, const Axis& b)
{
    constexpr double steepest2 =
        0.01;  // the squared sine of the angle between axes about parallel: 6 degrees
    const double aa = dot(a.along, a.along), bb = dot(b.along, b.along), ab = dot(a.along, b.along);
    const bool are_parallel = aa * bb > 0 && aa * bb - ab * ab < steepest2 * aa * bb;
    if (are_parallel) {
        const double first = nearest_place(a, b.from), second = nearest_place(a, b.at(1));
        // Otherwise they lie one behind the other.
        if (first != second)
            return {{AxisPlaces{first, nearest_place(b, a.at(first))},
                     AxisPlaces{second, nearest_place(b, a.at(second))}},
                    2};
    }
    return {{nearest_places(a, b), {}}, 1};
}

}  // namespace motley
