// Bounds by active sets on a sparse LDL^T; cones by a semismooth Newton method that starts from there.
#include "complementarity.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace motley::reference {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Largest part for which contradictory rows are met by a dense decomposition.
constexpr Index largest_dense = 1500;

/// Least-norm solution of A x = b. LDL^T of A + epsilon I, refined: each round takes epsilon / (sigma + epsilon) of what
/// is left of b in the range of A, and x never leaves that range (the proximal point method). Contradictory rows leave a
/// residual that does not fall: then least squares.
VectorXd solve_least_norm(const Sparse& a, const VectorXd& b)
{
    const Index n = a.rows();
    const double largest = a.diagonal().cwiseAbs().maxCoeff();
    Sparse shifted = a, one(n, n);
    one.setIdentity();
    shifted += 1e-10 * std::max(largest, 1e-300) * one;
    const Eigen::SimplicialLDLT<Sparse> factors(shifted);
    VectorXd x = VectorXd::Zero(n), rest = b;
    const double enough = 1e-14 * (1 + b.norm());
    for (int round = 0; round < 30 && factors.info() == Eigen::Success; ++round) {
        x += factors.solve(rest);
        const double before = rest.norm();
        rest = b - a * x;
        if (rest.norm() < enough || rest.norm() > 0.5 * before) break;
    }
    if ((x.allFinite() && rest.norm() < 1e-11 * (1 + b.norm())) || n > largest_dense) return x;
    return Eigen::MatrixXd(a).completeOrthogonalDecomposition().solve(b);
}

Sparse submatrix(const Sparse& a, const std::vector<Index>& rows)
{
    std::vector<Index> place(static_cast<std::size_t>(a.rows()), -1);
    for (std::size_t i = 0; i < rows.size(); ++i)
        place[static_cast<std::size_t>(rows[i])] = static_cast<Index>(i);
    std::vector<Eigen::Triplet<double>> entries;
    for (const Index column : rows) {
        for (Sparse::InnerIterator entry(a, column); entry; ++entry) {
            const Index row = place[static_cast<std::size_t>(entry.row())];
            if (row >= 0) entries.emplace_back(row, place[static_cast<std::size_t>(column)], entry.value());
        }
    }
    const auto n = static_cast<Index>(rows.size());
    Sparse part(n, n);
    part.setFromTriplets(entries.begin(), entries.end());
    return part;
}

/// One part of a problem.
class Part {
  public:
    explicit Part(Problem problem) : p_(std::move(problem)), rows_(p_.a), n_(p_.q.size())
    {
        scale_.resize(n_);
        const double largest = p_.a.diagonal().cwiseAbs().maxCoeff();
        for (Index i = 0; i < n_; ++i) {
            const double k = p_.a.coeff(i, i);
            scale_(i) = k > 1e-14 * largest ? 1 / k : 0;
        }
        in_cone_.assign(static_cast<std::size_t>(n_), false);
        for (const Cone& cone : p_.cones) {
            for (Index i = 0; i < cone.count; ++i) in_cone_[static_cast<std::size_t>(cone.first + i)] = true;
        }
    }

    Solution solve()
    {
        if (!p_.q.allFinite()) return {VectorXd::Zero(n_), std::numeric_limits<double>::infinity()};
        VectorXd lambda = solve_bounds();
        if (!p_.cones.empty()) solve_cones(lambda);
        return {lambda, violation(lambda)};
    }

  private:
    Problem p_;
    Rows rows_;
    Index n_;
    VectorXd scale_;  ///< 1 / A_ii; 0 of a row that cannot move
    std::vector<bool> in_cone_;
    enum class Where { free, low, high };

    [[nodiscard]] double low(Index i) const { return p_.low[static_cast<std::size_t>(i)]; }
    [[nodiscard]] double high(Index i) const { return p_.high[static_cast<std::size_t>(i)]; }
    [[nodiscard]] double radius(const Cone& cone, const VectorXd& lambda) const
    {
        if (cone.normals.empty()) return cone.bound;
        double sum = 0;
        for (const Index normal : cone.normals) sum += std::max(lambda(normal), 0.0);
        return cone.bound * sum;
    }

