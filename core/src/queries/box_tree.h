// A tree of boxes over a list whose neighbours lie near each other: sixteen consecutive entries share a leaf, sixteen
// leaves a node, and so on (I. Kamel and C. Faloutsos, "On packing R-trees", 1993). Boxes fit what they hold, so that
// clumps, lines and a few entries far away cost nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "motley/core/vector.h"
#include "stores/array.h"

namespace motley {

/// Holds points; things at these points may reach `reach` beyond it. Empty at first. All in m, world.
struct Box {
    Vec2<double> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    double reach = 0;

    void include(const Box& other)
    {
        low = {std::min(low.x, other.low.x), std::min(low.y, other.low.y)};
        high = {std::max(high.x, other.high.x), std::max(high.y, other.high.y)};
        reach = std::max(reach, other.reach);
    }
    void include(const Vec2<double>& point) { include(Box{point, point, 0}); }
};

/// How much of a box a query wants.
enum class BoxShare : std::uint8_t { none, some, all };

class BoxTree {
  public:
    static constexpr int fan_out_bits = 4;
    static constexpr std::uint32_t fan_out = 1U << fan_out_bits;

    void clear() { levels_ = 0; }
    /// Makes room, so that build() over as many entries allocates nothing.
    void make_room(std::size_t entries) { boxes_.reserve(boxes_over(entries)); }
    /// Builds the tree over entries 0 to `entries` - 1, box_of(i) being the box of entry i.
    template <class BoxOf>
    void build(std::uint32_t entries, const BoxOf& box_of);

    /// Asks judge(box, first) of boxes from the top, `first` being their first entry; calls work(first, last, is_all)
    /// for the entries of those of which it wants all, and of leaves of which it wants some. In the order of entries.
    /// Ends when work() returns false; then returns false.
    template <class Judge, class Work>
    bool visit(const Judge& judge, const Work& work) const
    {
        return levels_ == 0 || visit_nodes(levels_ - 1, 0, nodes_[top()], judge, work);
    }
    /// Calls work(first, last) for the entries of leaves whose measure(box) is at most bound(), about in the order of
    /// the measure. The bound may fall meanwhile.
    template <class Measure, class Bound, class Work>
    void visit_nearest(const Measure& measure, const Bound& bound, const Work& work) const
    {
        if (levels_ > 0) visit_near_nodes(levels_ - 1, 0, nodes_[top()], measure, bound, work);
    }

  private:
    static constexpr std::size_t most_levels = 8;               // 16^8 entries are all that 32 bits count
    Array<Box> boxes_;                                          ///< by level, the leaves first
    std::array<std::uint32_t, most_levels> first_{}, nodes_{};  ///< by level: in boxes_, and how many
    std::uint32_t entries_ = 0;
    int levels_ = 0;

    [[nodiscard]] std::size_t top() const { return static_cast<std::size_t>(levels_ - 1); }
    static std::size_t boxes_over(std::size_t entries);
    /// The number of entries below a node of a level, where it is full.
    static std::uint64_t entries_below(int level) { return std::uint64_t{1} << fan_out_bits * (level + 1); }
    [[nodiscard]] std::uint32_t first_entry(int level, std::uint32_t node) const
    {
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(entries_below(level) * node, entries_));
    }
    [[nodiscard]] const Box& box(int level, std::uint32_t node) const
    {
        return boxes_[first_[static_cast<std::size_t>(level)] + node];
    }
    [[nodiscard]] std::uint32_t last_child(int level, std::uint32_t node) const
    {
        return std::min(fan_out * (node + 1), nodes_[static_cast<std::size_t>(level) - 1]);
    }
    template <class Judge, class Work>
    bool visit_nodes(int level, std::uint32_t first, std::uint32_t last, const Judge& judge,
                     const Work& work) const;
    template <class Measure, class Bound, class Work>
    void visit_near_nodes(int level, std::uint32_t first, std::uint32_t last, const Measure& measure,
                          const Bound& bound, const Work& work) const;
};

inline std::size_t BoxTree::boxes_over(std::size_t entries)
{
    std::size_t boxes = 0;
    for (std::size_t nodes = entries; nodes > 0;) {
        nodes = (nodes + fan_out - 1) / fan_out;
        boxes += nodes;
        if (nodes <= fan_out) break;
    }
    return boxes;
}

template <class BoxOf>
void BoxTree::build(std::uint32_t entries, const BoxOf& box_of)
{
    boxes_.clear();
    boxes_.resize(boxes_over(entries));
    entries_ = entries;
    levels_ = 0;
    std::uint32_t first = 0;
    for (std::uint32_t below = entries; below > 0;) {
        const std::uint32_t nodes = below / fan_out + (below % fan_out != 0 ? 1 : 0);
        for (std::uint32_t i = 0; i < below; ++i)
            boxes_[first + i / fan_out].include(levels_ == 0 ? box_of(i) : box(levels_ - 1, i));
        first_[static_cast<std::size_t>(levels_)] = first;
        nodes_[static_cast<std::size_t>(levels_++)] = nodes;
        first += nodes;
        if (nodes <= fan_out) break;
        below = nodes;
    }
}

template <class Judge, class Work>
bool BoxTree::visit_nodes(int level, std::uint32_t first, std::uint32_t last, const Judge& judge,
                          const Work& work) const
{
    for (std::uint32_t node = first; node < last; ++node) {
        const std::uint32_t begin = first_entry(level, node);
        const BoxShare share = judge(box(level, node), begin);
        if (share == BoxShare::none) continue;
        const bool goes_on =
            share == BoxShare::all || level == 0
                ? work(begin, first_entry(level, node + 1), share == BoxShare::all)
                : visit_nodes(level - 1, fan_out * node, last_child(level, node), judge, work);
        if (!goes_on) return false;
    }
    return true;
}

template <class Measure, class Bound, class Work>
void BoxTree::visit_near_nodes(int level, std::uint32_t first, std::uint32_t last, const Measure& measure,
                               const Bound& bound, const Work& work) const
{
    struct Near {
        double measure;
        std::uint32_t node;
    };
    std::array<Near, fan_out> near;
    std::size_t count = 0;
    for (std::uint32_t node = first; node < last; ++node) {
        const double measured = measure(box(level, node));
        if (!(measured <= bound())) continue;
        std::size_t place = count++;
        for (; place > 0 && near[place - 1].measure > measured; --place) near[place] = near[place - 1];
        near[place] = {measured, node};
    }
    for (std::size_t i = 0; i < count && near[i].measure <= bound(); ++i) {
        const std::uint32_t node = near[i].node;
        if (level == 0) {
            work(first_entry(0, node), first_entry(0, node + 1));
        } else {
            visit_near_nodes(level - 1, fan_out * node, last_child(level, node), measure, bound, work);
        }
    }
}

}  // namespace motley
