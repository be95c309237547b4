// Runs a plan over a block of copies.
#include "figures/figure_step.h"

#include "kernels/prefetch.h"
#include "layout/colouring.h"

namespace motley {
namespace {

/// Runs a kernel over the contacts and the joints that the tree does not solve, in the order of their colours.
void sweep(const KernelContext& context, const FigureBlock& block,
           ConstraintKernels::CopiesSweep ConstraintKernels::*kernel)
{
    const auto run = [&](const FigureBlock::Joint& lanes, int a, int b) {
        if (lanes.kernels->*kernel != nullptr)
            (lanes.kernels->*kernel)(context, lanes.streams, lanes.block, block.body(a), block.body(b));
    };
    auto contact = block.contacts.begin();
    const auto run_contacts_before = [&](int colour) {
        for (; contact != block.contacts.end() && contact->colour < colour; ++contact)
            run(contact->lanes, contact->a, contact->b);
    };
    const auto& joints = block.shape->joints;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i].in_tree) continue;
        run_contacts_before(joints[i].colour);
        run(block.joints[i], joints[i].a, joints[i].b);
    }
    run_contacts_before(overflow_colour);
}

/// Moves data between the stores of the scene and the rows of the block: kernel prepare or store.
void transfer(const KernelContext& context, const FigureBlock& block, std::span<const ConstraintData> data,
              ConstraintKernels::Transfer ConstraintKernels::*kernel)
{
    const auto& joints = block.shape->joints;
    const std::size_t count = joints.size() + block.contacts.size();
    const auto lanes_of = [&](std::size_t i) -> const FigureBlock::Joint& {
        return i < joints.size() ? block.joints[i] : block.contacts[i - joints.size()].lanes;
    };
    const auto data_of = [&](std::size_t i) -> const ConstraintData& {
        const int type = i < joints.size() ? joints[i].type : block.contacts[i - joints.size()].type;
        return data[static_cast<std::size_t>(type)];
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (i + 1 < count)
            prefetch_constraints(kernel, lanes_of(i + 1).streams, data_of(i + 1), lanes_of(i + 1).block);
        const auto& [kernels, streams, which] = lanes_of(i);
        (kernels->*kernel)(context, streams, data_of(i), which, which + 1);
    }
}

/// Adds the impulses of a finished substep to the sums, for contacts and joints outside the tree; the tree adds its own
/// as it solves.
void add_up(const KernelContext& context, const FigureBlock& block)
{
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        if (block.shape->joints[i].in_tree) continue;
        const FigureBlock::Joint& joint = block.joints[i];
        joint.kernels->add_up(context, joint.streams, joint.block, joint.block + 1);
    }
    for (const auto& [lanes, type, colour, a, b] : block.contacts) {
        if (lanes.streams.sums != nullptr)
            lanes.kernels->add_up(context, lanes.streams, lanes.block, lanes.block + 1);
    }
}

bool any_of_lanes(const float* lanes, std::int32_t count)
{
    return std::any_of(lanes, lanes + count, [](float value) { return value != 0; });
}

/// Finds out what acts on the row of a limit or motor, and writes it. With `only` just in those copies where that is not 0.
void act(const KernelContext& context, const FigureBlock& block, const FigureNode& node,
         const FigureNode::Active& active, int row, float* by, const float* only = nullptr)
{
    const FigureShape::Joint& joint = block.shape->joints[static_cast<std::size_t>(active.joint)];
    const auto& [kernels, streams, which] = block.joints[active.joint];
    float* const of_child = block.system + node.taken;
    float* const of_parent =
        node.parent_node < 0
            ? nullptr
            : block.system + block.shape->nodes[static_cast<std::size_t>(node.parent_node)].taken;
    const auto at_row = [&](std::int64_t array) { return block.system + array + block_lanes * row; };
    float* const rotor = block.shape->has_rotors ? at_row(node.rotor) : nullptr;
    kernels->act(context, streams, which, block.body(joint.a), block.body(joint.b),
                 block.system + node.jacobian + FigureNode::row_floats * row, by,
                 {at_row(node.give), at_row(node.spring_give), rotor, at_row(node.given), at_row(node.speed),
                  at_row(node.least), at_row(node.most)},
                 active.reversed ? of_child : of_parent, active.reversed ? of_parent : of_child, only);
}

