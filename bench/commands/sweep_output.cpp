// A sweep as CSV, JSON and a table.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "commands/sweep.h"
#include "measuring/runner.h"

namespace motley::bench {
namespace {

const char* name_of(Method method)
{
    return method == Method::soft_step            ? "soft_step"
           : method == Method::sequential_impulse ? "sequential_impulse"
                                                  : "direct";
}
const char* name_of(DriftCorrection drift)
{
    return drift == DriftCorrection::none        ? "none"
           : drift == DriftCorrection::baumgarte ? "baumgarte"
                                                 : "projection";
}

}  // namespace

std::string csv_of(const SweepResult& result)
{
    std::string text =
        "scene,engine,label,method,substeps,iterations,relaxations,exact_joints,exact_contacts,joint_hertz,"
        "drift_correction,"
        "warm_start,tolerance,"
        "threads,isa,ms_per_step,error,worst,on_front,note\n";
    for (const SweepPoint& p : result.points) {
        text += fmt::format("{},{},\"{}\",", result.scene, p.engine, p.label);
        if (p.dials) {
            const SolverSettings& s = p.dials->settings;
            text +=
                fmt::format("{},{},{},{},{:d},{:d},{:g},{},{:d},{:g},{},{},", name_of(s.method), s.substeps,
                            s.iterations, s.relaxations, s.exact_joints, s.exact_contacts, s.joint_hertz,
                            name_of(s.drift_correction), s.warm_start, s.tolerance, p.dials->solver.threads,
                            isa_name(p.dials->solver.isa.value_or(default_isa())));
        } else {
            text += ",,,,,,,,,,,,";
        }
        text += fmt::format("{:.6g},{:.6g},{:.6g},{:d},{}\n", p.seconds * 1e3, p.error, p.worst, p.on_front,
                            p.note);
    }
    return text;
}

std::string json_of(const SweepResult& result)
{
    nlohmann::ordered_json json;
    json["scene"] = result.scene;
    json["description"] = result.description;
    json["error"] = result.error_name;
    json["bodies"] = result.bodies;
    json["joints"] = result.joints;
    json["steps"] = result.steps;
    json["rounds"] = result.rounds;
    json["host_load"] = result.host_load;
    json["notes"] = result.notes;
    json["points"] = nlohmann::ordered_json::array();
    for (const SweepPoint& p : result.points) {
        nlohmann::ordered_json point;
        point["engine"] = p.engine;
        point["label"] = p.label;
        if (p.dials) {
            const SolverSettings& s = p.dials->settings;
            point["dials"] = {{"method", name_of(s.method)},
                              {"substeps", s.substeps},
                              {"iterations", s.iterations},
                              {"relaxations", s.relaxations},
                              {"exact_joints", s.exact_joints},
                              {"exact_contacts", s.exact_contacts},
                              {"joint_hertz", s.joint_hertz},
                              {"drift_correction", name_of(s.drift_correction)},
                              {"warm_start", s.warm_start},
                              {"tolerance", s.tolerance},
                              {"threads", p.dials->solver.threads},
                              {"isa", isa_name(p.dials->solver.isa.value_or(default_isa()))}};
        }
        point["ms_per_step"] = p.seconds * 1e3;
        point["ms_of_each_round"] = nlohmann::ordered_json::array();
        for (const double seconds : p.step_seconds) point["ms_of_each_round"].push_back(seconds * 1e3);
        // JSON has no infinity: a point that came apart has a note instead of an error.
        if (std::isfinite(p.error)) {
            point["error"] = p.error;
            point["worst"] = p.worst;
        }
        point["on_front"] = p.on_front;
        if (!p.note.empty()) point["note"] = p.note;
        json["points"].push_back(point);
    }
    return json.dump(1) + "\n";
}

std::string table_of(const SweepResult& result)
{
    std::string text = fmt::format(
        "{}: {} bodies, {} joints, {} steps measured, {} rounds, host load {:.2f}\n", result.scene,
        result.bodies, result.joints, result.steps, result.rounds, result.host_load);
    text += fmt::format("{:<14}{:<44}{:>12}{:>14}{:>14}\n", "engine", "setting", "ms/step", "error", "worst");
    std::size_t behind = 0;
    for (const SweepPoint& p : result.points) {
        if (!p.on_front) {
            ++behind;
            continue;
        }
        text += fmt::format("{:<14}{:<44}{:>12.4f}{:>14.4g}{:>14.4g}\n", p.engine, p.label, p.seconds * 1e3,
                            p.error, p.worst);
    }
    for (double error = 1e-1; error > 5e-5; error /= 10) {
        text += fmt::format("fastest within {:<8.0e}", error);
        for (const auto& [engine, point] : fastest_within(result, error)) {
            text += point == nullptr ? fmt::format("  {}: none", engine)
                                     : fmt::format("  {}: {:.4f} ms", engine, point->seconds * 1e3);
        }
        text += "\n";
    }
    text += fmt::format("{} points lie behind this front; error: {}\n", behind, result.error_name);
    for (const std::string& note : result.notes) text += "note: " + note + "\n";
    return text;
}

}  // namespace motley::bench
