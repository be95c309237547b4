// A first sweep finds the fastest setting that is exact enough. A second one runs it on one thread and on two, and
// Bullet, in turn.
#include "commands/anchors.h"

#include <fmt/format.h>

#include "commands/sweep.h"
#include "measuring/host.h"

namespace motley::bench {
namespace {

/// A large scene, and how far its joints part with Box3D at 4 substeps: the error at which motley is timed. Box3D's
/// times are not used, because times do not carry over from machine to machine.
struct Anchor {
    const char* scene;
    std::int64_t bodies;
    double most_error;  ///< m rms
};
constexpr Anchor anchors[] = {
    {"grid", 10000, 0.0074}, {"chains", 20000, 0.0038}, {"ragdolls", 11000, 0.0005}};
constexpr const char* bullet_setting = "10 iterations, erp 0.2";

DialGrid grid_of(const Dials& dials)
{
    DialGrid grid;
    const SolverSettings& s = dials.settings;
    grid.methods = {s.method};
    grid.substeps = {s.substeps};
    grid.iterations = {s.iterations};
    grid.relaxations = {s.relaxations};
    grid.hertz = {s.contact_hertz > 0 ? s.joint_hertz : 0};
    grid.exact = {s.exact_joints ? 1 : 0};
    grid.exact_contacts = {s.exact_contacts ? 1 : 0};
    grid.threads = {1, 2};
    return grid;
}

/// The fastest setting that is exact enough.
std::optional<Dials> pick(const Anchor& anchor, const SweepOptions& options)
{
    DialGrid grid;
    grid.methods = {Method::soft_step};
    grid.substeps = {1, 2, 3, 4, 5};
    grid.iterations = {1};
    grid.hertz = {0};
    const SweepResult found = sweep(anchor.scene, grid, options);
    const SweepPoint* best = fastest_within(found, anchor.most_error).front().second;
    return best == nullptr ? std::nullopt : best->dials;
}

AnchorResult measure(const Anchor& anchor, const AnchorOptions& asked)
{
    SweepOptions options;
    options.agents = asked.quick ? anchor.bodies / 10 : anchor.bodies;
    options.rounds = asked.rounds;
    options.progress = asked.progress;
    AnchorResult result;
    result.scene = anchor.scene;
    result.most_error = anchor.most_error;
    result.host_load = host_load();
    const std::optional<Dials> dials = pick(anchor, options);
    if (!dials) return result;
    options.with_peers = true;
    options.only_peer = bullet_setting;
    const SweepResult measured = sweep(anchor.scene, grid_of(*dials), options);
    for (const int threads : {1, 2}) {
        for (const SweepPoint& point : measured.points) {
            if (point.dials && point.dials->solver.threads == threads)
                result.motley.push_back({point.label, point.seconds, point.error});
        }
    }
    for (const SweepPoint& point : measured.points) {
        if (!point.dials) result.bullet_seconds = point.solver_seconds;
    }
    return result;
}

}  // namespace

std::vector<AnchorResult> measure_anchors(const AnchorOptions& options)
{
    std::vector<AnchorResult> results;
    for (const Anchor& anchor : anchors) results.push_back(measure(anchor, options));
    return results;
}

std::string table_of(const std::vector<AnchorResult>& results)
{
    std::string text = fmt::format(
        "whole steps of motley beside Bullet's solver alone, run in turn; host load {:.2f}\n"
        "{:10} {:34} {:>9} {:>11} {:>9}\n",
        results.empty() ? 0 : results.front().host_load, "scene", "setting", "ms", "rms m", "x Bullet");
    for (const AnchorResult& result : results) {
        if (result.motley.empty())
            text +=
                fmt::format("{:10} no setting parts by {:g} m or less\n", result.scene, result.most_error);
        for (const AnchorResult::Line& line : result.motley) {
            text += fmt::format("{:10} {:34} {:9.3f} {:11.3g}", result.scene, line.label, line.seconds * 1e3,
                                line.error);
            if (result.bullet_seconds > 0)
                text += fmt::format(" {:9.1f}", result.bullet_seconds / line.seconds);
            text += '\n';
        }
        if (result.bullet_seconds > 0)
            text += fmt::format("{:10} {:34} {:9.3f}\n", result.scene, "Bullet, 10 iterations",
                                result.bullet_seconds * 1e3);
    }
    if (!results.empty() && results.front().bullet_seconds < 0)
        text +=
            "Bullet was not found when the program was built: .ci/install-packages --with-report-tools "
            "brings it\n";
    return text;
}

}  // namespace motley::bench
