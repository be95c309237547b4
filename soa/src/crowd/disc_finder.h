// Finds which discs and walls are so near each other that they may touch before the next search, and puts their
// contacts into the blocks of the scene.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "crowd/block_filler.h"
#include "crowd/carried_impulses.h"
#include "crowd/disc_split.h"
#include "crowd/disc_strips.h"
#include "stores/array.h"

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
    /// Instead of find(), for a band of which others find the contacts.
    void leave(DiscStore& discs, std::size_t band);
    [[nodiscard]] static bool are_rows_scattered(const DiscStore& discs);
    // Between searches of all discs, those that left their skins are searched for one by one. What is found does not
    // depend on the solver that finds it, only on the scene.
    /// Gives the discs in these rows of planar bodies new anchors and skins. The rows may be in any order.
    void begin_late(SceneCore& scene, std::span<const std::uint32_t> rows, float dt);
    /// Whether all that they may meet is in their own band and the two beside it. Otherwise a search of all discs must
    /// be made, as below.
    [[nodiscard]] bool are_late_near(const DiscStore& discs) const
    {
        return static_cast<double>(discs.late_drift) +
                   static_cast<double>(std::max(strips.most_reach(), discs.late_reach)) <=
               late_room;
    }
    double late_room =
        INFINITY;  ///< m: how far the nearest of them is, beyond its reach, from bands not beside its own
    /// Lists the contacts that the discs of a band may have now. Bands may be listed on different threads.
    void list_late(const SceneCore& scene, std::size_t band);
    /// Whether those of a band are apart enough for this. Otherwise a search of all discs takes less.
    [[nodiscard]] bool are_late_sparse(std::size_t band) const { return late_[band].is_sparse; }
    /// Puts what was listed for a band into its blocks; returns whether there was anything. Likewise.
    bool add_late(SceneCore& scene, std::size_t band, int worker);
    /// Notes what was listed for the bands [first, last), and for band 0.
    void end_late(DiscStore& discs, std::size_t first, std::size_t last);
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
        Array<Pair> pairs;
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
        std::make_shared<const char>('\0');  ///< its address names this finder
    std::uint64_t searches_ = 0;             ///< the last one is that of the strips
    Array<std::uint32_t> places_;            ///< of each row in the strips; empty until they are asked for
    Array<std::uint32_t> renewed_in_;  ///< by row: the last call of begin_late() that renewed its anchor
    std::uint32_t late_call_ = 0;
    struct Leaving {
        std::uint32_t place, row;
    };
    Array<Leaving> leaving_;  ///< the discs of begin_late(), in the order of the strips
    /// A contact that may be new: of the disc in row `a`, which left its skin, with that in row `b`, or with segment `b`.
    struct LateContact {
        std::uint32_t a, b;
        std::uint32_t band;  ///< whose it is
        bool is_wall;
        [[nodiscard]] std::uint64_t key() const { return is_wall ? late_wall_key(a, b) : late_key(a, b); }
    };
    struct LateList {
        std::size_t first = 0, last = 0;  ///< in leaving_: the discs of the band
        Array<LateContact> contacts;
        bool has_wide = false;  ///< some are of band 0
        bool is_sparse = true;
    };
    Array<LateList> late_;                      ///< by band of the disc that left
    Array<std::uint64_t> fresh_;                ///< the keys of all of them
    std::atomic<std::size_t> found_in_all_{0};  ///< pairs in this search of all discs
    struct PlacedSegment {
        Vec2<double> from, to;  ///< in the frame of the strips
        std::uint32_t index;
    };
    Array<Worker> workers_;
    Array<Array<PlacedSegment>> segments_;  ///< by band

    [[nodiscard]] PlacedSegment place_segment(const DiscStore& discs, std::uint32_t index) const;
    void place_segments(const DiscStore& discs);
    static void make_room_for_touches(DiscBand& band, std::size_t blocks);
    void list_rows(DiscStore& discs, std::uint32_t first, std::uint32_t last) const;
    void make_strips_of(SceneCore& scene);
    void begin_fillers(DiscBand& band, Worker& worker, std::size_t numbers);
    static void go_on_with_fillers(DiscBand& found, Worker& worker, std::size_t bodies,
                                   const BodyNumbers& numbers);
    void renew(SceneCore& scene, std::uint32_t row, std::size_t band, float dt);
    void cut_leaving_into_bands(const DiscStore& discs);
    [[nodiscard]] PlacedDisc place_now(const SceneCore& scene, std::uint32_t row) const;
    std::size_t list_late_pairs(const SceneCore& scene, const PlacedDisc& me, std::size_t band,
                                LateList& list);
    void list_late_walls(const SceneCore& scene, const PlacedDisc& me, std::size_t band, LateList& list);
    /// How many discs a band has and the next one has, whose numbers they get among its contacts.
    [[nodiscard]] std::size_t numbers_of(const SceneCore& scene, std::size_t band) const;
    void find_in_strips(SceneCore& scene, std::size_t band, Worker& worker);
    void find_wide(SceneCore& scene, Worker& worker);
    void count_pairs(const DiscStore& discs, std::size_t more);
    void list_pairs(std::int32_t strip, Array<Pair>& pairs) const;
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
