// The scene's door: everything that comes in is checked here, and nothing is changed before all of it is.
#include "motley/core/scene.h"

#include <cmath>
#include <limits>

#include "motley/core/invalid_input.h"

namespace motley {
namespace {

constexpr float largest_speed = 1e9F;
constexpr double largest_position = 1e12;

bool is_finite(const Vec3<float>& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check(const char* field, double value, double low, double high, const char* expected)
{
    if (!(value >= low && value <= high)) refuse(field, value, expected);  // NaN fails too
}

void check_position(const char* who, const Vec3<double>& p)
{
    const std::string name(who);
    const char* expected = "a finite value from -1e12 to 1e12 (m)";
    check((name + ".x").c_str(), p.x, -largest_position, largest_position, expected);
    check((name + ".y").c_str(), p.y, -largest_position, largest_position, expected);
    check((name + ".z").c_str(), p.z, -largest_position, largest_position, expected);
}

void check_vector(const char* who, const Vec3<float>& v, float limit, const char* expected)
{
    const std::string name(who);
    check((name + ".x").c_str(), v.x, -limit, limit, expected);
    check((name + ".y").c_str(), v.y, -limit, limit, expected);
    check((name + ".z").c_str(), v.z, -limit, limit, expected);
}

/// The components that a body does not have must be zero: a silent loss would be a wrong answer.
void check_velocity_of(BodyModel model, BodyMotion motion, const Vec3<float>* linear,
                       const Vec3<float>* angular)
{
    if (motion == BodyMotion::static_body) {
        if (linear) check_vector("linear_velocity", *linear, 0, "0 of a static body (m/s)");
        if (angular) check_vector("angular_velocity", *angular, 0, "0 of a static body (rad/s)");
        return;
    }
    if (linear)
        check_vector("linear_velocity", *linear, largest_speed, "a finite value from -1e9 to 1e9 (m/s)");
    if (angular)
        check_vector("angular_velocity", *angular, largest_speed, "a finite value from -1e9 to 1e9 (rad/s)");
    if (motion == BodyMotion::kinematic_body) return;
    if (model == BodyModel::planar) {
        if (linear) check("linear_velocity.z", linear->z, 0, 0, "0 of a planar body (m/s)");
        if (angular) check("angular_velocity.x", angular->x, 0, 0, "0 of a planar body (rad/s)");
        if (angular) check("angular_velocity.y", angular->y, 0, 0, "0 of a planar body (rad/s)");
    } else if (model == BodyModel::particle && angular) {
        check_vector("angular_velocity", *angular, 0, "0 of a particle (rad/s)");
    }
}

/// Principal moments are the eigenvalues; a real body's obey A + B >= C, that is 2 |m| <= trace in every
/// direction. Checked through tr(m)/2 I - m being positive semi-definite, which needs no eigenvalues.
void check_inertia(const Sym3<float>& inertia)
{
    const double xx = inertia.xx, xy = inertia.xy, xz = inertia.xz, yy = inertia.yy, yz = inertia.yz,
                 zz = inertia.zz;
    const double sum = xx + xy + xz + yy + yz + zz;
    if (!std::isfinite(sum)) refuse("BodyDefinition.inertia", sum, "finite components (kg m2)");
    check("BodyDefinition.inertia.xx", xx, 1e-20, 1e20, "1e-20 to 1e20 (kg m2)");
    check("BodyDefinition.inertia.yy", yy, 1e-20, 1e20, "1e-20 to 1e20 (kg m2)");
    check("BodyDefinition.inertia.zz", zz, 1e-20, 1e20, "1e-20 to 1e20 (kg m2)");
    const double trace = xx + yy + zz;
    const double minor = xx * yy - xy * xy;
    const double full = determinant(Sym3<double>{xx, xy, xz, yy, yz, zz});
    if (!(minor > 0) || !(full > 0)) {
        refuse("BodyDefinition.inertia", full, "a positive definite tensor (determinant above 0)");
    }
    const double half = trace / 2 * (1 + 1e-5);  // a thin rod sits on the edge; leave room for float rounding
    const Sym3<double> rest{half - xx, -xy, -xz, half - yy, -yz, half - zz};
    const double scale = trace * trace * trace;
    const double edge = -1e-12;
    if (rest.xx < edge * trace || rest.yy < edge * trace || rest.zz < edge * trace ||
        rest.xx * rest.yy - rest.xy * rest.xy < edge * trace * trace || determinant(rest) < edge * scale) {
        refuse("BodyDefinition.inertia", trace, "moments that obey the triangle inequality A + B >= C");
    }
}

void check_definition(const BodyDefinition& d)
{
    if (d.model > BodyModel::rigid) {
        refuse("BodyDefinition.model", static_cast<double>(d.model), "particle, planar or rigid");
    }
    if (d.motion > BodyMotion::static_body) {
        refuse("BodyDefinition.motion", static_cast<double>(d.motion),
               "dynamic_body, kinematic_body or static_body");
    }
    check_position("BodyDefinition.position", d.position);
    check("BodyDefinition.yaw", d.yaw, -1e9, 1e9, "a finite value from -1e9 to 1e9 (rad)");
    const bool fixed = d.motion != BodyMotion::dynamic_body;
    const Quat<double>& q = d.orientation;
    const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (fixed || d.model == BodyModel::rigid) {
        check("BodyDefinition.orientation", length2, 1e-12, 1e12,
              "a quaternion with a length from 1e-6 to 1e6 (squared shown)");
    }
    check_velocity_of(d.model, d.motion, &d.linear_velocity, &d.angular_velocity);
    if (fixed) return;
    check("BodyDefinition.mass", d.mass, 1e-10, 1e10, "1e-10 to 1e10 (kg)");
    if (d.model == BodyModel::planar) {
        check("BodyDefinition.inertia.zz", d.inertia.zz, 1e-20, 1e20, "1e-20 to 1e20 (kg m2)");
    }
    if (d.model == BodyModel::rigid) check_inertia(d.inertia);
}

std::uint64_t mix(std::uint64_t hash, std::uint64_t value)
{
    // One round of a multiply-xorshift hash: every bit of the state moves about half of the result.
    hash ^= value + 0x9E3779B97F4A7C15ULL + (hash << 6) + (hash >> 2);
    hash *= 0xFF51AFD7ED558CCDULL;
    return hash ^ (hash >> 33);
}

template <class T>
std::uint64_t hash_bytes(std::uint64_t hash, const T* values, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &values[i], sizeof(T));
        hash = mix(hash, bits);
    }
    return hash;
}

}  // namespace

