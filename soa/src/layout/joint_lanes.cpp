// Follows changes joint by joint: first those that have gone give their lanes and colours back, then those that have come
// get theirs, and at last the small components that have changed are looked at as figures and as free groups.
#include "layout/joint_lanes.h"

#include <algorithm>

#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// Of the list of joints on a body. A row that is free now has none.
std::uint32_t first_end_of(const BodyStore& bodies, BodyRow body)
{
    return bodies.first_ends[bodies.rows(body.kind()).slot[body.row()]];
}

}  // namespace

bool JointLanes::follow(SceneCore& scene, ColourMasks& masks)
{
    const BodyStore& bodies = scene.bodies;
    if (bodies.contained_count > 0 || batches_.has_overflow() || figures_.refused().joints > 0) return false;
    look_at(*scene.joints);
    masks.grow(bodies);
    intake_.grow(bodies);
    grow_to(places_, joints_->slots.size());
    for (std::size_t kind = 0; kind < body_kind_count; ++kind)
        grow_to(sizes_[kind], bodies.rows(static_cast<BodyKind>(kind)).size());
    note_changes(scene);
    if (!take_figures_apart()) return false;
    drop_gone();
    for (const Change& change : changes_) {
        renew_mask(bodies, change.a, masks);
        renew_mask(bodies, change.b, masks);
    }
    return place_new(masks) && find_components(scene) && figures_.are_full_enough();
}

JointLanes::Place& JointLanes::place_of(int type, std::int32_t constraint)
{
    return places_[constraint < 0 ? static_cast<std::uint32_t>(~constraint)
                                  : columns_.slot_of(type, constraint)];
}

void JointLanes::look_at(JointStores& joints)
{
    joints_ = &joints;
    columns_ = JointColumns(joints);
}

void JointLanes::start_over(JointStores& joints)
{
    look_at(joints);
    places_.clear();
    places_.resize(joints_->slots.size());
    for (Array<Size>& sizes : sizes_) sizes.clear();
    small_.clear();
    batches_.for_each_block([&](int constraint_class, std::uint8_t colour, std::int32_t block,
                                const BlockBodies&, const BlockConstraints& constraints, int lanes) {
        for (int lane = 0; lane < lanes; ++lane) {
            const std::uint32_t slot = columns_.slot_of(type_of(constraint_class), constraints.lane[lane]);
            places_[slot] = {joints.slots[slot].generation,
                             {constraint_class, block, static_cast<std::uint8_t>(lane), colour}};
        }
    });
}

/// Sorts the changes: joints that have moved in their store get their new index, those that are gone are marked in their
/// lanes, by the bitwise complement of their slot, and those that have come are listed in the order in which they get colours.
/// Joints of bodies that have fallen asleep are gone, and come when these wake.
void JointLanes::note_changes(const SceneCore& scene)
{
    gone_.clear();
    come_.clear();
    changes_.clear();
    Array<std::uint32_t>& slots = joints_->changes.slots;
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    for (const std::uint32_t slot : slots) {
        const JointStores::Slot& joint = joints_->slots[slot];
        Place& place = places_[slot];
        Placement now;
        if (joint.live != 0) now = JointIntake::candidate(scene, joint.type, joint.index).placement;
        const bool is_solved =
            joint.live != 0 && !scene.bodies.is_asleep(now.a) && !scene.bodies.is_asleep(now.b);
        if (place.is_in_lane() && is_solved && joint.generation == place.generation) {
            batches_.set_constraint(place.lane, static_cast<std::int32_t>(joint.index));
            continue;
        }
        if (place.is_in_lane()) {
            const Placement was = batches_.placement_in(place.lane);
            touch(was);
            batches_.set_constraint(place.lane, static_cast<std::int32_t>(~slot));
            gone_.push_back(slot);
        }
        if (!is_solved) continue;
        come_.push_back(now);
        place.generation = joint.generation;
        place.is_new = true;
        touch(now);
    }
    std::sort(come_.begin(), come_.end(), [&](const Placement& x, const Placement& y) {
        return columns_.order_of(x) < columns_.order_of(y);
    });
}

