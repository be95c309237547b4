// See shape_pairs.h.
#include "shapes/shape_pairs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "crowd/disc_strips.h"
#include "motley/core/invalid_input.h"
#include "queries/line_of_sight.h"
#include "queries/radix_sort.h"
#include "scene/wall_ends.h"
#include "stores/array.h"
#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

double distance(const Vec3<double>& p, const Vec3<double>& q)
{
    return std::sqrt(dot(p - q, p - q));
}

double distance(const Vec2<double>& p, const Vec2<double>& q)
{
    return std::sqrt(dot(p - q, p - q));
}

/// How far two axes are apart.
double distance(const Axis& a, const Axis& b)
{
    const AxisPlaces places = nearest_places(a, b);
    return distance(a.at(places.on_a), b.at(places.on_b));
}

/// The skin of what goes so far within a step: enough for some steps.
double skin_of(double goes)
{
    constexpr double least = 0.06, steps_ahead = 4;  // m; steps
    return least + steps_ahead * goes;
}

constexpr std::uint64_t joined_key(std::uint32_t slot_a, std::uint32_t slot_b)
{
    return std::uint64_t{std::min(slot_a, slot_b)} << 32 | std::max(slot_a, slot_b);
}

}  // namespace

void ShapePairs::open(const SceneCore& scene, double dt)
{
    dt_ = dt;
    count_ = scene.shapes.capsules.size();
    disc_rows_ = scene.discs.is_in_use() ? scene.bodies.rows(BodyKind::planar).size() : 0;
    resize_with_room(placed_, count_);
    resize_with_room(found_, static_cast<std::size_t>(std::max(chunk_count(), disc_chunk_count())));
    find_wall_ends(scene, wall_ends_);
    walls_go_ = dt * fastest_wall_end(scene);
}

std::int64_t ShapePairs::chunk_count() const
{
    return (static_cast<std::int64_t>(count_) + capsules_a_chunk - 1) / capsules_a_chunk;
}

std::int64_t ShapePairs::disc_chunk_count() const
{
    return disc_chunks(static_cast<std::uint32_t>(disc_rows_));
}

bool ShapePairs::leaves(const PlacedCapsule& placed, const Anchor& anchor)
{
    const double went =
        std::max(distance(placed.axis.from, anchor.from), distance(placed.axis.at(1), anchor.to));
    return !(went + placed.goes + step_slack <= anchor.skin);
}

void ShapePairs::place(const SceneCore& scene, std::int64_t chunk)
{
    const auto first = static_cast<std::size_t>(chunk * capsules_a_chunk);
    const std::size_t last = std::min(count_, first + static_cast<std::size_t>(capsules_a_chunk));
    bool any_leaves = anchors_.size() < last;
    double fastest = 0;
    for (std::size_t i = first; i < last; ++i) {
        placed_[i] = placed(scene, scene.shapes.capsules[i], dt_);
        fastest = std::max(fastest, placed_[i].goes);
        any_leaves = any_leaves || leaves(placed_[i], anchors_[i]);
    }
    found_[static_cast<std::size_t>(chunk)].leaves = any_leaves;
    found_[static_cast<std::size_t>(chunk)].fastest = fastest;
}

void ShapePairs::place_discs(const SceneCore& scene, std::int64_t chunk)
{
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    bool any_leaves = std::min(disc_anchors_.size(), disc_slots_.size()) < disc_rows_;
    double fastest = 0;
    for_each_row_of_chunk(chunk, static_cast<std::uint32_t>(disc_rows_), [&](std::uint32_t row) {
        const double goes = dt_ * speed_of(&planar.velocity[std::size_t{4} * row]);
        fastest = std::max(fastest, goes);
        if (any_leaves) return;
        const DiscAnchor& anchor = disc_anchors_[row];
        any_leaves = disc_slots_[row] != planar.slot[row];
        if (any_leaves || anchor.skin < 0) return;
        any_leaves =
            !(distance(in_plane(planar.pose[row].position), anchor.at) + goes + step_slack <= anchor.skin);
    });
    found_[static_cast<std::size_t>(chunk)].discs_leave = any_leaves;
    found_[static_cast<std::size_t>(chunk)].fastest_disc = fastest;
}

