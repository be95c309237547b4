// The exact laws of crowds: every scene of people that has a law, with its pass marks in one table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measuring/runner.h"

namespace motley::bench {

struct LawsOptions {
    bool quick = false;  ///< fewer people and shorter runs
    bool progress = true;
};

/// How a run of a scene is solved: who finds the contacts, and whether by the defaults or by finer settings.
enum class LawWay { found, found_fine, listed, listed_fine };
inline constexpr int law_way_count = 4;

/// 16 substeps with two sweeps of relaxation each, where the default has 4 with one.
SolverSettings fine_settings();

/// A scene under each way; without marks where a way does not exist.
struct LawResult {
    std::string name;
    /// Marks whose names begin with this are missed by the default settings, which is known: tests/README.md.
    std::optional<std::string> debt;
    std::vector<Mark> marks[law_way_count];
    [[nodiscard]] bool is_debt(LawWay way, const Mark& mark) const;
};

/// Runs the scenes. Throws what run_scene() throws.
std::vector<LawResult> run_laws(const LawsOptions& options);
/// Laws that are missed with contacts that the library finds, or, where it cannot find them, with listed ones. Debts count
/// only with `with_debts`.
int failures_in(const std::vector<LawResult>& results, bool with_debts);
std::string table_of(const std::vector<LawResult>& results);

}  // namespace motley::bench