void JointLanes::touch(const Placement& joint)
{
    // What comes in the place of what is gone is often between the same bodies.
    const Change change{joint.a, joint.b};
    if (changes_.empty() || !(changes_.back() == change)) changes_.push_back(change);
}

bool JointLanes::take_figures_apart()
{
    const auto take_apart = [&](BodyRow body) {
        const Figures::Copy copy = figures_.copy_of(body);
        return copy.block == Figures::none || figures_.take_apart(copy, *this);
    };
    return std::all_of(changes_.begin(), changes_.end(),
                       [&](const Change& change) { return take_apart(change.a) && take_apart(change.b); });
}

bool JointLanes::sweep(const BatchSet::Lane& lane)
{
    const Placement joint = batches_.placement_in(lane);
    if (joint.constraint < 0) {  // gone
        place_of(joint.type, joint.constraint).lane = {};
        return true;
    }
    return add(joint);
}

bool JointLanes::add(const Placement& joint)
{
    const int constraint_class = class_of(joint.type, joint.a.kind(), joint.b.kind());
    const std::optional<BatchSet::Lane> lane = batches_.take_free_lane(constraint_class, joint.colour);
    if (!lane) return false;
    batches_.put(*lane, joint);
    place_of(joint.type, joint.constraint).lane = *lane;
    return true;
}

void JointLanes::solve_in_copy(const Placement& joint, const BatchSet::Lane& lane)
{
    batches_.put(lane, joint);
    leave(std::exchange(place_of(joint.type, joint.constraint).lane, lane));
}

void JointLanes::move(const BatchSet::Lane& from, const BatchSet::Lane& to)
{
    const Placement joint = batches_.placement_in(from);
    batches_.put(to, joint);
    place_of(joint.type, joint.constraint).lane = to;
}

/// Closes the gap among the joints of a class and colour that are swept.
void JointLanes::leave(const BatchSet::Lane& lane)
{
    const BatchSet::Lane last = batches_.give_last_back(lane.constraint_class, lane.colour);
    if (last != lane) move(last, lane);
    batches_.end_block_at(last);
}

void JointLanes::drop_gone()
{
    for (const std::uint32_t slot : gone_) {
        const BatchSet::Lane lane = std::exchange(places_[slot].lane, {});
        if (lane != BatchSet::Lane{}) leave(lane);
    }
}

/// A moving body keeps only the colours of the joints that it still has, also those of joints that are not solved now because
/// the body sleeps.
void JointLanes::renew_mask(const BodyStore& bodies, BodyRow body, ColourMasks& masks)
{
    if (body.kind() == BodyKind::fixed) return;
    std::uint32_t mask = 0;
    bool is_jointed = false;
    joints_->for_each_on(first_end_of(bodies, body), [&](const JointStores::Slot& joint) {
        const int type = contact_type_count + joint.type;
        const std::uint8_t colour = columns_.colour_of(type, static_cast<std::int32_t>(joint.index));
        if (colour != no_colour) mask |= 1U << colour;
        if (!place_of(joint).is_in_lane()) return;
        mask |= JointIntake::start_rows_bit_of(static_cast<std::size_t>(type));
        is_jointed = true;
    });
    masks.set(body, mask);
    intake_.note(body, is_jointed);
}

bool JointLanes::place_new(ColourMasks& masks)
{
    for (Placement& joint : come_) {
        if (joint.colour == no_colour) columns_.give_colour(joint, masks);  // else it slept
        if (joint.colour == overflow_colour || !add(joint)) return false;
        if (JointIntake::start_rows_bit_of(joint.type) != 0) masks.note_start_rows(joint.a, joint.b);
        for (const BodyRow body : {joint.a, joint.b}) intake_.note(body, true);
    }
    return true;
}

