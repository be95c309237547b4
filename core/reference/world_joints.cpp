// Rows of joints in the reference: what they want, and a sweep over them.
#include <algorithm>
#include <cmath>

#include "motley/reference/constraints.h"
#include "world_rows.h"

namespace motley::reference {

std::vector<Block> World::blocks_of(const Joint& joint) const
{
    const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
    const bool in_plane = is_planar_pair(joint.a, joint.b);
    if (!joint.model->keeps_rows_of_start()) {
        const double travelled =
            joint.travelled + joint.model->travel(start_[a], start_[b], bodies[a], bodies[b]);
        return joint.model->blocks(bodies[a], bodies[b], in_plane, travelled);
    }
    std::vector<Block> blocks = joint.model->blocks(start_[a], start_[b], in_plane, joint.travelled);
    for (Block& block : blocks) {
        if (block.kind == Block::Kind::contact)
            block.error += block.jacobian * moved_since_start(joint.a, joint.b);
    }
    return blocks;
}

Eigen::MatrixXd World::mass_of(const Joint& joint, const Block& block) const
{
    const std::vector<Body>& then = joint.model->keeps_rows_of_start() ? start_ : bodies;
    return effective_mass(block.jacobian, then[static_cast<std::size_t>(joint.a)],
                          then[static_cast<std::size_t>(joint.b)]);
}

void World::find_rows(Joint& joint, double h, const SolverSettings& settings,
                      std::vector<BlockRow>& rows) const
{
    std::vector<Block> blocks = blocks_of(joint);
    joint.impulses.resize(blocks.size());
    const std::size_t contacts = contacts_of(blocks);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const double most = h * blocks[i].most;
        BlockRow row{&joint, i, std::move(blocks[i]), {}, {}, {}, {}, {}, {}, {}, most, contacts};
        const Eigen::VectorXd& error = row.block.error;
        aim(row, error, h, settings);
        if (row.impulse().size() != error.size()) row.impulse() = 0 * error;
        rows.push_back(std::move(row));
    }
}

void World::begin_joint(Joint& joint, double h, const SolverSettings& settings, std::vector<BlockRow>& rows)
{
    const std::size_t first = rows.size();
    find_rows(joint, h, settings, rows);
    const std::vector<Body>& then = joint.model->keeps_rows_of_start() ? start_ : bodies;
    const Eigen::Matrix<double, 12, 12> inverse_mass =
        pair_inverse_mass(then[static_cast<std::size_t>(joint.a)], then[static_cast<std::size_t>(joint.b)]);
    for (std::size_t i = first; i < rows.size(); ++i) {
        BlockRow& row = rows[i];
        const Block& block = row.block;
        row.mass = mass_of(joint, block);
        if (block.armature > 0) row.mass(0, 0) += block.armature;
        row.to_force = to_force_of(block);
        if (block.bounds_torque) {
            row.response = inverse_mass.block<3, 3>(3, 3) + inverse_mass.block<3, 3>(9, 9);
        } else {
            row.response = response(block.jacobian, inverse_mass);
            if (block.armature > 0) row.response(0, 0) = 1 / row.mass(0, 0);
        }
        apply(joint, block.jacobian, row.impulse());
        // The rotor begins with the change that it had in the last substep, and the bodies with what they gave for it.
        if (block.armature > 0 && i == first) {
            apply(joint, block.jacobian, Eigen::VectorXd::Constant(1, -block.armature * joint.rotor_change));
            joint.rotor_start = joint.rotor_speed;
            joint.rotor_speed += joint.rotor_change;
        }
    }
}

