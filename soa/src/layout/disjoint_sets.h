// Disjoint sets that grow as constraints connect their members.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "stores/array.h"

namespace motley {

/// Union-find. The smallest member names its set, so that its name does not depend on the order of ties.
class DisjointSets {
  public:
    /// Starts over with `size` sets of one member each.
    void reset(std::size_t size)
    {
        parent_.resize(size);
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    [[nodiscard]] std::size_t size() const { return parent_.size(); }
    [[nodiscard]] std::int32_t root_of(std::int32_t member)
    {
        while (parent_[static_cast<std::size_t>(member)] != member) {
            std::int32_t& up = parent_[static_cast<std::size_t>(member)];
            up = parent_[static_cast<std::size_t>(up)];
            member = up;
        }
        return member;
    }
    void tie(std::int32_t a, std::int32_t b)
    {
        const std::int32_t u = root_of(a), v = root_of(b);
        parent_[static_cast<std::size_t>(std::max(u, v))] = std::min(u, v);
    }
    /// Points every member at its root, so that root() is a single read until the next tie().
    void flatten()
    {
        for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = root_of(static_cast<std::int32_t>(i));
    }
    [[nodiscard]] std::int32_t root(std::size_t member) const { return parent_[member]; }

  private:
    Array<std::int32_t> parent_;
};

}  // namespace motley
