// See flow_field.h.
#include "worlds/flow_field.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace motley::bench {

FlowField::FlowField(std::int32_t side, const std::vector<Cell>& cells)
    : side_(side), distances_(cells.size(), INFINITY), directions_(cells.size())
{
    using Entry = std::pair<float, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (cells[i] == Cell::goal) next.emplace(distances_[i] = 0, i);
    }
    const auto is_open = [&](std::int32_t x, std::int32_t y) {
        return x >= 0 && y >= 0 && x < side && y < side &&
               cells[static_cast<std::size_t>(y * side + x)] != Cell::closed;
    };
    while (!next.empty()) {
        const auto [distance, cell] = next.top();
        next.pop();
        if (distance > distances_[cell]) continue;
        const auto x = static_cast<std::int32_t>(cell) % side, y = static_cast<std::int32_t>(cell) / side;
        for (std::int32_t dy = -1; dy <= 1; ++dy) {
            for (std::int32_t dx = -1; dx <= 1; ++dx) {
                if (!is_open(x + dx, y + dy) || !is_open(x + dx, y) || !is_open(x, y + dy)) continue;
                const float further = distance + (dx != 0 && dy != 0 ? 1.41421356F : 1.0F);
                const auto neighbour = static_cast<std::size_t>((y + dy) * side + x + dx);
                if (further < distances_[neighbour]) next.emplace(distances_[neighbour] = further, neighbour);
            }
        }
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!(distances_[i] > 0 && distances_[i] < INFINITY)) continue;
        const auto x = static_cast<std::int32_t>(i) % side, y = static_cast<std::int32_t>(i) / side;
        const Vec2<float> fall{fall_along(i, x, 1), fall_along(i, y, static_cast<std::size_t>(side))};
        const float length = std::sqrt(dot(fall, fall));
        if (length > 0) directions_[i] = (1 / length) * fall;
    }
}

std::size_t FlowField::cell_of(const Vec2<double>& at) const
{
    const auto place = [&](double x) {
        return static_cast<std::size_t>(std::clamp(x, 0.0, static_cast<double>(side_) - 0.5));
    };
    return place(at.y) * static_cast<std::size_t>(side_) + place(at.x);
}

/// How steeply distances fall along an axis of the grid, by the two neighbours of a cell. Away from one that is closed,
/// and not at all where both are.
float FlowField::fall_along(std::size_t cell, std::int32_t place, std::size_t step) const
{
    const float before = place > 0 ? distances_[cell - step] : INFINITY,
                after = place + 1 < side_ ? distances_[cell + step] : INFINITY, here = distances_[cell];
    if (before == INFINITY && after == INFINITY) return 0;
    if (before == INFINITY) return here - after;
    if (after == INFINITY) return before - here;
    return (before - after) / 2;
}

}  // namespace motley::bench
