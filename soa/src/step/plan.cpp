// See plan.h. make_plan() lists the stages of a step as the README describes them.
#include "step/plan.h"

#include <algorithm>
#include <cstddef>

namespace motley {
namespace {

struct OperationFacts {
    const char* name;
    Stage stage;
};

constexpr OperationFacts facts[] = {
    {"find islands", Stage::prepare},
    {"note momenta of free groups", Stage::prepare},
    {"prepare", Stage::prepare},
    {"stiffen what bears heavy loads", Stage::prepare},
    {"list bodies beside patches", Stage::prepare},
    {"step figures in lockstep", Stage::figures},
    {"solve directly", Stage::solve},
    {"add up impulses", Stage::integrate_velocities},
    {"integrate velocities", Stage::integrate_velocities},
    {"factor trees", Stage::warm_start},
    {"begin trees", Stage::warm_start},
    {"warm start", Stage::warm_start},
    {"lengthen steps beside trees", Stage::warm_start},
    {"solve trees", Stage::warm_start},
    {"solve", Stage::solve},
    {"measure residuals", Stage::solve},
    {"visit each patch", Stage::solve},
    {"integrate positions", Stage::integrate_positions},
    {"integrate positions, then the next velocities", Stage::integrate_positions},
    {"project", Stage::integrate_positions},
    {"relax", Stage::relax},
    {"restitution", Stage::restitution},
    {"store impulses", Stage::store},
    {"land free groups", Stage::store},
    {"move bodies", Stage::store},
};
static_assert(std::size(facts) == static_cast<std::size_t>(Operation::move_bodies) + 1);

const OperationFacts& facts_of(Operation operation)
{
    return facts[static_cast<std::size_t>(operation)];
}

const char* name_of(Substeps substeps)
{
    switch (substeps) {
        case Substeps::every:
            return "";
        case Substeps::first:
            return " (first substep)";
        case Substeps::all_but_first:
            return " (all but the first substep)";
        case Substeps::last:
            return " (last substep)";
        case Substeps::all_but_last:
            return " (all but the last substep)";
    }
    return "";
}

void append(std::string& text, const Array<PlanStage>& stages, const char* indent)
{
    for (const PlanStage& stage : stages) {
        text += indent;
        text += name_of(stage.operation);
        if (stage.where == Where::beside_patches) text += ", beside patches";
        if (stage.times > 1) text += " x " + std::to_string(stage.times);
        text += name_of(stage.substeps);
        text += '\n';
    }
}

Array<PlanStage>::iterator find(Array<PlanStage>& stages, Operation operation)
{
    return std::find_if(stages.begin(), stages.end(),
                        [&](const PlanStage& stage) { return stage.operation == operation; });
}

}  // namespace

const char* name_of(Operation operation)
{
    return facts_of(operation).name;
}

Stage stage_of(Operation operation)
{
    return facts_of(operation).stage;
}

void make_plan(const SolverSettings& settings, const StepNeeds& needs, Plan& plan)
{
    for (Array<PlanStage>* stages : {&plan.before, &plan.substep, &plan.after, &plan.visit}) stages->clear();
    plan.replays_warm_starts = false;
    if (settings.method == Method::direct) {
        plan.substeps = 0;  // the reference solver makes its own
        plan.after = {{Operation::solve_directly}, {Operation::move_bodies}};
        return;
    }
    const bool is_soft = settings.method == Method::soft_step;
    const bool relaxes = is_soft && settings.relaxations > 0;
    const bool projects = !is_soft && settings.drift_correction == DriftCorrection::projection;
    plan.substeps = settings.substeps;

    const auto before = [&](const PlanStage& stage) { plan.before.push_back(stage); };
    if (needs.picks_islands) before({Operation::find_islands});
    before({Operation::note_momenta});
    before({Operation::prepare});
    before({Operation::stiffen});
    before({Operation::step_figures});

    const auto in_substep = [&](const PlanStage& stage) { plan.substep.push_back(stage); };
    in_substep({Operation::add_up_impulses, Substeps::all_but_first});
    in_substep({Operation::integrate_velocities});
    if (needs.solves_trees) {
        // With relaxation, trees have been factored after the last integration of positions.
        in_substep({Operation::factor_trees, relaxes ? Substeps::first : Substeps::every});
        in_substep({Operation::begin_trees});
    }
    in_substep({Operation::warm_start});
    if (needs.solves_trees) {
        in_substep({Operation::lengthen_steps});
        // Limits and motors must start from velocities with which the exact joints hold.
        in_substep({Operation::solve_trees});
    }
    in_substep({.operation = Operation::solve, .times = settings.iterations});
    if (needs.measures) in_substep({Operation::measure, Substeps::last});
    in_substep({Operation::integrate_positions});
    if (projects && settings.projections > 0)
        in_substep({.operation = Operation::project, .times = settings.projections});
    if (relaxes) {
        // Impulses must act at the present poses, or angular momentum is lost.
        if (needs.solves_trees) in_substep({Operation::factor_trees});
        in_substep({.operation = Operation::relax, .times = settings.relaxations});
    }

    const auto after = [&](const PlanStage& stage) { plan.after.push_back(stage); };
    if (needs.bounces) after({Operation::restitute});
    after({Operation::add_up_impulses});
    after({Operation::store});
    after({Operation::land});
    after({Operation::move_bodies});
}

void fuse_integrations(Plan& plan)
{
    if (plan.substep.empty() || plan.substep.back().operation != Operation::integrate_positions) return;
    find(plan.substep, Operation::integrate_velocities)->substeps = Substeps::first;
    plan.substep.back().substeps = Substeps::last;
    plan.substep.push_back({Operation::integrate_on, Substeps::all_but_last});
}

void replay_warm_starts(Plan& plan)
{
    plan.replays_warm_starts = true;
    find(plan.substep, Operation::warm_start)->substeps = Substeps::first;
}

void visit_patches_once(Plan& plan)
{
    plan.visit = {{Operation::solve}, {Operation::integrate_positions}, {Operation::relax}};
    const auto solve = find(plan.substep, Operation::solve);
    const int solves = solve->times, relaxations = find(plan.substep, Operation::relax)->times;
    plan.substep.erase(solve, plan.substep.end());
    const auto in_substep = [&](const PlanStage& stage) {
        if (stage.times > 0) plan.substep.push_back(stage);
    };
    in_substep({.operation = Operation::solve, .times = solves - 1});
    in_substep({.operation = Operation::solve, .where = Where::beside_patches});
    in_substep({Operation::visit_patches});
    in_substep({.operation = Operation::integrate_positions, .where = Where::beside_patches});
    in_substep({.operation = Operation::relax, .where = Where::beside_patches});
    in_substep({.operation = Operation::relax, .times = relaxations - 1});
    plan.before.push_back({Operation::list_bodies_beside_patches});
}

std::string text_of(const Plan& plan)
{
    std::string text;
    append(text, plan.before, "");
    if (!plan.substep.empty()) text += std::to_string(plan.substeps) + " substeps of\n";
    for (const PlanStage& stage : plan.substep) {
        append(text, {stage}, "    ");
        if (stage.operation == Operation::visit_patches) append(text, plan.visit, "        ");
    }
    append(text, plan.after, "");
    return text;
}

}  // namespace motley
