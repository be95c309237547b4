// See crowd_index.h.
#include "motley/core/crowd_index.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "motley/core/invalid_input.h"
#include "queries/box_tree.h"
#include "queries/curve_order.h"
#include "queries/line_of_sight.h"
#include "queries/polygon_geometry.h"
#include "scene/body_checks.h"
#include "scene/scene_core.h"
#include "stores/array.h"
#include "stores/growth.h"

namespace motley {
namespace {

struct Person {
    Vec2<double> at;  ///< m, world
    BodyId body;
    float radius;  ///< m
};

double length_of(const Vec2<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// From a point to the nearest place of a box. Rounded as length_of(), it is no more than to any point of the box.
double distance_to(const Box& box, const Vec2<double>& point)
{
    return length_of({std::max({box.low.x - point.x, point.x - box.high.x, 0.0}),
                      std::max({box.low.y - point.y, point.y - box.high.y, 0.0})});
}

/// To the furthest place of a box; likewise no less.
double furthest_of(const Box& box, const Vec2<double>& point)
{
    return length_of({std::max(point.x - box.low.x, box.high.x - point.x),
                      std::max(point.y - box.low.y, box.high.y - point.y)});
}

bool is_nearer(const NearPerson& one, const NearPerson& other)
{
    return one.distance != other.distance ? one.distance < other.distance : one.body.slot < other.body.slot;
}

void check_point(const char* name, const Vec2<double>& point)
{
    check_position(name, {point.x, point.y, 0});
}

void check_distance(const char* name, double distance)
{
    if (!(distance >= 0)) refuse(name, distance, "0 or more (m)");
}

void sort_by_slot(std::vector<BodyId>& bodies)
{
    std::sort(bodies.begin(), bodies.end(),
              [](const BodyId& one, const BodyId& other) { return one.slot < other.slot; });
}

/// Calls work(person) for every disc of a scene.
template <class Work>
void for_each_person(const SceneCore& scene, const Work& work)
{
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    for (std::uint32_t row = 1; row < rows.size(); ++row) {
        const std::uint32_t slot = rows.slot[row];
        const DiscShape* shape = slot != 0 ? scene.discs.shape_of(slot) : nullptr;
        if (shape == nullptr) continue;
        const Vec3<PoseReal>& at = rows.pose[row].position;
        work(Person{{static_cast<double>(at.x), static_cast<double>(at.y)},
                    scene.bodies.id_of_slot(slot),
                    shape->radius});
    }
}

}  // namespace

/// The people in the order of a curve, and a tree over them.
struct CrowdIndexCore {
    Array<Person> people;
    BoxTree tree;
    Array<Person> listed;  ///< in the order of the scene: room for the next build
    CurveOrder order;

