// Checks that what was read is a valid scene: the checksum of a file detects accidents, these checks everything else.
#include "scene/scene_archive.h"

#include <cmath>

#include "scene/archive_checks.h"
#include "scene/body_checks.h"
#include "stores/array.h"

namespace motley {
namespace {

template <class Real>
bool are_finite(std::initializer_list<Real> values)
{
    for (const Real value : values) {
        if (!std::isfinite(value)) return false;
    }
    return true;
}

/// Rounding changes a length of 1 by a few units in the last place of a float at most.
bool is_unit(const Quat<PoseReal>& q)
{
    const double length2 = static_cast<double>(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return std::abs(length2 - 1) < 1e-4;
}

void check_lengths(const BodyRows& rows, BodyKind kind)
{
    const std::size_t size = rows.slot.size(), floats = size * 4 * static_cast<std::size_t>(quads_of(kind));
    const bool rigid = kind == BodyKind::rigid, turns = rigid || kind == BodyKind::fixed;
    demand(size > 0 && rows.slot[0] == 0 && rows.velocity.size() == floats &&
               rows.acceleration.size() == floats && rows.pose.size() == size &&
               rows.orientation.size() == (turns ? size : 0) && rows.inertia.size() == (rigid ? size : 0),
           "its rows of bodies differ in length");
}

/// Pose and velocity of a live body. Finite values are enough: steps may exceed the ranges that Scene accepts from a
/// host.
void check_state(const BodyRows& rows, BodyKind kind, std::uint32_t row, BodyModel model, BodyMotion motion)
{
    const BodyPose& pose = rows.pose[row];
    demand(are_finite({pose.position.x, pose.position.y, pose.position.z, pose.yaw}),
           "a body that is nowhere");
    const bool turns = quads_of(kind) == 2;
    if (turns) demand(is_unit(rows.orientation[row]), "an orientation that is none");
    const float* v = &rows.velocity[std::size_t{4} * static_cast<std::size_t>(quads_of(kind)) * row];
    const Vec3<float> linear{v[0], v[1], v[2]},
        angular = turns ? Vec3<float>{v[4], v[5], v[6]} : Vec3<float>{};
    demand(is_finite(linear) && is_finite(angular), "a speed that is none");
    if (motion != BodyMotion::dynamic_body) check_velocity_of(model, motion, &linear, &angular);
}

}  // namespace

void SceneArchive::check_bodies(const SceneCore& scene)
{
    const BodyStore& bodies = scene.bodies;
    const std::size_t slots = bodies.slots_.size();
    demand(slots > 0 && bodies.live_.size() == slots && bodies.models_.size() == slots &&
               bodies.motions_.size() == slots && bodies.contained.size() == slots &&
               bodies.sleep.size() == slots && bodies.slow_for.size() == slots &&
               bodies.inverse_masses.size() == slots && bodies.inverse_inertias.size() == slots &&
               bodies.dampings.size() == slots,
           "its tables of bodies differ in length");
    demand(bodies.live_[0] == 0 && bodies.slots_[0].generation != 0 && bodies.contained[0] == 0 &&
               !bodies.dampings[0].is_any(),
           "a body of the null handle");
    for (int k = 0; k < body_kind_count; ++k) {
        const auto kind = static_cast<BodyKind>(k);
        const BodyRows& rows = bodies.rows(kind);
        check_lengths(rows, kind);
        for (std::uint32_t row = 0; row < rows.slot.size(); ++row) {
            const std::uint32_t slot = rows.slot[row];
            demand(slot == 0 || (slot < slots && bodies.live_[slot] != 0 &&
                                 bodies.slots_[slot].row.bits == BodyRow(kind, row).bits),
                   "a row of no body");
        }
        check_free_list(
            rows.free_rows, rows.slot.size(), [&](std::uint32_t row) { return rows.slot[row] != 0; },
            "a free row that is taken");
    }
    std::size_t alive = 0;
    for (std::uint32_t slot = 1; slot < slots; ++slot) {
        const BodyModel model = bodies.models_[slot];
        const BodyMotion motion = bodies.motions_[slot];
        demand(bodies.live_[slot] <= 1 && bodies.slots_[slot].generation != 0, "a handle of no body");
        demand(model <= BodyModel::rigid && motion <= BodyMotion::static_body, "a body of no model");
        const bool dynamic = motion == BodyMotion::dynamic_body;
        demand(bodies.contained[slot] <= (bodies.live_[slot] != 0 && dynamic ? 1 : 0),
               "a frozen body that cannot move");
        const Damping& damping = bodies.dampings[slot];
        check_damping("BodyDefinition", damping.linear, damping.angular);
        demand(!damping.is_any() || (bodies.live_[slot] != 0 && dynamic), "damping of a body that has none");
        if (bodies.live_[slot] == 0) continue;
        ++alive;
        const BodyRow where = bodies.slots_[slot].row;
        const BodyKind kind = dynamic ? static_cast<BodyKind>(model) : BodyKind::fixed;
        const BodyRows& rows = bodies.rows(where.kind());
        demand(where.kind() == kind && where.row() < rows.slot.size() && rows.slot[where.row()] == slot,
               "a body without a row");
        const float mass = bodies.inverse_masses[slot], moment = bodies.inverse_inertias[slot];
        demand(dynamic ? mass >= 1 / heaviest_body && mass <= 1 / lightest_body : mass == 0,
               "a mass that no body has");
        if (kind == BodyKind::planar)
            demand(moment >= 1 / most_moment && moment <= 1 / least_moment,
                   "a moment of inertia that no body has");
        if (kind == BodyKind::rigid) check_inertia("BodyDefinition", rows.inertia[where.row()]);
        check_state(rows, kind, where.row(), model, motion);
    }
    check_free_list(
        bodies.free_slots_, slots, [&](std::uint32_t slot) { return bodies.live_[slot] != 0; },
        "a free handle that is taken");
    demand(alive == scene.body_count + 1, "bodies that are not counted");
    demand(bodies.is_alive(scene.ground) && bodies.motion(scene.ground) == BodyMotion::static_body,
           "no ground to stand on");
    demand(scene.user_data.size() <= slots, "user data of no body");
    for (std::uint32_t slot = 0; slot < scene.user_data.size(); ++slot)
        demand(bodies.live_[slot] != 0 || scene.user_data[slot] == 0, "user data of no body");
    const Vec3<double> origin = scene.state(scene.ground).position;
    demand(dot(origin, origin) == 0, "a ground that is not at the origin");
}

void SceneArchive::check_joints(const SceneCore& scene)
{
    const BodyStore& bodies = scene.bodies;
    const JointStores& joints = *scene.joints;
    demand(!joints.slots.empty() && joints.slots[0].live == 0, "a joint of the null handle");
    Array<std::uint32_t> colours(bodies.slots_.size(), 0);  // by body, a bit for each colour
    std::size_t count = 0;
    joints.for_each([&](const auto& store, int type) {
        using Store = std::remove_cvref_t<decltype(store)>;
        const std::size_t size = store.definitions.size();
        count += size;
        demand(store.memory.size() == size * quad_floats<typename Store::Memory> &&
                   store.wrenches.size() == size * Store::wrench_floats && store.colours.size() == size &&
                   store.slots.size() == size,
               "its lists of joints differ in length");
        for (std::size_t i = 0; i < size; ++i) {
            const auto& definition = store.definitions[i];
            Store::Type::validate(definition, scene.check_joint_bodies(definition.body_a, definition.body_b));
            const std::uint32_t slot = store.slots[i];
            demand(slot > 0 && slot < joints.slots.size() && joints.slots[slot].live == 1 &&
                       joints.slots[slot].type == type && joints.slots[slot].index == i,
                   "a joint without a handle");
            const std::uint8_t colour = store.colours[i];
            demand(colour <= overflow_colour || colour == no_colour, "a joint of no colour");
            if (colour >= overflow_colour) continue;
            for (const BodyId body : {definition.body_a, definition.body_b}) {
                if (bodies.row_of(body).kind() == BodyKind::fixed) continue;
                demand((colours[body.slot] >> colour & 1) == 0, "two joints of one colour on a body");
                colours[body.slot] |= 1U << colour;
            }
        }
    });
    std::size_t alive = 0, watched = 0;
    for (const JointStores::Slot& slot : joints.slots) {
        demand(slot.live <= 1 && slot.watched <= 1, "a handle of no joint");
        if (slot.live == 0) continue;
        ++alive;
        watched += slot.watched;
        SceneCore::check_wish("iterations", slot.iterations);
        SceneCore::check_break_limit(slot.break_limit);
    }
    demand(alive == count, "a handle of no joint");
    check_free_list(
        joints.free_slots, joints.slots.size(),
        [&](std::uint32_t slot) { return joints.slots[slot].live != 0; }, "a free joint that is taken");
    for (const ConstraintId id : joints.watched) {
        if (scene.is_alive(id)) watched -= joints.slots[id.slot].watched;
    }
    demand(watched == 0, "a watch on no joint");
}

/// Each sleeper is the next one of one sleeper, so that islands are rings.
void SceneArchive::check_sleep(const SceneCore& scene)
{
    const BodyStore& bodies = scene.bodies;
    const auto sleeps = [&](std::uint32_t slot) {
        return bodies.sleep[slot] != Sleep::awake && bodies.motions_[slot] == BodyMotion::dynamic_body;
    };
    Array<std::uint8_t> is_next(bodies.slots_.size(), 0);
    for (std::uint32_t slot = 0; slot < bodies.slots_.size(); ++slot) {
        const Sleep sleep = bodies.sleep[slot];
        demand(sleep <= Sleep::roused, "a body that neither sleeps nor is awake");
        demand(bodies.slow_for[slot] >= 0, "a body that is slow since the future");
        if (sleep == Sleep::awake) continue;
        demand(bodies.live_[slot] != 0 && bodies.contained[slot] == 0 &&
                   (sleep == Sleep::roused || sleeps(slot)),
               "a sleeper that cannot sleep");
        if (!sleeps(slot)) continue;
        demand(slot < scene.sleep.sleepers.size(), "a sleeper without an island");
        const std::uint32_t next = scene.sleep.sleepers[slot].next;
        demand(next < bodies.slots_.size() && bodies.live_[next] != 0 && sleeps(next) && is_next[next] == 0,
               "a sleeper whose island is no ring");
        is_next[next] = 1;
    }
    demand(scene.sleep.speed >= 0 && is_finite(scene.sleep.gravity) && scene.sleep.pause >= 0,
           "sleep out of range");
    const ContactList& list = scene.contacts.current();
    for (std::size_t i = 0; list.has_sleepers && i < list.count; ++i)
        demand(list.sleepers[i] < bodies.slots_.size(), "a contact of a sleeper that is no body");
}

void SceneArchive::check(const SceneCore& scene)
{
    check_bodies(scene);
    check_joints(scene);
    check_sleep(scene);
    check_discs(scene);
    check_capsules(scene);
    for (const IslandIterations& asked : scene.island_iterations) scene.check_island_wish(asked);
    const ContactList& list = scene.contacts.current();
    for (std::size_t i = 0; i < list.count; ++i)
        demand(list.colours[i] <= overflow_colour || list.colours[i] == no_colour, "a contact of no colour");
    demand(scene.last_substep >= 0 && scene.last_substep <= scene.last_step && scene.last_step <= 1,
           "a step of no length");
}

void SceneArchive::derive(SceneCore& scene)
{
    BodyStore& bodies = scene.bodies;
    JointStores& joints = *scene.joints;
    bodies.derive();
    scene.discs.derive();
    bodies.first_ends.assign(bodies.slots_.size(), 0);
    joints.ends.assign(2 * joints.slots.size(), {});
    joints.for_each([&](auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        store.parameters.assign(store.size() * quad_floats<typename Store::Parameters>, 0);
        store.world_points.assign(Store::has_world_points ? store.size() : 0, {});
        for (std::size_t i = 0; i < store.size(); ++i) {
            store.define(i, store.definitions[i]);
            const std::uint32_t slot = store.slots[i];
            joints.link(2 * slot, bodies.first_ends[store.definitions[i].body_a.slot]);
            joints.link(2 * slot + 1, bodies.first_ends[store.definitions[i].body_b.slot]);
        }
    });
    joints.with_iterations = 0;
    for (const JointStores::Slot& slot : joints.slots)
        joints.with_iterations += slot.live != 0 && slot.iterations != 0 ? 1 : 0;
}

}  // namespace motley