    /// Guesses which rows are at a bound, solves for the others exactly, and mends the guess: all wrong rows at once
    /// while that helps, else the last of them alone, which ends (Murty; Judice and Pires, block principal pivoting).
    /// Rows of cones stay at zero.
    VectorXd solve_bounds() const
    {
        std::vector<Where> where(static_cast<std::size_t>(n_), Where::free);
        VectorXd lambda = VectorXd::Zero(n_);
        const double least = 1e-12 * (1 + p_.q.cwiseAbs().maxCoeff());
        std::size_t fewest = static_cast<std::size_t>(n_) + 1;
        int patience = 10;
        for (Index round = 0; round < 50 * n_ + 100; ++round) {
            std::vector<Index> free;
            for (Index i = 0; i < n_; ++i) {
                const Where at = where[static_cast<std::size_t>(i)];
                lambda(i) = at == Where::low ? low(i) : at == Where::high ? high(i) : 0;
                if (at == Where::free && !in_cone_[static_cast<std::size_t>(i)]) free.push_back(i);
            }
            if (!free.empty()) {
                const VectorXd rest = p_.q + p_.a * lambda;
                const VectorXd inner = solve_least_norm(submatrix(p_.a, free), -VectorXd(rest(free)));
                lambda(free) = inner;
            }
            const VectorXd w = p_.q + p_.a * lambda;
            std::vector<Index> wrong;
            for (Index i = 0; i < n_; ++i) {
                const Where at = where[static_cast<std::size_t>(i)];
                if (in_cone_[static_cast<std::size_t>(i)] || (low(i) == high(i) && at != Where::free))
                    continue;
                const bool is_wrong = at == Where::free
                                          ? lambda(i) < low(i) - 1e-12 || lambda(i) > high(i) + 1e-12
                                      : at == Where::low ? w(i) < -least
                                                         : w(i) > least;
                if (is_wrong) wrong.push_back(i);
            }
            if (wrong.empty()) break;
            if (wrong.size() < fewest) {
                fewest = wrong.size();
                patience = 10;
            } else if (patience > 0) {
                --patience;
            }
            if (patience == 0) wrong = {wrong.back()};
            for (const Index i : wrong) {
                Where& at = where[static_cast<std::size_t>(i)];
                at = at != Where::free ? Where::free : lambda(i) < low(i) ? Where::low : Where::high;
            }
        }
        return lambda;
    }

    /// The natural map lambda - P(lambda - scale w): zero at the solution. With `jacobian` also an element of its
    /// generalised derivative (Alart and Curnier 1991).
    VectorXd natural_map(const VectorXd& lambda, std::vector<Eigen::Triplet<double>>* jacobian) const
    {
        const VectorXd w = p_.q + p_.a * lambda;
        VectorXd map(n_);
        const auto add_row = [&](Index to, double factor, Index row) {
            for (Rows::InnerIterator entry(rows_, row); entry; ++entry)
                jacobian->emplace_back(to, entry.col(), factor * entry.value());
        };
        for (Index i = 0; i < n_; ++i) {
            if (in_cone_[static_cast<std::size_t>(i)]) continue;
            const double z = lambda(i) - scale_(i) * w(i);
            const bool inside = z > low(i) && z < high(i) && scale_(i) > 0;
            map(i) = inside ? scale_(i) * w(i) : lambda(i) - std::clamp(z, low(i), high(i));
            if (jacobian == nullptr) continue;
            if (inside) add_row(i, scale_(i), i);
            // Enough to make redundant rows regular; Newton's next round mends what it costs.
            jacobian->emplace_back(i, i, inside ? 1e-10 : 1);
        }
        for (const Cone& cone : p_.cones) {
            const Index first = cone.first, count = cone.count;
            const double step = scale_.segment(first, count).maxCoeff();
            const VectorXd z = lambda.segment(first, count) - step * w.segment(first, count);
            const double r = radius(cone, lambda), length = z.norm();
            if (length <= r && step > 0) {
                map.segment(first, count) = step * w.segment(first, count);
                for (Index i = first; jacobian != nullptr && i < first + count; ++i) {
                    add_row(i, step, i);
                    jacobian->emplace_back(i, i, 1e-10);
                }
                continue;
            }
            const VectorXd along = length > 0 ? VectorXd(z / length) : VectorXd::Zero(count);
            map.segment(first, count) = lambda.segment(first, count) - r * along;
            if (jacobian == nullptr) continue;
            // d(r z / |z|) = z/|z| dr + r / |z| (I - z z^T / |z|^2) dz, dz = dlambda - step A dlambda.
            const Eigen::MatrixXd turn =
                (length > 0 ? r / length : 0.0) *
                (Eigen::MatrixXd::Identity(count, count) - along * along.transpose());
            for (Index i = 0; i < count; ++i) {
                jacobian->emplace_back(first + i, first + i, 1);
                for (Index k = 0; k < count; ++k) {
                    jacobian->emplace_back(first + i, first + k, -turn(i, k));
                    add_row(first + i, step * turn(i, k), first + k);
                }
                for (const Index normal : cone.normals) {
                    if (lambda(normal) > 0) jacobian->emplace_back(first + i, normal, -cone.bound * along(i));
                }
            }
        }
        return map;
    }

    /// One sweep of projected Gauss-Seidel over every row and cone.
    void sweep(VectorXd& lambda) const
    {
        const auto speed = [&](Index i) { return p_.q(i) + rows_.row(i).dot(lambda); };
        for (Index i = 0; i < n_; ++i) {
            if (!in_cone_[static_cast<std::size_t>(i)])
                lambda(i) = std::clamp(lambda(i) - scale_(i) * speed(i), low(i), high(i));
        }
        for (const Cone& cone : p_.cones) {
            const double step = scale_.segment(cone.first, cone.count).minCoeff();
            VectorXd z(cone.count);
            for (Index i = 0; i < cone.count; ++i)
                z(i) = lambda(cone.first + i) - 0.7 * step * speed(cone.first + i);
            const double r = radius(cone, lambda);
            if (z.norm() > r) z *= r / z.norm();
            lambda.segment(cone.first, cone.count) = z;
        }
    }

