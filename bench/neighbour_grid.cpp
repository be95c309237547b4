// Discs counted into cells.
#include "neighbour_grid.h"

#include <algorithm>
#include <cmath>

namespace motley::bench {
namespace {

/// A grid never has more cells than this: a lone walker far away must not cost memory, only some tests.
constexpr double most_cells = 1 << 24;

}  // namespace

void NeighbourGrid::sort(std::span<const Vec3<double>> positions, double cell, Executor& executor)
{
    double min_x = 1e300, min_y = 1e300, max_x = -1e300, max_y = -1e300;
    for (const Vec3<double>& p : positions) {
        min_x = std::min(min_x, p.x);
        min_y = std::min(min_y, p.y);
        max_x = std::max(max_x, p.x);
        max_y = std::max(max_y, p.y);
    }
    if (positions.empty()) min_x = min_y = max_x = max_y = 0;
    while ((max_x - min_x) / cell * ((max_y - min_y) / cell) > most_cells) cell *= 2;
    width_ = static_cast<std::int32_t>((max_x - min_x) / cell) + 1;
    height_ = static_cast<std::int32_t>((max_y - min_y) / cell) + 1;

    const std::size_t count = positions.size();
    cells_.resize(count);
    sorted_.resize(count);
    starts_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 2, 0);
    const double scale = 1 / cell;
    parallel_for(executor, static_cast<std::int64_t>(count), 8192, [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            const auto x = std::min(static_cast<std::int32_t>((positions[i].x - min_x) * scale), width_ - 1);
            const auto y = std::min(static_cast<std::int32_t>((positions[i].y - min_y) * scale), height_ - 1);
            cells_[i] = static_cast<std::int32_t>(index_of(x, y));
        }
    });
    // Counts two ahead, so that after the sums starts_[c + 1] is where cell c begins, and filling moves it on to
    // where cell c ends, that is to where cell c + 1 begins.
    for (const std::int32_t c : cells_) ++starts_[static_cast<std::size_t>(c) + 2];
    for (std::size_t c = 2; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t at = starts_[static_cast<std::size_t>(cells_[i]) + 1]++;
        sorted_[static_cast<std::size_t>(at)] = {static_cast<float>(positions[i].x - min_x),
                                                 static_cast<float>(positions[i].y - min_y),
                                                 static_cast<std::int32_t>(i)};
    }
}

}  // namespace motley::bench
