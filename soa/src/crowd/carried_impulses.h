// The impulses of the last step by pair of bodies, for contacts that are found anew. A list for each row, of the pairs
// in which its body came first.
#pragma once

#include <cstdint>

#include "scene/scene_core.h"
#include "stores/array.h"
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

    // Between keep() and the search, when people move from scene to scene:
    /// Calls take(row, other, is_wall, impulse) for each that is kept, and forgets those for which it returns true. `other` is
    /// the row of the second body, or the segment.
    template <class Take>
    void take_out(const Take& take)
    {
        for (std::uint32_t row = 0; row < heads_.size(); ++row) {
            for (std::uint32_t e = heads_[row]; e != none; e = entries_[e].next) {
                Entry& entry = entries_[e];
                if (entry.other != none &&
                    take(row, entry.other & ~wall_bit, (entry.other & wall_bit) != 0, entry.impulse))
                    entry.other = none;
            }
        }
    }
    /// Makes room for bodies in so many rows, and for so many more impulses.
    void make_room(std::size_t rows, std::size_t impulses);
    /// A row has a new body.
    void forget_row(std::uint32_t row) { heads_[row] = none; }
    void put_in(std::uint32_t row, std::uint32_t other, bool is_wall, const Impulse& impulse)
    {
        entries_[used_] = {is_wall ? wall_bit | other : other, heads_[row], impulse};
        heads_[row] = used_++;
    }

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
    Array<Entry> entries_;
    std::uint32_t used_ = 0;
    Array<std::uint32_t> heads_;   ///< by row: its first entry, or none
    Array<std::uint32_t> places_;  ///< by band: the number of its entries, then the place of the first one

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
