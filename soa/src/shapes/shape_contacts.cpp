// See shape_contacts.h.
#include "shapes/shape_contacts.h"

#include <algorithm>
#include <cmath>

#include "maths/across.h"
#include "stores/array.h"
#include "stores/growth.h"

namespace motley {
namespace {

enum class Partner : std::uint64_t { capsule, half_space, wall, disc };

constexpr std::uint64_t key_of(Partner partner, std::uint32_t capsule, std::uint32_t other, int point)
{
    static_assert(ShapeStore::most_slots <= std::uint32_t{1} << 28);
    return found_key | static_cast<std::uint64_t>(partner) << 61 | std::uint64_t{capsule} << 33 |
           std::uint64_t{other} << 4 | static_cast<std::uint64_t>(point);
}
/// The slot of the capsule in a key.
constexpr std::uint32_t capsule_of(std::uint64_t key)
{
    return static_cast<std::uint32_t>(key >> 33) & (ShapeStore::most_slots - 1);
}

/// What touches: a body, where its centre of mass is, its surface and the axis at whose distance that surface is.
struct TouchingBody {
    BodyId body;
    Vec3<double> centre;
    const PlacedCapsule* shape;
    ShapeSurface surface;
    bool is_static = false;  ///< then its arm does not matter, and may be out of the range of arms
};

bool is_static(const SceneCore& scene, BodyId body)
{
    return scene.bodies.motion(body) == BodyMotion::static_body;
}

Vec3<double> centre_of(const SceneCore& scene, BodyId body)
{
    const BodyRow where = scene.bodies.row_of(body);
    return convert<double>(scene.bodies.rows(where.kind()).pose[where.row()].position);
}

TouchingBody side_of(const SceneCore& scene, const ShapePairs& pairs, std::uint32_t index)
{
    const Capsule& capsule = scene.shapes.capsules[index];
    const PlacedCapsule& placed = pairs.capsule(index);
    return {capsule.body, placed.centre, &placed, capsule.surface, placed.is_static};
}

std::uint32_t slot_of(const SceneCore& scene, std::uint32_t capsule)
{
    return scene.shapes.capsules[capsule].slot;
}

/// A unit vector across both axes, or across one of them, from a to b as far as that can be told: for axes that meet.
Vec3<double> direction_across(const Axis& a, const Axis& b, const Vec3<double>& a_to_b, bool is_flat)
{
    const double aa = dot(a.along, a.along), bb = dot(b.along, b.along);
    const Vec3<double>& longer = aa >= bb ? a.along : b.along;
    Vec3<double> across = is_flat ? Vec3<double>{-longer.y, longer.x, 0} : cross(a.along, b.along);
    if (!(dot(across, across) > 1e-12 * aa * bb) && !is_flat) across = some_across(longer);
    double length = std::sqrt(dot(across, across));
    if (!(length > 0)) {  // two points in one place
        across = is_flat ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 0, 1};
        length = 1;
    }
    return (dot(across, a_to_b) < 0 ? -1 / length : 1 / length) * across;
}

Contact contact_at(const TouchingBody& a, const TouchingBody& b, const Vec3<double>& point,
                   const Vec3<double>& normal, double separation)
{
    Contact contact;
    contact.body_a = a.body;
    contact.body_b = b.body;
    contact.normal = convert<float>(normal);
    contact.separation = static_cast<float>(separation);
    contact.arm_a = convert<float>(a.is_static ? Vec3<double>{} : point - a.centre);
    contact.arm_b = convert<float>(b.is_static ? Vec3<double>{} : point - b.centre);
    contact.friction = std::sqrt(a.surface.friction * b.surface.friction);
    contact.restitution = std::max(a.surface.restitution, b.surface.restitution);
    return contact;
}

/// A contact at places of two axes. Seen from above, it is as high as what can be pushed at any height: the body that is
/// not planar.
Contact contact_between(const TouchingBody& a, const TouchingBody& b, const std::array<Axis, 2>& axes,
                        const AxisPlaces& places, const Vec3<double>& normal, double separation)
{
    const PlacedCapsule &of_a = *a.shape, &of_b = *b.shape;
    Vec3<double> point = axes[0].at(places.on_a) + (of_a.radius + separation / 2) * normal;
    if (of_a.is_flat || of_b.is_flat)
        point.z = of_a.is_flat ? of_b.axis.at(places.on_b).z : of_a.axis.at(places.on_a).z;
    return contact_at(a, b, point, normal, separation);
}

/// m: two capsules that are further apart do not touch within the step.
double margin_of(const PlacedCapsule& a, const PlacedCapsule& b)
{
    return step_slack + a.goes + b.goes;
}

/// False where two capsules do not touch within the step for certain.
bool may_touch(const PlacedCapsule& a, const PlacedCapsule& b)
{
    return may_be_within(a, b, a.radius + b.radius + margin_of(a, b));
}

/// Lists the contacts of two capsules that may touch within the step. `key` is that of the first one.
void list_capsules(const TouchingBody& a, const TouchingBody& b, std::uint64_t key, Array<Contact>& contacts)
{
    const PlacedCapsule &of_a = *a.shape, &of_b = *b.shape;
    const bool is_flat = of_a.is_flat || of_b.is_flat;
    const Axis axis_a = is_flat ? flattened(of_a.axis) : of_a.axis;
    const Axis axis_b = is_flat ? flattened(of_b.axis) : of_b.axis;
    const double margin = margin_of(of_a, of_b);
    const TouchingPlaces touching = touching_places(axis_a, axis_b);
    for (int i = 0; i < touching.count; ++i) {
        const AxisPlaces& places = touching.places[static_cast<std::size_t>(i)];
        const Vec3<double> apart = axis_b.at(places.on_b) - axis_a.at(places.on_a);
        const double distance = std::sqrt(dot(apart, apart));
        const double separation = distance - of_a.radius - of_b.radius;
        if (!(separation <= margin)) continue;
        const Vec3<double> normal = distance > 1e-9
                                        ? (1 / distance) * apart
                                        : direction_across(axis_a, axis_b, b.centre - a.centre, is_flat);
        contacts.push_back(contact_between(a, b, {axis_a, axis_b}, places, normal, separation));
        contacts.back().key = key | static_cast<std::uint64_t>(i);
    }
}

/// Out of a wall on its left, as seen from the first point towards the last.
Vec3<double> left_of(const Axis& wall)
{
    const double length = std::sqrt(dot(wall.along, wall.along));
    return {-wall.along.y / length, wall.along.x / length, 0};
}

/// Each end of either axis with the nearest place of the other: whichever way the capsule turns within the step, it meets
/// the wall there. Ends of the wall count only beside the capsule.
struct WallPlaces {
    std::array<AxisPlaces, 4> places{};
    int count = 0;
};
WallPlaces places_at_wall(const Axis& wall, const Axis& capsule)
{
    WallPlaces found;
    const auto add = [&](const AxisPlaces& places) {
        found.places[static_cast<std::size_t>(found.count++)] = places;
    };
    add({nearest_place(wall, capsule.from), 0});
    if (!(dot(capsule.along, capsule.along) > 0)) return found;
    add({nearest_place(wall, capsule.at(1)), 1});
    for (const double end : {0.0, 1.0}) {
        const double on_capsule = nearest_place(capsule, wall.at(end));
        if (on_capsule > 0 && on_capsule < 1) add({end, on_capsule});
    }
    return found;
}

/// Lists the contacts of a capsule with a wall that it may touch within the step. Beside the wall it is held on the left
/// (side 1), on the right (-1), or where it is (0), however far it has been pressed beyond.
void list_at_wall(const TouchingBody& a, const TouchingBody& b, double side, double margin, std::uint64_t key,
                  Array<Contact>& contacts)
{
    const Axis &wall = a.shape->axis, axis = flattened(b.shape->axis);
    // Who is known to be on neither side is on that of the middle.
    const Vec3<double> left = left_of(wall);
    if (side == 0) side = dot(left, axis.at(0.5) - wall.from) < 0 ? -1 : 1;
    const Vec3<double> out = side * left;
    const WallPlaces found = places_at_wall(wall, axis);
    for (int i = 0; i < found.count; ++i) {
        const AxisPlaces& places = found.places[static_cast<std::size_t>(i)];
        const Vec3<double> apart = axis.at(places.on_b) - wall.at(places.on_a);
        const double distance = std::sqrt(dot(apart, apart));
        const bool is_beside = places.on_a > 0 && places.on_a < 1;
        const Vec3<double> normal = is_beside || !(distance > 1e-9) ? out : (1 / distance) * apart;
        const double separation = dot(normal, apart) - b.shape->radius;
        if (!(separation <= margin)) continue;
        contacts.push_back(contact_between(a, b, {wall, axis}, places, normal, separation));
        contacts.back().key = key | static_cast<std::uint64_t>(i);
    }
}

/// Lists the contacts of a capsule with a half-space: one at each end of its axis.
void list_half_space(const TouchingBody& a, const PlacedHalfSpace& half_space, const TouchingBody& b,
                     std::uint64_t key, Array<Contact>& contacts)
{
    const PlacedCapsule& capsule = *b.shape;
    const int ends = dot(capsule.axis.along, capsule.axis.along) > 0 ? 2 : 1;
    for (int i = 0; i < ends; ++i) {
        const Vec3<double> end = capsule.axis.at(i);
        const double separation = dot(half_space.normal, end - half_space.point) - capsule.radius;
        const Vec3<double> arm = end - half_space.centre;
        const double plane_goes = half_space.slides + half_space.turns * std::sqrt(dot(arm, arm));
        if (!(separation <= step_slack + capsule.goes + plane_goes)) continue;
        const Vec3<double> point = end - (capsule.radius + separation / 2) * half_space.normal;
        contacts.push_back(contact_at(a, b, point, half_space.normal, separation));
        contacts.back().key = key | static_cast<std::uint64_t>(i);
    }
}

}  // namespace

