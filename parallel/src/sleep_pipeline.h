// Who wakes when a step begins (waking.cpp), and who falls asleep when it has ended (sleep_pipeline.cpp), by the rules of
// scene/sleep.h. What a host's calls wake is in core/src/scene/scene_sleep.cpp.
//
// Waking looks only at sleepers that have somebody awake beside them: at the list of contacts, at bands of discs of which
// DiscBand::half_awake counts such pairs, and at walls that move. Islands are looked for when somebody has been slow for
// long, at most every eighth step. What ties two bodies reaches a little further than what wakes, or an island would wake
// as soon as it has fallen asleep.
//
// An island may reach over several regions of a crowd. Each region finds its part of it; RegionLink says which parts are one,
// and who has woken elsewhere.
#pragma once

#include <cstdint>
#include <span>

#include "layout/body_sets.h"
#include "layout/layout.h"
#include "region_link.h"
#include "stage_runner.h"
#include "stores/array.h"

namespace motley {

class SleepPipeline {
  public:
    SleepPipeline(StageRunner& runner, Layout& layout) : runner_(runner), layout_(layout) {}

    RegionLink* region = nullptr;  ///< the scene is one region of a crowd; null: it is all of it

    /// What the rules depend on in a step.
    struct Step {
        SceneCore& scene;
        std::span<const Contact> contacts;
        float dt;  ///< s
        const SolverSettings& settings;
    };
    /// Before a step is laid out, with its contacts taken in.
    void wake(const Step& step);
    /// After a step, before its length is noted: scales the impulses of sleepers, so that they stay the same forces.
    void keep_loads(SceneCore& scene);
    /// After a step.
    void fall_asleep(const Step& step);

  private:
    StageRunner& runner_;
    Layout& layout_;
    Array<Array<std::uint32_t>> touched_;  ///< slots of sleepers, by part of the work that found them
    Array<std::int64_t> candidates_;       ///< by chunk of rows: bodies that have been slow for long
    BodySets islands_;
    Array<std::uint8_t> restless_;  ///< by index of islands_: 1 if the body keeps its island awake
    struct Ring {
        std::uint32_t head = 0, tail = 0;  ///< slots; 0: none yet
    };
    Array<Ring> rings_;  ///< by index of islands_: of the sleepers that it names

    [[nodiscard]] bool is_copy(std::uint32_t slot) const
    {
        return region != nullptr && region->is_copy(slot);
    }
    void make_room(SceneCore& scene);
    void wake_roused(SceneCore& scene);
    void wake_beside_moving_bodies(const Step& step);
    void wake_for_contacts(const Step& step);
    void wake_for_discs(const Step& step);
    void wake_touched(SceneCore& scene, std::size_t parts);
    [[nodiscard]] bool is_any_slow_for_long(const Step& step);
    void find_islands(const Step& step);
    void tie_joints(const Step& step);
    void tie_contacts(const Step& step);
    void tie_discs(const Step& step);
    void tie(const Step& step, BodyRow a, BodyRow b);
    void tie_near(const Step& step, BodyRow a, BodyRow b);
    void put_to_sleep(const Step& step);
};

}  // namespace motley
