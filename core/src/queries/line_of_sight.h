// A straight way from one point to another, and where it meets pieces of walls and boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "motley/core/vector.h"
#include "queries/box_tree.h"

namespace motley {

/// Of a line that does not meet something.
inline constexpr double no_meeting = std::numeric_limits<double>::infinity();

/// The most by which a computed cross product differs from the true one, where u and v are differences of doubles.
inline double rounding_of_cross(const Vec2<double>& u, const Vec2<double>& v)
{
    return 8e-16 * (std::abs(u.x * v.y) + std::abs(u.y * v.x));
}

struct LineOfSight {
    Vec2<double> from{}, to{};  ///< m

    /// The fraction of the way, 0 to 1, at which it first meets the straight piece from a to b, ends included, or
    /// no_meeting. Two pieces that share an end compute the same side of it, so that no line passes between them.
    [[nodiscard]] double meets(const Vec2<double>& a, const Vec2<double>& b) const
    {
        const auto same_side = [](double one, double other) {
            return (one > 0 && other > 0) || (one < 0 && other < 0);
        };
        const Vec2<double> along = to - from, piece = b - a;
        const double side_of_a = cross(along, a - from), side_of_b = cross(along, b - from);
        if (same_side(side_of_a, side_of_b)) return no_meeting;
        const double side_of_from = cross(piece, from - a), side_of_to = cross(piece, to - a);
        if (same_side(side_of_from, side_of_to)) return no_meeting;
        if ((side_of_a == 0 && side_of_b == 0) || side_of_from == side_of_to) return meets_along(a, piece);
        return std::clamp(side_of_from / (side_of_from - side_of_to), 0.0, 1.0);
    }

    /// A fraction of the way before which it is not in the box, or no_meeting. A box that it misses by no more than the
    /// rounding of doubles counts as met.
    [[nodiscard]] double enters(const Box& box) const
    {
        const Vec2<double> along = to - from;
        const double x = entry(from.x, along.x, box.low.x, box.high.x);
        const double y = entry(from.y, along.y, box.low.y, box.high.y);
        // It misses the box as well if all of that is on one side of it.
        const Vec2<double> half = 0.5 * (box.high - box.low), middle = 0.5 * (box.high + box.low) - from;
        const double reach = (1 + 1e-9) * (std::abs(along.x) * half.y + std::abs(along.y) * half.x);
        if (std::abs(cross(along, middle)) > reach + rounding_of_cross(along, middle)) return no_meeting;
        return std::max(x, y);
    }

  private:
    /// Of a piece on the same straight line.
    [[nodiscard]] double meets_along(const Vec2<double>& a, const Vec2<double>& piece) const
    {
        const double length2 = dot(piece, piece);
        const double begins = dot(from - a, piece) / length2, ends = dot(to - a, piece) / length2;
        if ((begins < 0 && ends < 0) || (begins > 1 && ends > 1)) return no_meeting;
        if (begins < 0) return begins / (begins - ends);
        if (begins > 1) return (begins - 1) / (begins - ends);
        return 0;
    }
    /// A fraction of the way before which one coordinate is not between `low` and `high`.
    static double entry(double from, double along, double low, double high)
    {
        const double gap = along < 0 ? from - high : low - from,
                     beyond = along < 0 ? low - from : from - high;
        if (gap > std::abs(along) || beyond > 0) return no_meeting;
        return gap > 0 ? gap / std::abs(along) : 0;
    }
};

}  // namespace motley