Scene::Scene()
{
    BodyDefinition world;
    world.motion = BodyMotion::static_body;
    ground_ = bodies_.add(world);
}

// ---- bodies
// ---------------------------------------------------------------------------------------------------

BodyId Scene::add_body(const BodyDefinition& definition)
{
    check_definition(definition);
    ++body_count_;
    return bodies_.add(definition);
}

void Scene::add_bodies(std::span<const BodyDefinition> definitions, std::span<BodyId> ids)
{
    if (ids.size() != definitions.size()) {
        refuse("add_bodies.ids.size()", static_cast<double>(ids.size()), "the size of definitions");
    }
    for (const BodyDefinition& definition : definitions) check_definition(definition);
    for (std::size_t i = 0; i < definitions.size(); ++i) ids[i] = bodies_.add(definitions[i]);
    body_count_ += definitions.size();
}

void Scene::remove_body(BodyId body)
{
    remove_bodies({&body, 1});
}

void Scene::remove_bodies(std::span<const BodyId> bodies)
{
    require_alive(bodies, "remove_bodies.bodies");
    for (const BodyId body : bodies) {
        if (body == ground_) refuse("remove_bodies.bodies", "the ground", "a body that the host added");
    }
    // `contained` doubles as the mark of this call; its third value never outlives it.
    constexpr std::uint8_t mark = 0x80;
    bool twice = false;
    for (const BodyId body : bodies) {
        twice = twice || (bodies_.contained[body.slot] & mark) != 0;
        bodies_.contained[body.slot] |= mark;
    }
    for (const BodyId body : bodies) bodies_.contained[body.slot] &= static_cast<std::uint8_t>(~mark);
    if (twice) refuse("remove_bodies.bodies", "a list with a body named twice", "each body once");

    remove_joints_of(bodies);
    for (const BodyId body : bodies) bodies_.remove(body);
    body_count_ -= bodies.size();
}

bool Scene::is_alive(BodyId body) const
{
    return bodies_.is_alive(body);
}

void Scene::refuse_dead(BodyId body, const char* what)
{
    const std::string value = body == BodyId{} ? std::string("the null handle")
                                               : "slot " + std::to_string(body.slot) + " generation " +
                                                     std::to_string(body.generation) + ", not alive";
    refuse(what, value, "a body of this scene");
}

