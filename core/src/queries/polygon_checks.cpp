// See polygon_checks.h.
#include "queries/polygon_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "motley/core/invalid_input.h"
#include "queries/box_tree.h"
#include "queries/curve_order.h"
#include "queries/line_of_sight.h"
#include "queries/polygon_geometry.h"
#include "scene/body_checks.h"
#include "stores/array.h"

namespace motley {
namespace {

struct Edge {
    Vec2<double> middle, from, to;  ///< m
    std::size_t ring, index;        ///< of its first point
};

/// Where a point is beside an edge, as far as rounding lets one tell.
enum class Side : std::int8_t { right = -1, on = 0, left = 1 };

Side side_of(const Edge& edge, const Vec2<double>& point)
{
    const Vec2<double> along = edge.to - edge.from, away = point - edge.from;
    const double side = cross(along, away);
    if (std::abs(side) <= rounding_of_cross(along, away)) return Side::on;
    return side > 0 ? Side::left : Side::right;
}

bool are_opposite(Side one, Side other)
{
    return static_cast<int>(one) * static_cast<int>(other) < 0;
}

std::string text_of(const Vec2<double>& at)
{
    char text[64];
    std::snprintf(text, sizeof text, "(%.9g %.9g)", at.x, at.y);
    return text;
}

/// Refuses an edge that meets one before it.
[[noreturn]] void refuse_meeting(const Edge& edge, const Edge& other, std::string_view expected)
{
    const double fraction = LineOfSight{edge.from, edge.to}.meets(other.from, other.to);
    const Vec2<double> at = fraction < no_meeting ? edge.from + fraction * (edge.to - edge.from) : edge.from;
    refuse(point_name(edge.ring, edge.index),
           text_of(edge.from) + ", from where an edge meets that from " +
               point_name(other.ring, other.index) + " at " + text_of(at),
           expected);
}

/// Whether two edges on one straight line share more than a point.
bool overlap(const Edge& one, const Edge& other)
{
    if (side_of(one, other.from) != Side::on || side_of(one, other.to) != Side::on) return false;
    const Vec2<double> along = one.to - one.from;
    const double length2 = dot(along, along);
    const double a = dot(along, other.from - one.from) / length2,
                 b = dot(along, other.to - one.from) / length2;
    constexpr double rounding = 1e-12;
    return std::min(std::max(a, b), 1.0) - std::max(std::min(a, b), 0.0) > rounding;
}

bool cross_each_other(const Edge& one, const Edge& other)
{
    return are_opposite(side_of(one, other.from), side_of(one, other.to)) &&
           are_opposite(side_of(other, one.from), side_of(other, one.to));
}

void check_two_edges(const Edge& edge, const Edge& other, std::size_t points)
{
    if (edge.ring != other.ring) {
        if (cross_each_other(edge, other) || overlap(edge, other))
            refuse_meeting(edge, other, "rings that meet in points only");
        return;
    }
    const bool follow = edge.index == other.index + 1 || edge.index + 1 == other.index + points;
    const bool meet = follow ? overlap(edge, other)
                             : LineOfSight{edge.from, edge.to}.meets(other.from, other.to) < no_meeting;
    if (meet) refuse_meeting(edge, other, "a ring that does not meet itself");
}

Array<Edge> edges_of(const Polygon& polygon)
{
    Array<Edge> edges;
    for_each_ring(polygon, [&](const auto& ring, std::size_t number) {
        if (ring.size() < 3)
            refuse(ring_name(number) + ".size()", static_cast<double>(ring.size()), "3 or more points");
        for_each_edge(ring, [&](const Vec2<double>& from, const Vec2<double>& to, std::size_t index) {
            check_segment(point_name(number, index).c_str(), from, to);
            edges.push_back({0.5 * (from + to), from, to, number, index});
        });
    });
    return edges;
}

/// Compares each edge with those whose boxes it meets.
void check_edges(const Polygon& polygon, const Array<Edge>& edges)
{
    CurveOrder order;
    order.find({&edges[0].middle, edges.size(), sizeof(Edge)});
    BoxTree tree;
    tree.build(static_cast<std::uint32_t>(edges.size()), [&](std::uint32_t i) {
        Box box;
        box.include(edges[order[i]].from);
        box.include(edges[order[i]].to);
        return box;
    });
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const LineOfSight line{edges[i].from, edges[i].to};
        const auto judge = [&](const Box& box, std::uint32_t) {
            return line.enters(box) < no_meeting ? BoxShare::some : BoxShare::none;
        };
        const std::size_t ring = edges[i].ring;
        const std::size_t points = ring == 0 ? polygon.outer.size() : polygon.holes[ring - 1].size();
        tree.visit(judge, [&](std::uint32_t first, std::uint32_t last, bool) {
            for (std::uint32_t j = first; j < last; ++j) {
                if (order[j] < i) check_two_edges(edges[i], edges[order[j]], points);
            }
            return true;
        });
    }
}

/// Whether a point is on an edge of the ring, as far as rounding lets one tell.
bool is_on(const std::vector<Vec2<double>>& ring, const Vec2<double>& point)
{
    bool is = false;
    for_each_edge(ring, [&](const Vec2<double>& from, const Vec2<double>& to, std::size_t) {
        const Vec2<double> along = to - from, away = point - from;
        const double t = dot(along, away), length2 = dot(along, along);
        is = is || (side_of({{}, from, to, 0, 0}, point) == Side::on && t >= -1e-12 * length2 &&
                    t <= (1 + 1e-12) * length2);
    });
    return is;
}

/// Rings do not cross, so a hole is where its points are that are not on the other ring.
void check_hole(const Polygon& polygon, std::size_t hole)
{
    const std::vector<Vec2<double>>& ring = polygon.holes[hole];
    for_each_edge(ring, [&](const Vec2<double>& from, const Vec2<double>& to, std::size_t index) {
        for (const Vec2<double>& point : {from, 0.5 * (from + to)}) {
            if (!is_inside(polygon.outer, point) && !is_on(polygon.outer, point))
                refuse(point_name(hole + 1, index), text_of(from) + ", outside the outer ring",
                       "holes in the outer ring");
        }
    });
    Box around;
    for (const Vec2<double>& point : ring) around.include(point);
    for (std::size_t other = 0; other < polygon.holes.size(); ++other) {
        const Vec2<double>& point = polygon.holes[other][0];
        if (other == hole || point.x < around.low.x || point.x > around.high.x || point.y < around.low.y ||
            point.y > around.high.y)
            continue;
        for_each_edge(
            polygon.holes[other], [&](const Vec2<double>& from, const Vec2<double>&, std::size_t index) {
                if (is_inside(ring, from) && !is_on(ring, from))
                    refuse(point_name(other + 1, index), text_of(from) + ", in " + ring_name(hole + 1),
                           "holes outside each other");
            });
    }
}

}  // namespace

void check_polygon(const Polygon& polygon)
{
    check_edges(polygon, edges_of(polygon));
    for (std::size_t hole = 0; hole < polygon.holes.size(); ++hole) check_hole(polygon, hole);
}

}  // namespace motley
