// Sorts discs into cells by counting.
#include "worlds/neighbour_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace motley::bench {
namespace {

/// The most cells of a grid: with a limit, one person far away costs more distance tests, not memory.
constexpr double most_cells = 1 << 24;
constexpr std::int64_t discs_per_chunk = 1024;
/// The most bands of rows that discs are sorted into first: few enough to write to all of them in turn.
constexpr std::int32_t most_bands = 128;

/// Calls work(begin, end) for chunks of so many discs.
template <class Work>
void for_discs(std::size_t count, Executor& executor, const Work& work)
{
    parallel_for(executor, static_cast<std::int64_t>(count), discs_per_chunk,
                 [&](std::int64_t begin, std::int64_t end) {
                     work(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
                 });
}

}  // namespace

void NeighbourGrid::sort(std::span<const Vec3<double>> positions, std::span<const float> radii, float margin,
                         Executor& executor)
{
    const std::size_t count = positions.size();
    bounds_.assign(count / discs_per_chunk + 1, {});
    for_discs(count, executor, [&](std::size_t begin, std::size_t end) {
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
    // Plus one: a line of people has no area, but cells.
    while (((all.max_x - all.min_x) / cell + 1) * ((all.max_y - all.min_y) / cell + 1) > most_cells)
        cell *= 2;
    cells_per_metre_ = 1 / cell;
    width_ = static_cast<std::int32_t>((all.max_x - all.min_x) / cell) + 1;
    height_ = static_cast<std::int32_t>((all.max_y - all.min_y) / cell) + 1;

    // Coordinates are floats from the corner. Where their rounding is no longer small beside the margin, the search reaches
    // farther, so that no pair is missed: two coordinates of two discs, each off by half a unit in the last place.
    const double rounding = 4 * std::ldexp(std::max(all.max_x - all.min_x, all.max_y - all.min_y), -24);
    const double reach =
        static_cast<double>(margin) + (rounding > 0.01 * static_cast<double>(margin) ? rounding : 0);

    sort_into_bands(positions, radii, static_cast<float>(reach), executor);
    starts_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1);
    parallel_for(executor, band_count_, 1, [&](std::int64_t band, std::int64_t) { sort_band(band); });
    starts_.back() = static_cast<std::int32_t>(count);
}

/// A stable counting sort, so that the order does not depend on the threads. It counts the discs of each chunk in
/// each band, and computes from the counts where each chunk writes.
void NeighbourGrid::sort_into_bands(std::span<const Vec3<double>> positions, std::span<const float> radii,
                                    float margin, Executor& executor)
{
    const std::size_t count = positions.size(), chunks = count / discs_per_chunk + 1;
    band_shift_ = static_cast<int>(std::bit_width(static_cast<std::uint32_t>((height_ - 1) / most_bands)));
    band_count_ = ((height_ - 1) >> band_shift_) + 1;
    const auto bands = static_cast<std::size_t>(band_count_);
    cells_.resize(count);
    bands_.resize(count);
    placed_.resize(count);
    sorted_.resize(count);
    places_.assign(chunks * bands, 0);
    const auto for_each_disc = [&](const auto& work) {
        for_discs(count, executor, [&](std::size_t begin, std::size_t end) {
            std::int32_t* places = places_.data() + begin / discs_per_chunk * bands;
            for (std::size_t i = begin; i < end; ++i) work(i, places);
        });
    };
    for_each_disc([&](std::size_t i, std::int32_t* places) {
        const std::int32_t row = row_of(positions[i].y);
        cells_[i] = static_cast<std::int32_t>(index_of(column_of(positions[i].x), row));
        bands_[i] = static_cast<std::uint8_t>(row >> band_shift_);
        ++places[bands_[i]];
    });
    std::int32_t next = 0;
    first_in_band_.resize(bands + 1);
    for (std::size_t band = 0; band < bands; ++band) {
        first_in_band_[band] = next;
        for (std::size_t chunk = 0; chunk < chunks; ++chunk)
            next += std::exchange(places_[chunk * bands + band], next);
    }
    first_in_band_[bands] = next;
    for_each_disc([&](std::size_t i, std::int32_t* places) {
        const auto place = static_cast<std::size_t>(places[bands_[i]]++);
        placed_[place] = {
            {static_cast<float>(positions[i].x - low_.x), static_cast<float>(positions[i].y - low_.y),
             radii[i] + margin / 2, static_cast<std::int32_t>(i)},
            cells_[i]};
    });
}

void NeighbourGrid::sort_band(std::int64_t band)
{
    const auto first_row = static_cast<std::int32_t>(band) << band_shift_;
    const std::size_t first_cell = index_of(0, first_row);
    const std::size_t last_cell = index_of(0, std::min(first_row + (1 << band_shift_), height_));
    const std::span<std::int32_t> starts(starts_.data() + first_cell, last_cell - first_cell);
    const auto begin = static_cast<std::size_t>(first_in_band_[static_cast<std::size_t>(band)]);
    const auto end = static_cast<std::size_t>(first_in_band_[static_cast<std::size_t>(band) + 1]);
    const std::span<const Placed> discs(placed_.data() + begin, end - begin);
    std::fill(starts.begin(), starts.end(), 0);
    for (const Placed& disc : discs) ++starts[static_cast<std::size_t>(disc.cell) - first_cell];
    auto next = static_cast<std::int32_t>(end);
    for (std::size_t c = starts.size(); c-- > 0;) starts[c] = next -= starts[c];
    // Placing the discs advances each cell's start to that cell's end,
    for (const Placed& disc : discs)
        sorted_[static_cast<std::size_t>(starts[static_cast<std::size_t>(disc.cell) - first_cell]++)] =
            disc.disc;
    // which is where the next cell starts.
    for (std::size_t c = starts.size(); c-- > 1;) starts[c] = starts[c - 1];
    starts[0] = static_cast<std::int32_t>(begin);
}

std::size_t NeighbourGrid::find_pairs(std::int64_t chunk, std::vector<Pair>& pairs) const
{
    std::size_t found = 0;
    const Rectangle cells = cells_of(chunk);
    for (std::int32_t y = cells.first_row; y < cells.end_row; ++y) {
        for (std::int32_t x = cells.first_column; x < cells.end_column; ++x) {
            const std::int32_t begin = starts_[index_of(x, y)], end = starts_[index_of(x, y) + 1];
            if (begin == end) continue;
            // Neighbouring cells of a row are contiguous in sorted_: first the rest of this cell and the cell to the
            // right, then three cells above.
            const std::int32_t right_end = x + 1 < width_ ? starts_[index_of(x + 1, y) + 1] : end;
            std::int32_t above_begin = 0, above_end = 0;
            if (y + 1 < height_) {
                above_begin = starts_[index_of(x > 0 ? x - 1 : 0, y + 1)];
                above_end = starts_[index_of(x + 1 < width_ ? x + 1 : x, y + 1) + 1];
            }
            for (std::int32_t i = begin; i < end; ++i) {
                // Room for what one disc may find: for all of a cell at once it would grow with the cell's square.
                const std::size_t most =
                    found + static_cast<std::size_t>(right_end - i - 1 + above_end - above_begin);
                if (pairs.size() < most) pairs.resize(most + most / 2 + 1024);
                Pair* const list = pairs.data();
                const Sorted me = sorted_[static_cast<std::size_t>(i)];
                const auto look = [&](std::int32_t from, std::int32_t to) {
                    for (std::int32_t j = from; j < to; ++j) {
                        const Sorted& other = sorted_[static_cast<std::size_t>(j)];
                        const float dx = other.x - me.x, dy = other.y - me.y, near = other.reach + me.reach;
                        // The pair is always written, and counted only when near. One in three is, which a branch
                        // would often mispredict.
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
