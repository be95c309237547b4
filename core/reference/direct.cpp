// Every row of a substep at once: a linear complementarity problem with bounds, by active sets.
//
//   w = (J M^-1 J^T + Gamma) lambda + J v + bias;   low <= lambda <= high
//   w = 0 where lambda is between its bounds, w >= 0 at the low one, w <= 0 at the high one
//
// Gamma is what softness comes to: delta = -ms K^-1 (J v + bias) - is lambda rests where J v + bias + (is/ms) K lambda = 0.
#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "world_rows.h"

namespace motley::reference {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// One scalar row after another.
struct System {
    std::vector<Eigen::Matrix<double, 1, 12>> jacobian;
    std::vector<std::pair<int, int>> ends;
    std::vector<double> bias, low, high;
    std::vector<Eigen::Triplet<double>> softness;  ///< of Gamma

    [[nodiscard]] int size() const { return static_cast<int>(bias.size()); }
    int add(int a, int b, const Eigen::Matrix<double, 1, 12>& row, double b_i, double from, double to)
    {
        jacobian.push_back(row);
        ends.push_back({a, b});
        bias.push_back(b_i);
        low.push_back(from);
        high.push_back(to);
        return size() - 1;
    }
};

enum class Where { free, low, high };

struct Solution {
    Eigen::VectorXd lambda;
    double violation;
};

/// Guesses which rows are at a bound, solves for the others exactly, and mends the guess: all wrong rows at once while
/// that helps, else the last of them alone, which ends (Murty; Judice and Pires, block principal pivoting).
Solution solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& q, const System& system)
{
    const auto n = static_cast<Eigen::Index>(system.size());
    std::vector<Where> where(static_cast<std::size_t>(n), Where::free);
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n), w = q;
    const double scale = 1e-12 * (1 + q.cwiseAbs().maxCoeff());
    std::size_t fewest = static_cast<std::size_t>(n) + 1;
    int patience = 10;
    for (int round = 0; round < 50 * n + 100; ++round) {
        std::vector<Eigen::Index> free;
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            if (where[k] == Where::free) free.push_back(i);
            lambda(i) = where[k] == Where::low ? system.low[k] : where[k] == Where::high ? system.high[k] : 0;
        }
        const Eigen::VectorXd rest = q + a * lambda;
        if (!free.empty()) {
            // Least norm where rows are redundant.
            const Eigen::VectorXd inner = Eigen::MatrixXd(a(free, free))
                                              .completeOrthogonalDecomposition()
                                              .solve(-Eigen::VectorXd(rest(free)));
            lambda(free) = inner;
        }
        w = q + a * lambda;
        std::vector<std::size_t> wrong;
        for (std::size_t k = 0; k < where.size(); ++k) {
            if (system.low[k] == system.high[k] && where[k] != Where::free) continue;  // nothing to choose
            const auto i = static_cast<Eigen::Index>(k);
            const bool is_wrong = where[k] == Where::free ? lambda(i) < system.low[k] - 1e-12 ||
                                                                lambda(i) > system.high[k] + 1e-12
                                  : where[k] == Where::low ? w(i) < -scale
                                                           : w(i) > scale;
            if (is_wrong) wrong.push_back(k);
        }
        if (wrong.empty()) break;
        if (wrong.size() < fewest) {
            fewest = wrong.size();
            patience = 10;
        } else if (patience > 0) {
            --patience;
        }
        if (patience == 0) wrong = {wrong.back()};
        for (const std::size_t k : wrong) {
            const auto i = static_cast<Eigen::Index>(k);
            where[k] = where[k] != Where::free     ? Where::free
                       : lambda(i) < system.low[k] ? Where::low
                                                   : Where::high;
        }
    }
    double violation = 0;
    for (std::size_t k = 0; k < where.size(); ++k) {
        if (system.low[k] == system.high[k]) continue;
        const auto i = static_cast<Eigen::Index>(k);
        const bool at_low = lambda(i) <= system.low[k], at_high = lambda(i) >= system.high[k];
        violation = std::max(violation, at_low    ? std::max(-w(i), 0.0)
                                        : at_high ? std::max(w(i), 0.0)
                                                  : std::abs(w(i)));
    }
    return {lambda, violation};
}

}  // namespace

