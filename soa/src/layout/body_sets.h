// Sets of moving bodies, of any kinds, that constraints connect.
#pragma once

#include <array>
#include <cstdint>

#include "layout/disjoint_sets.h"
#include "stores/body_store.h"

namespace motley {

/// DisjointSets of all moving rows, which are numbered kind after kind. Fixed bodies connect nothing.
class BodySets {
  public:
    /// Starts over with every row in a set of its own. size_of(kind) is the number of rows of a kind.
    template <class SizeOf>
    void reset(const SizeOf& size_of)
    {
        std::size_t count = 0;
        for (std::size_t kind = 0; kind < moving_kinds; ++kind) {
            first_[kind] = count;
            count += static_cast<std::size_t>(size_of(static_cast<BodyKind>(kind)));
        }
        sets_.reset(count);
    }
    void tie(BodyRow a, BodyRow b)
    {
        if (a.kind() == BodyKind::fixed || b.kind() == BodyKind::fixed) return;
        sets_.tie(static_cast<std::int32_t>(number(a)), static_cast<std::int32_t>(number(b)));
    }
    /// To be called after the last tie() and before root().
    void flatten() { sets_.flatten(); }

    /// The number of moving rows, and the index of one of them.
    [[nodiscard]] std::size_t size() const { return sets_.size(); }
    [[nodiscard]] std::size_t number(BodyRow body) const
    {
        return first_[static_cast<std::size_t>(body.kind())] + body.row();
    }
    /// The index that names the set of a moving body.
    [[nodiscard]] std::int32_t root(BodyRow body) const { return sets_.root(number(body)); }

  private:
    static constexpr int moving_kinds = body_kind_count - 1;
    std::array<std::size_t, moving_kinds> first_{};  ///< index of the first row of a kind
    DisjointSets sets_;
};

}  // namespace motley