/// Finds out which limits and motors of a node act in any copy, and adds their rows to those of the locks. One that pushes
/// nowhere does not act; a rotor always does.
void add_acting_rows(const KernelContext& context, const FigureBlock& block, const FigureNode& node)
{
    int rows = node.rows;
    float* by = block.system + node.acts_by;
    float* row = block.system + node.in_use;
    for (const FigureNode::Active& active : node.actives) {
        const FigureBlock::Joint& lanes = block.joints[active.joint];
        const float* impulses = lanes.impulses();
        const std::int32_t count = lanes.streams.counts[lanes.block];
        bool acts = active.has_rotor;
        for (int i = 0; i < lanes.kernels->active_impulses; ++i)
            acts = acts || any_of_lanes(impulses + i * block_lanes, count);
        if (acts) {
            act(context, block, node, active, rows, by);
            acts = any_of_lanes(by, count);
        }
        *++row = acts ? static_cast<float>(rows++) : 0;
        by += block_lanes;
    }
    block.system[node.in_use] = static_cast<float>(rows);
}

/// Locks do not give way. (act() says how far the rows of limits, motors and springs do.) Once a step, because the memory may
/// have been that of another block.
void make_locks_rigid(const FigureBlock& block)
{
    for (const FigureNode& node : block.shape->nodes)
        std::fill_n(block.system + node.give, node.rows * block_lanes, 0.0F);
}

/// Calls work(node, limit, motor or spring, its row, its ActsBy in lanes) for all that act.
template <class Work>
void for_each_acting(const FigureBlock& block, const Work& work)
{
    if (!block.shape->has_actives) return;
    for (const FigureNode& node : block.shape->nodes)
        block.for_each_acting(node, [&](const FigureNode::Active& active, int row, const float* by) {
            work(node, active, row, by);
        });
}

/// Forgets what has let go: see FigureNode::taken.
void forget_taken(const FigureBlock& block)
{
    if (!block.shape->has_actives) return;
    for (const FigureNode& node : block.shape->nodes)
        std::fill_n(block.system + node.taken, 6 * block_lanes, 0.0F);
}

/// Computes the Jacobian J and the position error C of every lock at the present poses, and of the limits and motors that act,
/// and factors the tree, stiffened by the tension of the locks in the last substep. Given `only`, the tension is that which is
/// there, and what acts and what pulls at the bodies is found out again in copies where that is not 0; all else stays, so that the
/// factors of the other copies have the same bits as before.
void factor_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                 const float* only = nullptr)
{
    const auto locate = [&](int which, float* rows, float* tensions) {
        const FigureShape::Joint& joint = block.shape->joints[static_cast<std::size_t>(which)];
        const FigureBlock::Joint& lanes = block.joints[which];
        lanes.kernels->equality_rows(lanes.streams, lanes.block, block.body(joint.a), block.body(joint.b),
                                     rows);
        if (only != nullptr) return;
        const float* impulses = lanes.impulses();
        for (std::int64_t i = 0; i < lanes.impulse_floats(); ++i)
            tensions[i] = context.step.substep * impulses[i];
    };
    constexpr std::int64_t row_floats = FigureNode::row_floats;
    forget_taken(block);
    for (const FigureNode& node : block.shape->nodes) {
        for (const FigureNode::Lock& lock : node.locks)
            locate(lock.joint, block.system + node.jacobian + row_floats * lock.first_row,
                   block.system + node.tension + block_lanes * lock.first_row);
        if (only == nullptr) {
            add_acting_rows(context, block, node);
        } else {
            block.for_each_acting(node, [&](const FigureNode::Active& active, int row, float* by) {
                act(context, block, node, active, row, by, only);
            });
        }
    }
    for (const FigureClosure& closure : block.shape->closures)
        locate(closure.joint, block.system + block.shape->closure_jacobian + row_floats * closure.first_row,
               block.system + block.shape->closure_target + block_lanes * closure.first_row);
    kernels.factor(block, only);
}

