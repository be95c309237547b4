// The rows of a substep, shared by the sequential and the simultaneous solution.
#pragma once

#include <algorithm>

#include "motley/reference/world.h"

namespace motley::reference {

/// How many of these blocks are contacts.
inline std::size_t contacts_of(const std::vector<Block>& blocks)
{
    return static_cast<std::size_t>(std::count_if(
        blocks.begin(), blocks.end(), [](const Block& b) { return b.kind == Block::Kind::contact; }));
}
/// The impulses of a joint's contacts, which are the last blocks of it.
inline double push_of(const Joint& joint, std::size_t contacts)
{
    double sum = 0;
    for (std::size_t i = joint.impulses.size() - contacts; i < joint.impulses.size(); ++i)
        sum += joint.impulses[i](0);
    return sum;
}
/// Maps the impulses of a block to what is bounded of them.
inline Eigen::MatrixXd to_force_of(const Block& block)
{
    if (block.bounds_torque) return block.jacobian.rightCols<3>().transpose();
    return Eigen::MatrixXd::Identity(block.jacobian.rows(), block.jacobian.rows());
}

/// A bounded impulse after a step that would lead to `free`. Where that is too long, the step has the same stride in
/// every direction of the force and is then shortened: it converges only where the force points against the speed that
/// remains (see bounded_impulse.h). `to_force` maps impulses to what is bounded, whose response is k; `most` is at
/// least k's largest eigenvalue.
inline Eigen::VectorXd bounded(const Eigen::VectorXd& held, const Eigen::VectorXd& free,
                               const Eigen::MatrixXd& to_force, const Eigen::MatrixXd& k, double most,
                               double bound)
{
    if ((to_force * free).norm() <= bound) return free;
    Eigen::VectorXd next = held;
    if (most > 0) {
        const Eigen::VectorXd stride = k * (to_force * (free - held)) / most;
        next += pseudo_inverse(to_force) * stride;
    }
    const double size = (to_force * next).norm();
    if (size > bound) next *= bound / size;
    return next;
}

struct World::BlockRow {
    Joint* joint;
    std::size_t index;  ///< of the block in its joint
    Block block;
    Eigen::MatrixXd mass;
    Eigen::MatrixXd to_force;  ///< maps impulses to what `most` bounds
    Eigen::MatrixXd response;  ///< K of what `most` bounds
    Eigen::VectorXd bias, relax_bias;
    Soft soft, relax_soft;
    double most;                 ///< largest norm of the impulse, unless the joint's contacts bound it
    std::size_t joint_contacts;  ///< how many of the joint's blocks are contacts; they come last

    [[nodiscard]] double bound() const
    {
        if (block.most_per_contact < 0) return most;
        return block.most_per_contact * push_of(*joint, joint_contacts);
    }
    [[nodiscard]] Eigen::VectorXd& impulse() const { return joint->impulses[index]; }
};

struct World::ContactRow {
    const ContactPoint* point;
    Jacobian normal, tangents;
    double approach;
    double impulse, peak = 0;
    Eigen::VectorXd friction;
    double most;                    ///< N s, of the normal impulse in a substep
    Eigen::VectorXd surface_speed;  ///< m/s, of the surface of a along the tangents
    ContactResult step{};           ///< of the substeps so far

    /// Friction in the world frame: the linear part on b of a row is its tangent.
    [[nodiscard]] Eigen::Vector3d force() const { return tangents.middleCols<3>(6).transpose() * friction; }
};

/// The wrench on b of an impulse along rows, at the point where they act: a row with a linear part gives a linear
/// impulse there, a row without one an angular impulse.
inline Eigen::Matrix<double, 6, 1> wrench_of(const Jacobian& jacobian, const Eigen::VectorXd& impulse)
{
    Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
    for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
        const int part = jacobian.block<1, 3>(i, 6).isZero() ? 3 : 0;
        wrench.segment<3>(part) += impulse(i) * jacobian.block<1, 3>(i, 6 + part).transpose();
    }
    return wrench;
}

}  // namespace motley::reference
