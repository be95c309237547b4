#include "block_system.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "small_inverse.h"

namespace motley::reference {

void BlockSystem::lay_out(int nodes, int first_waiting, const std::vector<std::pair<int, int>>& pairs)
{
    const auto count = static_cast<std::size_t>(nodes);
    std::vector<std::vector<int>> neighbours(count);
    for (const auto& [a, b] : pairs) {
        neighbours[static_cast<std::size_t>(a)].push_back(b);
        neighbours[static_cast<std::size_t>(b)].push_back(a);
    }
    std::vector<bool> waits(count, false);
    // A node comes once for every change of its neighbours; entries from before the last change are passed over.
    using Candidate = std::tuple<bool, std::size_t, int>;
    std::vector<Candidate> candidates;
    candidates.reserve(count + 2 * pairs.size());
    const auto candidate = [&](int node) {
        const auto i = static_cast<std::size_t>(node);
        return Candidate(static_cast<bool>(waits[i]), neighbours[i].size(), node);
    };
    const auto add_candidate = [&](int node) {
        candidates.push_back(candidate(node));
        std::push_heap(candidates.begin(), candidates.end(), std::greater<>());
    };
    for (int i = 0; i < nodes; ++i) {
        std::vector<int>& mine = neighbours[static_cast<std::size_t>(i)];
        std::sort(mine.begin(), mine.end());
        mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
        waits[static_cast<std::size_t>(i)] = i >= first_waiting;
        add_candidate(i);
    }
    order_.clear();
    place_.assign(count, 0);
    beside_.assign(count, {});
    int blocks = 0;
    std::vector<int> merged;
    std::vector<bool> is_eliminated(count, false);
    while (!candidates.empty()) {
        std::pop_heap(candidates.begin(), candidates.end(), std::greater<>());
        const Candidate least = candidates.back();
        candidates.pop_back();
        const int pivot = std::get<int>(least);
        if (is_eliminated[static_cast<std::size_t>(pivot)] || least != candidate(pivot)) continue;
        is_eliminated[static_cast<std::size_t>(pivot)] = true;
        place_[static_cast<std::size_t>(pivot)] = static_cast<int>(order_.size());
        order_.push_back(pivot);
        const std::vector<int> left = std::move(neighbours[static_cast<std::size_t>(pivot)]);
        std::vector<Beside>& later = beside_[static_cast<std::size_t>(pivot)];
        later.reserve(left.size());
        for (const int node : left) later.push_back({node, blocks++});
        // Elimination connects its remaining neighbours with each other.
        for (const int node : left) {
            std::vector<int>& mine = neighbours[static_cast<std::size_t>(node)];
            merged.clear();
            std::set_union(mine.begin(), mine.end(), left.begin(), left.end(), std::back_inserter(merged));
            merged.erase(std::remove_if(merged.begin(), merged.end(),
                                        [&](int other) { return other == pivot || other == node; }),
                         merged.end());
            mine.swap(merged);
            waits[static_cast<std::size_t>(node)] = false;
            add_candidate(node);
        }
    }
    diagonal_.resize(count);
    lower_.resize(static_cast<std::size_t>(blocks));
    upper_.resize(static_cast<std::size_t>(blocks));
}

void BlockSystem::reset()
{
    for (Block& block : diagonal_) block.setIdentity();
    for (Block& block : lower_) block.setZero();
    for (Block& block : upper_) block.setZero();
}

int BlockSystem::block_of(int first, int later) const
{
    const std::vector<Beside>& row = beside_[static_cast<std::size_t>(first)];
    return std::lower_bound(row.begin(), row.end(), later,
                            [](const Beside& beside, int node) { return beside.node < node; })
        ->block;
}

BlockSystem::Block& BlockSystem::at(int a, int b)
{
    if (a == b) return diagonal_[static_cast<std::size_t>(a)];
    const bool b_first = place_[static_cast<std::size_t>(b)] < place_[static_cast<std::size_t>(a)];
    const auto block = static_cast<std::size_t>(b_first ? block_of(b, a) : block_of(a, b));
    return b_first ? lower_[block] : upper_[block];
}

bool BlockSystem::factor()
{
    for (const int pivot : order_) {
        Block& diagonal = diagonal_[static_cast<std::size_t>(pivot)];
        invert_small(diagonal);
        if (!diagonal.allFinite()) return false;
        const std::vector<Beside>& row = beside_[static_cast<std::size_t>(pivot)];
        for (const Beside& i : row) {
            Block& lower = lower_[static_cast<std::size_t>(i.block)];
            lower = (lower * diagonal).eval();
            for (const Beside& k : row)
                at(i.node, k.node).noalias() -= lower * upper_[static_cast<std::size_t>(k.block)];
        }
    }
    return true;
}

void BlockSystem::solve(Eigen::VectorXd& x) const
{
    const auto part = [&](int node) { return x.segment<6>(6 * static_cast<Eigen::Index>(node)); };
    for (const int pivot : order_) {
        for (const Beside& i : beside_[static_cast<std::size_t>(pivot)])
            part(i.node).noalias() -= lower_[static_cast<std::size_t>(i.block)] * part(pivot);
    }
    for (std::size_t i = order_.size(); i-- > 0;) {
        const int pivot = order_[i];
        Eigen::Matrix<double, 6, 1> rest = part(pivot);
        for (const Beside& k : beside_[static_cast<std::size_t>(pivot)])
            rest.noalias() -= upper_[static_cast<std::size_t>(k.block)] * part(k.node);
        part(pivot).noalias() = diagonal_[static_cast<std::size_t>(pivot)] * rest;
    }
}

}  // namespace motley::reference
