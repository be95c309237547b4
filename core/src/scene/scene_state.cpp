// The state of bodies, read and written by the host one at a time and in bulk. Nothing is changed before everything
// is checked.
#include "scene/scene_core.h"

#include <cmath>

#include "motley/core/invalid_input.h"
#include "scene/body_checks.h"
#include "stores/joint_store.h"

namespace motley {

Quat<double> SceneCore::orientation(BodyRow where) const
{
    const BodyRows& rows = bodies.rows(where.kind());
    if (quads_of(where.kind()) == 2) return convert<double>(rows.orientation[where.row()]);
    if (where.kind() == BodyKind::particle) return {0, 0, 0, 1};
    const auto yaw = static_cast<double>(rows.pose[where.row()].yaw);
    return {0, 0, std::sin(yaw / 2), std::cos(yaw / 2)};
}

BodyState SceneCore::state(BodyId body) const
{
    require_alive(body, "state.body");
    const BodyRow where = bodies.row_of(body);
    const BodyRows& rows = bodies.rows(where.kind());
    const std::size_t row = where.row();
    BodyState state;
    state.position = convert<double>(rows.pose[row].position);
    state.yaw = static_cast<double>(rows.pose[row].yaw);
    state.orientation = orientation(where);
    const Velocity now = velocity(where);
    state.linear_velocity = now.linear;
    state.angular_velocity = now.angular;
    return state;
}

SceneCore::Velocity SceneCore::velocity(BodyRow where) const
{
    const float* v =
        &bodies.rows(where.kind())
             .velocity[std::size_t{4} * static_cast<std::size_t>(quads_of(where.kind())) * where.row()];
    switch (where.kind()) {
        case BodyKind::particle:
            return {{v[0], v[1], v[2]}, {}};
        case BodyKind::planar:
            return {{v[0], v[1], 0}, {0, 0, v[2]}};
        case BodyKind::rigid:
        case BodyKind::fixed:
            return {{v[0], v[1], v[2]}, {v[4], v[5], v[6]}};
    }
    return {};
}

void Scene::set_pose(BodyId body, const Vec3<double>& position, const Quat<double>& orientation, double yaw)
{
    core_->require_alive(body, "set_pose.body");
    if (body == core_->ground) refuse("set_pose.body", "the ground", "a body that the host added");
    check_position("set_pose.position", position);
    check("set_pose.yaw", yaw, -1e9, 1e9, "a finite value from -1e9 to 1e9 (rad)");
    const Quat<double>& q = orientation;
    const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    check("set_pose.orientation", length2, 1e-12, 1e12,
          "a quaternion with a length from 1e-6 to 1e6 (squared shown)");
    core_->wake_island(body.slot);
    core_->wake_joined_to(body);
    core_->wake_near_walls_of(body);
    core_->rouse(body);
    const BodyRow where = core_->bodies.row_of(body);
    BodyRows& rows = core_->bodies.rows(where.kind());
    rows.pose[where.row()] = {convert<PoseReal>(position), static_cast<PoseReal>(yaw)};
    if (quads_of(where.kind()) == 2) {
        const double length = std::sqrt(length2);
        rows.orientation[where.row()] =
            convert<PoseReal>(Quat<double>{q.x / length, q.y / length, q.z / length, q.w / length});
        if (where.kind() == BodyKind::rigid && core_->bodies.contained[body.slot] == 0)
            core_->bodies.refresh_world_inertia(where.row());
    }
    core_->forget_discs_of(body);
    core_->wake_near_walls_of(body);
    // A teleport makes the cached impulses meaningless.
    core_->joints->for_each_on(core_->bodies.first_ends[body.slot], [&](const JointStores::Slot& joint) {
        core_->joints->for_each([&](auto& store, int type) {
            if (type == joint.type) store.forget_impulse(joint.index);
        });
    });
}

void SceneCore::check_velocity(BodyId body, const Vec3<float>* linear, const Vec3<float>* angular) const
{
    check_velocity_of(bodies.model(body), bodies.motion(body), linear, angular);
}

void SceneCore::write_velocity(BodyId body, const Vec3<float>* linear, const Vec3<float>* angular)
{
    if (bodies.contained[body.slot] != 0) return;  // frozen where it is
    const auto moves = [](const Vec3<float>* v) { return v && (v->x != 0 || v->y != 0 || v->z != 0); };
    if (bodies.is_asleep(body.slot) && (moves(linear) || moves(angular))) rouse(body);
    const BodyRow where = bodies.row_of(body);
    float* v =
        &bodies.rows(where.kind())
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
    core_->require_alive(body, "set_velocity.body");
    core_->check_velocity(body, &linear, &angular);
    core_->write_velocity(body, &linear, &angular);
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
        core_->require_alive(bodies[i], "set_velocities.bodies");
        core_->check_velocity(bodies[i], &linear[i], angular.empty() ? nullptr : &angular[i]);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        core_->write_velocity(bodies[i], &linear[i], angular.empty() ? nullptr : &angular[i]);
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
        core_->require_alive(bodies[i], "set_forces.bodies");
        if (core_->bodies.motion(bodies[i]) != BodyMotion::dynamic_body) {
            refuse("set_forces.bodies", "a static or kinematic body", "dynamic bodies");
        }
        if (!is_finite(forces[i]))
            check_vector("set_forces.forces", forces[i], 1e30F, "finite components (N)");
        if (!torques.empty() && !is_finite(torques[i])) {
            check_vector("set_forces.torques", torques[i], 1e30F, "finite components (N m)");
        }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = core_->bodies.row_of(bodies[i]);
        BodyRows& rows = core_->bodies.rows(where.kind());
        float* a = &rows.acceleration[std::size_t{4} * where.row() *
                                      static_cast<std::size_t>(quads_of(where.kind()))];
        const float inverse_mass = core_->bodies.inverse_masses[bodies[i].slot];
        a[0] = inverse_mass * forces[i].x;
        a[1] = inverse_mass * forces[i].y;
        if (where.kind() != BodyKind::planar) a[2] = inverse_mass * forces[i].z;
        if (!torques.empty() && where.kind() == BodyKind::planar)
            a[2] = core_->bodies.inverse_inertias[bodies[i].slot] * torques[i].z;
        if (!torques.empty() && where.kind() == BodyKind::rigid) {
            a[4] = torques[i].x;
            a[5] = torques[i].y;
            a[6] = torques[i].z;
        }
        core_->rouse_if_pushed(bodies[i]);
    }
}