void Scene::require_alive(std::span<const BodyId> bodies, const char* what) const
{
    for (const BodyId body : bodies) require_alive(body, what);
}

BodyModel Scene::model(BodyId body) const
{
    require_alive(body, "model.body");
    return bodies_.model(body);
}

BodyMotion Scene::motion(BodyId body) const
{
    require_alive(body, "motion.body");
    return bodies_.motion(body);
}

BodyState Scene::state(BodyId body) const
{
    require_alive(body, "state.body");
    const BodyRow where = bodies_.row_of(body);
    const BodyRows& rows = bodies_.rows(where.kind());
    const std::size_t row = where.row();
    BodyState state;
    state.position = rows.pose[row].position;
    state.yaw = rows.pose[row].yaw;
    const float* v = &rows.velocity[row * 4 * static_cast<std::size_t>(quads_of(where.kind()))];
    switch (where.kind()) {
        case BodyKind::particle:
            state.linear_velocity = {v[0], v[1], v[2]};
            break;
        case BodyKind::planar:
            state.linear_velocity = {v[0], v[1], 0};
            state.angular_velocity = {0, 0, v[2]};
            state.orientation = {0, 0, std::sin(state.yaw / 2), std::cos(state.yaw / 2)};
            break;
        case BodyKind::rigid:
        case BodyKind::fixed:
            state.linear_velocity = {v[0], v[1], v[2]};
            state.angular_velocity = {v[4], v[5], v[6]};
            state.orientation = rows.orientation[row];
            break;
    }
    return state;
}

void Scene::set_pose(BodyId body, const Vec3<double>& position, const Quat<double>& orientation, double yaw)
{
    require_alive(body, "set_pose.body");
    if (body == ground_) refuse("set_pose.body", "the ground", "a body that the host added");
    check_position("set_pose.position", position);
    check("set_pose.yaw", yaw, -1e9, 1e9, "a finite value from -1e9 to 1e9 (rad)");
    const Quat<double>& q = orientation;
    const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    check("set_pose.orientation", length2, 1e-12, 1e12,
          "a quaternion with a length from 1e-6 to 1e6 (squared shown)");
    const BodyRow where = bodies_.row_of(body);
    BodyRows& rows = bodies_.rows(where.kind());
    rows.pose[where.row()] = {position, yaw};
    if (quads_of(where.kind()) == 2) {
        const double length = std::sqrt(length2);
        rows.orientation[where.row()] = {q.x / length, q.y / length, q.z / length, q.w / length};
        if (where.kind() == BodyKind::rigid && bodies_.contained[body.slot] == 0)
            bodies_.refresh_world_inertia(where.row());
    }
    if (bodies_.joint_counts[body.slot] == 0) return;
    // A teleport makes the cached impulses meaningless.
    joints_.for_each([&](auto& store, int) {
        for (std::size_t i = 0; i < store.size(); ++i) {
            if (store.definitions[i].body_a == body || store.definitions[i].body_b == body)
                store.forget_impulse(i);
        }
    });
}

void Scene::check_velocity(BodyId body, const Vec3<float>* linear, const Vec3<float>* angular) const
{
    check_velocity_of(bodies_.model(body), bodies_.motion(body), linear, angular);
}

void Scene::write_velocity(BodyId body, const Vec3<float>* linear, const Vec3<float>* angular)
{
    const BodyRow where = bodies_.row_of(body);
    float* v =
        &bodies_.rows(where.kind())
             .velocity[std::size_t{4} * where.row() * static_cast<std::size_t>(quads_of(where.kind()))];
    if (linear) {
        v[0] = linear->x;
        v[1] = linear->y;
        if (where.kind() != BodyKind::planar) v[2] = linear->z;
    }
    if (!angular) return;
    if (where.kind() == BodyKind::planar) v[2] = angular->z;
    if (quads_of(where.kind()) == 2) {
        v[4] = angular->x;
        v[5] = angular->y;
        v[6] = angular->z;
    }
}

void Scene::set_velocity(BodyId body, const Vec3<float>& linear, const Vec3<float>& angular)
{
    require_alive(body, "set_velocity.body");
    check_velocity(body, &linear, &angular);
    write_velocity(body, &linear, &angular);
}

