// Discs, walls, and the contacts that were found between them. The contacts are kept from step to step in the blocks in
// which they are solved, so that nothing is listed, coloured or looked up in a step in which the neighbours stay the
// same.
//
// Bodies are sorted into strips of the plane, and consecutive strips into bands. A contact belongs to the band of its
// first body, and its other body is in the same band or in the next one. So bands of even number share no body with
// each other, nor do those of odd number. Band 0 is solved by itself: it has the contacts of discs that reach further.
// Contacts that were found since the last search of all discs are added to the bands that their bodies were in then.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "motley/core/crowd.h"
#include "stores/aligned_vector.h"
#include "stores/disc_class.h"
#include "stores/lane_block.h"

namespace motley {

/// Whether something of such a category and mask meets `other`: each has a category bit that the other one's mask has.
template <class One, class Other>
constexpr bool do_meet(const One& one, const Other& other)
{
    return (one.category & other.mask) != 0 && (other.category & one.mask) != 0;
}

/// Radius 0: the body has no disc.
struct DiscShape {
    float radius = 0, friction = 0;
    std::uint32_t category = 1, mask = UINT32_MAX;
};

/// A straight piece of a wall.
struct WallSegment {
    Vec2<double> from{}, to{};  ///< m, in the frame of the body, or of the world where that is static
    BodyId body{};
    float friction = 0;
    std::uint32_t category = 1, mask = UINT32_MAX;
    std::uint32_t wall = 0;                         ///< slot
    float surface_speed = 0, max_force = INFINITY;  ///< as in WallDefinition
    std::uint32_t is_one_way = 0;
    std::uint32_t number = 0;  ///< among the segments of its wall

    /// Whether contacts must be told what the surface does.
    [[nodiscard]] bool has_own_surface() const { return surface_speed != 0 || max_force < INFINITY; }
};

/// A segment by its wall and its number there, which stay when other walls are removed. The null handle: no wall.
struct WallMet {
    WallId wall{};
    std::uint32_t number = 0;
    std::int32_t side = 0;  ///< of what met it: 1: left; -1: right; 0: at an end of the segment, or not known
};

/// A disc near a wall.
struct WallTouch {
    static constexpr float passing = 2;
    std::uint32_t segment = 0;
    /// 1: the disc is to the left of the segment as it runs from `from` to `to`; -1: to the right; `passing`: a one-way
    /// wall does not hold it.
    float side = 1;
};

/// The contacts of one class in one band. The vectors may be longer than `count` blocks.
struct DiscBlocks {
    std::int32_t count = 0;
    AlignedVector<BlockBodies> bodies;
    AlignedVector<std::uint8_t> lanes;  ///< of each block, those that are not padding
    /// As DiscContactKind::Row, Impulse and Impulse: field f of lane l of block b at 16 (fields b + f) + l.
    AlignedVector<float> rows, impulses, sums;
    Array<WallTouch> touches;  ///< of walls: by 16 b + l
};
struct DiscBand {
    std::array<DiscBlocks, disc_class_count> blocks;   ///< those that are solved
    std::array<DiscBlocks, disc_class_count> resting;  ///< of bodies that sleep: they keep what they bore
    std::uint32_t half_awake = 0;  ///< of `blocks`, contacts of a sleeper with a body that is awake
};

/// How the last search of all discs laid out its strips.
struct StripFrame {
    Vec2<double> origin{};  ///< m, world: the low corner of all discs
    double per_metre = 1;   ///< strips a metre
    float most_reach = 0;   ///< m: discs that reach further are in band 0
    std::int32_t strips = 1;
    std::int32_t is_turned = 0;  ///< 1: strips run along y and are stacked along x
    std::int32_t unused = 0;     ///< so that files have no undefined bytes
};

/// Where a body was when its neighbours were found, and how far it may go before they must be found again.
struct DiscAnchor {
    float x = 0, y = 0;     ///< m, from StripFrame::origin
    float skin = INFINITY;  ///< m; infinite for rows without a disc
};

/// Names a contact of two discs by their rows, or of a disc and a segment.
constexpr std::uint64_t late_key(std::uint32_t row_a, std::uint32_t row_b)
{
    return std::uint64_t{row_a < row_b ? row_a : row_b} << 32 | (row_a < row_b ? row_b : row_a);
}
constexpr std::uint64_t late_wall_key(std::uint32_t row, std::uint32_t segment)
{
    return std::uint64_t{1} << 63 | std::uint64_t{segment} << 32 | row;
}

struct DiscStore {
    Array<DiscShape> shapes;         ///< by slot of the body; may be shorter than the table of slots
    std::size_t count = 0;           ///< of discs
    std::size_t rough_discs = 0;     ///< those with friction
    std::size_t filtered_discs = 0;  ///< those whose category or mask is not the default

    struct WallSlot {
        std::uint32_t generation = 1;
        std::uint8_t live = 0;
    };
    Array<WallSlot> walls{1};  ///< by slot; the first is the null handle's: new ones get its generation
    Array<std::uint32_t> free_walls;
    Array<WallSegment> segments;  ///< of live walls, in the order in which they were added