    void solve_cones(VectorXd& lambda) const
    {
        constexpr double enough = 1e-12;
        VectorXd best = lambda;
        double least = violation(lambda);
        for (int round = 0; round < 200 && least > enough; ++round) {
            std::vector<Eigen::Triplet<double>> entries;
            const VectorXd map = natural_map(lambda, &entries);
            Sparse jacobian(n_, n_);
            jacobian.setFromTriplets(entries.begin(), entries.end());
            Eigen::SparseLU<Sparse> factors(jacobian);
            bool descends = false;
            if (factors.info() == Eigen::Success) {
                const VectorXd step = factors.solve(-map);
                for (double length = 1; step.allFinite() && length > 1e-3; length /= 2) {
                    const VectorXd there = lambda + length * step;
                    if (natural_map(there, nullptr).norm() > (1 - 1e-4 * length) * map.norm()) continue;
                    lambda = there;
                    descends = true;
                    break;
                }
            }
            // Where Newton's direction does not help, sweeps come nearer, and to another face of the cones.
            for (int i = 0; !descends && i < 200; ++i) sweep(lambda);
            const double now = violation(lambda);
            if (now < least) {
                least = now;
                best = lambda;
            }
        }
        lambda = best;
        for (int i = 0; i < 20000 && violation(lambda) > 1e-10; ++i) sweep(lambda);
        if (violation(lambda) > least) lambda = best;
    }

    [[nodiscard]] double violation(const VectorXd& lambda) const
    {
        const VectorXd map = natural_map(lambda, nullptr);
        double most = 0;
        for (Index i = 0; i < n_; ++i) {
            if (scale_(i) > 0) most = std::max(most, std::abs(map(i)) / scale_(i));
        }
        return most;
    }
};

/// Which part each row belongs to: rows hang together through A and through their cones.
std::vector<Index> parts_of(const Problem& problem)
{
    std::vector<Index> leader(static_cast<std::size_t>(problem.q.size()));
    std::iota(leader.begin(), leader.end(), Index{0});
    const auto find = [&](Index i) {
        while (leader[static_cast<std::size_t>(i)] != i)
            i = leader[static_cast<std::size_t>(i)] =
                leader[static_cast<std::size_t>(leader[static_cast<std::size_t>(i)])];
        return i;
    };
    const auto join = [&](Index i, Index k) {
        const Index a = find(i), b = find(k);
        leader[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    };
    for (Index column = 0; column < problem.a.cols(); ++column) {
        for (Sparse::InnerIterator entry(problem.a, column); entry; ++entry) {
            if (entry.value() != 0) join(entry.row(), column);
        }
    }
    for (const Cone& cone : problem.cones) {
        for (Index i = 0; i < cone.count; ++i) join(cone.first, cone.first + i);
        for (const Index normal : cone.normals) join(cone.first, normal);
    }
    for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = find(static_cast<Index>(i));
    return leader;
}

}  // namespace

Solution solve(const Problem& problem)
{
    const Index n = problem.q.size();
    Solution whole{VectorXd::Zero(n), 0};
    const std::vector<Index> part_of = parts_of(problem);
    std::vector<std::vector<Index>> members(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i)
        members[static_cast<std::size_t>(part_of[static_cast<std::size_t>(i)])].push_back(i);
    std::vector<std::vector<Cone>> cones(static_cast<std::size_t>(n));
    for (const Cone& cone : problem.cones)
        cones[static_cast<std::size_t>(part_of[static_cast<std::size_t>(cone.first)])].push_back(cone);
    for (std::size_t leader = 0; leader < members.size(); ++leader) {
        const std::vector<Index>& rows = members[leader];
        if (rows.empty()) continue;
        Problem part{submatrix(problem.a, rows), problem.q(rows), {}, {}, cones[leader]};
        const auto place = [&](Index row) {
            return static_cast<Index>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
        };
        for (const Index row : rows) {
            part.low.push_back(problem.low[static_cast<std::size_t>(row)]);
            part.high.push_back(problem.high[static_cast<std::size_t>(row)]);
        }
        // The rows of a cone lie in line in the whole, and so in a part that has all of them.
        for (Cone& cone : part.cones) {
            cone.first = place(cone.first);
            for (Index& normal : cone.normals) normal = place(normal);
        }
        const Solution solution = Part(std::move(part)).solve();
        whole.lambda(rows) = solution.lambda;
        whole.violation = std::max(whole.violation, solution.violation);
    }
    return whole;
}

}  // namespace motley::reference