/// Softness and bias of a block with this error, for sweeps and for relaxation.
void World::aim(BlockRow& row, const Eigen::VectorXd& error, double h, const SolverSettings& settings) const
{
    const Block& block = row.block;
    const bool contact = block.kind == Block::Kind::contact;
    const bool soft_step = settings.method == Method::soft_step;
    const double beta =
        settings.drift_correction == DriftCorrection::baumgarte ? static_cast<double>(settings.baumgarte) : 0;
    const Soft rigid{0, 1, 0};
    row.relax_soft = rigid;
    if (block.kind == Block::Kind::motor) {
        row.soft = rigid;
    } else if (block.stiffness > 0 || block.damping > 0) {
        // lambda = -h (k (C + h v) + c v), solved for v with v = v_free + K lambda.
        const double resistance = block.damping + h * block.stiffness, give = 1 / (h * resistance);
        const double mass = mass_of(*row.joint, block)(0, 0) + block.armature, k = mass > 0 ? 1 / mass : 0;
        row.soft = row.relax_soft = {block.stiffness / resistance, k / (k + give), give / (k + give)};
    } else if (block.hertz > 0) {
        row.soft = row.relax_soft = softness(block.hertz, block.damping_ratio, h);
    } else if (contact) {
        row.soft = contact_softness(row.joint->a, row.joint->b, h, settings);
    } else {
        row.soft = soft_step ? softness(std::min(static_cast<double>(settings.joint_hertz), stiffest(h)),
                                        settings.joint_damping_ratio, h)
                             : Soft{beta / h, 1, 0};
    }
    row.bias = row.soft.rate * error;
    row.relax_bias = row.relax_soft.rate * error;
    if (block.is_one_sided()) {
        const double slop = contact && !soft_step ? static_cast<double>(settings.penetration_slop) : 0;
        if (error(0) > 0) {  // room: it may close by that much within the substep
            row.soft = rigid;
            row.bias = row.relax_bias = error / h;
        } else {
            row.bias(0) = row.soft.rate * std::min(error(0) + slop, 0.0);
        }
    }
    if (block.speed.size() > 0) {
        row.bias -= block.speed;
        row.relax_bias -= block.speed;
    }
}

void World::solve_block(BlockRow& row, double h, const SolverSettings& settings, bool relax)
{
    Joint& joint = *row.joint;
    // The separation of contacts is computed anew, because positions may have moved since.
    if (row.block.kind == Block::Kind::contact) aim(row, blocks_of(joint)[row.index].error, h, settings);
    const Soft& soft = relax ? row.relax_soft : row.soft;
    const Eigen::VectorXd& bias = relax ? row.relax_bias : row.bias;
    const Eigen::VectorXd held = row.impulse();
    const double side = row.block.side;
    // A rotor that is geared to the row takes its share of an impulse along it, and of what others changed of its
    // speed.
    const double rotor = row.block.armature, to_bodies = rotor > 0 ? 1 - rotor / row.mass(0, 0) : 1;
    if (rotor > 0) {
        const Eigen::VectorXd excess =
            speed(joint.a, joint.b, row.block.jacobian).array() - joint.rotor_speed;
        apply(joint, row.block.jacobian, -rotor * to_bodies * excess);
    }
    Eigen::VectorXd wanted =
        held - soft.mass_scale * row.mass * (speed(joint.a, joint.b, row.block.jacobian) + side * bias) -
        soft.impulse_scale * held;
    if (row.block.is_one_sided()) {
        const double there = row.mass(0, 0) * side * speed(joint.a, joint.b, row.block.jacobian)(0);
        const double most =
            side * held(0) - there + row.mass(0, 0) * static_cast<double>(settings.push_out_speed);
        wanted(0) = side * std::clamp(side * wanted(0), 0.0, std::max(most, 0.0));
    }
    if (std::isfinite(row.bound())) {
        wanted = bounded(held, wanted, row.to_force, row.response,
                         row.response.cwiseAbs().rowwise().sum().maxCoeff(), row.bound());
    }
    apply(joint, row.block.jacobian, to_bodies * (wanted - held));
    if (rotor > 0) {
        joint.rotor_speed = speed(joint.a, joint.b, row.block.jacobian)(0);
        joint.rotor_change = joint.rotor_speed - joint.rotor_start;
    }
    row.impulse() = wanted;
    double& peak = row.joint->peaks[row.index];
    peak = std::max(peak, wanted(0));
}

