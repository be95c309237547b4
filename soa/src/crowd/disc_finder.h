// Finds which discs and walls are so near each other that they may touch before the next search, and puts their
// contacts into the blocks of the scene.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "crowd/block_filler.h"
#include "crowd/carried_impulses.h"
#include "crowd/disc_strips.h"

namespace motley {

class DiscFinder {
  public:
    DiscStrips strips;        ///< first the discs are sorted
    CarriedImpulses carried;  ///< the impulses of the bands as they were are kept
    /// Then there is space for the contacts of every band, for so many workers...
    void open(SceneCore& scene, int workers);
    /// ...and every band is found; band 0 has the contacts of discs that reach far.
    void find(SceneCore& scene, std::size_t band, int worker);

  private:
    struct Pair {
        std::uint32_t a, b;  ///< places in the order of the strips
    };
    struct Worker {
        std::vector<Pair> pairs;
        std::array<BlockFiller, disc_class_count> fillers;
    };
    struct PlacedSegment {
        Vec2<double> from, to;  ///< in the frame of the strips
        std::uint32_t index;
    };
    std::vector<Worker> workers_;
    std::vector<std::vector<PlacedSegment>> segments_;  ///< by band

    void place_segments(const DiscStore& discs);
    void find_in_strips(SceneCore& scene, std::size_t band, Worker& worker);
    void find_wide(SceneCore& scene, Worker& worker);
    void list_pairs(std::int32_t strip, std::vector<Pair>& pairs) const;
    template <class Number>
    void add_pair(SceneCore& scene, DiscBand& band, Worker& worker, const PlacedDisc& a, const PlacedDisc& b,
                  const Number& number_of) const;
    template <class Number>
    void add_touch(SceneCore& scene, DiscBand& band, Worker& worker, const PlacedSegment& segment,
                   const PlacedDisc& disc, const Number& number_of) const;
};

/// Where the ends of the segments of walls are now, world, two a segment.
void find_wall_ends(const SceneCore& scene, std::vector<Vec2<double>>& ends);
/// The fastest end of a wall, m/s.
double fastest_wall_end(const SceneCore& scene);
/// When a step begins: the rows of walls.
void place_walls(const SceneCore& scene, std::span<const Vec2<double>> ends, float warm_start_scale,
                 DiscBand& band);

}  // namespace motley