double World::step_directly(double dt, const SolverSettings& settings,
                            const std::vector<ContactPoint>& points)
{
    if (settings.substeps != 1) throw std::invalid_argument("step_directly: settings.substeps must be 1");
    const double h = dt;
    start_ = bodies;
    const Eigen::Vector3d gravity(settings.gravity.x, settings.gravity.y, settings.gravity.z);
    for (Body& body : bodies) body.accelerate(gravity, h);

    System system;
    std::vector<BlockRow> rows_of_joints;
    for (Joint& joint : joints) {
        for (Eigen::VectorXd& impulse : joint.impulses) impulse.setZero();
        begin_joint(joint, h, settings, rows_of_joints);
    }
    std::vector<int> first_row;
    for (const BlockRow& row : rows_of_joints) {
        const Block& block = row.block;
        const int a = row.joint->a, b = row.joint->b;
        first_row.push_back(system.size());
        const bool limit = block.kind == Block::Kind::limit;
        if (block.jacobian.rows() > 1 && std::isfinite(row.most))
            throw std::invalid_argument("step_directly: bounded servos of several rows are not solved");
        const double low = limit && block.side > 0 ? 0 : -row.most,
                     high = limit && block.side < 0 ? 0 : row.most;
        const Eigen::MatrixXd k =
            block.jacobian *
            pair_inverse_mass(bodies[static_cast<std::size_t>(a)], bodies[static_cast<std::size_t>(b)]) *
            block.jacobian.transpose();
        for (Eigen::Index i = 0; i < block.jacobian.rows(); ++i) {
            system.add(a, b, block.jacobian.row(i), block.side * row.bias(i), low, high);
            for (Eigen::Index m = 0; m < block.jacobian.rows(); ++m) {
                system.softness.emplace_back(first_row.back() + i, first_row.back() + m,
                                             row.soft.impulse_scale / row.soft.mass_scale * k(i, m));
            }
        }
    }
    for (const ContactPoint& point : points) {
        if (point.contact.friction > 0 || point.contact.restitution > 0)
            throw std::invalid_argument("step_directly: contacts must have neither friction nor restitution");
        const ContactRow row = begin_contact(point, 0);
        const double s = point.contact.separation;
        const double beta =
            settings.drift_correction == DriftCorrection::baumgarte ? settings.baumgarte : 0.0F;
        const double deep = beta / h * std::min(s + static_cast<double>(settings.penetration_slop), 0.0);
        const double bias = s > 0 ? s / h : std::max(deep, -static_cast<double>(settings.push_out_speed));
        system.add(point.a, point.b, row.normal.row(0), bias, 0, unbounded);
    }

    // J and M^-1 of the whole scene.
    const auto rows = static_cast<Eigen::Index>(system.size()),
               columns = static_cast<Eigen::Index>(6 * bodies.size());
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(rows, columns),
                    inverse_mass = Eigen::MatrixXd::Zero(columns, columns);
    Eigen::VectorXd v(columns);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        inverse_mass.block<6, 6>(at, at) = bodies[i].inverse_mass();
        v.segment<6>(at) = bodies[i].velocity;
    }
    for (std::size_t i = 0; i < system.jacobian.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        j.block<1, 6>(row, 6 * system.ends[i].first) += system.jacobian[i].head<6>();
        j.block<1, 6>(row, 6 * system.ends[i].second) += system.jacobian[i].tail<6>();
    }
    Eigen::MatrixXd a = j * inverse_mass * j.transpose();
    for (const auto& entry : system.softness) a(entry.row(), entry.col()) += entry.value();
    const Eigen::VectorXd q = j * v + Eigen::Map<const Eigen::VectorXd>(
                                          system.bias.data(), static_cast<Eigen::Index>(system.bias.size()));
    const Solution solution = solve(a, q, system);

    const Eigen::VectorXd after = v + inverse_mass * j.transpose() * solution.lambda;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        bodies[i].velocity = after.segment<6>(static_cast<Eigen::Index>(6 * i));
        if (bodies[i].motion != BodyMotion::static_body) bodies[i].advance(bodies[i].velocity, h);
    }
    for (std::size_t i = 0; i < rows_of_joints.size(); ++i) {
        Eigen::VectorXd& impulse = rows_of_joints[i].impulse();
        impulse = solution.lambda.segment(first_row[i], impulse.size());
    }
    end_step(h);
    return solution.violation;
}

}  // namespace motley::reference