std::int64_t segment_of(std::uint64_t key)
{
    const auto partner = static_cast<Partner>(key >> 61 & 3);
    return partner == Partner::wall ? static_cast<std::int64_t>(key >> 4 & ((std::uint64_t{1} << 29) - 1))
                                    : -1;
}

void ShapeContacts::open(const SceneCore& scene, const ShapePairs& pairs, double dt)
{
    dt_ = dt;
    half_spaces_.clear();
    for (const HalfSpace& half_space : scene.shapes.half_spaces)
        half_spaces_.push_back(placed(scene, half_space, dt));
    const std::size_t counts[] = {half_spaces_.empty() ? 0 : scene.shapes.capsules.size(),
                                  pairs.capsules().size(), pairs.walls().size(), pairs.discs().size()};
    for (std::size_t part = 0; part < 4; ++part)
        first_chunk_[part + 1] =
            first_chunk_[part] + (static_cast<std::int64_t>(counts[part]) + a_chunk - 1) / a_chunk;
    grow_to(listed_, static_cast<std::size_t>(chunk_count()));
    remember_sides(scene, pairs);
}

/// On which side of a wall each capsule was that was listed with it in the last step.
void ShapeContacts::remember_sides(const SceneCore& scene, const ShapePairs& pairs)
{
    beside_.clear();
    if (pairs.walls().empty()) return;
    for (std::size_t i = 0; i < scene.shapes.contacts.size(); ++i) {
        const Contact& contact = scene.shapes.contacts[i];
        const WallMet& met = scene.shapes.walls_met[i];
        if (!scene.discs.is_alive(met.wall) || !scene.bodies.is_alive(contact.body_b)) continue;
        beside_.push_back(
            {capsule_of(contact.key), met.wall.slot, met.number, contact.body_b.slot, met.side});
    }
    std::sort(beside_.begin(), beside_.end(),
              [](const Beside& x, const Beside& y) { return x.order() < y.order(); });
    keep_room(beside_);
}

