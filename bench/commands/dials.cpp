// Dials: their combinations and their names.
#include <fmt/format.h>

#include "commands/sweep.h"

namespace motley::bench {
namespace {

void expand_method(const DialGrid& grid, Method method, const SolverOptions& solver, std::vector<Dials>& all)
{
    const bool soft = method == Method::soft_step, direct = method == Method::direct;
    const std::vector<int> one{1};
    const std::vector<int> defaults = soft ? std::vector<int>{1, 2} : std::vector<int>{4, 8, 16, 32};
    const std::vector<int>& iterations = direct ? one : grid.iterations.empty() ? defaults : grid.iterations;
    const std::vector<float> no_tolerance{0};
    const std::vector<int> default_substeps =
        direct ? std::vector<int>{1, 4} : std::vector<int>{1, 2, 4, 8, 16};
    for (const int substeps : grid.substeps.empty() ? default_substeps : grid.substeps) {
        for (const int iteration : iterations) {
            for (const int relaxation : soft ? grid.relaxations : one) {
                for (const float hertz : soft ? grid.hertz : std::vector<float>{0}) {
                    for (const DriftCorrection drift :
                         soft ? std::vector{DriftCorrection::baumgarte} : grid.drift_corrections) {
                        for (const int warm : direct ? one : grid.warm_starts) {
                            for (const float tolerance : direct ? no_tolerance : grid.tolerances) {
                                SolverSettings s;
                                s.method = method;
                                s.substeps = substeps;
                                s.iterations = iteration;
                                s.relaxations = relaxation;
                                if (hertz != 0) {
                                    s.joint_hertz = hertz;
                                    s.contact_hertz = hertz / 2;
                                }
                                s.drift_correction = drift;
                                s.warm_start = warm != 0;
                                s.tolerance = tolerance;
                                for (const int exact : soft ? grid.exact : std::vector<int>{0}) {
                                    s.exact_joints = exact != 0;
                                    for (const int contacts :
                                         soft&& relaxation > 0 ? grid.exact_contacts : std::vector<int>{0}) {
                                        s.exact_contacts = contacts != 0;
                                        all.push_back({s, solver});
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

const char* name_of(DriftCorrection drift)
{
    return drift == DriftCorrection::none        ? "none"
           : drift == DriftCorrection::baumgarte ? "Baumgarte"
                                                 : "projection";
}

}  // namespace

std::vector<Dials> expand(const DialGrid& grid)
{
    std::vector<Dials> all;
    const std::vector<Isa> isas = grid.isas.empty() ? std::vector{default_isa()} : grid.isas;
    for (const Method method : grid.methods) {
        for (const int threads : grid.threads) {
            for (const Isa isa : isas) {
                expand_method(grid, method, {.threads = threads, .isa = isa}, all);
                // The direct method uses neither lanes nor threads, so one combination is enough.
                if (method == Method::direct) break;
            }
            if (method == Method::direct) break;
        }
    }
    for (const Dials& dials : all) dials.settings.validate();
    return all;
}

std::string label_of(const Dials& dials)
{
    const SolverSettings s = dials.settings.resolved();
    std::string label;
    if (s.method == Method::soft_step) {
        label = fmt::format("soft {} x {}+{}", s.substeps, s.iterations, s.relaxations);
        if (s.contact_hertz > 0)
            label += s.joint_hertz >= 1e5F ? ", stiffest" : fmt::format(", {:g} Hz", s.joint_hertz);
    } else if (s.method == Method::sequential_impulse) {
        label = fmt::format("impulse {} x {}, {}", s.substeps, s.iterations, name_of(s.drift_correction));
    } else {
        label = fmt::format("direct {}, {}", s.substeps, name_of(s.drift_correction));
    }
    if (s.exact_joints) label += ", exact";
    if (s.exact_contacts) label += ", exact contacts";
    if (!s.warm_start) label += ", cold";
    if (s.tolerance > 0) label += fmt::format(", tolerance {:g}", s.tolerance);
    if (dials.solver.threads != 1) label += fmt::format(", {} threads", dials.solver.threads);
    if (dials.solver.isa && *dials.solver.isa != default_isa())
        label += fmt::format(", {}", isa_name(*dials.solver.isa));
    return label;
}

}  // namespace motley::bench
