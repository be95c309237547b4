// Finds which discs and walls are so near each other that they may touch before the next search, and puts their
// contacts into the blocks of the scene.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "crowd/block_filler.h"
#include "crowd/carried_impulses.h"
#include "crowd/disc_split.h"
#include "crowd/disc_strips.h"

namespace motley {

class DiscFinder {
  public:
    DiscStrips strips;        ///< first the discs are sorted
    CarriedImpulses carried;  ///< the impulses of the bands as they were are kept
    /// Makes the next search of all discs that of this finder.
    void name_search(DiscStore& discs);
    /// Whether `carried` has them already, because memory ran out in the middle of this finder's last search.
    [[nodiscard]] bool has_impulses_of(const DiscStore& discs) const
    {
        return discs.is_torn && discs.searcher == self_ && discs.search == searches_;
    }
    /// Then there is space for the contacts of every band, for so many workers...
    void open(SceneCore& scene, int workers);
    /// ...and the contacts of every band are found; band 0 has those of discs that reach far. Refuses far more pairs than
    /// discs.
    void find(SceneCore& scene, std::size_t band, int worker);
    /// After that: room for more pairs, so that a step to come seldom allocates, and whether the rows should be sorted.
    static void make_room_for_pairs(DiscStore& discs);
    [[nodiscard]] static bool are_rows_scattered(const DiscStore& discs);
    /// Between searches of all discs: gives the discs in these rows of planar bodies new anchors and skins, and adds
    /// the contacts that they may have now to band 0. The rows may be in any order; they are sorted. Returns false where
    /// people are so close that a search of all discs takes less, and must now be made.
    bool find_late(SceneCore& scene, std::span<std::uint32_t> rows, float dt);
    /// Makes space for so many workers.
    /// Each worker gets the room of the one that has most: which bands a worker gets is not the same in every search.
    void make_room_for_workers(int workers);
    /// When bodies have fallen asleep or woken: sorts the contacts of a band into those that are solved and those that
    /// rest.
    void divide(SceneCore& scene, std::size_t band, int worker);

  private:
    /// A disc lists at most so many that come after it in a strip. Equal discs beside each other have fewer than ten; of a
    /// million at one spot each then pushes some, and not all others at once.
    static constexpr std::size_t most_later_neighbours = 32;
    struct Pair {
        std::uint32_t a, b;  ///< places in the order of the strips
    };
    struct Worker {
        std::vector<Pair> pairs;
        std::array<BlockFiller, disc_class_count> fillers, resting_fillers;
        DiscSplit split;
        template <class Work>
        void for_each_filler(const Work& work)
        {
            for (BlockFiller& filler : fillers) work(filler);
            for (BlockFiller& filler : resting_fillers) work(filler);
        }
        void finish()
        {
            for_each_filler([](BlockFiller& filler) { filler.finish(); });
        }
    };
    std::shared_ptr<const char> self_ =
        std::make_shared<const char>('\0');     ///< its address names this finder
    std::uint64_t searches_ = 0;                ///< the last one is that of the strips
    std::vector<std::uint32_t> places_;         ///< of each row in the strips; empty until they are asked for
    std::vector<std::uint64_t> fresh_;          ///< contacts that find_late() has added
    std::vector<std::uint8_t> is_new_;          ///< by row: it has a new anchor in this call of find_late()
    std::size_t looked_at_ = 0;                 ///< discs in this call of find_late()
    std::atomic<std::size_t> found_in_all_{0};  ///< pairs in this search of all discs
    struct PlacedSegment {
        Vec2<double> from, to;  ///< in the frame of the strips
        std::uint32_t index;
    };
    std::vector<Worker> workers_;
    std::vector<std::vector<PlacedSegment>> segments_;  ///< by band

    void place_segments(const DiscStore& discs);
    static void make_room_for_touches(DiscBand& band, std::size_t blocks);
    void list_rows(DiscStore& discs, std::uint32_t first, std::uint32_t last) const;
    void make_strips_of(SceneCore& scene);
    void begin_fillers(DiscBand& band, Worker& worker, std::size_t numbers, bool goes_on);
    void find_late_of(SceneCore& scene, std::uint32_t row, float dt);
    void find_late_pairs(SceneCore& scene, const PlacedDisc& me);
    void find_late_walls(SceneCore& scene, const PlacedDisc& me);
    [[nodiscard]] bool is_listed(const DiscStore& discs, std::uint64_t key, bool may_be_fresh) const;
    /// The band of a strip, counted from 1.
    [[nodiscard]] std::size_t band_of(std::int32_t strip) const;
    void find_in_strips(SceneCore& scene, std::size_t band, Worker& worker);
    void find_wide(SceneCore& scene, Worker& worker);
    void count_pairs(const DiscStore& discs, std::size_t more);
    void list_pairs(std::int32_t strip, std::vector<Pair>& pairs) const;
    void add_pair(SceneCore& scene, DiscBand& band, Worker& worker, const PlacedDisc& a, const PlacedDisc& b,
                  const CarriedImpulses::Impulse& impulse, std::uint32_t number_a,
                  std::uint32_t number_b) const;
    void add_touch(SceneCore& scene, DiscBand& band, Worker& worker, const PlacedSegment& segment,
                   const PlacedDisc& disc, CarriedImpulses::Impulse impulse, std::uint32_t number) const;
    static bool is_near(const DiscStore& discs, const PlacedSegment& segment, const PlacedDisc& disc);
    [[nodiscard]] CarriedImpulses::Impulse carried_of(const PlacedDisc& a, const PlacedDisc& b) const;
};

/// When a step begins: the rows of walls that are solved.
void place_walls(const SceneCore& scene, std::span<const Vec2<double>> ends, float warm_start_scale,
                 DiscBand& band);
/// When contacts have come to rest: their rows, from where their bodies lie.
void place_resting(const SceneCore& scene, std::span<const Vec2<double>> ends, DiscBand& band);

}  // namespace motley