/// The side on which a wall is to hold a capsule: the one on which it was, unless its middle is further beyond than
/// contacts give way. A one-way wall holds on the left what has passed it, until that has walked around an end; what
/// passes is not held.
ShapeContacts::Hold ShapeContacts::hold_of(const SceneCore& scene, const ShapePairs& pairs,
                                           const ShapePair& pair, const Axis& wall) const
{
    const Capsule& capsule = scene.shapes.capsules[pair.capsule];
    const PlacedCapsule& placed = pairs.capsule(pair.capsule);
    const Axis axis = flattened(placed.axis);
    const Vec3<double> left = left_of(wall);
    const auto left_by = [&](double place) { return dot(left, axis.at(place) - wall.from); };
    const WallMet met = scene.discs.met(pair.partner);
    const Beside key{capsule.slot, met.wall.slot, met.number, capsule.body.slot, -1};
    auto before = std::lower_bound(beside_.begin(), beside_.end(), key.order(),
                                   [](const Beside& x, const auto& order) { return x.order() < order; });
    const auto is_of_pair = [&] { return before != beside_.end() && before->is_of(key); };
    if (scene.discs.segments[pair.partner].is_one_way != 0) {
        if (!is_of_pair()) return {std::min(left_by(0), left_by(1)) >= placed.radius, 1};
        const double nearest = nearest_place(wall, axis.at(0.5));
        return {left_by(0.5) >= (nearest > 0 && nearest < 1 ? -placed.radius : 0), 1};
    }
    // Of two points that one may be at an end of the wall.
    while (is_of_pair() && before->side == 0) ++before;
    if (!is_of_pair() || before->side * left_by(0.5) < -placed.radius) return {true, 0};
    return {true, static_cast<double>(before->side)};
}

