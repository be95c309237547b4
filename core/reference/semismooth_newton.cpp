// A semismooth Newton method on the natural map (Alart and Curnier 1991), each step of it a proximal point step.
//
// Within a group the linearised map is E delta_lambda + F J delta_y = -map. With y = J^T lambda this makes a system of
// six rows for each body. Contacts, which may have more rows between two bodies than these have degrees of freedom, are
// eliminated from it: delta_lambda = s - D J delta_y, with D = E^-1 F and s = -E^-1 map, leaves
// (I + J^T D J) delta_y = J^T s. Joints stay in it with rows of their own, because D is large where a row holds as an
// equation, and added to a large D the mass of a light body in a chain would be lost in rounding. With the rows J_c of
// contacts and J_j of joints the system is
//
//   [ I + J_c^T D J_c   -J_j^T ] [ delta_y        ]   [ J_c^T s ]
//   [ F J_j              E     ] [ delta_lambda_j ] = [ -map_j  ]
//
// Where a row holds as an equation, E is epsilon. This makes the system regular also where rows are redundant. Because
// each step starts from the impulses of the one before, epsilon leaves no error: a step only leaves
// epsilon / (sigma + epsilon) of it in a direction whose response is sigma (the proximal point method, Rockafellar
// 1976).
#include "semismooth_newton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "block_system.h"
#include "natural_map.h"

namespace motley::reference {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Column = RowGroup::Rows<1>;

/// epsilon: the share of a row's own K that is added to it. A smaller one converges faster but rounds worse. Equations
/// alone are well posed; among contacts, rows may nearly contradict each other, and a larger epsilon keeps their
/// impulses smaller. Contacts of masses far apart want the smallest one, which is for the attempts after the first.
constexpr double epsilon_of_equations = 1e-8, epsilon_of_contacts = 1e-7, epsilon_of_attempts = 1e-10;
/// That of the walk with which each attempt begins.
constexpr std::array<double, 6> epsilon_of_walks{1e-6, 1e-3, 1e-5, 1e-4, 1e-7, 1e-2};
/// A violation below which the rounding of doubles hardly lets the natural map decrease any more.
constexpr double enough = 1e-13;
/// A violation below which further attempts are not worth their time.
constexpr double rounding = 0.01 * solved_to;

/// How Newton steps go on.
struct Descent {
    int rounds;  ///< steps at most
    double least_epsilon;
    /// A step must leave less of the map than the worst of so many steps before it. With 1 the map decreases in every step, which
    /// ends at kinks of the map (L. Grippo, F. Lampariello, S. Lucidi 1986).
    std::size_t memory;
};
constexpr Descent descent_of_equations{40, epsilon_of_equations, 1},
    descent_of_contacts{15, epsilon_of_contacts, 1}, descent_of_attempts{60, epsilon_of_attempts, 20};

/// The groups of one part, with its bodies numbered from 0.
class Part {
  public:
    Part(const std::vector<RowGroup*>& groups, const std::vector<int>& place, int bodies)
        : change(VectorXd::Zero(6 * static_cast<Index>(bodies))), bodies_(bodies), nodes_(bodies)
    {
        units_.reserve(groups.size());
        for (RowGroup* group : groups) {
            MappedGroup& unit = units_.emplace_back();
            unit.group = group;
            for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
                const int body = group->bodies[side];
                unit.bodies[side] = body < 0 ? -1 : place[static_cast<std::size_t>(body)];
            }
            if (group->cones.empty() && !group->is_contact && group->size() <= 6) unit.node = nodes_++;
        }
        const double largest = prepare_scales();
        for (MappedGroup& unit : units_) {
            for (Index i = 0; i < unit.scale.size(); ++i)
                unit.scale(i) = unit.scale(i) > 1e-14 * largest ? 1 / unit.scale(i) : 0;
            const RowGroup& group = *unit.group;
            is_linear_ = is_linear_ && group.cones.empty() && (group.low.array() == -unbounded).all() &&
                         (group.high.array() == unbounded).all();
        }
    }

