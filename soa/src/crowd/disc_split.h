// Sorts the contacts of a band anew into those that are solved and those that rest, when bodies have fallen asleep or
// woken. A contact rests if all of its bodies that could move sleep; then it keeps its impulses, and no step visits it.
#pragma once

#include <array>
#include <cstdint>

#include "crowd/block_filler.h"
#include "scene/scene_core.h"
#include "stores/array.h"
#include "stores/disc_store.h"

namespace motley {

class DiscSplit {
  public:
    using Fillers = std::array<BlockFiller, disc_class_count>;
    /// Bands may be divided on different threads, each with its own DiscSplit and fillers.
    void divide(const SceneCore& scene, DiscBand& band, Fillers& fillers, Fillers& resting_fillers);

  private:
    Array<float> floats_;        ///< rows, impulses and sums of contacts, one after another
    Array<std::uint32_t> rows_;  ///< of their bodies, two a contact
    Array<WallTouch> touches_;   ///< of walls
    Array<std::uint8_t> rests_;  ///< by contact

    template <DiscClass c>
    void divide_class(const SceneCore& scene, DiscBand& band, BlockFiller& filler, BlockFiller& resting);
    template <DiscClass c>
    void take_out(const SceneCore& scene, const DiscBlocks& blocks);
};

}  // namespace motley
