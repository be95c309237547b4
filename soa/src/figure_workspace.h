// Where a worker solves figures. What a block that is alone needs only while it is solved (its bodies in lanes, its tree,
// the rows of its joints) lies here, the same few hundred kilobytes for every block: they stay in the core's second level
// cache, where memory of each block's own would stream through it.
#pragma once

#include <span>
#include <vector>

#include "figure.h"

namespace motley {

class FigureWorkspace {
  public:
    /// Room for any of these blocks. Allocates only when one is larger than all before.
    void make_room(std::span<const FigureBlock> blocks);
    /// The block as it is solved here, until the next one is taken in.
    [[nodiscard]] FigureBlock take_in(const FigureBlock& block);

  private:
    AlignedVector<float> floats_;
    std::vector<FigureBlock::Joint> joints_;
};

}  // namespace motley