    VectorXd change;  ///< y

    double solve()
    {
        for (MappedGroup& unit : units_) {
            if (!unit.group->offset.allFinite()) return fail();
            if (is_linear_ || !unit.group->lambda.allFinite()) unit.group->lambda.setZero();
            unit.offset = unit.group->offset;
        }
        accumulate();
        lay_out();
        iterate();
        for (MappedGroup& unit : units_) unit.group->lambda = unit.best;
        accumulate();
        for (MappedGroup& unit : units_) unit.offset = unit.group->offset;
        return look().violation;
    }

  private:
    static constexpr double unbounded = std::numeric_limits<double>::infinity();
    struct Look {
        double violation, merit;
    };
    std::vector<MappedGroup> units_;
    int bodies_, nodes_;     ///< nodes: bodies, then joints
    bool is_linear_ = true;  ///< only equations
    double epsilon_ = 0, least_ = unbounded;
    std::vector<double> merits_;  ///< of the map, before each of these Newton steps
    BlockSystem system_;
    VectorXd move_;

    double fail()
    {
        for (MappedGroup& unit : units_) unit.group->lambda.setZero();
        change.setZero();
        return unbounded;
    }
    double prepare_scales()
    {
        double largest = 0;
        for (MappedGroup& unit : units_) {
            RowGroup& group = *unit.group;
            unit.scale = Column::Zero(group.size());
            for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
                if (unit.bodies[side] >= 0) unit.scale += group.jacobian[side].rowwise().squaredNorm();
            }
            // epsilon is a share of K without the part of a common spin, which is huge because its inertia is tiny.
            unit.share = unit.scale;
            if (unit.bodies[2] >= 0) unit.share -= group.jacobian[2].rowwise().squaredNorm();
            unit.share = (unit.scale.array() > 0).select(unit.share.cwiseQuotient(unit.scale), 1);
            if (group.softness.size() > 0) unit.scale += group.softness.diagonal();
            if (group.size() > 0) largest = std::max(largest, unit.scale.maxCoeff());
        }
        return largest;
    }
    auto of_body(VectorXd& y, int body) const { return y.segment<6>(6 * static_cast<Index>(body)); }
    Column speed(const MappedGroup& unit, VectorXd& y) const
    {
        Column sum = Column::Zero(unit.group->size());
        for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
            if (unit.bodies[side] >= 0)
                sum.noalias() += unit.group->jacobian[side] * of_body(y, unit.bodies[side]);
        }
        return sum;
    }
    void push(const MappedGroup& unit, const Column& lambda, VectorXd& y) const
    {
        for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
            if (unit.bodies[side] >= 0)
                of_body(y, unit.bodies[side]).noalias() += unit.group->jacobian[side].transpose() * lambda;
        }
    }
    void accumulate()
    {
        change.setZero();
        for (const MappedGroup& unit : units_) push(unit, unit.group->lambda, change);
    }
    void lay_out()
    {
        std::vector<std::pair<int, int>> pairs;
        for (const MappedGroup& unit : units_) {
            for (const int body : unit.bodies) {
                if (unit.node >= 0 && body >= 0) pairs.emplace_back(body, unit.node);
            }
            for (std::size_t a = 0; unit.node < 0 && a < unit.bodies.size(); ++a) {
                for (std::size_t b = 0; b < a; ++b) {
                    if (unit.bodies[a] >= 0 && unit.bodies[b] >= 0)
                        pairs.emplace_back(unit.bodies[a], unit.bodies[b]);
                }
            }
        }
        system_.lay_out(nodes_, bodies_, pairs);
    }

    /// Computes the natural map lambda - P(lambda - scale w) of the present impulses, with P the projection to bounds
    /// and cones. It is zero at the solution.
    Look look()
    {
        Look all{0, 0};
        for (MappedGroup& unit : units_) {
            const RowGroup& group = *unit.group;
            unit.w = unit.offset + speed(unit, change);
            if (group.softness.size() > 0) unit.w.noalias() += group.softness * group.lambda;
            find_map(unit);
            for (int i = 0; i < group.size(); ++i) {
                if (unit.scale(i) == 0) continue;
                const double left = unit.map(i) / unit.scale(i);
                all.violation = std::max(all.violation, std::abs(left));
                all.merit += left * unit.map(i);
            }
        }
        if (!std::isfinite(all.merit)) all.violation = unbounded;
        return all;
    }
    bool factor()
    {
        system_.reset();
        for (MappedGroup& unit : units_) {
            linearise(unit, epsilon_);
            if (unit.node >= 0) {
                enter_joint(unit);
            } else {
                enter_contact(unit);
            }
        }
        return system_.factor();
    }
    void enter_joint(const MappedGroup& unit)
    {
        const int n = unit.group->size();
        system_.at(unit.node, unit.node).topLeftCorner(n, n) = unit.e;
        for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
            if (unit.bodies[side] < 0) continue;
            system_.at(unit.node, unit.bodies[side]).topRows(n) +=
                unit.f.lazyProduct(unit.group->jacobian[side]);
            system_.at(unit.bodies[side], unit.node).leftCols(n) -= unit.group->jacobian[side].transpose();
        }
    }
    void enter_contact(const MappedGroup& unit)
    {
        for (std::size_t a = 0; a < RowGroup::most_bodies; ++a) {
            if (unit.bodies[a] < 0) continue;
            const Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, RowGroup::most_rows> left =
                unit.group->jacobian[a].transpose().lazyProduct(unit.law);
            for (std::size_t b = 0; b < RowGroup::most_bodies; ++b) {
                if (unit.bodies[b] >= 0)
                    system_.at(unit.bodies[a], unit.bodies[b]) += left.lazyProduct(unit.group->jacobian[b]);
            }
        }
    }
    /// Newton's step of every group, from the present factors.
    bool find_step()
    {
        move_.setZero(6 * static_cast<Index>(nodes_));
        for (const MappedGroup& unit : units_) {
            if (unit.node >= 0) {
                move_.segment(6 * static_cast<Index>(unit.node), unit.group->size()) = -unit.map;
            } else {
                push(unit, unit.drive, move_);
            }
        }
        system_.solve(move_);
        if (!move_.allFinite()) return false;
        for (MappedGroup& unit : units_) {
            if (unit.node >= 0) {
                unit.step = move_.segment(6 * static_cast<Index>(unit.node), unit.group->size());
            } else {
                unit.step = unit.drive;
                unit.step.noalias() -= unit.law * speed(unit, move_);
            }
        }
        return true;
    }
    /// Takes the largest share of the step, of 1, 1/2, 1/4, ..., that leaves less of the map than the worst of the last `memory`
    /// steps began with, and returns it. Returns 0, with the impulses as they were, if none does.
    double descend(Look& now, std::size_t memory)
    {
        merits_.push_back(now.merit);
        const auto kept = static_cast<std::ptrdiff_t>(std::min(merits_.size(), memory));
        const double worst = *std::max_element(merits_.end() - kept, merits_.end());
        for (MappedGroup& unit : units_) unit.start = unit.group->lambda;
        for (double length = 1; length > 0.02; length /= 2) {
            for (MappedGroup& unit : units_) unit.group->lambda = unit.start + length * unit.step;
            accumulate();
            const Look there = look();
            if (there.merit < (1 - 1e-4 * length) * worst) {
                now = there;
                return length;
            }
        }
        for (MappedGroup& unit : units_) unit.group->lambda = unit.start;
        accumulate();
        now = look();
        return 0;
    }
    /// Takes from the equations the part that no impulse can meet, which is found from the step that was not taken: the
    /// rest is their solution in the least squares sense.
    void give_up_contradictions()
    {
        for (MappedGroup& unit : units_) {
            for (int i = 0; i < unit.group->size(); ++i) {
                if (unit.where[static_cast<std::size_t>(i)] == Where::inside && unit.scale(i) > 0)
                    unit.offset(i) += epsilon_ * unit.share(i) / unit.scale(i) * unit.step(i);
            }
        }
    }
    /// Whether even the full step would leave more than half of the map: then rows contradict each other.
    [[nodiscard]] bool contradicts(const Look& now) const
    {
        double left = 0;
        for (const MappedGroup& unit : units_) {
            for (int i = 0; i < unit.group->size(); ++i) {
                if (unit.where[static_cast<std::size_t>(i)] == Where::inside && unit.scale(i) > 0)
                    left = std::max(left, std::abs(epsilon_ * unit.share(i) / unit.scale(i) * unit.step(i)));
            }
        }
        return left > 0.5 * now.violation;
    }

    void iterate()
    {
        keep_best(look());
        newton(is_linear_ ? descent_of_equations : descent_of_contacts);
        if (is_linear_) return;
        // The descent may be stuck at a kink of the map that is no solution. Full steps lead away from it: the impulses
        // of nearly redundant rows grow until one reaches its bound. Sweeps lead to another face of the cones.
        int sweeps = 50;
        for (const double epsilon : epsilon_of_walks) {
            if (least_ <= rounding) return;
            go_back_to_best();
            walk(15, epsilon);
            newton(descent_of_attempts);
            if (least_ <= rounding) return;
            go_back_to_best();
            for (int i = 0; i < sweeps; ++i) sweep();
            sweeps = std::min(2 * sweeps, 400);
            newton(descent_of_attempts);
        }
    }
    /// Newton steps, as long as they decrease the map as `descent` asks. Where one does not, a larger epsilon turns it
    /// towards solving each row by itself (Levenberg and Marquardt).
    void newton(const Descent& descent)
    {
        merits_.clear();
        Look now = look();
        epsilon_ = descent.least_epsilon;
        for (int round = 0; round < descent.rounds && now.violation > enough; ++round) {
            const bool has_step = factor() && find_step();
            const double before = now.violation;
            const bool contradictory = has_step && is_linear_ && contradicts(now);
            const double length = has_step ? descend(now, descent.memory) : 0;
            if (contradictory && now.violation > std::max(0.5 * before, rounding)) {
                for (MappedGroup& unit : units_) unit.group->lambda = unit.start;
                give_up_contradictions();
                accumulate();
                now = look();
                least_ = unbounded;
                keep_best(now);
                continue;
            }
            keep_best(now);
            if (length == 0 && (now.violation < rounding || epsilon_ >= 1)) return;
            epsilon_ = length == 0    ? std::min(1.0, epsilon_ * 1e3)
                       : length < 0.2 ? std::min(1.0, epsilon_ * 1e2)
                                      : std::max(descent.least_epsilon, epsilon_ * 1e-2);
        }
    }
    /// Full steps of the proximal point method, also where they increase the map.
    void walk(int rounds, double epsilon)
    {
        epsilon_ = epsilon;
        for (int round = 0; round < rounds && least_ > enough; ++round) {
            if (!factor() || !find_step()) return;
            for (MappedGroup& unit : units_) unit.group->lambda += unit.step;
            accumulate();
            keep_best(look());
        }
    }
    void keep_best(const Look& now)
    {
        if (!(now.violation < least_)) return;
        least_ = now.violation;
        for (MappedGroup& unit : units_) unit.best = unit.group->lambda;
    }
    void go_back_to_best()
    {
        for (MappedGroup& unit : units_) unit.group->lambda = unit.best;
        accumulate();
        look();
    }

    void sweep()
    {
        for (MappedGroup& unit : units_) sweep_group(unit, change);
    }
};

}  // namespace

double solve_part(const std::vector<RowGroup*>& groups, const std::vector<int>& place, int bodies,
                  VectorXd& change)
{
    Part part(groups, place, bodies);
    const double violation = part.solve();
    change = std::move(part.change);
    return violation;
}

}  // namespace motley::reference