void ShapePairs::find_fastest()
{
    fastest_ = walls_go_;
    for (std::int64_t chunk = 0; chunk < chunk_count(); ++chunk)
        fastest_ = std::max(fastest_, found_[static_cast<std::size_t>(chunk)].fastest);
    for (std::int64_t chunk = 0; chunk < disc_chunk_count(); ++chunk)
        fastest_ = std::max(fastest_, found_[static_cast<std::size_t>(chunk)].fastest_disc);
}

bool ShapePairs::are_current(const SceneCore& scene) const
{
    const std::shared_ptr<const char>& joints = scene.joints->version;
    if (!shape_version_ || shape_version_ != scene.shapes.version) return false;
    if (!joint_version_ || joint_version_ != joints) return false;
    for (std::int64_t chunk = 0; chunk < chunk_count(); ++chunk) {
        if (found_[static_cast<std::size_t>(chunk)].leaves) return false;
    }
    for (std::int64_t chunk = 0; chunk < disc_chunk_count(); ++chunk) {
        if (found_[static_cast<std::size_t>(chunk)].discs_leave) return false;
    }
    if (!wall_ends_.empty() && !(fastest_ <= blow_skin_)) return false;
    for (std::size_t end = 0; end < wall_ends_.size(); ++end) {
        if (!(distance(wall_ends_[end], wall_anchors_[end]) + walls_go_ + step_slack <= wall_skin_))
            return false;
    }
    return true;
}

Box ShapePairs::box_of(std::uint32_t capsule) const
{
    const PlacedCapsule& placed = placed_[capsule];
    const Vec2<double> from = in_tree(placed.axis.from), to = in_tree(placed.axis.at(1));
    const double reach = placed.radius + anchors_[capsule].skin;
    return {{std::min(from.x, to.x) - reach, std::min(from.y, to.y) - reach},
            {std::max(from.x, to.x) + reach, std::max(from.y, to.y) + reach},
            0};
}

void ShapePairs::choose_plane()
{
    plane_ = {Vec3<double>{1, 0, 0}, Vec3<double>{0, 1, 0}};
    if (!wall_ends_.empty() || disc_rows_ > 0) return;
    Vec3<double> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (const PlacedCapsule& placed : placed_) {
        if (placed.is_flat) return;
        const Vec3<double>& at = placed.axis.from;
        low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
    }
    const Vec3<double> spread = high - low;
    if (spread.x <= spread.y && spread.x < spread.z) {
        plane_[0] = {0, 0, 1};
    } else if (spread.y < spread.z) {
        plane_[1] = {0, 0, 1};
    }
}

void ShapePairs::begin(const SceneCore& scene)
{
    shape_version_.reset();  // should memory run out on the way, the next step finds pairs again
    found_in_all_.store(0, std::memory_order_relaxed);
    resize_with_room(anchors_, count_);
    resize_with_room(centres_, count_);
    for (std::size_t i = 0; i < count_; ++i) {
        const Axis& axis = placed_[i].axis;
        anchors_[i] = {axis.from, axis.at(1), skin_of(placed_[i].goes)};
    }
    choose_plane();
    for (std::size_t i = 0; i < count_; ++i) centres_[i] = in_tree(placed_[i].axis.at(0.5));
    order_.make_room(centres_.capacity());
    tree_.make_room(centres_.capacity());
    order_.find({centres_.data(), count_, sizeof centres_[0]});
    tree_.build(static_cast<std::uint32_t>(count_), [&](std::uint32_t i) { return box_of(order_[i]); });
    resize_with_room(disc_anchors_, disc_rows_);
    resize_with_room(disc_slots_, disc_rows_);
    wall_anchors_ = wall_ends_;
    wall_skin_ = skin_of(walls_go_);
    blow_skin_ = skin_of(fastest_);
    list_joined(scene);
}

void ShapePairs::list_joined(const SceneCore& scene)
{
    if (joint_version_ && joint_version_ == scene.joints->version) return;
    joined_.clear();
    scene.joints->for_each([&](const auto& store, int) {
        for (const auto& joint : store.definitions)
            joined_.push_back(joined_key(joint.body_a.slot, joint.body_b.slot));
    });
    std::sort(joined_.begin(), joined_.end());
}

