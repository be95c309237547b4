// The table at the end of a run, and the same as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "measuring/host.h"
#include "measuring/runner.h"

namespace motley::bench {
namespace {

double agent_steps(const RunResult& r)
{
    return r.bodies * static_cast<double>(r.times.steps);
}
double per(double amount, double seconds)
{
    return seconds > 0 ? amount / seconds : 0;
}

/// From the sweeping time only: what one visit of one constraint costs.
double nanoseconds_per_visit(const RunResult& r)
{
    double sweeps = 0;
    for (const Stage stage : {Stage::warm_start, Stage::solve, Stage::relax})
        sweeps += r.times.stages[static_cast<std::size_t>(stage)];
    return per(sweeps * 1e9, r.times.constraint_sweeps);
}

/// Who found the contacts of people; nothing where there are none.
const char* contacts_of(const RunResult& r)
{
    const SceneEntry* entry = find_scene(r.scene);
    const bool has_people = entry != nullptr && (entry->takes.found || entry->takes.listed);
    return !has_people ? "" : r.lists_contacts ? ", contacts listed" : ", contacts found";
}

}  // namespace

std::string table_of(const RunResult& r)
{
    std::string text;
    const auto line = [&](std::string_view what, const std::string& value) {
        text += fmt::format("  {:<34} {}\n", what, value);
    };
    text += fmt::format("{}: {}, {}, {} thread{}, {} steps{}\n", r.scene, r.method, r.isa, r.threads,
                        r.threads == 1 ? "" : "s", r.steps, contacts_of(r));
    line("bodies (mean)", fmt::format("{:.0f}", r.bodies));
    line("agent-steps/s, whole step", fmt::format("{:.3f} M", per(agent_steps(r), r.times.whole()) * 1e-6));
    line("agent-steps/s, solver alone", fmt::format("{:.3f} M", per(agent_steps(r), r.times.solver) * 1e-6));
    line("whole step, median", fmt::format("{:.3f} ms", r.median_step_seconds * 1e3));
    line("constraints (mean)", fmt::format("{:.0f}", r.constraints));
    line("ns per constraint and sweep", fmt::format("{:.2f}", nanoseconds_per_visit(r)));
    line("colours / overflow (most)", fmt::format("{} / {}", r.colours, r.overflow));
    line("lane occupancy", fmt::format("{:.1f} %", 100 * r.lane_occupancy));
    line("bytes per constraint and sweep", fmt::format("{:.1f}", r.bytes_per_constraint));
    const double steps = static_cast<double>(std::max<std::int64_t>(1, r.times.steps));
    text += "  ms per step\n";
    line("  steering (host)", fmt::format("{:9.4f}", r.times.steering / steps * 1e3));
    line("  neighbour search (host)", fmt::format("{:9.4f}", r.times.search / steps * 1e3));
    for (int s = 0; s < stage_count; ++s) {
        line(fmt::format("  {}", stage_name(static_cast<Stage>(s))),
             fmt::format("{:9.4f}", r.times.stages[static_cast<std::size_t>(s)] / steps * 1e3));
    }
    line("overlap p50 / p99 / max", fmt::format("{:.3f} / {:.3f} / {:.3f} % of radius", 100 * r.overlap_p50,
                                                100 * r.overlap_p99, 100 * r.overlap_max));
    line("joint separation rms / max",
         fmt::format("{:.3g} / {:.3g} m", r.errors.joint_separation_rms, r.errors.joint_separation_max));
    if (r.last.measures.residual_norm > 0) {
        line("residual of the last step",
             fmt::format("{:.3g} sqrt(J), rms {:.3g} m/s, max {:.3g} m/s", r.last.measures.residual_norm,
                         r.last.measures.residual_rms, r.last.measures.residual_max));
        line("substeps x iterations of the last step",
             fmt::format("{} x {}", r.last.substeps, r.last.iterations));
    }
    line("residual approach speed, rms", fmt::format("{:.3g} m/s", r.residual));
    if (r.direct_rms >= 0) {
        line("off the simultaneous solution",
             fmt::format("{:.3g} / {:.3g} m/s rms / max, a step", r.direct_rms, r.direct_max));
    }
    line("bodies contained", fmt::format("{}", r.contained));
    for (const auto& [name, value] : r.figures)
        line(name, std::isnan(value) ? "not measured: the run was too short" : fmt::format("{:.4g}", value));
    for (const Mark& mark : r.marks) {
        text +=
            fmt::format("  {} {}: {:.3g}, at most {:g}\n", mark.verdict(), mark.name, mark.value, mark.bound);
    }
    line("state hash", fmt::format("{:016x}", r.state_hash));
    return text;
}

std::string json_of(const RunResult& r)
{
    nlohmann::ordered_json json;
    json["scene"] = r.scene;
    json["method"] = r.method;
    json["isa"] = r.isa;
    json["threads"] = r.threads;
    json["steps"] = r.steps;
    json["bodies"] = r.bodies;
    json["agent_steps_per_second"] = per(agent_steps(r), r.times.whole());
    json["agent_steps_per_second_solver"] = per(agent_steps(r), r.times.solver);
    json["median_step_ms"] = r.median_step_seconds * 1e3;
    json["constraints"] = r.constraints;
    json["ns_per_constraint_and_sweep"] = nanoseconds_per_visit(r);
    json["colours"] = r.colours;
    json["overflow"] = r.overflow;
    json["lane_occupancy"] = r.lane_occupancy;
    json["bytes_per_constraint"] = r.bytes_per_constraint;
    json["seconds"]["steering"] = r.times.steering;
    json["seconds"]["neighbour search"] = r.times.search;
    for (int s = 0; s < stage_count; ++s)
        json["seconds"][stage_name(static_cast<Stage>(s))] = r.times.stages[static_cast<std::size_t>(s)];
    json["overlap_share_of_radius"] = {
        {"p50", r.overlap_p50}, {"p99", r.overlap_p99}, {"max", r.overlap_max}};
    json["joint_separation_m"] = {{"rms", r.errors.joint_separation_rms},
                                  {"max", r.errors.joint_separation_max}};
    json["residual_approach_speed_rms"] = r.residual;
    if (r.direct_rms >= 0) json["off_direct_m_per_s"] = {{"rms", r.direct_rms}, {"max", r.direct_max}};
    json["bodies_contained"] = r.contained;
    for (const auto& [name, value] : r.figures) json["figures"][name] = value;
    for (const Mark& mark : r.marks)
        json["marks"][mark.name] = {
            {"value", mark.value}, {"at_most", mark.bound}, {"passes", mark.passes()}};
    if (*contacts_of(r) != 0) json["contacts"] = r.lists_contacts ? "listed" : "found";
    json["state_hash"] = fmt::format("{:016x}", r.state_hash);
    json["host_load"] = host_load();
    return json.dump(2) + "\n";
}

}  // namespace motley::bench
