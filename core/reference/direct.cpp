// The whole scene at once: every row of a substep in one complementarity problem.
//
//   w = (J M^-1 J^T + Gamma) lambda + J v + bias
//
// Gamma is what softness comes to: delta = -ms K^-1 (J v + bias) - is lambda rests where
// J v + bias + (is / ms) K lambda = 0.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "complementarity.h"
#include "world_rows.h"

namespace motley::reference {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
using Eigen::Index;
using Eigen::VectorXd;

/// The rows of a problem as they come.
class Assembly {
  public:
    explicit Assembly(const std::vector<Body>& bodies) : bodies_(bodies) {}

    /// Adds rows between two bodies, each within [low, high]. Returns the first.
    Index add(int a, int b, const Jacobian& rows, const VectorXd& bias, double low, double high)
    {
        const Index first = size();
        for (Index i = 0; i < rows.rows(); ++i) {
            for (int side = 0; side < 2; ++side) {
                for (Index k = 0; k < 6; ++k) {
                    const double value = rows(i, 6 * side + k);
                    if (value != 0) entries_.emplace_back(first + i, 6 * (side == 0 ? a : b) + k, value);
                }
            }
            bias_.push_back(bias(i));
            problem.low.push_back(low);
            problem.high.push_back(high);
        }
        return first;
    }
    void soften(Index first, const Eigen::MatrixXd& gamma)
    {
        for (Index i = 0; i < gamma.rows(); ++i) {
            for (Index k = 0; k < gamma.cols(); ++k) {
                if (gamma(i, k) != 0) softness_.emplace_back(first + i, first + k, gamma(i, k));
            }
        }
    }
    [[nodiscard]] Index size() const { return static_cast<Index>(bias_.size()); }

    /// Makes A and q of the rows; `velocity` is that of all bodies in line.
    Solution solve(const VectorXd& velocity)
    {
        const Index n = size(), columns = 6 * static_cast<Index>(bodies_.size());
        if (n == 0) return {VectorXd::Zero(0), 0};
        std::vector<Eigen::Triplet<double>> mass;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const Matrix6 m = bodies_[i].inverse_mass();
            for (Index r = 0; r < 6; ++r) {
                for (Index c = 0; c < 6; ++c) {
                    if (m(r, c) != 0)
                        mass.emplace_back(6 * static_cast<Index>(i) + r, 6 * static_cast<Index>(i) + c,
                                          m(r, c));
                }
            }
        }
        jacobian_.resize(n, columns);
        jacobian_.setFromTriplets(entries_.begin(), entries_.end());
        inverse_mass_.resize(columns, columns);
        inverse_mass_.setFromTriplets(mass.begin(), mass.end());
        Eigen::SparseMatrix<double> gamma(n, n);
        gamma.setFromTriplets(softness_.begin(), softness_.end());
        problem.a = jacobian_ * inverse_mass_ * Eigen::SparseMatrix<double>(jacobian_.transpose());
        problem.a += gamma;
        problem.q = jacobian_ * velocity + Eigen::Map<const VectorXd>(bias_.data(), n);
        return reference::solve(problem);
    }
    /// M^-1 J^T lambda, of all bodies in line.
    [[nodiscard]] VectorXd change(const VectorXd& lambda) const
    {
        if (size() == 0) return VectorXd::Zero(6 * static_cast<Index>(bodies_.size()));
        return inverse_mass_ * (jacobian_.transpose() * lambda);
    }

    Problem problem;

  private:
    const std::vector<Body>& bodies_;
    std::vector<Eigen::Triplet<double>> entries_, softness_;
    std::vector<double> bias_;
    Eigen::SparseMatrix<double> jacobian_, inverse_mass_;
};

VectorXd velocities(const std::vector<Body>& bodies)
{
    VectorXd v(6 * static_cast<Index>(bodies.size()));
    for (std::size_t i = 0; i < bodies.size(); ++i)
        v.segment<6>(6 * static_cast<Index>(i)) = bodies[i].velocity;
    return v;
}

}  // namespace

