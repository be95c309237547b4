// The memory in which a worker solves figures. A block that is alone (see Figures) needs its bodies in lanes, its
// tree and the rows of its joints only while it is solved. They are kept here, in the same few hundred kilobytes for
// every block, which stay in the core's second level cache; memory of each block's own would stream through it.
#pragma once

#include <span>
#include <vector>

#include "figures/figure.h"

namespace motley {

class FigureWorkspace {
  public:
    /// Makes space for the largest of these blocks. Allocates only when one is larger than all before.
    void make_room(std::span<const FigureBlock> blocks);
    /// The block with its pointers into this memory; valid until the next take_in().
    [[nodiscard]] FigureBlock take_in(const FigureBlock& block);

  private:
    AlignedVector<float> floats_;
    std::vector<FigureBlock::Joint> joints_;
};

}  // namespace motley
