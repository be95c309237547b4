// Who is near whom, as steering needs it: a list for each person, across the seam of a period as well.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "worlds/crowd.h"
#include "worlds/neighbour_grid.h"

namespace motley::bench {

class Neighbours {
  public:
    /// Finds all pairs of people with a gap below `within`, m, at the observed positions. A period must be longer than
    /// twice that, and people lie inside it.
    void find(const Crowd& crowd, float within, Executor& executor);
    /// Indices in crowd.agents.
    [[nodiscard]] std::span<const std::int32_t> of(std::size_t person) const
    {
        return std::span(others_).subspan(starts_[person], starts_[person + 1] - starts_[person]);
    }

  private:
    NeighbourGrid grid_;
    std::vector<Vec3<double>> positions_;  ///< of the people, and of the images of those near the seam
    std::vector<float> radii_;             ///< likewise
    std::vector<std::int32_t> person_;     ///< whose place or image each is
    std::vector<NeighbourGrid::Pair> pairs_, of_chunk_;
    std::vector<std::size_t> starts_;
    std::vector<std::int32_t> others_;

    void add_images(const Crowd& crowd, double within);
    void sort_by_person(std::size_t people);
};

}  // namespace motley::bench