double World::step_directly(double dt, const SolverSettings& settings,
                            const std::vector<ContactPoint>& points)
{
    const double h = dt / settings.substeps;
    begin_step();
    std::vector<ContactRow> contacts;
    for (const ContactPoint& point : points) contacts.push_back(begin_contact(point, 0));
    const Eigen::Vector3d gravity(settings.gravity.x, settings.gravity.y, settings.gravity.z);
    double violation = 0;
    for (int substep = 0; substep < settings.substeps; ++substep) {
        for (Body& body : bodies) body.accelerate(gravity, h);
        violation = std::max(violation, solve_substep_directly(h, settings, contacts));
        for (Body& body : bodies) {
            if (body.motion != BodyMotion::static_body) body.advance(body.velocity, h);
        }
        for (int i = 0; settings.drift_correction == DriftCorrection::projection && i < settings.projections;
             ++i)
            project_directly(contacts, settings);
    }
    finish_contacts(contacts, h, settings);
    end_step(h);
    return violation;
}

double World::solve_substep_directly(double h, const SolverSettings& settings,
                                     std::vector<ContactRow>& contacts)
{
    Assembly assembly(bodies);
    for (Joint& joint : joints) {
        for (VectorXd& impulse : joint.impulses) impulse.setZero();
    }
    std::vector<BlockRow> blocks;
    for (Joint& joint : joints) begin_joint(joint, h, settings, blocks);
    struct Placed {
        Index first;
        Eigen::MatrixXd to_rows;  ///< what turns the impulse of the problem into that of the block's rows
    };
    std::vector<Placed> placed;
    for (const BlockRow& row : blocks) {
        const Block& block = row.block;
        const Index count = block.jacobian.rows();
        const int a = row.joint->a, b = row.joint->b;
        Jacobian jacobian = block.jacobian;
        VectorXd bias = row.bias;
        if (block.is_one_sided()) bias = bias.cwiseMax(-static_cast<double>(settings.push_out_speed));
        bias *= block.side;
        Eigen::MatrixXd to_rows = Eigen::MatrixXd::Identity(count, count);
        const bool bounded = block.most_per_contact >= 0 || (std::isfinite(row.most) && count > 1);
        if (bounded && block.bounds_torque) {
            // The bound is a ball of torques: rows G w = s are solved as w = G^-1 s, whose impulse is the torque.
            const Eigen::MatrixXd turn = block.jacobian.rightCols<3>();
            const Eigen::MatrixXd inverse = turn.completeOrthogonalDecomposition().pseudoInverse();
            jacobian = inverse * jacobian;
            bias = inverse * bias;
            to_rows = inverse.transpose();
        }
        const bool limit = block.is_one_sided();
        const bool by_contacts = block.most_per_contact >= 0;
        double low = limit && block.side > 0 ? 0 : -row.most;
        double high = limit && block.side < 0 ? 0 : row.most;
        if (!bias.allFinite()) {  // a limit at infinity
            bias.setZero();
            low = high = 0;
        }
        const Index first = assembly.add(a, b, jacobian, bias, low, high);
        const Eigen::MatrixXd k =
            jacobian *
            pair_inverse_mass(bodies[static_cast<std::size_t>(a)], bodies[static_cast<std::size_t>(b)]) *
            jacobian.transpose();
        assembly.soften(first, row.soft.impulse_scale / row.soft.mass_scale * k);
        if (by_contacts) {
            // The joint's contacts come next, one row each, once its other blocks are there.
            Cone cone{first, count, block.most_per_contact};
            Index next = first;
            for (std::size_t i = row.index; i < row.joint->impulses.size(); ++i) {
                if (i + row.joint_contacts >= row.joint->impulses.size()) cone.normals.push_back(next);
                next += row.joint->impulses[i].size();
            }
            assembly.problem.cones.push_back(cone);
        } else if (bounded) {
            assembly.problem.cones.push_back({first, count, row.most});
        }
        placed.push_back({first, to_rows});
    }
    const double beta =
        settings.drift_correction == DriftCorrection::baumgarte ? static_cast<double>(settings.baumgarte) : 0;
    std::vector<Index> first_of_contact;
    for (const ContactRow& row : contacts) {
        const ContactPoint& point = *row.point;
        const double s = separation(row);
        const double deep = beta / h * std::min(s + static_cast<double>(settings.penetration_slop), 0.0);
        const double bias = s > 0 ? s / h : std::max(deep, -static_cast<double>(settings.push_out_speed));
        const Index normal =
            assembly.add(point.a, point.b, row.normal, VectorXd::Constant(1, bias), 0, unbounded);
        first_of_contact.push_back(normal);
        const double mu = static_cast<double>(point.contact.friction);
        if (mu == 0) continue;
        const Index count = row.tangents.rows();
        const Index first =
            assembly.add(point.a, point.b, row.tangents, VectorXd::Zero(count), -unbounded, unbounded);
        assembly.problem.cones.push_back({first, count, mu, {normal}});
    }
    const Solution solution = assembly.solve(velocities(bodies));
    const VectorXd change = assembly.change(solution.lambda);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        bodies[i].velocity += change.segment<6>(6 * static_cast<Index>(i));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        VectorXd& impulse = blocks[i].impulse();
        impulse = placed[i].to_rows * solution.lambda.segment(placed[i].first, impulse.size());
        double& peak = blocks[i].joint->peaks[blocks[i].index];
        peak = std::max(peak, impulse(0));
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        ContactRow& row = contacts[i];
        row.impulse = solution.lambda(first_of_contact[i]);
        row.peak = std::max(row.peak, row.impulse);
        row.friction.setZero();
        if (row.point->contact.friction > 0)
            row.friction = solution.lambda.segment(first_of_contact[i] + 1, row.friction.size());
    }
    return solution.violation;
}

