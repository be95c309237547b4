// A uniform grid. In every step discs are sorted into bands of rows and then into cells; then each disc is tested
// against the half of its neighbourhood that comes after it. The order of pairs depends on positions alone, never on
// threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "stores/aligned_vector.h"

namespace motley::bench {

class NeighbourGrid {
  public:
    /// Two discs that are near each other.
    struct Pair {
        std::int32_t a, b;
    };

    /// Sorts the discs into cells. Discs are near each other when the gap between them is below `margin`, m. Where they
    /// are so far apart that rounding to float is large beside the margin, some pairs beyond it are listed too.
    void sort(std::span<const Vec3<double>> positions, std::span<const float> radii, float margin,
              Executor& executor);

    /// Puts the pairs of a chunk at the front of `pairs`, which grows as needed, and returns how many. Chunks may
    /// run on different threads.
    std::size_t find_pairs(std::int64_t chunk, std::vector<Pair>& pairs) const;
    /// Calls visit(i) for every disc of a chunk whose cell overlaps the box, in the order of cells.
    template <class Visit>
    void for_each_disc_in(std::int64_t chunk, Vec2<double> low, Vec2<double> high, const Visit& visit) const
    {
        const Rectangle cells = cells_of(chunk);
        const std::int32_t first_column = std::max(cells.first_column, column_of(low.x));
        const std::int32_t last_column = std::min(cells.end_column - 1, column_of(high.x));
        if (first_column > last_column) return;
        const std::int32_t last_row = std::min(cells.end_row - 1, row_of(high.y));
        for (std::int32_t y = std::max(cells.first_row, row_of(low.y)); y <= last_row; ++y) {
            const std::int32_t begin = starts_[index_of(first_column, y)];
            const std::int32_t end = starts_[index_of(last_column, y) + 1];
            for (std::int32_t i = begin; i < end; ++i) visit(sorted_[static_cast<std::size_t>(i)].disc);
        }
    }
    /// The largest distance from its centre at which a disc of the last sort can be near something, m.
    [[nodiscard]] double longest_reach() const { return longest_reach_; }
    /// Chunks go down one strip of columns after the other, so that consecutive pairs involve few discs. They depend
    /// on the crowd alone.
    [[nodiscard]] std::int64_t chunk_count() const
    {
        return std::int64_t{chunks_down()} * pieces(width_, columns_per_strip);
    }

  private:
    static constexpr std::int32_t columns_per_strip = 128, rows_per_chunk = 8;
    /// The cells of a chunk.
    struct Rectangle {
        std::int32_t first_column, end_column, first_row, end_row;
    };
    struct Sorted {
        float x, y;   ///< from the grid's corner, m
        float reach;  ///< m
        std::int32_t disc;
    };
    struct Placed {
        Sorted disc;
        std::int32_t cell;
    };
    AlignedVector<std::int32_t> cells_;   ///< of each disc
    AlignedVector<std::uint8_t> bands_;   ///< likewise
    AlignedVector<Placed> placed_;        ///< by band; within a band in the order of the input
    AlignedVector<std::int32_t> places_;  ///< of each chunk of discs in each band: the next place in placed_
    std::vector<std::int32_t> first_in_band_;
    std::int32_t band_count_ = 0;
    int band_shift_ = 0;                  ///< a band is 2^this rows
    AlignedVector<std::int32_t> starts_;  ///< of each cell in sorted_, and one past the last
    AlignedVector<Sorted> sorted_;
    std::int32_t width_ = 1, height_ = 1;
    Vec2<double> low_{};
    double cells_per_metre_ = 1, longest_reach_ = 0;
    struct Bounds {
        double min_x = 1e300, min_y = 1e300, max_x = -1e300, max_y = -1e300;
        float largest_radius = 0;
    };
    std::vector<Bounds> bounds_;  ///< of each chunk of discs

    void sort_into_bands(std::span<const Vec3<double>> positions, std::span<const float> radii, float margin,
                         Executor& executor);
    void sort_band(std::int64_t band);
    [[nodiscard]] std::int32_t column_of(double x) const { return cell_along(x - low_.x, width_); }
    [[nodiscard]] std::int32_t row_of(double y) const { return cell_along(y - low_.y, height_); }
    [[nodiscard]] std::int32_t cell_along(double offset, std::int32_t cells) const
    {
        return static_cast<std::int32_t>(
            std::clamp(offset * cells_per_metre_, 0.0, static_cast<double>(cells - 1)));
    }

    [[nodiscard]] std::size_t index_of(std::int32_t x, std::int32_t y) const
    {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    static std::int32_t pieces(std::int32_t cells, std::int32_t a_piece)
    {
        return (cells + a_piece - 1) / a_piece;
    }
    [[nodiscard]] std::int32_t chunks_down() const { return pieces(height_, rows_per_chunk); }
    [[nodiscard]] Rectangle cells_of(std::int64_t chunk) const
    {
        const auto column = static_cast<std::int32_t>(chunk / chunks_down()) * columns_per_strip;
        const auto row = static_cast<std::int32_t>(chunk % chunks_down()) * rows_per_chunk;
        return {column, std::min(column + columns_per_strip, width_), row,
                std::min(row + rows_per_chunk, height_)};
    }
};

}  // namespace motley::bench
