// The list of scenes: crowds here, rigs from rigs.cpp. To add a crowd: its header in scenes/, and its line here.
#include "worlds/bench_scene.h"
#include "worlds/scenes/bottleneck.h"
#include "worlds/scenes/corridor.h"
#include "worlds/scenes/door_closes.h"
#include "worlds/scenes/evacuation.h"
#include "worlds/scenes/flow.h"
#include "worlds/scenes/lean.h"
#include "worlds/scenes/level_of_detail.h"
#include "worlds/scenes/open_crowd.h"
#include "worlds/scenes/pulse.h"
#include "worlds/scenes/push.h"
#include "worlds/scenes/rig_scene.h"
#include "worlds/scenes/silo.h"
#include "worlds/scenes/wave.h"

namespace motley::bench {
namespace {

template <class S>
std::unique_ptr<BenchScene> make(const RunOptions& options)
{
    return std::make_unique<S>(options);
}

template <const auto& shape>
std::unique_ptr<BenchScene> make_pulse(const RunOptions& options)
{
    return std::make_unique<InelasticPulse>(options, shape);
}

template <int newtons>
std::unique_ptr<BenchScene> make_push(const RunOptions& options)
{
    return std::make_unique<Push>(options, newtons);
}

template <const auto& plan>
std::unique_ptr<BenchScene> make_levels(const RunOptions& options)
{
    return std::make_unique<LevelOfDetail>(options, plan);
}
constexpr LevelsPlan level_of_detail{};
/// Five in a hundred lie, twenty fall and twenty rise in each second.
constexpr LevelsPlan mixed{.density = 4,
                           .has_particles = false,
                           .is_rough = false,
                           .lying = 0.05,
                           .falls = 20,
                           .falls_as_one = 0,
                           .lies_for = 50};

std::vector<SceneEntry> all_scenes()
{
    constexpr SceneTakes both{.listed = true, .found = true};
    std::vector<SceneEntry> all{
        {"bottleneck",
         "75 people through a 0.5 m door, entering where and when a real experiment has them",
         75,
         90,
         make<Bottleneck>,
         {.torsos = true, .listed = true, .found = true}},
        {"crowd",
         "N people at 5 per m2, each walking from goal to goal",
         10000,
         10,
         make<OpenCrowd>,
         {.density = true, .steering = true, .listed = true, .found = true}},
        {"flow",
         "N people follow flow fields among pillars from block to block",
         10000,
         10,
         make<Flow>,
         {.density = true, .steering = true, .torsos = true, .listed = true, .found = true}},
        {"evacuation",
         "everybody leaves a room by a door of 1.2 m",
         400,
         300,
         make<Evacuation>,
         {.door = true, .steering = true, .torsos = true, .listed = true, .found = true}},
        {"counterflow",
         "people walk both ways in a corridor of 50 x 5 m whose ends are joined",
         500,
         80,
         make<Counterflow>,
         {.density = true, .steering = true, .torsos = true, .listed = true, .found = true}},
        {"corridor",
         "people walk one way there: the speed at a density",
         500,
         60,
         make<Corridor>,
         {.density = true, .listed = true, .found = true}},
        {"level-of-detail",
         "near people are discs with friction, far ones discs without or particles, the fallen figures: the "
         "price of each",
         2000,
         30,
         make_levels<level_of_detail>,
         {.density = true, .found = true}},
        {"mixed",
         "a dense crowd in which 1 of 20 lies as a figure, and 20 fall and 20 rise each second",
         20000,
         20,
         make_levels<mixed>,
         {.density = true, .found = true}},
        {"door-closes",
         "walls close on people at 0.5, 2 and 20 m/s",
         300,
         30,
         make<DoorCloses>,
         {.found = true}},
        {"push", "a packed slab leans on a wall with 50 N each: 4.5 kN/m", 1800, 10, make_push<50>, both},
        {"push-214", "the same with the full drive of a walker, 214 N each", 1800, 10, make_push<214>, both},
        {"silo", "a packed slab between side walls with friction 0.3: Janssen's profile", 1800, 18,
         make<Silo>, both},
        {"lean", "rows of 100 people lean on each other with 50 N each, and the first on a wall", 10000, 6,
         make<Lean<100>>, both},
        {"lean-30", "the same in rows of 30", 10000, 6, make<Lean<30>>, both},
        {"lean-10", "the same in rows of 10", 10000, 6, make<Lean<10>>, both},
        {"pulse", "rows of 20 people 0.1 m apart; the first runs into them and takes all along", 10000, 3,
         make_pulse<InelasticPulse::row>, both},
        {"strip", "rows of 100 people 2 cm apart, pushed with 150 N s: the wave, one row wide", 10000, 10,
         make_pulse<InelasticPulse::strip>, both},
        {"bounce",
         "rows of 20 people 0.1 m apart who bounce: a speed is handed on",
         10000,
         2,
         make<ElasticPulse>,
         {.listed = true}},
        {"wave", "a standing crowd 2 cm apart; 5 m of its edge are pushed with 150 N s each", 10000, 5,
         make<Wave>, both},
    };
    for (const RigEntry& rig : rig_list()) {
        all.push_back({rig.name, rig.description, rig.bodies, rig.warm_up + rig.seconds,
                       [&rig](const RunOptions& options) -> std::unique_ptr<BenchScene> {
                           return std::make_unique<RigScene>(rig, options);
                       }});
    }
    return all;
}

}  // namespace

std::span<const SceneEntry> scene_list()
{
    static const std::vector<SceneEntry> all = all_scenes();
    return all;
}

const SceneEntry* find_scene(const std::string& name)
{
    for (const SceneEntry& entry : scene_list()) {
        if (name == entry.name) return &entry;
    }
    return nullptr;
}

}  // namespace motley::bench
