// Contacts of discs, which the library found, as contacts of the reference.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motley/reference/world.h"
#include "scene/scene_core.h"

namespace motley::reference {

class DiscPoints {
  public:
    /// Appends the contacts of discs that a step solves to `points`, and what they bore in the last step to `recalled`. Their rows
    /// are made. index_of_slot[s] is the index of the body with slot s in the world. Their keys are none of those that `points` has.
    void list(const SceneCore& scene, std::span<const int> index_of_slot, std::vector<ContactPoint>& points,
              World::ContactResults& recalled);
    /// Writes what they bore into their blocks. Allocates nothing.
    void store(const World& world, DiscStore& discs) const;

  private:
    static constexpr std::uint64_t no_key = UINT64_MAX;
    std::vector<std::uint64_t>
        keys_;  ///< by contact, in the order of the blocks; no_key where none is solved
};

}  // namespace motley::reference