void ShapePairs::anchor_discs(const SceneCore& scene, std::int64_t chunk)
{
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    for_each_row_of_chunk(chunk, static_cast<std::uint32_t>(disc_rows_), [&](std::uint32_t row) {
        const std::uint32_t slot = planar.slot[row];
        disc_slots_[row] = slot;
        disc_anchors_[row].skin = -1;
        if (slot == 0 || scene.discs.shape_of(slot) == nullptr) return;
        const double goes = dt_ * speed_of(&planar.velocity[std::size_t{4} * row]);
        disc_anchors_[row] = {in_plane(planar.pose[row].position), skin_of(goes)};
    });
}

template <class Work>
void ShapePairs::for_each_near(const Box& box, const Work& work) const
{
    const auto judge = [&](const Box& other, std::uint32_t) {
        const bool apart = other.low.x > box.high.x || other.high.x < box.low.x || other.low.y > box.high.y ||
                           other.high.y < box.low.y;
        return apart ? BoxShare::none : BoxShare::some;
    };
    tree_.visit(judge, [&](std::uint32_t first, std::uint32_t last, bool) {
        for (std::uint32_t place = first; place < last; ++place) work(place);
        return true;
    });
}

bool ShapePairs::are_joined(BodyId a, BodyId b) const
{
    return std::binary_search(joined_.begin(), joined_.end(), joined_key(a.slot, b.slot));
}

bool ShapePairs::may_meet(const SceneCore& scene, std::uint32_t a, std::uint32_t b) const
{
    const Capsule &one = scene.shapes.capsules[a], &other = scene.shapes.capsules[b];
    if (one.body == other.body || (one.group != 0 && one.group == other.group)) return false;
    if (!placed_[a].can_move && !placed_[b].can_move) return false;
    return do_meet(one.surface, other.surface);
}

/// The pairs of capsules at places `first` to `last` - 1 of the order with those behind them. They are near each other, so
/// that one visit to the tree serves all.
void ShapePairs::find_capsules(const SceneCore& scene, std::size_t first, std::size_t last,
                               Found& found) const
{
    Box box;
    for (std::size_t i = first; i < last; ++i) box.include(box_of(order_[i]));
    found.near.clear();
    for_each_near(box, [&](std::uint32_t place) {
        if (place > first) found.near.push_back(place);
    });
    for (std::size_t i = first; i < last; ++i) {
        const std::uint32_t capsule = order_[i];
        const PlacedCapsule& own = placed_[capsule];
        const double reach = own.radius + anchors_[capsule].skin;
        for (const std::uint32_t place : found.near) {
            if (place <= i) continue;  // the other one finds it
            const std::uint32_t other = order_[place];
            const PlacedCapsule& near = placed_[other];
            const double within = reach + near.radius + anchors_[other].skin;
            if (!may_be_within(own, near, within) || !may_meet(scene, capsule, other)) continue;
            if (!are_joined(scene.shapes.capsules[capsule].body, scene.shapes.capsules[other].body))
                found.capsules.push_back({std::min(capsule, other), std::max(capsule, other)});
        }
    }
}

bool ShapePairs::are_too_many(std::size_t before, const Array<ShapePair>& pairs)
{
    const auto more = static_cast<std::int64_t>(pairs.size() - before);
    return found_in_all_.fetch_add(more, std::memory_order_relaxed) + more > most_pairs();
}

void ShapePairs::find_discs(const SceneCore& scene, std::int64_t chunk, Found& found)
{
    bool stops = false;
    for_each_row_of_chunk(chunk, static_cast<std::uint32_t>(disc_rows_), [&](std::uint32_t row) {
        const DiscAnchor& anchor = disc_anchors_[row];
        if (anchor.skin < 0 || stops) return;
        const std::size_t before = found.discs.size();
        const std::uint32_t slot = disc_slots_[row];
        const DiscShape& disc = *scene.discs.shape_of(slot);
        const PlacedCapsule own = placed_disc(scene, row, disc, dt_);
        const double reach = own.radius + anchor.skin;
        const Vec2<double> wide{reach, reach};
        for_each_near({anchor.at - wide, anchor.at + wide, 0}, [&](std::uint32_t place) {
            const std::uint32_t capsule = order_[place];
            const Capsule& other = scene.shapes.capsules[capsule];
            const PlacedCapsule& near = placed_[capsule];
            if (!may_be_within(own, near, reach + near.radius + anchors_[capsule].skin)) return;
            if (other.body.slot == slot || !do_meet(disc, other.surface)) return;
            if (are_joined(scene.bodies.id_of_slot(slot), other.body)) return;
            found.discs.push_back({capsule, slot});
        });
        stops = are_too_many(before, found.discs);
    });
}

