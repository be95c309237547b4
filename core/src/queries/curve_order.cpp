// See curve_order.h.
#include "queries/curve_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "queries/radix_sort.h"

namespace motley {
namespace {

constexpr int curve_bits = 16;                           // of each coordinate
constexpr std::uint32_t cells = (1U << curve_bits) - 1;  // along a side, less one
constexpr std::size_t few = 16;                          // points may share a place
constexpr std::size_t many = 512;                        // points are worth a radix sort

/// The curve runs through the quarters of a square in an order that depends on how the square is turned: `turn` has bit
/// 0 if x and y are exchanged, and bit 1 if both are mirrored.
struct Quarter {
    std::uint32_t along, turn;  ///< which one it is along the curve, and how it is turned
};
constexpr Quarter quarter_of(std::uint32_t turn, std::uint32_t x, std::uint32_t y)
{
    const std::uint32_t mirrored = turn >> 1;
    x ^= mirrored;
    y ^= mirrored;
    if ((turn & 1) != 0) std::swap(x, y);
    return {(3 * x) ^ y, y != 0 ? turn : turn ^ 1 ^ x << 1};
}

/// Two steps at once, by turn and two bits each of x and y: the place among sixteen in the higher bits, and the turn in
/// the lowest two.
constexpr std::array<std::uint8_t, 64> two_steps = [] {
    std::array<std::uint8_t, 64> table{};
    for (std::uint32_t i = 0; i < 64; ++i) {
        const std::uint32_t turn = i >> 4, x = i >> 2 & 3, y = i & 3;
        const Quarter first = quarter_of(turn, x >> 1, y >> 1), second = quarter_of(first.turn, x & 1, y & 1);
        table[i] = static_cast<std::uint8_t>((first.along << 2 | second.along) << 2 | second.turn);
    }
    return table;
}();

std::uint32_t place_of(std::uint32_t x, std::uint32_t y)
{
    std::uint32_t place = 0, turn = 0;
    for (int bit = curve_bits - 2; bit >= 0; bit -= 2) {
        const std::uint32_t steps = two_steps[turn << 4 | (x >> bit & 3) << 2 | (y >> bit & 3)];
        place = place << 4 | steps >> 2;
        turn = steps & 3;
    }
    return place;
}

}  // namespace

void CurveOrder::make_room(std::size_t count)
{
    placed_.reserve(count);
    spare_.reserve(count);
}

void CurveOrder::find(StridedSpan<const Vec2<double>> points)
{
    placed_.resize(points.size());
    spare_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) placed_[i].index = static_cast<std::uint32_t>(i);
    sort(points, placed_);
}

void CurveOrder::sort(StridedSpan<const Vec2<double>> points, std::span<Placed> part)
{
    Vec2<double> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    for (const Placed& placed : part) {
        const Vec2<double>& at = points[placed.index];
        low = {std::min(low.x, at.x), std::min(low.y, at.y)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
    const double side = std::max(high.x - low.x, high.y - low.y);
    // In one place, or so far apart that a double does not hold it.
    if (!(side > 0) || std::isinf(side)) return;
    for (Placed& placed : part) {
        const Vec2<double> offset = points[placed.index] - low;
        placed.place = place_of(static_cast<std::uint32_t>(offset.x / side * cells),
                                static_cast<std::uint32_t>(offset.y / side * cells));
    }
    if (part.size() >= many) {
        radix_sort(part, std::span(spare_), [](const Placed& placed) { return placed.place; });
    } else {
        std::sort(part.begin(), part.end(), [](const Placed& one, const Placed& other) {
            return one.place != other.place ? one.place < other.place : one.index < other.index;
        });
    }
    // The points furthest apart have different places, so each run is shorter than the part.
    for (std::size_t first = 0, last = 0; first < part.size(); first = last) {
        const std::uint32_t place = part[first].place;
        for (last = first + 1; last < part.size() && part[last].place == place;) ++last;
        if (last - first > few) sort(points, part.subspan(first, last - first));
    }
}

}  // namespace motley
