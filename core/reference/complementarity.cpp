// Finds the parts of a problem that bodies connect, and solves each by itself.
#include "complementarity.h"

#include <algorithm>
#include <numeric>

#include "semismooth_newton.h"

namespace motley::reference {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The part of each body, named by the least index of the bodies that groups connect it with.
std::vector<int> parts_of(const Problem& problem)
{
    std::vector<int> leader(static_cast<std::size_t>(problem.bodies));
    std::iota(leader.begin(), leader.end(), 0);
    const auto find = [&](int i) {
        while (leader[static_cast<std::size_t>(i)] != i)
            i = leader[static_cast<std::size_t>(i)] =
                leader[static_cast<std::size_t>(leader[static_cast<std::size_t>(i)])];
        return i;
    };
    for (const RowGroup& group : problem.groups) {
        const int any = *std::max_element(group.bodies.begin(), group.bodies.end());
        for (const int body : group.bodies) {
            if (body < 0) continue;
            const int a = find(any), b = find(body);
            leader[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    }
    for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = find(static_cast<int>(i));
    return leader;
}

}  // namespace

Solution solve(Problem& problem)
{
    const auto count = static_cast<std::size_t>(problem.bodies);
    Solution whole{VectorXd::Zero(6 * static_cast<Index>(count)), 0, 0};
    const std::vector<int> part_of = parts_of(problem);
    std::vector<std::vector<RowGroup*>> groups(count);
    std::vector<std::vector<int>> members(count);
    std::vector<int> place(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<int>& part = members[static_cast<std::size_t>(part_of[i])];
        place[i] = static_cast<int>(part.size());
        part.push_back(static_cast<int>(i));
    }
    for (RowGroup& group : problem.groups) {
        const int body = *std::max_element(group.bodies.begin(), group.bodies.end());
        if (body < 0) {
            group.lambda.setZero();  // between bodies that cannot move
        } else {
            groups[static_cast<std::size_t>(part_of[static_cast<std::size_t>(body)])].push_back(&group);
        }
    }
    VectorXd change;
    for (std::size_t leader = 0; leader < count; ++leader) {
        if (groups[leader].empty()) continue;
        const double violation =
            solve_part(groups[leader], place, static_cast<int>(members[leader].size()), change);
        for (std::size_t i = 0; i < members[leader].size(); ++i) {
            whole.change.segment<6>(6 * static_cast<Index>(members[leader][i])) =
                change.segment<6>(6 * static_cast<Index>(i));
        }
        whole.violation = std::max(whole.violation, violation);
        whole.unsolved += violation > solved_to ? 1 : 0;
    }
    return whole;
}

}  // namespace motley::reference
