// The substeps of a block of copies, in the order of Solver's.
#include "figure_step.h"

namespace motley {
namespace {

/// Runs a kernel over the joints that the tree does not solve, in the order of their colours.
void sweep(const KernelContext& context, const FigureBlock& block,
           ConstraintKernels::CopiesSweep ConstraintKernels::*kernel)
{
    const auto& joints = block.shape->joints;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i].in_tree) continue;
        const FigureBlock::Joint& joint = block.joints[i];
        if (joint.kernels->*kernel == nullptr) continue;
        (joint.kernels->*kernel)(context, joint.streams, joint.block, block.body(joints[i].a),
                                 block.body(joints[i].b));
    }
}

/// What goes between the stores of the scene and the rows of the block.
void transfer(const KernelContext& context, const FigureBlock& block, std::span<const ConstraintData> data,
              ConstraintKernels::Transfer ConstraintKernels::*kernel)
{
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        const FigureBlock::Joint& joint = block.joints[i];
        (joint.kernels->*kernel)(context, joint.streams,
                                 data[static_cast<std::size_t>(block.shape->joints[i].type)], joint.block,
                                 joint.block + 1);
    }
}

/// What the joints beside the tree did in a substep that is done; the tree adds up as it solves.
void add_up(const KernelContext& context, const FigureBlock& block)
{
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        if (block.shape->joints[i].in_tree) continue;
        const FigureBlock::Joint& joint = block.joints[i];
        joint.kernels->add_up(context, joint.streams, joint.block, joint.block + 1);
    }
}

std::int64_t impulse_floats(const FigureBlock::Joint& joint)
{
    return std::int64_t{joint.kernels->impulse_floats} * block_lanes;
}

/// J and C of every lock where the bodies are now, and the factors, stiffened by what the locks pull with.
void factor_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block)
{
    const auto locate = [&](int which, float* rows, float* tensions) {
        const FigureShape::Joint& joint = block.shape->joints[static_cast<std::size_t>(which)];
        const FigureBlock::Joint& lanes = block.joints[which];
        lanes.kernels->equality_rows(lanes.streams, lanes.block, block.body(joint.a), block.body(joint.b),
                                     rows);
        const std::int64_t floats = impulse_floats(lanes);
        const float* impulses = lanes.streams.impulses + lanes.block * floats;
        for (std::int64_t i = 0; i < floats; ++i) tensions[i] = context.step.substep * impulses[i];
    };
    constexpr std::int64_t row_floats = FigureNode::row_floats;
    for (const FigureNode& node : block.shape->nodes) {
        for (const FigureNode::Lock& lock : node.locks)
            locate(lock.joint, block.system + node.jacobian + row_floats * lock.first_row,
                   block.system + node.target + block_lanes * lock.first_row);
    }
    for (const FigureClosure& closure : block.shape->closures)
        locate(closure.joint, block.system + block.shape->closure_jacobian + row_floats * closure.first_row,
               block.system + block.shape->closure_target + block_lanes * closure.first_row);
    kernels.factor(block);
}

}  // namespace

void step_figure(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                 std::span<const ConstraintData> data, const FigureSteps& steps)
{
    const bool has_tree = block.shape->has_tree();
    const bool has_others = block.shape->has_joints_beside_tree();
    // Locks alone are solved by their first sweep.
    const auto sweeps = [&](int wanted) { return has_others || wanted == 0 ? wanted : 1; };
    // Impulses act where the bodies are, or angular momentum is lost: so the tree is factored again before it relaxes. The next
    // substep begins there and needs no other factors.
    const bool relaxes = steps.relaxations > 0;
    transfer(context, block, data, &ConstraintKernels::prepare);
    kernels.load(context, block);
    if (context.overloaded->load(std::memory_order_relaxed))
        sweep(context, block, &ConstraintKernels::stiffen_copies);
    for (int substep = 0; substep < steps.substeps; ++substep) {
        kernels.integrate_velocities(context, block);
        if (has_tree && (substep == 0 || !relaxes)) factor_tree(context, kernels, block);
        if (has_tree) begin_tree(block);
        if (has_others) sweep(context, block, &ConstraintKernels::warm_start_copies);
        // Limits and motors shall see bodies that hold together.
        if (has_tree && has_others) kernels.solve(block, context.step.exact_rate);
        for (int i = 0; i < sweeps(steps.iterations); ++i) {
            if (has_others) sweep(context, block, &ConstraintKernels::solve_copies);
            if (has_tree) kernels.solve(block, context.step.exact_rate);
        }
        kernels.integrate_positions(context, block);
        if (has_tree && relaxes) factor_tree(context, kernels, block);
        for (int i = 0; i < sweeps(steps.relaxations); ++i) {
            if (has_others) sweep(context, block, &ConstraintKernels::relax_copies);
            if (has_tree) kernels.solve(block, 0);
        }
        if (has_others) add_up(context, block);
    }
    kernels.store(context, block);
    transfer(context, block, data, &ConstraintKernels::store);
}

void prepare_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block)
{
    kernels.load(context, block);
    factor_tree(context, kernels, block);
}

void begin_tree(const FigureBlock& block)
{
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        if (!block.shape->joints[i].in_tree) continue;
        const std::int64_t floats = impulse_floats(block.joints[i]);
        float* impulses = block.joints[i].streams.impulses + block.joints[i].block * floats;
        std::fill(impulses, impulses + floats, 0.0F);
    }
}

void solve_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                float rate)
{
    kernels.load_velocities(context, block);
    kernels.solve(block, rate);
    kernels.store_velocities(context, block);
}

}  // namespace motley