/// The impulses of locks, and of what acts, start from zero in a substep.
void start_impulses(const FigureBlock& block)
{
    // What has let go has not been applied in this substep.
    forget_taken(block);
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        if (!block.shape->joints[i].in_tree) continue;
        std::fill_n(block.joints[i].impulses(), block.joints[i].impulse_floats(), 0.0F);
    }
    for_each_acting(block,
                    [&](const FigureNode& node, const FigureNode::Active& active, int row, const float* by) {
                        const FigureBlock::Joint& lanes = block.joints[active.joint];
                        float* const impulses = lanes.impulses();
                        // A spring's is the third; sweeps solve one beside a limit or motor that acts.
                        for (int which = 0; which < lanes.kernels->active_impulses; ++which) {
                            const float above = which < 2 ? ActsBy::rotor : ActsBy::motor;
                            for (int i = 0; i < block_lanes; ++i)
                                if (by[i] > above) impulses[which * block_lanes + i] = 0;
                        }
                        if (active.has_rotor)
                            std::fill_n(impulses + RotorImpulse::change * block_lanes, block_lanes, 0.0F);
                        // No spring has pushed in this substep.
                        float* const speed_left = block.system + node.speed_left(row, block.rows_of(node));
                        for (int i = 0; i < block_lanes; ++i) {
                            const float speed = block.system[node.speed + block_lanes * row + i];
                            speed_left[i] = active.reversed ? -speed : speed;
                            block.system[node.given + block_lanes * row + i] = 0;
                        }
                    });
}

/// Whether light bodies of a copy may be under much more tension now than when the tree was factored. Not looked at beside limits,
/// motors and springs of the tree: how hard they may push is seen only once it is solved.
bool may_come_taut(const FigureBlock& block)
{
    if (block.shape->has_actives) return false;
    const Array<PointTree>& trees = block.shape->point_trees;
    return std::any_of(trees.begin(), trees.end(), [&](const PointTree& tree) {
        return any_of_lanes(block.system + tree.rigid, block.count);  // RigidTree::uneven comes first
    });
}

/// Where light bodies are under much more tension now than when the tree was factored, it is factored again.
void follow_tension(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block)
{
    kernels.follow_tension(block, context.step.substep, context.step.exact_rate);
    const float* const exceeding = block.system + block.shape->exceeding;
    if (!any_of_lanes(exceeding, block.count)) return;
    factor_tree(context, kernels, block, exceeding);
}

/// What acts on a row has pushed so hard, in one lane, of whose impulses `limit` is the first: a spring alone, or a limit and a
/// motor together.
float pushed_by(float by, const float* limit, int impulses)
{
    if (by > ActsBy::motor) return limit[2 * block_lanes];
    return impulses > 1 ? limit[0] + limit[block_lanes] : limit[0];
}

/// Finds the copies in which a motor, a spring or a limit has pushed harder than it may. Null where none has.
const float* find_exceeding(const FigureBlock& block)
{
    if (!block.shape->has_actives) return nullptr;
    float* const exceeding = block.system + block.shape->exceeding;
    std::fill_n(exceeding, block_lanes, 0.0F);
    for_each_acting(
        block, [&](const FigureNode& node, const FigureNode::Active& active, int row, const float* by) {
            const FigureBlock::Joint& lanes = block.joints[active.joint];
            const float* const least = block.system + node.least + row * block_lanes;
            const float* const most = block.system + node.most + row * block_lanes;
            for (int i = 0; i < block_lanes; ++i) {
                if (!(by[i] > ActsBy::rotor)) continue;
                const float pushed = pushed_by(by[i], lanes.impulses() + i, lanes.kernels->active_impulses);
                if (pushed < least[i] || pushed > most[i]) exceeding[i] = 1;
            }
        });
    return any_of_lanes(exceeding, block.count) ? exceeding : nullptr;
}

/// Solves the tree, and then again without the limits, motors and springs that it has made push harder than they may. These may
/// be others then; two rounds leave few. (What is left lets go when the tree is factored next; but a motor that was too strong
/// for a substep in each step would be too strong for ever.)
void solve_within_bounds(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                         float rate)
{
    kernels.solve(block, rate);
    for (int round = 0; round < 2; ++round) {
        const float* const exceeding = find_exceeding(block);
        if (exceeding == nullptr) return;
        factor_tree(context, kernels, block, exceeding);
        // What stiffened locks do to the bodies has been done by the first solve.
        for (const FigureNode& node : block.shape->nodes)
            std::fill_n(block.system + node.pull, 3 * block_lanes, 0.0F);
        kernels.correct(block, rate);
    }
}