void Scene::set_velocities(std::span<const BodyId> bodies, StridedSpan<const Vec3<float>> linear,
                           StridedSpan<const Vec3<float>> angular)
{
    if (linear.size() != bodies.size()) {
        refuse("set_velocities.linear.size()", static_cast<double>(linear.size()), "the size of bodies");
    }
    if (!angular.empty() && angular.size() != bodies.size()) {
        refuse("set_velocities.angular.size()", static_cast<double>(angular.size()),
               "0 or the size of bodies");
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        require_alive(bodies[i], "set_velocities.bodies");
        check_velocity(bodies[i], &linear[i], angular.empty() ? nullptr : &angular[i]);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        write_velocity(bodies[i], &linear[i], angular.empty() ? nullptr : &angular[i]);
    }
}

void Scene::set_force(BodyId body, const Vec3<float>& force, const Vec3<float>& torque)
{
    set_forces({&body, 1}, {&force, 1}, {&torque, 1});
}

void Scene::set_forces(std::span<const BodyId> bodies, StridedSpan<const Vec3<float>> forces,
                       StridedSpan<const Vec3<float>> torques)
{
    if (forces.size() != bodies.size()) {
        refuse("set_forces.forces.size()", static_cast<double>(forces.size()), "the size of bodies");
    }
    if (!torques.empty() && torques.size() != bodies.size()) {
        refuse("set_forces.torques.size()", static_cast<double>(torques.size()), "0 or the size of bodies");
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        require_alive(bodies[i], "set_forces.bodies");
        if (bodies_.motion(bodies[i]) != BodyMotion::dynamic_body) {
            refuse("set_forces.bodies", "a static or kinematic body", "dynamic bodies");
        }
        if (!is_finite(forces[i]))
            check_vector("set_forces.forces", forces[i], 1e30F, "finite components (N)");
        if (!torques.empty() && !is_finite(torques[i])) {
            check_vector("set_forces.torques", torques[i], 1e30F, "finite components (N m)");
        }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = bodies_.row_of(bodies[i]);
        BodyRows& rows = bodies_.rows(where.kind());
        float* a = &rows.acceleration[std::size_t{4} * where.row() *
                                      static_cast<std::size_t>(quads_of(where.kind()))];
        const float inverse_mass = bodies_.inverse_masses[bodies[i].slot];
        a[0] = inverse_mass * forces[i].x;
        a[1] = inverse_mass * forces[i].y;
        if (where.kind() != BodyKind::planar) a[2] = inverse_mass * forces[i].z;
        if (torques.empty()) continue;
        if (where.kind() == BodyKind::planar)
            a[2] = rows.delta[std::size_t{4} * where.row() + 3] * torques[i].z;
        if (where.kind() == BodyKind::rigid) {
            a[4] = torques[i].x;
            a[5] = torques[i].y;
            a[6] = torques[i].z;
        }
    }
}

void Scene::revive(BodyId body, const Vec3<double>& position, const Vec3<float>& linear)
{
    require_alive(body, "revive.body");
    if (bodies_.contained[body.slot] == 0) refuse("revive.body", "a body that moves", "a contained body");
    check_position("revive.position", position);
    check_velocity(body, &linear, nullptr);
    bodies_.revive(body);
    bodies_.rows(bodies_.row_of(body).kind()).pose[bodies_.row_of(body).row()].position = position;
    write_velocity(body, &linear, nullptr);
}

bool Scene::is_contained(BodyId body) const
{
    require_alive(body, "is_contained.body");
    return bodies_.contained[body.slot] != 0;
}

void Scene::read_positions(std::span<const BodyId> bodies, StridedSpan<Vec3<double>> positions) const
{
    if (positions.size() != bodies.size()) {
        refuse("read_positions.positions.size()", static_cast<double>(positions.size()),
               "the size of bodies");
    }
    require_alive(bodies, "read_positions.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = bodies_.row_of(bodies[i]);
        positions[i] = bodies_.rows(where.kind()).pose[where.row()].position;
    }
}

void Scene::read_velocities(std::span<const BodyId> bodies, StridedSpan<Vec3<float>> linear,
                            StridedSpan<Vec3<float>> angular) const
{
    if (!linear.empty() && linear.size() != bodies.size()) {
        refuse("read_velocities.linear.size()", static_cast<double>(linear.size()),
               "0 or the size of bodies");
    }
    if (!angular.empty() && angular.size() != bodies.size()) {
        refuse("read_velocities.angular.size()", static_cast<double>(angular.size()),
               "0 or the size of bodies");
    }
    require_alive(bodies, "read_velocities.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = bodies_.row_of(bodies[i]);
        const float* v =
            &bodies_.rows(where.kind())
                 .velocity[std::size_t{4} * where.row() * static_cast<std::size_t>(quads_of(where.kind()))];
        const bool planar = where.kind() == BodyKind::planar;
        if (!linear.empty()) linear[i] = {v[0], v[1], planar ? 0.0F : v[2]};
        if (angular.empty()) continue;
        angular[i] = {};
        if (planar) angular[i].z = v[2];
        if (quads_of(where.kind()) == 2) angular[i] = {v[4], v[5], v[6]};
    }
}