void Scene::revive(BodyId body, const Vec3<double>& position, const Vec3<float>& linear)
{
    core_->require_alive(body, "revive.body");
    if (core_->bodies.contained[body.slot] == 0)
        refuse("revive.body", "a body that moves", "a contained body");
    check_position("revive.position", position);
    core_->check_velocity(body, &linear, nullptr);
    core_->bodies.revive(body);
    core_->joints->change_altogether();
    core_->bodies.rows(core_->bodies.row_of(body).kind()).pose[core_->bodies.row_of(body).row()].position =
        convert<PoseReal>(position);
    core_->write_velocity(body, &linear, nullptr);
    core_->forget_discs_of(body);
}

bool Scene::is_contained(BodyId body) const
{
    core_->require_alive(body, "is_contained.body");
    return core_->bodies.contained[body.slot] != 0;
}

void Scene::read_positions(std::span<const BodyId> bodies, StridedSpan<Vec3<double>> positions) const
{
    if (positions.size() != bodies.size()) {
        refuse("read_positions.positions.size()", static_cast<double>(positions.size()),
               "the size of bodies");
    }
    core_->require_alive(bodies, "read_positions.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = core_->bodies.row_of(bodies[i]);
        positions[i] = convert<double>(core_->bodies.rows(where.kind()).pose[where.row()].position);
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
    core_->require_alive(bodies, "read_velocities.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = core_->bodies.row_of(bodies[i]);
        const float* v =
            &core_->bodies.rows(where.kind())
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
    core_->require_alive(bodies, "read_yaws.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const BodyRow where = core_->bodies.row_of(bodies[i]);
        yaws[i] = static_cast<double>(core_->bodies.rows(where.kind()).pose[where.row()].yaw);
    }
}

void Scene::read_orientations(std::span<const BodyId> bodies, StridedSpan<Quat<double>> orientations) const
{
    if (orientations.size() != bodies.size()) {
        refuse("read_orientations.orientations.size()", static_cast<double>(orientations.size()),
               "the size of bodies");
    }
    core_->require_alive(bodies, "read_orientations.bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i)
        orientations[i] = core_->orientation(core_->bodies.row_of(bodies[i]));
}

}  // namespace motley
