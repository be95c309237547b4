// A uniform grid: discs are counted into cells and sorted by them every step, then each looks at the half of its
// neighbourhood that lies after it. The order of pairs depends on positions alone, never on threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

class NeighbourGrid {
  public:
    /// Sorts the discs into cells of `cell` metres; a disc reaches at most half a cell.
    void sort(std::span<const Vec3<double>> positions, double cell, Executor& executor);

    /// Calls emit(chunk, i, j) for each pair closer than `reach`, chunks in parallel, pairs of a chunk in order.
    template <class Emit>
    void for_each_pair(float reach, Executor& executor, const Emit& emit) const
    {
        parallel_for(executor, chunk_count(), 1, [&](std::int64_t chunk, std::int64_t) {
            for (std::int32_t y = first_row(chunk); y < first_row(chunk + 1); ++y)
                pairs_of_row(y, reach, chunk, emit);
        });
    }
    /// Calls visit(chunk, i) for every disc, chunk by chunk in the order of cells.
    template <class Visit>
    void for_each_disc(std::int64_t chunk, const Visit& visit) const
    {
        const std::int32_t begin = starts_[index_of(0, first_row(chunk))];
        const std::int32_t end = starts_[index_of(0, first_row(chunk + 1))];
        for (std::int32_t i = begin; i < end; ++i) visit(sorted_[static_cast<std::size_t>(i)].disc);
    }
    /// Chunks of rows; depends on the crowd only.
    [[nodiscard]] std::int64_t chunk_count() const { return (height_ + rows_per_chunk - 1) / rows_per_chunk; }

  private:
    static constexpr std::int32_t rows_per_chunk = 4;
    struct Sorted {
        float x, y;  ///< from the grid's corner, m
        std::int32_t disc;
    };
    std::vector<std::int32_t> cells_;   ///< of each disc
    std::vector<std::int32_t> starts_;  ///< of each cell in sorted_, and one past the last
    std::vector<Sorted> sorted_;
    std::int32_t width_ = 1, height_ = 1;

    [[nodiscard]] std::size_t index_of(std::int32_t x, std::int32_t y) const
    {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] std::int32_t first_row(std::int64_t chunk) const
    {
        const auto row = static_cast<std::int32_t>(chunk) * rows_per_chunk;
        return row < height_ ? row : height_;
    }

    template <class Emit>
    void pairs_of_row(std::int32_t y, float reach, std::int64_t chunk, const Emit& emit) const
    {
        const float reach2 = reach * reach;
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
            for (std::int32_t i = begin; i < end; ++i) {
                const Sorted& me = sorted_[static_cast<std::size_t>(i)];
                const auto look = [&](std::int32_t from, std::int32_t to) {
                    for (std::int32_t j = from; j < to; ++j) {
                        const Sorted& other = sorted_[static_cast<std::size_t>(j)];
                        const float dx = other.x - me.x, dy = other.y - me.y;
                        if (dx * dx + dy * dy < reach2) emit(chunk, me.disc, other.disc);
                    }
                };
                look(i + 1, right_end);
                look(above_begin, above_end);
            }
        }
    }
};

}  // namespace motley::bench