WallMet ShapeContacts::wall_met(const SceneCore& scene, const ShapePairs& pairs, std::size_t segment,
                                const Contact& contact)
{
    constexpr double beside = 0.99;  // the cosine between the normals of a wall and of a contact beside it
    WallMet met = scene.discs.met(segment);
    const Vec2<double> along = pairs.wall_ends()[2 * segment + 1] - pairs.wall_ends()[2 * segment];
    const double left =
        cross(along, {static_cast<double>(contact.normal.x), static_cast<double>(contact.normal.y)}) /
        std::sqrt(dot(along, along));
    met.side = left > beside ? 1 : left < -beside ? -1 : 0;
    return met;
}

ContactSurface<float> ShapeContacts::surface_of(const SceneCore& scene, const ShapePairs& pairs,
                                                std::size_t segment)
{
    const WallSegment& own = scene.discs.segments[segment];
    const Vec2<double> along = pairs.wall_ends()[2 * segment + 1] - pairs.wall_ends()[2 * segment];
    const double scale = static_cast<double>(own.surface_speed) / std::sqrt(dot(along, along));
    return {convert<float>(Vec3<double>{scale * along.x, scale * along.y, 0}), own.max_force};
}

void ShapeContacts::list(const SceneCore& scene, const ShapePairs& pairs, std::int64_t chunk)
{
    Array<Contact>& contacts = listed_[static_cast<std::size_t>(chunk)];
    contacts.clear();
    std::size_t part = 0;
    while (chunk >= first_chunk_[part + 1]) ++part;
    const auto first = static_cast<std::size_t>((chunk - first_chunk_[part]) * a_chunk);
    const auto share_of = [&](std::span<const ShapePair> all) {
        return all.subspan(first, std::min(static_cast<std::size_t>(a_chunk), all.size() - first));
    };
    switch (part) {
        case 0: {
            const std::size_t last =
                std::min(scene.shapes.capsules.size(), first + static_cast<std::size_t>(a_chunk));
            for (std::size_t i = first; i < last; ++i)
                list_half_spaces(scene, pairs, static_cast<std::uint32_t>(i), contacts);
            break;
        }
        case 1:
            for (const ShapePair& pair : share_of(pairs.capsules())) list_pair(scene, pairs, pair, contacts);
            break;
        case 2:
            for (const ShapePair& pair : share_of(pairs.walls())) list_wall(scene, pairs, pair, contacts);
            break;
        default:
            for (const ShapePair& pair : share_of(pairs.discs())) list_disc(scene, pairs, pair, contacts);
    }
    keep_room(contacts);
}