    // What the last search found:
    Array<DiscBand> bands;  ///< the first `band_count` of them
    std::size_t band_count = 0;
    AlignedVector<DiscAnchor> anchors;   ///< by row of planar bodies
    AlignedVector<DiscAnchor> found_at;  ///< the same as of the last search of all discs
    StripFrame frame;                    ///< of that search
    /// The rows of the discs in the order of the strips. Empty after a file or a renumbering, until the next search.
    Array<std::uint32_t> rows_by_place;
    /// Whether bodies that are near each other have come to lie far apart in memory: see sort_disc_rows().
    bool wants_sorting = false;
    int steps_since_sorting = least_steps_between_sortings;
    /// Sorting costs as much as some steps, and people who run about at random are soon out of order again.
    static constexpr int least_steps_between_sortings = 60;
    Array<std::uint32_t> sorted_rows;  ///< space for sort_disc_rows()
    /// Who made that search, and its number there; nobody after a file or a renumbering.
    std::shared_ptr<const char> searcher;
    std::uint64_t search = 0;
    /// Contacts that were found since, sorted: see late_key().
    Array<std::uint64_t> late;
    float late_reach = 0;           ///< m, the most that a disc reaches that was searched for since
    float late_drift = 0;           ///< m, the most that one of them is from its place in found_at
    Array<Vec2<double>> wall_ends;  ///< two a segment: where the ends were, world
    float wall_skin = 0;            ///< m: how far an end may move before a new search
    int age = 0;                    ///< steps since then
    /// Whether `resting` has the contacts of those who sleep now.
    bool is_divided = true;
    /// Whether a body, a disc or a wall was added, removed or teleported since then.
    bool is_stale = true;
    /// Whether memory ran out half-way in a search of all discs: blocks have lost impulses, which the searcher still has
    /// unless something was removed since.
    bool is_torn = false;

    [[nodiscard]] bool is_in_use() const { return count > 0; }
    [[nodiscard]] const DiscShape* shape_of(std::uint32_t slot) const
    {
        return slot < shapes.size() && shapes[slot].radius > 0 ? &shapes[slot] : nullptr;
    }
    /// The wall of a segment.
    [[nodiscard]] WallId wall_of(std::size_t segment) const
    {
        const std::uint32_t slot = segments[segment].wall;
        return {slot, walls[slot].generation};
    }
    [[nodiscard]] WallMet met(std::size_t segment) const
    {
        return {wall_of(segment), segments[segment].number};
    }
    [[nodiscard]] bool is_alive(WallId wall) const
    {
        return wall.slot < walls.size() && walls[wall.slot].live != 0 &&
               walls[wall.slot].generation == wall.generation;
    }
    /// Gives a body a disc, or takes it away with radius 0. `shapes` is long enough.
    void set_shape(std::uint32_t slot, const DiscShape& shape);
    /// Puts the anchor of a row where its body is. Anchors are floats: the skin grows by what rounding moves them.
    void place_anchor(std::uint32_t row, const Vec3<PoseReal>& at)
    {
        DiscAnchor& anchor = anchors[row];
        const double x = static_cast<double>(at.x) - frame.origin.x,
                     y = static_cast<double>(at.y) - frame.origin.y;
        anchor.x = static_cast<float>(x);
        anchor.y = static_cast<float>(y);
        const double off =
            std::abs(x - static_cast<double>(anchor.x)) + std::abs(y - static_cast<double>(anchor.y));
        anchor.skin += static_cast<float>(off);
    }
    /// Counts the discs anew.
    void derive();
    /// Frees the slot and the segments of a live wall. There is room in free_walls.
    void remove_wall(std::uint32_t slot);
    /// When a body was removed: its contacts in blocks must not be taken for those of the next body in its row.
    void forget_removed_row(std::uint32_t row);
    /// By slot: numbers of people that are the same on every rank. Empty where the scene is no region of a larger crowd.
    Array<std::uint64_t> numbers;
    /// Whether the body has left the row since the last search.
    [[nodiscard]] bool is_removed_row(std::size_t row) const
    {
        return row < anchors.size() && anchors[row].skin == removed_skin;
    }
    /// Whether the impulses of the body in a row must not be used again.
    [[nodiscard]] bool is_forgotten_row(std::size_t row) const
    {
        return row < anchors.size() && anchors[row].skin < 0;
    }
    /// When a body was removed or teleported: its impulses must not be used again.
    void forget_row(std::uint32_t row);
    /// When the rows of planar bodies are renumbered: row i is now new_rows[i]. The second one leaves out what is kept by
    /// row.
    void renumber(std::span<const std::uint32_t> new_rows);
    void renumber_contacts(std::span<const std::uint32_t> new_rows);

  private:
    // In place of a skin, until the next search: what has become of a row.
    static constexpr float forgotten_skin = -1, removed_skin = -2;
    void count_shape(const DiscShape& shape, std::size_t one);
    void remove_segments_of(std::uint32_t wall);
};

}  // namespace motley
