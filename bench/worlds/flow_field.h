// The way to the nearest of some places around what stands in between, for everybody at once: people look up their
// direction where they are.
#pragma once

#include <cstdint>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

/// A square grid of cells of a metre. Distances are those of paths over the eight neighbours of a cell (E. W. Dijkstra,
/// "A Note on Two Problems in Connexion with Graphs", 1959) that cut no corner of a closed cell.
class FlowField {
  public:
    enum class Cell : std::uint8_t { open, closed, goal };

    /// Of `side` x `side` cells, row by row from y = 0.
    FlowField(std::int32_t side, const std::vector<Cell>& cells);

    /// The unit direction of the shortest way, as distances fall about the cell of a place, m; 0 in a goal, or without a way.
    [[nodiscard]] Vec2<float> direction(const Vec2<double>& at) const { return directions_[cell_of(at)]; }
    /// m, from the middle of that cell to the middle of the nearest goal; infinite without a way.
    [[nodiscard]] float distance(const Vec2<double>& at) const { return distances_[cell_of(at)]; }

  private:
    std::int32_t side_;
    std::vector<float> distances_;
    std::vector<Vec2<float>> directions_;

    [[nodiscard]] std::size_t cell_of(const Vec2<double>& at) const;
    [[nodiscard]] float fall_along(std::size_t cell, std::int32_t place, std::size_t step) const;
};

}  // namespace motley::bench
