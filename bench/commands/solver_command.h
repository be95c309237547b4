// The options of one solver on the command line.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>

#include "motley/motley.h"

namespace motley::bench {

/// Names and values of dials, for CLI11.
inline const std::map<std::string, Method> method_names{{"soft_step", Method::soft_step},
                                                        {"sequential_impulse", Method::sequential_impulse},
                                                        {"direct", Method::direct}};
inline const std::map<std::string, DriftCorrection> drift_names{{"by_method", DriftCorrection::by_method},
                                                                {"none", DriftCorrection::none},
                                                                {"baumgarte", DriftCorrection::baumgarte},
                                                                {"projection", DriftCorrection::projection}};

/// The instruction set of that name. Prints an error when there is none.
inline std::optional<Isa> isa_called(const std::string& name)
{
    const std::optional<Isa> isa = isa_from_name(name);
    if (!isa) fmt::print(stderr, "motley: --isa is {}; expected scalar, sse2, avx2, avx512 or neon\n", name);
    return isa;
}

/// The dials of one solver.
struct SolverCommand {
    std::string isa;
    SolverSettings settings;
    SolverOptions solver;

    void declare(CLI::App& app)
    {
        app.add_option("--method", settings.method, "soft_step, sequential_impulse or direct")
            ->transform(CLI::CheckedTransformer(method_names));
        app.add_option("--drift-correction", settings.drift_correction,
                       "sequential_impulse, direct: none, baumgarte or projection; default: the method's")
            ->transform(CLI::CheckedTransformer(drift_names));
        app.add_option("--substeps", settings.substeps, "substeps a step")
            ->check(CLI::Range(1, 1024))
            ->capture_default_str();
        app.add_option("--iterations", settings.iterations, "sweeps a substep; 0: 1, sequential_impulse 8")
            ->check(CLI::Range(0, 10000))
            ->capture_default_str();
        app.add_option("--relaxations", settings.relaxations, "soft_step: sweeps without bias a substep")
            ->check(CLI::Range(0, 10000))
            ->capture_default_str();
        app.add_option("--contact-hertz", settings.contact_hertz,
                       "soft_step: stiffness of contacts; 0: half of what a substep can follow, 30 at least")
            ->capture_default_str();
        app.add_option("--joint-hertz", settings.joint_hertz,
                       "soft_step: stiffness of joints, as far as a substep can follow")
            ->capture_default_str();
        app.add_flag("--exact", settings.exact_joints, "soft_step: joints solved all at once");
        app.add_option(
               "--exact-above-ratio", settings.exact_above_ratio,
               "soft_step: joints solved all at once where a body hangs on one so many times lighter, or a "
               "rotor turns such bodies")
            ->capture_default_str();
        app.add_flag("--exact-limits", settings.exact_limits,
                     "limits, motors and springs too, where joints are and while they act");
        app.add_flag("--exact-contacts", settings.exact_contacts,
                     "contacts of an island solved all at once, where it is sparse");
        app.add_option("--isa", isa,
                       "scalar, sse2, avx2, avx512 or neon; default: MOTLEY_ISA, else the widest here");
        app.add_option("--threads", solver.threads, "threads, the caller's counted")
            ->check(CLI::Range(1, 1024))
            ->capture_default_str();
        app.add_option("--tolerance", settings.tolerance, "m/s at which an island's sweeps end; 0: never")
            ->capture_default_str();
        app.add_option("--budget", settings.budget_ms,
                       "ms a step may take; substeps or iterations are then the most; 0: no budget")
            ->capture_default_str();
    }
    /// False when there is no such instruction set.
    bool pick_isa()
    {
        if (isa.empty()) return true;
        solver.isa = isa_called(isa);
        return solver.isa.has_value();
    }
};

}  // namespace motley::bench
