// The list of scenes. To add one: its header in scenes/, and its line here.
#include "bench_scene.h"
#include "scenes/bottleneck.h"
#include "scenes/grid.h"
#include "scenes/open_crowd.h"
#include "scenes/push.h"

namespace motley::bench {
namespace {

template <class S>
std::unique_ptr<BenchScene> make(const RunOptions& options)
{
    return std::make_unique<S>(options);
}

constexpr SceneEntry entries[] = {
    {"bottleneck", "75 people through a 0.5 m door, entering where and when a real experiment has them", 75,
     90, make<Bottleneck>},
    {"crowd", "N people at 5 per m2, each walking from goal to goal", 10000, 10, make<OpenCrowd>},
    {"push", "a packed slab leans on a wall with 50 N each: 4.5 kN/m", 1800, 10, make<Push>},
    {"grid", "an N x N net of bodies tied by ball-sockets, hung by its top row (N = square root of --agents)",
     10000, 5, make<Grid>},
    {"chains", "chains of 20 bodies tied by ball-sockets, starting level (N / 20 chains)", 20000, 5,
     make<Chains>},
};

}  // namespace

std::span<const SceneEntry> scene_list()
{
    return entries;
}

const SceneEntry* find_scene(const std::string& name)
{
    for (const SceneEntry& entry : entries) {
        if (name == entry.name) return &entry;
    }
    return nullptr;
}

}  // namespace motley::bench
