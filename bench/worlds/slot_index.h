// Finds a body in a host's own list by its handle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

class SlotIndex {
  public:
    void build(std::span<const BodyId> bodies)
    {
        places_.clear();
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            if (places_.size() <= bodies[i].slot) places_.resize(bodies[i].slot + std::size_t{1}, -1);
            places_[bodies[i].slot] = static_cast<std::int32_t>(i);
        }
    }
    /// The place of a living body in the list; -1 if it is not there.
    [[nodiscard]] std::int32_t of(BodyId body) const
    {
        return body.slot < places_.size() ? places_[body.slot] : -1;
    }

  private:
    std::vector<std::int32_t> places_;
};

}  // namespace motley::bench