    void find(const Vec2<double>& point, double radius, bool with_discs, std::vector<BodyId>& found) const;
};
template class Boxed<CrowdIndexCore>;

CrowdIndex::CrowdIndex() = default;

void CrowdIndex::build(const Scene& scene)
{
    CrowdIndexCore& index = *core_;
    const SceneCore& core = core_of(scene);
    index.people.clear();
    index.tree.clear();
    index.listed.clear();
    make_room_for(index.listed, core.discs.count);
    make_room_for(index.people, core.discs.count);
    index.order.make_room(index.listed.capacity());
    index.tree.make_room(index.listed.capacity());
    for_each_person(core, [&](const Person& person) { index.listed.push_back(person); });
    const auto count = static_cast<std::uint32_t>(index.listed.size());
    index.order.find({count > 0 ? &index.listed[0].at : nullptr, count, sizeof(Person)});
    for (std::uint32_t i = 0; i < count; ++i) index.people.push_back(index.listed[index.order[i]]);
    index.tree.build(count, [&](std::uint32_t i) {
        const Person& person = index.people[i];
        return Box{person.at, person.at, static_cast<double>(person.radius)};
    });
}

bool CrowdIndex::is_current(const Scene& scene) const
{
    std::size_t same = 0, all = 0;
    for_each_person(core_of(scene), [&](const Person& person) {
        if (all < core_->listed.size()) {
            const Person& was = core_->listed[all];
            same += was.body == person.body && was.at.x == person.at.x && was.at.y == person.at.y &&
                            was.radius == person.radius
                        ? 1
                        : 0;
        }
        ++all;
    });
    return same == all && all == core_->listed.size();
}

std::size_t CrowdIndex::size() const
{
    return core_->people.size();
}

void CrowdIndexCore::find(const Vec2<double>& point, double radius, bool with_discs,
                          std::vector<BodyId>& found) const
{
    found.clear();
    const auto judge = [&](const Box& box, std::uint32_t) {
        if (distance_to(box, point) > radius + (with_discs ? box.reach : 0)) return BoxShare::none;
        return furthest_of(box, point) <= radius ? BoxShare::all : BoxShare::some;
    };
    tree.visit(judge, [&](std::uint32_t first, std::uint32_t last, bool is_all) {
        for (std::uint32_t i = first; i < last; ++i) {
            const Person& person = people[i];
            const double reach = radius + (with_discs ? static_cast<double>(person.radius) : 0);
            if (is_all || length_of(person.at - point) <= reach) found.push_back(person.body);
        }
        return true;
    });
    sort_by_slot(found);
}

void CrowdIndex::centres_within(const Vec2<double>& point, double radius, std::vector<BodyId>& found) const
{
    check_point("centres_within.point", point);
    check_distance("centres_within.radius", radius);
    core_->find(point, radius, false, found);
}

void CrowdIndex::discs_within(const Vec2<double>& point, double radius, std::vector<BodyId>& found) const
{
    check_point("discs_within.point", point);
    check_distance("discs_within.radius", radius);
    core_->find(point, radius, true, found);
}

void CrowdIndex::nearest(const Vec2<double>& point, std::size_t count, std::vector<NearPerson>& found,
                         double furthest) const
{
    check_point("nearest.point", point);
    check_distance("nearest.furthest", furthest);
    const Array<Person>& people = core_->people;
    count = std::min(count, people.size());
    found.clear();
    if (count == 0) return;
    found.reserve(count);
    // A heap with the furthest of the nearest so far in front.
    const auto bound = [&] { return found.size() < count ? furthest : found.front().distance; };
    const auto measure = [&](const Box& box) { return distance_to(box, point); };
    core_->tree.visit_nearest(measure, bound, [&](std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t i = first; i < last; ++i) {
            const NearPerson person{people[i].body, length_of(people[i].at - point)};
            if (!(person.distance <= bound())) continue;
            if (found.size() == count) {
                if (!is_nearer(person, found.front())) continue;
                std::pop_heap(found.begin(), found.end(), is_nearer);
                found.pop_back();
            }
            found.push_back(person);
            std::push_heap(found.begin(), found.end(), is_nearer);
        }
    });
    std::sort_heap(found.begin(), found.end(), is_nearer);
}

void CrowdIndex::inside(const Polygon& area, std::vector<BodyId>& found) const
{
    Box around;
    for_each_ring(area, [&](const auto& ring, std::size_t number) {
        if (ring.size() < 3)
            refuse(ring_name(number) + ".size()", static_cast<double>(ring.size()), "3 or more points");
        for (std::size_t i = 0; i < ring.size(); ++i) {
            if (!is_coordinate(ring[i].x) || !is_coordinate(ring[i].y))
                check_point(point_name(number, i).c_str(), ring[i]);
            around.include(ring[i]);
        }
    });
    found.clear();
    const Array<Person>& people = core_->people;
    // A box that no edge meets is all in or all out.
    const auto judge = [&](const Box& box, std::uint32_t first) {
        if (box.low.x > around.high.x || box.high.x < around.low.x || box.low.y > around.high.y ||
            box.high.y < around.low.y)
            return BoxShare::none;
        bool is_met = false;
        for_each_ring(area, [&](const auto& ring, std::size_t) {
            for_each_edge(ring, [&](const Vec2<double>& from, const Vec2<double>& to, std::size_t) {
                is_met = is_met || LineOfSight{from, to}.enters(box) < no_meeting;
            });
        });
        if (is_met) return BoxShare::some;
        return is_inside(area, people[first].at) ? BoxShare::all : BoxShare::none;
    };
    core_->tree.visit(judge, [&](std::uint32_t first, std::uint32_t last, bool is_all) {
        for (std::uint32_t i = first; i < last; ++i) {
            if (is_all || is_inside(area, people[i].at)) found.push_back(people[i].body);
        }
        return true;
    });
    sort_by_slot(found);
}

}  // namespace motley