void Scene::read_yaws(std::span<const BodyId> bodies, StridedSpan<double> yaws) const
{
    if (yaws.size() != bodies.size()) {
        refuse("read_yaws.yaws.size()", static_cast<double>(yaws.size()), "the size of bodies");
    }
    require_alive(bodies, "read_yaws.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = bodies_.row_of(bodies[i]);
        yaws[i] = bodies_.rows(where.kind()).pose[where.row()].yaw;
    }
}

// ---- joints
// ---------------------------------------------------------------------------------------------------

JointBodies Scene::check_joint_bodies(BodyId a, BodyId b) const
{
    require_alive(a, "joint.body_a");
    require_alive(b, "joint.body_b");
    if (a == b) refuse("joint.body_b", "the same body as body_a", "two different bodies");
    const bool fixed_a = bodies_.row_of(a).kind() == BodyKind::fixed;
    const bool fixed_b = bodies_.row_of(b).kind() == BodyKind::fixed;
    if (fixed_a && fixed_b)
        refuse("joint.body_b", "a second body that cannot move", "at least one dynamic body");
    return {bodies_.model(a), bodies_.model(b), fixed_a, fixed_b};
}

ConstraintId Scene::take_joint_slot(int type, std::size_t index)
{
    std::uint32_t slot;
    if (joints_.free_slots.empty()) {
        slot = static_cast<std::uint32_t>(joints_.slots.size());
        joints_.slots.emplace_back();
    } else {
        slot = joints_.free_slots.back();
        joints_.free_slots.pop_back();
    }
    JointStores::Slot& entry = joints_.slots[slot];
    if (++entry.generation == 0) entry.generation = 1;
    entry.index = static_cast<std::uint32_t>(index);
    entry.type = static_cast<std::uint8_t>(type);
    entry.live = true;
    return {slot, entry.generation};
}

bool Scene::is_alive(ConstraintId joint) const
{
    return joint.slot < joints_.slots.size() && joints_.slots[joint.slot].live &&
           joints_.slots[joint.slot].generation == joint.generation;
}

std::size_t Scene::joint_count() const
{
    std::size_t count = 0;
    joints_.for_each([&](const auto& store, int) { count += store.size(); });
    return count;
}

void Scene::remove_joint_at(int type, std::size_t index)
{
    joints_.for_each([&](auto& store, int t) {
        if (t != type) return;
        JointStores::Slot& entry = joints_.slots[store.slots[index]];
        entry.live = false;
        joints_.free_slots.push_back(store.slots[index]);
        --bodies_.joint_counts[store.definitions[index].body_a.slot];
        --bodies_.joint_counts[store.definitions[index].body_b.slot];
        store.swap_remove(index);
        if (index < store.size()) joints_.slots[store.slots[index]].index = static_cast<std::uint32_t>(index);
    });
    joints_.version.reset();
}

void Scene::remove_joint(ConstraintId joint)
{
    if (!is_alive(joint)) {
        refuse("remove_joint.joint", "slot " + std::to_string(joint.slot) + ", not alive",
               "a joint of this scene");
    }
    remove_joint_at(joints_.slots[joint.slot].type, joints_.slots[joint.slot].index);
}

void Scene::remove_joints_of(std::span<const BodyId> bodies)
{
    bool any = false;
    for (const BodyId body : bodies) any = any || bodies_.joint_counts[body.slot] != 0;
    if (!any) return;
    std::vector<std::uint8_t> going(bodies_.slot_count(), 0);
    for (const BodyId body : bodies) going[body.slot] = 1;
    joints_.for_each([&](auto& store, int type) {
        for (std::size_t i = store.size(); i-- > 0;) {
            if (going[store.definitions[i].body_a.slot] || going[store.definitions[i].body_b.slot])
                remove_joint_at(type, i);
        }
    });
}

