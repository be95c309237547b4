// The whole scene at once: every row of a substep in one complementarity problem.
//
//   w = (J M^-1 J^T + Gamma) lambda + J v + bias
//
// K = J M^-1 J^T. Gamma stands for softness: a sweep with mass_scale m_s and impulse_scale i_s changes lambda by
// -m_s K^-1 (J v + bias) - i_s lambda, which converges where J v + bias + (i_s / m_s) K lambda = 0. So Gamma is
// (i_s / m_s) K.
#include <algorithm>
#include <cmath>
#include <limits>

#include "direct_rows.h"
#include "world_rows.h"

namespace motley::reference {
using Eigen::Index;
using Eigen::VectorXd;

DirectResult World::step_directly(double dt, const SolverSettings& asked,
                                  const std::vector<ContactPoint>& points)
{
    const SolverSettings settings = asked.resolved();
    const double h = dt / settings.substeps;
    const double warm = last_substep_ > 0 ? std::min(h / last_substep_, 1.0) : 0;
    begin_step();
    for (Joint& joint : joints) {
        for (VectorXd& impulse : joint.impulses) impulse *= warm;
    }
    std::vector<ContactRow> contacts;
    contacts.reserve(points.size());
    for (const ContactPoint& point : points) contacts.push_back(begin_contact(point, h, warm));
    const Eigen::Vector3d gravity(settings.gravity.x, settings.gravity.y, settings.gravity.z);
    DirectResult result;
    for (int substep = 0; substep < settings.substeps; ++substep) {
        for (Body& body : bodies) body.accelerate(gravity, h);
        const bool holds_locks = settings.drift_correction == DriftCorrection::baumgarte && !joints.empty();
        const Islands islands = joints.empty() ? Islands{} : find_islands(contacts);
        std::vector<Eigen::Vector3d> lost;
        if (holds_locks) lost = angular_momenta(islands);
        const std::vector<StiffRow> stiff =
            joints.empty() ? std::vector<StiffRow>{} : find_stiff_rows(islands, h);
        const DirectResult part = solve_substep_directly(h, settings, contacts, stiff);
        result.violation = std::max(result.violation, part.violation);
        result.unsolved += part.unsolved;
        add_up(contacts);
        std::vector<Hold> holds;
        const auto lose = [&](double sign) {
            const std::vector<Eigen::Vector3d> now = angular_momenta(islands);
            for (std::size_t i = 0; i < now.size(); ++i) lost[i] += sign * now[i];
        };
        if (holds_locks) {
            holds = find_holds(h);
            lose(-1);
        }
        for (Body& body : bodies) body.move_on(h, false);
        if (!holds.empty()) {
            lose(1);
            const std::vector<bool> held = hold_locks(holds, islands, h, !stiff.empty());
            lose(-1);
            give_back(islands, held, lost);
        }
        for (int i = 0; settings.drift_correction == DriftCorrection::projection && i < settings.projections;
             ++i)
            project_directly(contacts, h, settings);
    }
    finish_contacts(contacts, settings);
    end_step(h);
    land_free_groups(h, dt, settings);
    return result;
}

DirectResult World::solve_substep_directly(double h, const SolverSettings& settings,
                                           std::vector<ContactRow>& contacts,
                                           const std::vector<StiffRow>& stiff)
{
    Assembly assembly(bodies);
    std::vector<BlockRow> blocks;
    for (Joint& joint : joints) find_rows(joint, h, settings, blocks);
    struct Placed {
        std::size_t group;
        Index first;
        Eigen::MatrixXd to_rows;  ///< maps the impulse in the problem to that of the block's rows
    };
    std::vector<Placed> placed;
    placed.reserve(blocks.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const BlockRow& row = blocks[i];
        const Block& block = row.block;
        const Index count = block.jacobian.rows();
        const int a = row.joint->a, b = row.joint->b;
        // Each block is a group of its own, unless contacts of the joint bound other blocks: then the joint is one
        // group.
        const bool by_contacts = block.most_per_contact >= 0;
        Placed at{0, 0, {}};
        if (row.joint_contacts > 0 && row.index > 0) {
            at = {placed.back().group, placed.back().first + blocks[i - 1].block.jacobian.rows(), {}};
        } else {
            Index rows = count;
            for (std::size_t k = i + 1;
                 row.joint_contacts > 0 && k < blocks.size() && blocks[k].joint == row.joint; ++k)
                rows += blocks[k].block.jacobian.rows();
            at.group = assembly.open(a, b, rows);
        }
        Jacobian jacobian = block.jacobian;
        VectorXd bias = row.bias, guess = row.impulse();
        if (block.is_one_sided()) bias = bias.cwiseMax(-static_cast<double>(settings.push_out_speed));
        bias *= block.side;
        const bool bounded = by_contacts || (std::isfinite(row.most) && count > 1);
        if (bounded && block.bounds_torque) {
            // The bound is a ball of torques: rows G w = s are solved as w = G^-1 s, whose impulse is the torque.
            const Eigen::MatrixXd turn = block.jacobian.rightCols<3>();
            const Eigen::MatrixXd inverse = pseudo_inverse(turn);
            jacobian = inverse.lazyProduct(block.jacobian);
            bias = inverse * bias;
            guess = turn.transpose() * guess;
            at.to_rows = inverse.transpose();
        }
        const bool limit = block.is_one_sided();
        double low = limit && block.side > 0 ? 0 : -row.most;
        double high = limit && block.side < 0 ? 0 : row.most;
        if (!bias.allFinite()) {  // a limit at infinity
            bias.setZero();
            low = high = 0;
        }
        assembly.fill(at.group, at.first, jacobian, speed(a, b, jacobian) + bias, low, high, guess);
        // The softness is a share of K with the rotor, but the K of the problem is without it.
        const double without = block.armature > 0 ? 1 + block.armature / mass_of(*row.joint, block)(0, 0) : 1;
        assembly.soften(at.group, at.first, count, row.soft.impulse_scale / row.soft.mass_scale / without);
        RowGroup& group = assembly.group(at.group);
        const int first = static_cast<int>(at.first);
        if (by_contacts) {
            // The joint's contacts come last, one row each.
            const int normals = static_cast<int>(row.joint_contacts);
            group.cones.push_back(
                {first, static_cast<int>(count), block.most_per_contact, group.size() - normals, normals});
        } else if (bounded) {
            group.cones.push_back({first, static_cast<int>(count), row.most, 0, 0});
        }
        placed.push_back(std::move(at));
    }
    // A rotor is a soft row towards the speed that it had; its softness is 1 over its inertia.
    std::vector<std::pair<std::size_t, const BlockRow*>> rotors;
    for (const BlockRow& row : blocks) {
        if (row.index > 0 || row.block.armature == 0) continue;
        const Joint& joint = *row.joint;
        const std::size_t at = assembly.open(joint.a, joint.b, 1);
        assembly.fill(at, 0, row.block.jacobian,
                      speed(joint.a, joint.b, row.block.jacobian).array() - joint.rotor_speed, -unbounded,
                      unbounded, VectorXd::Zero(1));
        assembly.group(at).softness.setConstant(1, 1, 1 / row.block.armature);
        rotors.emplace_back(at, &row);
    }
    const double beta =
        settings.drift_correction == DriftCorrection::baumgarte ? static_cast<double>(settings.baumgarte) : 0;
    std::vector<std::size_t> group_of_contact;
    group_of_contact.reserve(contacts.size());
    for (const ContactRow& row : contacts) {
        const int a = row.point->a, b = row.point->b;
        const double s = separation(row);
        const double deep = beta / h * std::min(s + static_cast<double>(settings.penetration_slop), 0.0);
        const double bias = s > 0 ? s / h : std::max(deep, -static_cast<double>(settings.push_out_speed));
        const double mu = static_cast<double>(row.point->contact.friction);
        const Index tangents = mu > 0 ? row.tangents.rows() : 0;
        const std::size_t at = assembly.open(a, b, 1 + tangents);
        group_of_contact.push_back(at);
        assembly.group(at).is_contact = true;
        assembly.fill(at, 0, row.normal, speed(a, b, row.normal).array() + bias, 0, row.most,
                      VectorXd::Constant(1, row.impulse));
        if (tangents == 0) continue;
        assembly.fill(at, 1, row.tangents, speed(a, b, row.tangents) - row.surface_speed, -unbounded,
                      unbounded, row.friction);
        assembly.group(at).cones.push_back({1, static_cast<int>(tangents), mu, 0, 1});
    }
    stiffen(assembly, stiff, true);
    const Solution solution = assembly.solve();
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].velocity += assembly.change(solution, i);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        VectorXd& impulse = blocks[i].impulse();
        impulse = assembly.group(placed[i].group).lambda.segment(placed[i].first, impulse.size());
        if (placed[i].to_rows.size() > 0) impulse = placed[i].to_rows * impulse;
        blocks[i].joint->wrench += wrench_of(blocks[i].block.jacobian, impulse);
        double& peak = blocks[i].joint->peaks[blocks[i].index];
        peak = std::max(peak, impulse(0));
    }
    for (const auto& [at, row] : rotors) {
        row->joint->wrench += wrench_of(row->block.jacobian, assembly.group(at).lambda);
        const double before = row->joint->rotor_speed;
        row->joint->rotor_speed = speed(row->joint->a, row->joint->b, row->block.jacobian)(0);
        row->joint->rotor_change = row->joint->rotor_speed - before;
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        ContactRow& row = contacts[i];
        const RowGroup& group = assembly.group(group_of_contact[i]);
        row.impulse = group.lambda(0);
        row.peak = std::max(row.peak, row.impulse);
        row.friction.setZero();
        if (group.size() > 1) row.friction = group.lambda.tail(group.size() - 1);
    }
    return {solution.violation, solution.unsolved};
}