/// Runs the stages of a plan that apply to a figure; the others apply to the whole scene.
class CopiesRunner {
  public:
    CopiesRunner(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                 std::span<const ConstraintData> data)
        : context_(context),
          kernels_(kernels),
          block_(block),
          data_(data),
          has_tree_(block.shape->has_tree()),
          has_others_(block.shape->has_joints_beside_tree() || !block.contacts.empty())
    {
    }
    void run(const PlanStage& stage) const
    {
        switch (stage.operation) {
            case Operation::prepare:
                transfer(context_, block_, data_, &ConstraintKernels::prepare);
                make_locks_rigid(block_);
                kernels_.load(context_, block_);
                break;
            case Operation::stiffen:
                if (context_.overloaded->load(std::memory_order_relaxed))
                    sweep(context_, block_, &ConstraintKernels::stiffen_copies);
                break;
            case Operation::add_up_impulses:
                add_up(context_, block_);
                break;
            case Operation::integrate_velocities:
                kernels_.integrate_velocities(context_, block_);
                break;
            case Operation::factor_trees:
                if (has_tree_) factor_tree(context_, kernels_, block_);
                break;
            case Operation::begin_trees:
                if (!has_tree_) break;
                start_impulses(block_);
                if (may_come_taut(block_)) follow_tension(context_, kernels_, block_);
                break;
            case Operation::warm_start:
                sweep(context_, block_, &ConstraintKernels::warm_start_copies);
                break;
            case Operation::lengthen_steps:
                lengthen_steps(block_);
                break;
            case Operation::solve_trees:
                if (has_tree_ && has_others_)
                    solve_within_bounds(context_, kernels_, block_, context_.step.exact_rate);
                break;
            case Operation::solve:
                iterate(&ConstraintKernels::solve_copies, stage.times, context_.step.exact_rate);
                break;
            case Operation::integrate_positions:
                kernels_.integrate_positions(context_, block_);
                break;
            case Operation::relax:
                iterate(&ConstraintKernels::relax_copies, stage.times, 0);
                break;
            case Operation::restitute:
                sweep(context_, block_, &ConstraintKernels::restitute_copies);
                break;
            case Operation::store:
                kernels_.store(context_, block_);
                transfer(context_, block_, data_, &ConstraintKernels::store);
                break;
            default:
                break;
        }
    }

  private:
    const KernelContext& context_;
    const FigureKernels& kernels_;
    const FigureBlock& block_;
    std::span<const ConstraintData> data_;
    bool has_tree_, has_others_;

    void iterate(ConstraintKernels::CopiesSweep ConstraintKernels::*kernel, int times, float rate) const
    {
        // Without joints and contacts outside the tree, the first sweep solves all.
        const int sweeps = has_others_ ? times : 1;
        for (int i = 0; i < sweeps; ++i) {
            sweep(context_, block_, kernel);
            if (has_tree_) solve_within_bounds(context_, kernels_, block_, rate);
        }
    }
};

}  // namespace

void step_figure(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                 std::span<const ConstraintData> data, const Plan& plan)
{
    const CopiesRunner runner(context, kernels, block, data);
    for_each_stage(plan, [&](const PlanStage& stage, int) { runner.run(stage); });
}

void prepare_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block)
{
    kernels.load(context, block);
    make_locks_rigid(block);
    factor_tree(context, kernels, block);
}

void begin_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block)
{
    start_impulses(block);
    if (!may_come_taut(block)) return;
    kernels.load_velocities(context, block);
    follow_tension(context, kernels, block);
}

void lengthen_steps(const FigureBlock& block)
{
    for (const JointAtPoint& joint : block.shape->joints_at_points) {
        const FigureShape::Joint& of_shape = block.shape->joints[static_cast<std::size_t>(joint.joint)];
        const FigureBlock::Joint& lanes = block.joints[joint.joint];
        if (lanes.kernels->lengthen_steps == nullptr) continue;
        lanes.kernels->lengthen_steps(lanes.streams, lanes.block, block.body(of_shape.a),
                                      block.body(of_shape.b), block.system + joint.arm_a,
                                      block.system + joint.arm_b);
    }
    for_each_acting(block, [&](const FigureNode&, const FigureNode::Active& active, int, const float* by) {
        const FigureBlock::Joint& lanes = block.joints[active.joint];
        lanes.kernels->set_aside(lanes.streams, lanes.block, by);
    });
}

void solve_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                float rate)
{
    kernels.load_velocities(context, block);
    solve_within_bounds(context, kernels, block, rate);
    kernels.store_velocities(context, block);
}

}  // namespace motley