namespace {

/// p_b - p_a in double.
Vec3<double> anchor_separation(const BodyState& a, const BodyState& b, const Vec3<float>& local_a,
                               const Vec3<float>& local_b)
{
    return (b.position - a.position) + (rotate(b.orientation, convert<double>(local_b)) -
                                        rotate(a.orientation, convert<double>(local_a)));
}

}  // namespace

JointForce Scene::joint_force(ConstraintId joint) const
{
    if (!is_alive(joint)) {
        refuse("joint_force.joint", "slot " + std::to_string(joint.slot) + ", not alive",
               "a joint of this scene");
    }
    const JointStores::Slot& entry = joints_.slots[joint.slot];
    JointForce result;
    joints_.for_each([&](const auto& store, int type) {
        if (type != entry.type) return;
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        const auto& definition = store.definitions[entry.index];
        const Vec3<double> d = anchor_separation(state(definition.body_a), state(definition.body_b),
                                                 definition.local_anchor_a, definition.local_anchor_b);
        if (last_substep > 0) {
            result.force = (1 / last_substep) * Type::push_on_b(definition, store.memory_of(entry.index), d);
        }
        const Vec3<double> e = Type::error(definition, d);
        result.error = static_cast<float>(std::sqrt(dot(e, e)));
    });
    return result;
}

// ---- whole scene
// ----------------------------------------------------------------------------------------------

std::uint64_t Scene::state_hash() const
{
    std::uint64_t hash = 0x6D6F746C6579ULL;
    for (std::uint32_t slot = 1; slot < bodies_.slot_count(); ++slot) {
        if (!bodies_.is_slot_live(slot)) continue;
        const BodyRow where = bodies_.row_of(bodies_.id_of_slot(slot));
        const BodyRows& rows = bodies_.rows(where.kind());
        const std::size_t quads = static_cast<std::size_t>(quads_of(where.kind()));
        hash = mix(hash, slot);
        hash = hash_bytes(hash, &rows.pose[where.row()].position.x, 3);
        hash = hash_bytes(hash, &rows.pose[where.row()].yaw, 1);
        if (quads == 2) hash = hash_bytes(hash, &rows.orientation[where.row()].x, 4);
        hash = hash_bytes(hash, &rows.velocity[4 * quads * where.row()], 4 * quads);
    }
    return hash;
}

SceneErrors Scene::errors() const
{
    SceneErrors errors;
    double sum = 0;
    std::size_t count = 0;
    joints_.for_each([&](const auto& store, int) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        for (const auto& definition : store.definitions) {
            const Vec3<double> e = Type::error(
                definition, anchor_separation(state(definition.body_a), state(definition.body_b),
                                              definition.local_anchor_a, definition.local_anchor_b));
            const double square = dot(e, e);
            sum += square;
            errors.joint_separation_max = std::max(errors.joint_separation_max, std::sqrt(square));
            ++count;
        }
    });
    if (count > 0) errors.joint_separation_rms = std::sqrt(sum / static_cast<double>(count));
    for (std::uint32_t slot = 1; slot < bodies_.slot_count(); ++slot) {
        if (!bodies_.is_slot_live(slot) || bodies_.inverse_masses[slot] == 0) continue;
        const BodyId body = bodies_.id_of_slot(slot);
        const BodyState s = state(body);
        const double mass = 1 / static_cast<double>(bodies_.inverse_masses[slot]);
        const Vec3<double> v = convert<double>(s.linear_velocity);
        const Vec3<double> w = convert<double>(s.angular_velocity);
        errors.momentum[0] += mass * v.x;
        errors.momentum[1] += mass * v.y;
        errors.momentum[2] += mass * v.z;
        errors.kinetic_energy += 0.5 * mass * dot(v, v);
        const BodyRow where = bodies_.row_of(body);
        if (where.kind() == BodyKind::planar) {
            const double inverse = bodies_.rows(where.kind()).delta[std::size_t{4} * where.row() + 3];
            if (inverse > 0) errors.kinetic_energy += 0.5 * w.z * w.z / inverse;
        }
        if (where.kind() == BodyKind::rigid) {
            const Sym3<float>& i = bodies_.rows(where.kind()).inertia[where.row()];
            const Sym3<double> inertia{i.xx, i.xy, i.xz, i.yy, i.yz, i.zz};
            const Vec3<double> local = rotate(conjugate(s.orientation), w);
            errors.kinetic_energy += 0.5 * dot(local, inertia * local);
        }
    }
    return errors;
}

}  // namespace motley