/// Carries the arms of the blocks of a joint along with the bodies, which have moved for h since: carried_arms.h.
void World::carry_arms(std::span<BlockRow> rows, double h) const
{
    const Block& first = rows.front().block;
    if (!first.point && !first.line) return;
    const Body &body_a = bodies[static_cast<std::size_t>(rows.front().joint->a)],
               &body_b = bodies[static_cast<std::size_t>(rows.front().joint->b)];
    const Vector6 &a = body_a.velocity, &b = body_b.velocity;
    const Eigen::Matrix<double, 12, 12> inverse_mass = pair_inverse_mass(body_a, body_b);
    const double mass = 1 / (inverse_mass(0, 0) + inverse_mass(6, 6)),
                 weight_a = mass * inverse_mass.block<3, 3>(3, 3).trace(),
                 weight_b = mass * inverse_mass.block<3, 3>(9, 9).trace();
    Eigen::Vector3d arm_a = first.point ? first.point->arm_a : first.line->arm_a,
                    arm_b = first.point ? first.point->arm_b : first.line->arm_b;
    const Eigen::Vector3d at_a = a.head<3>() + a.tail<3>().cross(arm_a),
                          at_b = b.head<3>() + b.tail<3>().cross(arm_b);
    if (first.line) {
        const Eigen::Vector3d by_a = h * a.tail<3>().cross(arm_a), by_b = h * b.tail<3>().cross(arm_b),
                              between = first.line->between + h * (at_b - at_a);
        const Eigen::Vector3d axis = rows.front().block.jacobian.row(0).segment<3>(6);
        const double turned = (between.normalized() - axis).squaredNorm(),
                     changed = weight_a * (by_a.squaredNorm() + turned * arm_a.squaredNorm()) +
                               weight_b * (by_b.squaredNorm() + turned * arm_b.squaredNorm());
        if (std::max(turned, changed) >= 0.25) return;
        for (BlockRow& row : rows)
            row.block.jacobian = direction_jacobian(between.normalized(), arm_a + by_a, arm_b + by_b);
        return;
    }
    const Eigen::Vector3d by_a = h * ((at_a + at_b) / 2 - a.head<3>()),
                          by_b = h * ((at_a + at_b) / 2 - b.head<3>());
    if (weight_a * by_a.squaredNorm() + weight_b * by_b.squaredNorm() >= 0.25) return;
    arm_a += by_a;
    arm_b += by_b;
    for (BlockRow& row : rows) {
        Jacobian& jacobian = row.block.jacobian;
        for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
            const Eigen::Vector3d along = jacobian.row(i).segment<3>(6);
            if (along.isZero(0)) continue;  // an angular row
            jacobian.row(i).segment<3>(3) = -arm_a.cross(along);
            jacobian.row(i).segment<3>(9) = arm_b.cross(along);
        }
    }
}

void World::solve_blocks(std::vector<BlockRow>& rows, double h, const SolverSettings& settings, bool relax)
{
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (relax && rows[i].index == 0) carry_arms({&rows[i], rows[i].joint->impulses.size()}, h);
        solve_block(rows[i], h, settings, relax);
        // After the last contact of a joint: what its contacts, pressing less, cannot hold any more is taken back.
        Joint& joint = *rows[i].joint;
        if (rows[i].index + 1 < joint.impulses.size()) continue;
        const double push = push_of(joint, rows[i].joint_contacts);
        for (std::size_t k = i - rows[i].index; k < i; ++k)
            shorten(joint, rows[k].block, rows[k].index, push);
    }
}

/// Shortens the impulses of a block to what the joint's contacts, which push with `push` N s together, can hold. Does nothing to
/// blocks that contacts do not bound.
void World::shorten(Joint& joint, const Block& block, std::size_t index, double push)
{
    Eigen::VectorXd& held = joint.impulses[index];
    const double size = (to_force_of(block) * held).norm(), bound = block.most_per_contact * push;
    if (block.most_per_contact < 0 || size <= bound) return;
    const Eigen::VectorXd shorter = bound / size * held;
    apply(joint, block.jacobian, shorter - held);
    held = shorter;
}

}  // namespace motley::reference
