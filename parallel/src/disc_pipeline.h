// The path of the contacts that the library finds itself: of discs with each other and with walls. Each phase is one
// function here, in the order in which they run.
#pragma once

#include "crowd/disc_finder.h"
#include "layout/layout.h"
#include "region_link.h"
#include "stage_runner.h"
#include "stores/array.h"

namespace motley {

class DiscPipeline {
  public:
    DiscPipeline(StageRunner& runner, Layout& layout) : runner_(runner), layout_(layout) {}

    RegionLink* region = nullptr;  ///< the scene is one region of a crowd; null: it is all of it

    /// Before a step of dt seconds: finds contacts anew, or those of discs that may have new neighbours.
    void find(SceneCore& scene, float dt);
    /// After that: sorts out the contacts of those who sleep, if others sleep than in the last step.
    void divide(SceneCore& scene);
    /// Makes the rows of this step.
    void prepare(SceneCore& scene);

  private:
    StageRunner& runner_;
    Layout& layout_;
    DiscFinder finder_;
    Array<Vec2<double>> wall_ends_;           ///< now
    Array<std::uint32_t> leaving_;            ///< rows of discs that may leave their skins in this step
    Array<Array<std::uint32_t>> leaving_of_;  ///< the same by chunk of rows

    /// Whether the contacts of a band are found and solved here.
    [[nodiscard]] bool is_own(std::size_t band) const
    {
        return region == nullptr || band == 0 || region->has_band(band);
    }

    [[nodiscard]] bool do_all_rest(const SceneCore& scene) const;
    [[nodiscard]] bool have_walls_left(const SceneCore& scene, float dt) const;
    bool may_keep_contacts(SceneCore& scene, float dt);
    void list_leaving(const SceneCore& scene, float dt);
    [[nodiscard]] SearchVote vote(const SceneCore& scene, bool must_search) const;
    bool find_late(SceneCore& scene, float dt);
    bool add_those_of_fast_discs(SceneCore& scene, float dt);
    void measure(SceneCore& scene, float dt);
    void deal_out_bands(SceneCore& scene, float dt);
    void sort_into_strips(SceneCore& scene, float dt);
    void carry_impulses(SceneCore& scene);
    void find_contacts(SceneCore& scene);
};

}  // namespace motley