/// Walls are few; a chunk looks only at its own share of them.
void ShapePairs::find_walls(const SceneCore& scene, std::int64_t chunk, Found& found)
{
    const auto chunks = static_cast<std::size_t>(chunk_count());
    for (auto i = static_cast<std::size_t>(chunk); i < scene.discs.segments.size(); i += chunks) {
        const WallSegment& segment = scene.discs.segments[i];
        const Vec2<double> from = wall_ends_[2 * i], to = wall_ends_[2 * i + 1];
        const Axis axis{{from.x, from.y, 0}, {to.x - from.x, to.y - from.y, 0}};
        const double skin = wall_skin_ + blow_skin_;
        const LineOfSight line{from, to};
        const std::size_t before = found.walls.size();
        const auto judge = [&](const Box& box, std::uint32_t) {
            const Vec2<double> wide{skin, skin};
            return line.enters({box.low - wide, box.high + wide, 0}) < no_meeting ? BoxShare::some
                                                                                  : BoxShare::none;
        };
        tree_.visit(judge, [&](std::uint32_t first, std::uint32_t last, bool) {
            for (std::uint32_t k = first; k < last; ++k) {
                const std::uint32_t capsule = order_[k];
                const PlacedCapsule& near = placed_[capsule];
                const Capsule& own = scene.shapes.capsules[capsule];
                if (!near.can_move || !do_meet(own.surface, segment)) continue;
                if (distance(flattened(near.axis), axis) > near.radius + anchors_[capsule].skin + skin)
                    continue;
                found.walls.push_back({capsule, static_cast<std::uint32_t>(i)});
            }
            return true;
        });
        if (are_too_many(before, found.walls)) return;
    }
}

void ShapePairs::find(const SceneCore& scene, std::int64_t chunk)
{
    Found& found = found_[static_cast<std::size_t>(chunk)];
    found.capsules.clear();
    found.walls.clear();
    found.discs.clear();
    const auto begin = static_cast<std::size_t>(chunk * capsules_a_chunk);
    const std::size_t end = std::min(count_, begin + static_cast<std::size_t>(capsules_a_chunk));
    constexpr std::size_t at_once = 8;
    for (std::size_t first = begin; first < end; first += at_once) {
        const std::size_t before = found.capsules.size();
        find_capsules(scene, first, std::min(end, first + at_once), found);
        if (are_too_many(before, found.capsules)) return;
    }
    if (chunk < chunk_count()) find_walls(scene, chunk, found);
    if (chunk < disc_chunk_count()) find_discs(scene, chunk, found);
    for (Array<ShapePair>* pairs : {&found.capsules, &found.walls, &found.discs}) keep_room(*pairs);
    keep_room(found.near);
}

void ShapePairs::sort(Array<ShapePair>& pairs)
{
    grow_to(spare_, pairs.size());
    radix_sort(std::span(pairs), std::span(spare_), [](const ShapePair& pair) { return pair.order(); });
}

void ShapePairs::collect(SceneCore& scene)
{
    if (found_in_all_.load(std::memory_order_relaxed) > most_pairs())
        refuse("pairs of " + std::to_string(count_) + " capsules that may touch",
               "more than " + std::to_string(most_pairs()), "fewer: capsules that are not all in one place");
    capsules_.clear();
    walls_.clear();
    discs_.clear();
    const auto append = [](Array<ShapePair>& all, const Array<ShapePair>& part) {
        all.insert(all.end(), part.begin(), part.end());
    };
    for (const Found& found : found_) {
        append(capsules_, found.capsules);
        append(walls_, found.walls);
        append(discs_, found.discs);
    }
    for (Array<ShapePair>* pairs : {&capsules_, &walls_, &discs_}) {
        sort(*pairs);
        keep_room(*pairs);
    }
    if (!scene.shapes.version) scene.shapes.version = std::make_shared<const char>('\0');
    shape_version_ = scene.shapes.version;
    joint_version_ = scene.joints->version;
}

}  // namespace motley
