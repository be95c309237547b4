// Discs sorted into strips of the plane, and in each strip along it, so that those near each other are found by a sweep
// over a few neighbours. The strips are stacked along the longer side of the crowd and are as wide as two discs can
// reach, so that neighbours are in the same strip or in the next one. The cost follows the number of discs, not the area
// that they are spread over.
//
// The order of discs is by strip, then by place along it, then by place across it, and at last by handle slot. It
// depends on where the discs are, and not on threads or on the order in which they were added. Where the scene is one of
// several regions (DiscStore::numbers), the number of a person takes the place of the slot.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "scene/scene_core.h"
#include "stores/array.h"
#include "stores/disc_store.h"

namespace motley {

/// Rows of planar bodies are measured and sorted in chunks, which do not depend on the number of threads.
inline constexpr std::uint32_t disc_rows_per_chunk = BodyRows::rows_per_chunk;
constexpr std::int64_t disc_chunks(std::uint32_t rows)
{
    return (std::int64_t{rows} + disc_rows_per_chunk - 1) / disc_rows_per_chunk;
}
/// Calls work(row) for each row of a chunk.
template <class Work>
void for_each_row_of_chunk(std::int64_t chunk, std::uint32_t rows, const Work& work)
{
    const auto first = static_cast<std::uint32_t>(chunk) * disc_rows_per_chunk;
    for (std::uint32_t row = first; row < std::min(first + disc_rows_per_chunk, rows); ++row) work(row);
}
/// The length of a velocity, m/s, whose first two numbers are vx and vy.
inline double speed_of(const float* v)
{
    const auto x = static_cast<double>(v[0]), y = static_cast<double>(v[1]);
    return std::sqrt(x * x + y * y);
}

/// A disc at its place in the order.
struct PlacedDisc {
    double along, across;  ///< m, from the low corner of all discs
    float reach;           ///< m: radius and skin
    float radius;          ///< m
    float inverse_mass;    ///< 1/kg
    std::uint32_t row;     ///< of planar bodies
};

class DiscStrips {
  public:
    static constexpr int buckets = 320;  ///< of reaches, eight an octave
    /// Where some discs are, and how many reach how far.
    struct Measured {
        Vec2<double> low{1e300, 1e300}, high{-1e300, -1e300};  ///< m, world: corners
        std::int64_t discs = 0;
        std::array<std::int32_t, buckets> reaches{};
    };
    /// Starts over. Then, chunk by chunk on any threads, measure(); then choose() from measured(); then anchor() and count()
    /// of every chunk; then open(); then place() of every chunk; then sort() of every group; then divide().
    void begin(SceneCore& scene, float dt);
    /// Makes the strips of the last search of all discs once more, on this thread.
    void restore(const SceneCore& scene);
    /// How far something that moves at `speed`, m/s, may go before it is searched for again, m, in steps of dt.
    static float skin_at(double speed, float dt);
    /// The same for a disc that is searched for between searches of all discs: then it reaches no further than most_late_reach()
    /// unless it must.
    [[nodiscard]] float late_skin(double speed, float dt, float radius) const;
    /// Two discs that reach so far from neighbouring strips are in neighbouring bands, of two strips or more.
    [[nodiscard]] float most_late_reach() const { return 1.9F * frame_.most_reach; }
    /// 1/kg, of the body in a row; also of one that sleeps.
    static float inverse_mass_of(const SceneCore& scene, std::uint32_t row);
    [[nodiscard]] std::int64_t chunk_count() const { return chunks_; }
    /// How far each disc of a chunk of rows may reach before the next search; writes the skins of the anchors.
    void measure(const SceneCore& scene, DiscStore& discs, std::int64_t chunk);
    /// What was measured, of all chunks.
    [[nodiscard]] Measured measured() const;
    /// Chooses the strips for all discs.
    void choose(DiscStore& discs, const Measured& all);
    /// Space to sort so many of them, which are those of this scene.
    void make_room_for(std::int64_t discs);
    /// Writes the places of the anchors, and cuts the skins of fast discs: these may leave them in this step.
    void anchor(SceneCore& scene, std::int64_t chunk) const;
    /// Counts the discs of each group.
    void count(const SceneCore& scene, std::int64_t chunk);
    void open();
    void place(const SceneCore& scene, std::int64_t chunk);
    [[nodiscard]] std::int64_t group_count() const { return groups_; }
    void sort(const SceneCore& scene, std::int64_t group);
    /// Divides the strips into bands of some hundred discs.
    void divide();
    /// Where other scenes have discs in the same strips: how many there are in each strip of this scene, besides the wide ones,
    /// whose number is returned...
    std::int64_t count_by_strip(const SceneCore& scene)
    {
        in_strip_.assign(static_cast<std::size_t>(strips_), 0);
        std::int64_t wide = 0;
        for (std::int64_t chunk = 0; chunk < chunks_; ++chunk) {
            for_each_disc(scene, chunk, [&](std::uint32_t row, const BodyRows& rows) {
                const DiscAnchor& anchor = scene.discs.found_at[row];
                const bool is_wide =
                    scene.discs.shapes[rows.slot[row]].radius + anchor.skin > frame_.most_reach;
                wide += is_wide ? 1 : 0;
                if (!is_wide) ++in_strip_[static_cast<std::size_t>(strip_at(to_strips(anchor).y))];
            });
        }
        return wide;
    }
    /// ...and in all of them, to be summed up before divide().
    [[nodiscard]] std::span<std::uint32_t> discs_by_strip() { return in_strip_; }
    [[nodiscard]] std::span<const std::uint32_t> discs_by_strip() const { return in_strip_; }

