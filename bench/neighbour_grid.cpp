// Discs counted into cells.
#include "neighbour_grid.h"

#include <algorithm>
#include <cmath>

namespace motley::bench {
namespace {

/// A grid never has more cells than this: a lone walker far away must not cost memory, only some tests.
constexpr double most_cells = 1 << 24;
constexpr std::int64_t discs_per_chunk = 8192;

}  // namespace

void NeighbourGrid::sort(std::span<const Vec3<double>> positions, std::span<const float> radii, float margin,
                         Executor& executor)
{
    const std::size_t count = positions.size();
    const auto for_discs = [&](const auto& work) {
        parallel_for(executor, static_cast<std::int64_t>(count), discs_per_chunk,
                     [&](std::int64_t begin, std::int64_t end) {
                         work(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
                     });
    };
    bounds_.assign(count / discs_per_chunk + 1, {});
    for_discs([&](std::size_t begin, std::size_t end) {
        Bounds b;
        for (std::size_t i = begin; i < end; ++i) {
            b.min_x = std::min(b.min_x, positions[i].x);
            b.min_y = std::min(b.min_y, positions[i].y);
            b.max_x = std::max(b.max_x, positions[i].x);
            b.max_y = std::max(b.max_y, positions[i].y);
            b.largest_radius = std::max(b.largest_radius, radii[i]);
        }
        bounds_[begin / discs_per_chunk] = b;
    });
    Bounds all;
    for (const Bounds& b : bounds_) {
        all.min_x = std::min(all.min_x, b.min_x);
        all.min_y = std::min(all.min_y, b.min_y);
        all.max_x = std::max(all.max_x, b.max_x);
        all.max_y = std::max(all.max_y, b.max_y);
        all.largest_radius = std::max(all.largest_radius, b.largest_radius);
    }
    if (count == 0) all.min_x = all.min_y = all.max_x = all.max_y = 0;
    low_ = {all.min_x, all.min_y};
    longest_reach_ = static_cast<double>(all.largest_radius + margin);
    double cell = std::max(1e-3, 1.0001 * static_cast<double>(2 * all.largest_radius + margin));
    while ((all.max_x - all.min_x) / cell * ((all.max_y - all.min_y) / cell) > most_cells) cell *= 2;
    cells_per_metre_ = 1 / cell;
    width_ = static_cast<std::int32_t>((all.max_x - all.min_x) / cell) + 1;
    height_ = static_cast<std::int32_t>((all.max_y - all.min_y) / cell) + 1;

    cells_.resize(count);
    sorted_.resize(count);
    for_discs([&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            cells_[i] =
                static_cast<std::int32_t>(index_of(column_of(positions[i].x), row_of(positions[i].y)));
        }
    });
    // Counts two ahead, so that after the sums starts_[c + 1] is where cell c begins, and handing out places moves it
    // on to where cell c ends, that is to where cell c + 1 begins.
    starts_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 2, 0);
    for (const std::int32_t c : cells_) ++starts_[static_cast<std::size_t>(c) + 2];
    for (std::size_t c = 2; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    for (std::int32_t& cell_or_place : cells_)
        cell_or_place = starts_[static_cast<std::size_t>(cell_or_place) + 1]++;
    for_discs([&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Sorted& place = sorted_[static_cast<std::size_t>(cells_[i])];
            place.x = static_cast<float>(positions[i].x - low_.x);
            place.y = static_cast<float>(positions[i].y - low_.y);
            place.reach = radii[i] + margin / 2;
            place.disc = static_cast<std::int32_t>(i);
        }
    });
}

std::size_t NeighbourGrid::find_pairs(std::int64_t chunk, std::vector<Pair>& pairs) const
{
    std::size_t found = 0;
    for (std::int32_t y = first_row(chunk); y < first_row(chunk + 1); ++y) {
        for (std::int32_t x = 0; x < width_; ++x) {
            const std::int32_t begin = starts_[index_of(x, y)], end = starts_[index_of(x, y) + 1];
            if (begin == end) continue;
            // Cells in line are discs in line: the rest of this cell and the one to the right, then three above.
            const std::int32_t right_end = x + 1 < width_ ? starts_[index_of(x + 1, y) + 1] : end;
            std::int32_t above_begin = 0, above_end = 0;
            if (y + 1 < height_) {
                above_begin = starts_[index_of(x > 0 ? x - 1 : 0, y + 1)];
                above_end = starts_[index_of(x + 1 < width_ ? x + 1 : x, y + 1) + 1];
            }
            const std::size_t most =
                found + static_cast<std::size_t>(end - begin) *
                            static_cast<std::size_t>(right_end - begin + above_end - above_begin);
            if (pairs.size() < most) pairs.resize(most + most / 2 + 1024);
            Pair* const list = pairs.data();
            for (std::int32_t i = begin; i < end; ++i) {
                const Sorted me = sorted_[static_cast<std::size_t>(i)];
                const auto look = [&](std::int32_t from, std::int32_t to) {
                    for (std::int32_t j = from; j < to; ++j) {
                        const Sorted& other = sorted_[static_cast<std::size_t>(j)];
                        const float dx = other.x - me.x, dy = other.y - me.y, near = other.reach + me.reach;
                        // Written always and counted when near: one in three is, which no predictor guesses.
                        list[found].a = me.disc;
                        list[found].b = other.disc;
                        found += dx * dx + dy * dy < near * near ? 1 : 0;
                    }
                };
                look(i + 1, right_end);
                look(above_begin, above_end);
            }
        }
    }
    return found;
}

}  // namespace motley::bench
