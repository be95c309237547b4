// The impulses of the last step by pair of bodies, for contacts that are found anew. A list for each row, of the pairs
// in which its body came first.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene_core.h"
#include "stores/disc_store.h"

namespace motley {

class CarriedImpulses {
  public:
    struct Impulse {
        float normal = 0, tangent = 0;
        float side = 0;                           ///< WallTouch::side; 0: the pair was not known
        float step_normal = 0, step_tangent = 0;  ///< of the whole step; only of bodies that sleep
    };
    /// Starts over: then count() of every band, then open(), then keep() of band 0, then of every other band. Count and
    /// keep may run on different threads.
    void begin(const SceneCore& scene);
    void count(const DiscStore& discs, std::size_t band);
    void open();
    void keep(const DiscStore& discs, std::size_t band);

    /// The impulses of two discs, in either order, or of a disc and a wall.
    [[nodiscard]] Impulse of_pair(std::uint32_t row_a, std::uint32_t row_b) const
    {
        const Entry* entry = find(row_a, row_b);
        if (entry == nullptr) entry = find(row_b, row_a);
        return entry == nullptr ? Impulse{} : entry->impulse;
    }
    [[nodiscard]] Impulse of_wall(std::uint32_t row, std::uint32_t segment) const
    {
        const Entry* entry = find(row, wall_bit | segment);
        return entry == nullptr ? Impulse{} : entry->impulse;
    }

  private:
    static constexpr std::uint32_t none = UINT32_MAX;
    static constexpr std::uint32_t wall_bit = 1U << 31;
    struct Entry {
        std::uint32_t other;  ///< row of the second body, or wall_bit and the segment
        std::uint32_t next;   ///< entry of the same row, or none
        Impulse impulse;
    };
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> heads_;  ///< by row: its first entry, or none
    std::vector<std::uint32_t>
        places_;  ///< by band: the number of its entries, then the place of the first one

    [[nodiscard]] const Entry* find(std::uint32_t row, std::uint32_t other) const
    {
        for (std::uint32_t e = heads_[row]; e != none; e = entries_[e].next) {
            if (entries_[e].other == other) return &entries_[e];
        }
        return nullptr;
    }
    template <class Work>
    static void for_each_kept(const DiscStore& discs, std::size_t band, const Work& work);
};

}  // namespace motley
