// Which islands still need sweeps, and the residual of the whole scene.
//
// An island is a set of moving bodies that constraints connect; fixed bodies connect nothing. Islands do not
// influence each other, so one that is solved well enough can be left alone while others go on. A block is left alone
// when all islands in it are finished.
#pragma once

#include <cstdint>
#include <span>

#include "layout/batches.h"
#include "layout/body_sets.h"
#include "scene/scene_core.h"
#include "stores/array.h"

namespace motley {

/// Sums over the constraints, in the order of the blocks, which does not depend on threads or lanes.
struct ResidualSum {
    double energy = 0;   ///< J
    double squares = 0;  ///< m2/s2
    double largest = 0;  ///< m/s; NaN if one of the residuals is NaN
    std::int64_t constraints = 0;
};
/// Sums the residuals that the last measuring sweep stored.
ResidualSum sum_residuals(const SweptChunks& swept);

class Convergence {
  public:
    /// Finds the islands of a step.
    void find_islands(const KernelContext& context, std::span<const Placement> joints,
                      std::span<const Placement> contacts, const SweptChunks& swept);
    /// After find_islands: looks up how many sweeps the host asked for, by joint and by island.
    void take_wishes(const SceneCore& scene, const SweptChunks& swept);
    /// The largest number of sweeps that the host asked for; 0 when it asked for none.
    [[nodiscard]] int most_wanted() const { return most_wanted_; }
    /// For another substep: no island is finished any more.
    void start_over(const SweptChunks& swept);
    /// After a measuring sweep: finishes the islands whose residuals are all at most `tolerance`.
    void judge(const SweptChunks& swept, float tolerance);

    [[nodiscard]] std::int64_t islands() const { return islands_; }
    [[nodiscard]] std::int64_t unfinished() const { return unfinished_; }

  private:
    BodySets bodies_;             ///< an island is named by its root
    Array<std::int32_t> worst_;   ///< largest residual, as the bits of a float in m/s, by root
    Array<std::int32_t> wanted_;  ///< sweeps, by root
    std::int64_t islands_ = 0, unfinished_ = 0;
    int most_wanted_ = 0;

    void tie(std::span<const Placement> placements);
    void tie(std::span<const SweepChunk> discs);
    void count(std::span<const Placement> placements);
    void count(std::span<const SweepChunk> discs);
    void count(std::int32_t island);
    void name_islands(const SweptChunks& swept);
    [[nodiscard]] std::int32_t island_of(const SweepChunk& chunk, std::int32_t block, int lane) const;
};

}  // namespace motley