    [[nodiscard]] std::int32_t strip_count() const { return strips_; }
    [[nodiscard]] std::span<const PlacedDisc> strip(std::int32_t s) const
    {
        const auto first = first_[static_cast<std::size_t>(s)],
                   last = first_[static_cast<std::size_t>(s) + 1];
        return std::span(sorted_).subspan(first, last - first);
    }
    /// Calls work(disc) for each disc of a strip whose place along it is from `low` to `high`, m.
    template <class Work>
    void for_each_between(std::int32_t s, double low, double high, const Work& work) const
    {
        const std::span<const PlacedDisc> placed = strip(s);
        auto disc = std::lower_bound(placed.begin(), placed.end(), low,
                                     [](const PlacedDisc& d, double along) { return d.along < along; });
        for (; disc != placed.end() && disc->along <= high; ++disc) work(*disc);
    }
    /// The place in the order of the first disc of a strip.
    [[nodiscard]] std::uint32_t first_of(std::int32_t s) const { return first_[static_cast<std::size_t>(s)]; }
    [[nodiscard]] const PlacedDisc& disc(std::uint32_t place) const { return sorted_[place]; }
    /// Discs that reach further than a strip is made for, in the same order along and across.
    [[nodiscard]] std::span<const PlacedDisc> wide() const
    {
        return std::span(sorted_).subspan(first_[static_cast<std::size_t>(strips_)]);
    }
    /// The most that a disc in a strip reaches, m.
    [[nodiscard]] float most_reach() const { return frame_.most_reach; }
    /// The number of bands, and the first strip of each, and one past the last.
    [[nodiscard]] std::int32_t band_count() const
    {
        return static_cast<std::int32_t>(band_strips_.size()) - 1;
    }
    [[nodiscard]] std::int32_t first_strip(std::int32_t band) const
    {
        return band_strips_[static_cast<std::size_t>(band)];
    }
    /// The place of the first disc of a band, counted from 1; of one past the last, the place after its last disc.
    [[nodiscard]] std::uint32_t first_place(std::size_t band) const
    {
        return first_of(first_strip(static_cast<std::int32_t>(band) - 1));
    }
    /// The band of a strip, counted from 1.
    [[nodiscard]] std::size_t band_of(std::int32_t strip) const;
    /// The strip of a place across the strips, m; also for places beyond the first and last one.
    [[nodiscard]] std::int32_t strip_at(double across) const
    {
        const double s = across * frame_.per_metre;
        return !(s > 0) ? 0 : s >= strips_ - 1 ? strips_ - 1 : static_cast<std::int32_t>(s);
    }
    /// Where a strip begins across the strips, m.
    [[nodiscard]] double low_edge_of(std::int32_t s) const
    {
        return static_cast<double>(s) / frame_.per_metre;
    }
    /// From the world into the frame of the strips, x along and y across.
    [[nodiscard]] Vec2<double> to_strips(const Vec2<double>& world) const
    {
        return turned(world - frame_.origin);
    }
    [[nodiscard]] Vec2<double> to_strips(const DiscAnchor& anchor) const
    {
        return turned({static_cast<double>(anchor.x), static_cast<double>(anchor.y)});
    }
    /// All discs in order, the wide ones last.
    [[nodiscard]] std::span<const PlacedDisc> discs() const { return sorted_; }

  private:
    static constexpr std::int32_t most_groups = 256;
    Array<Measured> measured_;  ///< by chunk
    std::int64_t chunks_ = 0;
    float dt_ = 0;
    StripFrame frame_;
    std::int64_t discs_ = 0;
    std::int32_t strips_ = 1, groups_ = 1, strips_per_group_ = 1;
    Array<std::uint32_t> places_;  ///< by chunk and group: the number of discs, then the next free place
    Array<std::uint32_t> first_in_group_;
    Array<std::uint32_t> starts_;                ///< by group: of the bins of its strips
    AlignedVector<PlacedDisc> placed_, sorted_;  ///< by group; in order
    Array<std::uint32_t> first_;                 ///< by strip, one past the last, and one past the wide ones
    Array<std::int32_t> band_strips_;
    Array<std::uint32_t> in_strip_;  ///< discs of all scenes; empty: there is one

    /// Calls work(row, rows) for each disc that was measured in a chunk of rows.
    template <class Work>
    static void for_each_disc(const SceneCore& scene, std::int64_t chunk, const Work& work)
    {
        const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
        // Bodies without discs may have been added since the last search.
        const auto known =
            static_cast<std::uint32_t>(std::min<std::size_t>(rows.size(), scene.discs.found_at.size()));
        for_each_row_of_chunk(chunk, known, [&](std::uint32_t row) {
            if (scene.discs.found_at[row].skin < INFINITY) work(row, rows);
        });
    }
    [[nodiscard]] Vec2<double> turned(const Vec2<double>& at) const
    {
        return frame_.is_turned != 0 ? Vec2<double>{at.y, at.x} : at;
    }
    [[nodiscard]] std::int32_t group_of(double across, float reach) const
    {
        return reach > frame_.most_reach ? groups_ : strip_at(across) / strips_per_group_;
    }
    static float skin_at(double speed, float dt, double steps);
    [[nodiscard]] static int bucket_of(float reach);
    [[nodiscard]] static float upper_end_of(int bucket);
};

}  // namespace motley