void ShapeContacts::list_half_spaces(const SceneCore& scene, const ShapePairs& pairs, std::uint32_t capsule,
                                     Array<Contact>& contacts) const
{
    const TouchingBody b = side_of(scene, pairs, capsule);
    if (!b.shape->can_move || b.shape->is_flat) return;
    for (std::size_t i = 0; i < half_spaces_.size(); ++i) {
        const HalfSpace& half_space = scene.shapes.half_spaces[i];
        if (!do_meet(half_space.surface, b.surface)) continue;
        const TouchingBody a{half_space.body, half_spaces_[i].centre, nullptr, half_space.surface,
                             is_static(scene, half_space.body)};
        list_half_space(a, half_spaces_[i], b,
                        key_of(Partner::half_space, slot_of(scene, capsule), half_space.slot, 0), contacts);
    }
}

void ShapeContacts::list_pair(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                              Array<Contact>& contacts)
{
    const PlacedCapsule &a = pairs.capsule(pair.capsule), &b = pairs.capsule(pair.partner);
    if (!may_touch(a, b)) return;
    list_capsules(side_of(scene, pairs, pair.capsule), side_of(scene, pairs, pair.partner),
                  key_of(Partner::capsule, slot_of(scene, pair.capsule), slot_of(scene, pair.partner), 0),
                  contacts);
}

void ShapeContacts::list_wall(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                              Array<Contact>& contacts) const
{
    const WallSegment& segment = scene.discs.segments[pair.partner];
    const Vec2<double> from = pairs.wall_ends()[2 * pair.partner],
                       to = pairs.wall_ends()[2 * pair.partner + 1];
    PlacedCapsule wall;
    wall.axis = {{from.x, from.y, 0}, {to.x - from.x, to.y - from.y, 0}};
    wall.goes = pairs.walls_go();
    wall.is_flat = true;
    const TouchingBody a{segment.body,
                         centre_of(scene, segment.body),
                         &wall,
                         {segment.friction, 0, segment.category, segment.mask},
                         is_static(scene, segment.body)};
    const TouchingBody b = side_of(scene, pairs, pair.capsule);
    const std::uint64_t key = key_of(Partner::wall, slot_of(scene, pair.capsule), pair.partner, 0);
    const Hold hold = hold_of(scene, pairs, pair, wall.axis);
    // Whatever is near may be thrown against the wall, and is remembered on its side.
    const double margin = step_slack + wall.goes + b.shape->goes + pairs.fastest();
    if (hold.holds) list_at_wall(a, b, hold.side, margin, key, contacts);
}

void ShapeContacts::list_disc(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                              Array<Contact>& contacts) const
{
    const BodyId body = scene.bodies.id_of_slot(pair.partner);
    const DiscShape& shape = *scene.discs.shape_of(pair.partner);
    const PlacedCapsule disc = placed_disc(scene, scene.bodies.row_of(body).row(), shape, dt_);
    if (!may_touch(disc, pairs.capsule(pair.capsule))) return;
    const TouchingBody a{body, disc.axis.from, &disc, {shape.friction, 0, shape.category, shape.mask}};
    list_capsules(a, side_of(scene, pairs, pair.capsule),
                  key_of(Partner::disc, slot_of(scene, pair.capsule), pair.partner, 0), contacts);
}

void ShapeContacts::append_to(Array<Contact>& contacts) const
{
    for (std::int64_t chunk = 0; chunk < chunk_count(); ++chunk) {
        const Array<Contact>& part = listed_[static_cast<std::size_t>(chunk)];
        contacts.insert(contacts.end(), part.begin(), part.end());
    }
}

}  // namespace motley
