// The trade between speed and accuracy: one scene under a grid of dials, each point its time a step and its error.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

/// The values of each dial; a sweep tries every combination that its method knows.
struct DialGrid {
    std::vector<Method> methods{Method::soft_step, Method::sequential_impulse, Method::direct};
    std::vector<int> substeps{};    ///< empty: 1 to 16; of direct 1 and 4
    std::vector<int> iterations{};  ///< empty: 1 and 2 of soft_step, 4 to 32 of sequential_impulse
    std::vector<int> relaxations{0, 1};
    /// Hz of joints, and half as many of contacts; capped at 0.25 / substep. 0: the default.
    std::vector<float> hertz{0, 1e6F};
    std::vector<DriftCorrection> drift_corrections{DriftCorrection::baumgarte, DriftCorrection::projection};
    std::vector<int> warm_starts{1};  ///< 0 or 1
    std::vector<int> exact{0, 1};     ///< SolverSettings::exact_joints, of soft_step and scenes of joints
    std::vector<int> exact_contacts{0, 1};  ///< of soft_step with relaxation, and scenes of listed contacts
    std::vector<float> tolerances{0};
    std::vector<int> threads{1};
    std::vector<Isa> isas{};  ///< empty: the widest here
};

/// One setting of every dial.
struct Dials {
    SolverSettings settings;
    SolverOptions solver;
};
/// Every combination, without those that differ only in dials that their method ignores.
std::vector<Dials> expand(const DialGrid& grid);
/// "soft_step 4 x 1+1, 60 Hz, ...": what differs from the defaults, short enough for a chart.
std::string label_of(const Dials& dials);

struct SweepOptions {
    std::int64_t agents = 0;  ///< 0: the scene's default
    double seconds = 0;       ///< measured; 0: the scene's default
    int rounds = 3;           ///< each point is run so often, in turn with the others
    std::uint64_t seed = 12345;
    bool with_peers = false;
    std::string only_peer{};  ///< only peers' points with this in name and setting; empty: all
    bool progress = true;
};

/// One point of the trade.
struct SweepPoint {
    std::string engine;  ///< "motley", or a peer with its version
    std::string label;
    std::optional<Dials> dials;        ///< of motley
    std::vector<double> step_seconds;  ///< median step of each round
    double seconds = 0;                ///< median of those
    double solver_seconds = -1;        ///< the solver's part of these; below 0 where a peer does not tell
    double error = 0;                  ///< in the scene's unit; infinite when it came apart
    double worst = 0;                  ///< the largest of what `error` is the mean of
    bool on_front = false;             ///< no point is both faster and more exact
    std::string note;                  ///< why there is no error
};

struct SweepResult {
    std::string scene, description, error_name;
    std::int64_t bodies = 0, joints = 0, steps = 0;
    double host_load = 0;
    int rounds = 0;
    std::vector<SweepPoint> points;  ///< by time
    std::vector<std::string> notes;  ///< peers that are missing or could not run
};

/// Runs the sweep. Throws std::runtime_error for a scene that is not there, InvalidInput for dials out of range.
SweepResult sweep(const std::string& scene, const DialGrid& grid, const SweepOptions& options);

/// Marks the points that no other point beats in both time and error.
void mark_front(std::vector<SweepPoint>& points);

/// The fastest point of each engine whose error is at most `error`; of motley first, null where there is none.
std::vector<std::pair<std::string, const SweepPoint*>> fastest_within(const SweepResult& result,
                                                                      double error);

std::string csv_of(const SweepResult& result);
std::string json_of(const SweepResult& result);
/// A table to read: the front, and how many points lie behind it.
std::string table_of(const SweepResult& result);

}  // namespace motley::bench
