// What a step asks of the ranks that solve the other regions of the same crowd. A region is a range of bands; its scene has
// the people of these bands, and copies of those in the next band, who belong to the region above. See mpi/src/region.h,
// which talks to them by MPI.
//
// Every call is made by every rank, in the same order, or the ranks would wait for each other.
#pragma once

#include <cstdint>
#include <span>

#include "crowd/disc_finder.h"
#include "layout/body_sets.h"
#include "scene/scene_core.h"

namespace motley {

/// What decides whether a step searches for the contacts of all discs.
struct SearchVote {
    std::int64_t discs = 0;    ///< of this region, then of all
    std::int64_t leaving = 0;  ///< of them those that may leave their skins
    std::int64_t late = 0;     ///< contacts that were found since the last search of all discs
    bool must_search = false;
};

class RegionLink {
  public:
    RegionLink() = default;
    RegionLink(const RegionLink&) = delete;
    RegionLink& operator=(const RegionLink&) = delete;
    virtual ~RegionLink() = default;

    /// The bands of this region, [first, last), counted from 1.
    [[nodiscard]] virtual std::size_t first_band() const = 0;
    [[nodiscard]] virtual std::size_t last_band() const = 0;
    [[nodiscard]] bool has_band(std::size_t band) const { return band >= first_band() && band < last_band(); }
    /// Whether the body is a copy of one of the region above.
    [[nodiscard]] virtual bool is_copy(std::uint32_t slot) const = 0;

    /// When a step begins: copies get the states and forces of those whom they are copies of.
    virtual void renew_copies(SceneCore& scene) = 0;

    // ---- sleep ----
    /// Whether anybody in any region may be asleep. All regions say the same.
    [[nodiscard]] virtual bool anybody_sleeps() const = 0;
    /// Tells all regions which islands have people who woke here since the last call; sleepers of those that woke anywhere
    /// wake here too.
    virtual void spread_waking(SceneCore& scene) = 0;
    /// Copies get BodyStore::slow_for from those whom they are copies of.
    virtual void renew_slowness(SceneCore& scene) = 0;
    /// Islands of this region are parts of islands of all. Marks those whose other parts are restless; see
    /// SleepPipeline::find_islands.
    virtual void join_islands(const SceneCore& scene, const BodySets& islands,
                              std::span<std::uint8_t> restless) = 0;
    /// People have fallen asleep, and may wake again.
    virtual void note_sleepers(const SceneCore& scene) = 0;

    // ---- contacts ----
    /// Adds up the votes of all regions.
    virtual void agree(SearchVote& vote) = 0;
    /// Reach, drift and room of the discs that left their skins: the most, the most and the least of all regions.
    virtual void agree(float& reach, float& drift, double& room) = 0;
    /// Whether something is so in all regions.
    virtual bool is_so_everywhere(bool here) = 0;
    bool is_so_anywhere(bool here) { return !is_so_everywhere(!here); }
    /// Refuses the step in all regions, if any of them counted something.
    virtual void refuse_everywhere(const char* what, std::int64_t count, const char* valid) = 0;
    /// A search of all discs begins: copies are left out of what follows, until people have moved.
    virtual void leave_copies_out(SceneCore& scene) = 0;
    virtual void add_up(DiscStrips::Measured& measured) = 0;
    virtual void add_up(std::span<std::uint32_t> discs_by_strip) = 0;
    /// The bands are cut: they are dealt out to the ranks, and people move to where their bands are, with their impulses.
    virtual void move_people(SceneCore& scene, const DiscStrips& strips, CarriedImpulses& carried) = 0;
    /// Contacts were found: the people at the borders whom both sides push are listed.
    virtual void list_pushed(const SceneCore& scene, const DiscStrips& strips) = 0;

    // ---- sweeps ----
    /// The bands of this parity have been solved at the borders: sends what they have made of velocities.
    virtual void send_velocities(const float* velocities, std::size_t parity) = 0;
    /// All bands of this parity have been solved: takes what the neighbours have made of theirs.
    virtual void take_velocities(float* velocities, std::size_t parity) = 0;
};

}  // namespace motley