/// Whether the joints that have stayed lead from one body to the other by a short way, sought from both ends in turn. No way leads
/// over a fixed body.
bool JointLanes::are_connected(const BodyStore& bodies, BodyRow from, BodyRow to)
{
    if (to.kind() == BodyKind::fixed) return false;
    reached_[0].assign(1, from);
    reached_[1].assign(1, to);
    const auto has = [&](std::size_t end, BodyRow body) {
        return std::find(reached_[end].begin(), reached_[end].end(), body) != reached_[end].end();
    };
    for (std::size_t i = 0; reached_[0].size() + reached_[1].size() <= Figures::most_bodies; ++i) {
        const std::size_t end = i % 2;
        if (i / 2 == reached_[end].size()) return false;  // it is connected to no others
        const BodyRow body = reached_[end][i / 2];
        bool found = false;
        const auto reach = [&](BodyRow other) {
            if (other.kind() == BodyKind::fixed) return;
            found = found || has(1 - end, other);
            if (!has(end, other)) reached_[end].push_back(other);
        };
        joints_->for_each_on(first_end_of(bodies, body), [&](const JointStores::Slot& entry) {
            const Place& place = place_of(entry);
            if (place.is_new || !place.is_in_lane()) return;
            const Placement joint = batches_.placement_in(place.lane);
            reach(joint.a);
            reach(joint.b);
        });
        if (found) return true;
    }
    return false;
}

/// Finds the components of the bodies whose joints have changed. The small ones may be figures, and their bodies are new
/// groups. Returns false if a large one may have lost or won bodies, or may be solved exactly now.
bool JointLanes::find_components(const SceneCore& scene)
{
    for (std::size_t i = changes_.size(); i-- > 0;) {  // see put_together()
        const Change& change = changes_[i];
        for (const BodyRow body : {change.a, change.b}) {
            if (body.kind() == BodyKind::fixed || size_of(body) == Size::small) continue;
            if (size_of(body) == Size::unknown && gather(scene, body)) {
                for (const BodyRow member : component_.bodies) groups_.dissolve(member);
                groups_.add(component_.bodies, component_.joints);
                if (!component_.joints.empty() &&
                    !figures_.put_together(component_.joints, scene.bodies, kernels_, *this))
                    return false;
                continue;
            }
            if (!are_connected(scene.bodies, body, body == change.a ? change.b : change.a) ||
                !figures_.lose_a_loop())
                return false;
            break;
        }
    }
    for (const BodyRow body : small_) size_of(body) = Size::unknown;
    small_.clear();
    for (const Placement& joint : come_) place_of(joint.type, joint.constraint).is_new = false;
    return true;
}

/// Lists a component, beginning at one of its bodies. Returns false if it is too large for a figure.
bool JointLanes::gather(const SceneCore& scene, BodyRow from)
{
    Array<BodyRow>& bodies = component_.bodies;
    Array<JointCandidate>& joints = component_.joints;
    bodies.clear();
    joints.clear();
    const auto see = [&](BodyRow body) {
        if (body.kind() == BodyKind::fixed || size_of(body) == Size::small) return;
        size_of(body) = Size::small;
        bodies.push_back(body);
    };
    see(from);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow body = bodies[i];
        joints_->for_each_on(first_end_of(scene.bodies, body), [&](const JointStores::Slot& entry) {
            if (!place_of(entry).is_in_lane()) return;  // it sleeps
            const JointCandidate joint = JointIntake::candidate(scene, entry.type, entry.index);
            const BodyRow a = joint.placement.a, b = joint.placement.b;
            see(a);
            see(b);
            // A joint is on the lists of both bodies.
            if (body == a || a.kind() == BodyKind::fixed) joints.push_back(joint);
        });
        if (bodies.size() <= Figures::most_bodies) continue;
        for (const BodyRow large : bodies) size_of(large) = Size::large;
        return false;
    }
    small_.insert(small_.end(), bodies.begin(), bodies.end());
    return true;
}

}  // namespace motley
