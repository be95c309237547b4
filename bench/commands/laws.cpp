// The list of laws, and their table. To add a law: a mark in its scene, and the scene's line here if it has none.
#include "commands/laws.h"

#include <fmt/format.h>

namespace motley::bench {
namespace {

struct LawScene {
    const char* name;
    const char* scene;
    std::int64_t agents;        ///< in the whole table
    std::int64_t quick_agents;  ///< in the quick one; 0: left out
    double seconds = 0;         ///< 0: the scene's default
    float dt = 1.0F / 60;
    float friction = -1;
    double door = 0;
    const char* debt = nullptr;  ///< as LawResult::debt
};

constexpr LawScene scenes[] = {
    {.name = "chains of 10", .scene = "lean-10", .agents = 1000, .quick_agents = 100},
    {.name = "chains of 30", .scene = "lean-30", .agents = 900, .quick_agents = 90},
    {.name = "chains of 30, dt 1/30", .scene = "lean-30", .agents = 900, .quick_agents = 0, .dt = 1.0F / 30},
    {.name = "chains of 30, dt 1/120",
     .scene = "lean-30",
     .agents = 900,
     .quick_agents = 0,
     .dt = 1.0F / 120},
    {.name = "chains of 100", .scene = "lean", .agents = 1000, .quick_agents = 100, .debt = ""},
    {.name = "inelastic pulse", .scene = "pulse", .agents = 1000, .quick_agents = 100},
    {.name = "elastic pulse", .scene = "bounce", .agents = 1000, .quick_agents = 100},
    {.name = "strip of a wave", .scene = "strip", .agents = 1000, .quick_agents = 100},
    {.name = "wave", .scene = "wave", .agents = 10000, .quick_agents = 1000},
    {.name = "slab", .scene = "push", .agents = 1800, .quick_agents = 360, .seconds = 8},
    {.name = "slab", .scene = "push", .agents = 9900, .quick_agents = 0, .seconds = 8},
    {.name = "slab, 214 N each",
     .scene = "push-214",
     .agents = 1800,
     .quick_agents = 360,
     .seconds = 8,
     .debt = "overlap"},
    {.name = "silo", .scene = "silo", .agents = 1800, .quick_agents = 600, .seconds = 18, .debt = "overlap"},
    {.name = "bottleneck", .scene = "bottleneck", .agents = 75, .quick_agents = 75},
    {.name = "evacuation", .scene = "evacuation", .agents = 400, .quick_agents = 200, .seconds = 60},
    {.name = "evacuation, friction 0.2",
     .scene = "evacuation",
     .agents = 400,
     .quick_agents = 0,
     .seconds = 60,
     .friction = 0.2F},
    {.name = "evacuation, door 5 m",
     .scene = "evacuation",
     .agents = 1000,
     .quick_agents = 0,
     .seconds = 60,
     .door = 5},
    {.name = "counterflow", .scene = "counterflow", .agents = 500, .quick_agents = 200, .seconds = 40},
    {.name = "counterflow", .scene = "counterflow", .agents = 1000, .quick_agents = 0, .seconds = 40},
    {.name = "doors close", .scene = "door-closes", .agents = 300, .quick_agents = 150, .seconds = 25},
};

constexpr bool is_fine(LawWay way)
{
    return way == LawWay::found_fine || way == LawWay::listed_fine;
}
constexpr bool is_listed(LawWay way)
{
    return way == LawWay::listed || way == LawWay::listed_fine;
}

std::vector<Mark> run(const LawScene& law, LawWay way, bool quick)
{
    const SceneEntry& entry = *find_scene(law.scene);
    if (!(is_listed(way) ? entry.takes.listed : entry.takes.found)) return {};
    RunOptions options;
    options.agents = quick ? law.quick_agents : law.agents;
    options.seconds = law.seconds;
    options.dt = law.dt;
    options.friction = law.friction;
    options.door = law.door;
    options.lists_contacts = is_listed(way);
    if (is_fine(way)) options.settings = fine_settings();
    RunOutputs quiet;
    quiet.progress = false;
    return run_scene(entry, options, quiet).marks;
}

std::string cell(const LawResult& result, LawWay way, std::size_t mark)
{
    const std::vector<Mark>& marks = result.marks[static_cast<int>(way)];
    if (marks.empty()) return "-";
    const bool is_owed = !marks[mark].passes() && result.is_debt(way, marks[mark]);
    return fmt::format("{:.2g} {}{}", marks[mark].value, marks[mark].verdict(), is_owed ? "*" : "");
}

}  // namespace

bool LawResult::is_debt(LawWay way, const Mark& mark) const
{
    return debt && !is_fine(way) && mark.name.starts_with(*debt);
}

SolverSettings fine_settings()
{
    SolverSettings settings;
    settings.substeps = 16;
    settings.relaxations = 2;
    return settings;
}

std::vector<LawResult> run_laws(const LawsOptions& options)
{
    std::vector<LawResult> results;
    for (const LawScene& law : scenes) {
        if (options.quick && law.quick_agents == 0) continue;
        LawResult& result = results.emplace_back();
        result.name = fmt::format("{}, {} people", law.name, options.quick ? law.quick_agents : law.agents);
        if (law.debt != nullptr) result.debt = law.debt;
        if (options.progress) fmt::print(stderr, "laws: {}\n", result.name);
        for (int way = 0; way < law_way_count; ++way)
            result.marks[way] = run(law, static_cast<LawWay>(way), options.quick);
    }
    return results;
}

int failures_in(const std::vector<LawResult>& results, bool with_debts)
{
    int count = 0;
    for (const LawResult& result : results) {
        const bool is_found = !result.marks[static_cast<int>(LawWay::found)].empty();
        for (const LawWay way : {is_found ? LawWay::found : LawWay::listed,
                                 is_found ? LawWay::found_fine : LawWay::listed_fine}) {
            for (const Mark& mark : result.marks[static_cast<int>(way)]) {
                const bool counts = with_debts || !result.is_debt(way, mark);
                count += !mark.passes() && counts ? 1 : 0;
            }
        }
    }
    return count;
}

std::string table_of(const std::vector<LawResult>& results)
{
    std::string text = fmt::format("{:<96}{:>8}  {:<14}{:<14}{:<14}{:<14}\n", "law", "at most", "found",
                                   "found, fine", "listed", "listed, fine");
    for (const LawResult& result : results) {
        const std::vector<Mark>* named = &result.marks[static_cast<int>(LawWay::found)];
        if (named->empty()) named = &result.marks[static_cast<int>(LawWay::listed)];
        for (std::size_t mark = 0; mark < named->size(); ++mark) {
            text +=
                fmt::format("{:<96}{:>8.2g}", result.name + ": " + (*named)[mark].name, (*named)[mark].bound);
            for (int way = 0; way < law_way_count; ++way)
                text += fmt::format("  {:<12}", cell(result, static_cast<LawWay>(way), mark));
            text.erase(text.find_last_not_of(' ') + 1);
            text += "\n";
        }
    }
    const SolverSettings fine = fine_settings();
    const int all = failures_in(results, true), unknown = failures_in(results, false);
    text += fmt::format(
        "found: contacts found by the library; listed: by a host's search. By the default settings, and "
        "fine: {} "
        "substeps, {} relaxations.\n",
        fine.substeps, fine.relaxations);
    text += fmt::format(
        "{} laws are missed with contacts found, {} of them known and marked * (tests/README.md)\n", all,
        all - unknown);
    return text;
}

}  // namespace motley::bench
