// Which islands still want sweeps, and what is left of the whole.
//
// An island is what constraints tie together, fixed bodies not counted. Nothing passes between islands, so one that is
// solved well enough can be left alone while others go on. A block is left alone when all islands in it are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "batches.h"
#include "body_sets.h"
#include "motley/core/scene_core.h"

namespace motley {

/// Sums over the constraints, in the order of the blocks, which does not depend on threads or lanes.
struct ResidualSum {
    double energy = 0;   ///< J
    double squares = 0;  ///< m2/s2
    double largest = 0;  ///< m/s; not a number as soon as one of them is not
    std::int64_t constraints = 0;
};
/// Of what a measuring sweep left.
ResidualSum sum_residuals(const SweepLists& sweeps);

class Convergence {
  public:
    /// Finds the islands of a step.
    void find_islands(const KernelContext& context, std::span<const Placement> joints,
                      std::span<const Placement> contacts, const SweepLists& sweeps);
    /// After find_islands: how many sweeps the host asked for, by joint and by island.
    void take_wishes(const SceneCore& scene, const SweepLists& sweeps);
    /// The most that anybody asked for; 0 when nobody did.
    [[nodiscard]] int most_wanted() const { return most_wanted_; }
    /// Every island wants sweeps again: another substep.
    void start_over(const SweepLists& sweeps);
    /// After a measuring sweep: finishes the islands whose residuals are all at most `tolerance`.
    void judge(const SweepLists& sweeps, float tolerance);

    [[nodiscard]] std::int64_t islands() const { return islands_; }
    [[nodiscard]] std::int64_t unfinished() const { return unfinished_; }

  private:
    BodySets bodies_;                   ///< an island is named by its root
    std::vector<std::int32_t> worst_;   ///< bits of m/s, by root
    std::vector<std::int32_t> wanted_;  ///< sweeps, by root
    std::int64_t islands_ = 0, unfinished_ = 0;
    int most_wanted_ = 0;

    void tie(std::span<const Placement> placements);
    void count(std::span<const Placement> placements);
    void name_islands(const SweepLists& sweeps);
    [[nodiscard]] std::int32_t island_of(const SweepChunk& chunk, std::int32_t block, int lane) const;
};

}  // namespace motley