/// The norm of C over all locks and exceeded limits.
double World::position_error() const
{
    double squares = 0;
    for (const Joint& joint : joints) {
        for (const Block& block : blocks_of(joint)) {
            if (block.is_spring() || block.kind == Block::Kind::motor) continue;
            const bool limit = block.is_one_sided();
            squares += (limit ? Eigen::VectorXd(block.error.cwiseMin(0.0)) : block.error).squaredNorm();
        }
    }
    return std::sqrt(squares);
}

/// One Newton step on all positions at once: locks, exceeded limits, contacts deeper than the slop.
void World::project_directly(const std::vector<ContactRow>& contacts, double h,
                             const SolverSettings& settings)
{
    Assembly assembly(bodies);
    for (const Joint& joint : joints) {
        for (const Block& block : blocks_of(joint)) {
            // Springs and motors are forces, not positions.
            if (block.is_spring() || block.kind == Block::Kind::motor) continue;
            const bool limit = block.is_one_sided();
            VectorXd error = block.error;
            if (block.kind == Block::Kind::contact)
                error(0) += static_cast<double>(settings.penetration_slop);
            if (limit && error(0) > 0) continue;
            assembly.fill(assembly.open(joint.a, joint.b, error.size()), 0, block.jacobian,
                          block.side * error, limit && block.side > 0 ? 0 : -unbounded,
                          limit && block.side < 0 ? 0 : unbounded, VectorXd::Zero(error.size()));
        }
    }
    for (const ContactRow& row : contacts) {
        const double deep = separation(row) + static_cast<double>(settings.penetration_slop);
        if (deep < 0)
            assembly.fill(assembly.open(row.point->a, row.point->b, 1), 0, row.normal,
                          VectorXd::Constant(1, deep), 0, h * row.most, VectorXd::Zero(1));
    }
    const Solution solution = assembly.solve();
    // Far from the solution a whole step may lead away from it: then half of it, and so on.
    const std::vector<Body> before = bodies;
    const double error = position_error();
    for (double share = 1; share > 0.01; share /= 2) {
        bodies = before;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            bodies[i].displace(share * assembly.change(solution, i));
        if (position_error() <= error) break;
    }
}

}  // namespace motley::reference