/// The norm of C over all locks and broken limits.
double World::position_error() const
{
    double squares = 0;
    for (const Joint& joint : joints) {
        for (const Block& block : blocks_of(joint)) {
            if (block.hertz > 0 || block.kind == Block::Kind::motor) continue;
            const bool limit = block.is_one_sided();
            squares += (limit ? Eigen::VectorXd(block.error.cwiseMin(0.0)) : block.error).squaredNorm();
        }
    }
    return std::sqrt(squares);
}

/// One Newton step on all positions at once: locks, limits that are broken, contacts deeper than the slop.
void World::project_directly(const std::vector<ContactRow>& contacts, const SolverSettings& settings)
{
    Assembly assembly(bodies);
    for (const Joint& joint : joints) {
        for (const Block& block : blocks_of(joint)) {
            // Springs and motors are forces, not positions.
            if (block.hertz > 0 || block.kind == Block::Kind::motor) continue;
            const bool limit = block.is_one_sided();
            VectorXd error = block.error;
            if (block.kind == Block::Kind::contact)
                error(0) += static_cast<double>(settings.penetration_slop);
            if (limit && error(0) > 0) continue;
            assembly.add(joint.a, joint.b, block.jacobian, block.side * error,
                         limit && block.side > 0 ? 0 : -unbounded, limit && block.side < 0 ? 0 : unbounded);
        }
    }
    for (const ContactRow& row : contacts) {
        const double deep = separation(row) + static_cast<double>(settings.penetration_slop);
        if (deep < 0)
            assembly.add(row.point->a, row.point->b, row.normal, VectorXd::Constant(1, deep), 0, unbounded);
    }
    const Solution solution = assembly.solve(VectorXd::Zero(6 * static_cast<Index>(bodies.size())));
    const VectorXd change = assembly.change(solution.lambda);
    // Far from the solution a whole step may lead away from it: then half of it, and so on.
    const std::vector<Body> before = bodies;
    const double error = position_error();
    for (double share = 1; share > 0.01; share /= 2) {
        bodies = before;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            bodies[i].advance(change.segment<6>(6 * static_cast<Index>(i)), share);
        if (position_error() <= error) break;
    }
}

}  // namespace motley::reference
