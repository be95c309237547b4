// A scene as a whole: the hash of its state, its errors, energy and momentum.
#include "maths/hash.h"
#include "scene/scene_core.h"
#include "stores/joint_store.h"

#include <cmath>

namespace motley {

std::uint64_t Scene::state_hash() const
{
    std::uint64_t hash = 0x6D6F746C6579ULL;
    for (std::uint32_t slot = 1; slot < core_->bodies.slot_count(); ++slot) {
        if (!core_->bodies.is_slot_live(slot)) continue;
        const BodyRow where = core_->bodies.row_of(core_->bodies.id_of_slot(slot));
        const BodyRows& rows = core_->bodies.rows(where.kind());
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
    double squares = 0, angle_squares = 0;
    std::size_t count = 0;
    core_->joints->for_each([&](const auto& store, int) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        if constexpr (Type::only_pulls) return;  // the distance from a target is no error
        for (std::size_t i = 0; i < store.size(); ++i) {
            const auto& definition = store.definitions[i];
            const JointReport report = Type::report(definition, store.memory_of(i), state(definition.body_a),
                                                    state(definition.body_b));
            const auto error = static_cast<double>(report.error),
                       angle = static_cast<double>(report.angle_error);
            squares += error * error;
            angle_squares += angle * angle;
            errors.joint_separation_max = std::max(errors.joint_separation_max, error);
            errors.joint_angle_max = std::max(errors.joint_angle_max, angle);
            ++count;
        }
    });
    if (count > 0) {
        errors.joint_separation_rms = std::sqrt(squares / static_cast<double>(count));
        errors.joint_angle_rms = std::sqrt(angle_squares / static_cast<double>(count));
    }
    for (std::uint32_t slot = 1; slot < core_->bodies.slot_count(); ++slot) {
        if (!core_->bodies.is_slot_live(slot) || core_->bodies.inverse_masses[slot] == 0) continue;
        const BodyRow where = core_->bodies.row_of(core_->bodies.id_of_slot(slot));
        const SceneCore::Velocity now = core_->velocity(where);
        const double mass = 1 / static_cast<double>(core_->bodies.inverse_masses[slot]);
        const Vec3<double> v = convert<double>(now.linear), w = convert<double>(now.angular);
        errors.momentum[0] += mass * v.x;
        errors.momentum[1] += mass * v.y;
        errors.momentum[2] += mass * v.z;
        errors.kinetic_energy += 0.5 * mass * dot(v, v);
        if (where.kind() == BodyKind::planar) {
            const double inverse = core_->bodies.rows(where.kind()).delta[std::size_t{4} * where.row() + 3];
            if (inverse > 0) errors.kinetic_energy += 0.5 * w.z * w.z / inverse;
        }
        if (where.kind() == BodyKind::rigid) {
            const Sym3<float>& i = core_->bodies.rows(where.kind()).inertia[where.row()];
            const Sym3<double> inertia{i.xx, i.xy, i.xz, i.yy, i.yz, i.zz};
            const Vec3<double> local = rotate(conjugate(core_->orientation(where)), w);
            errors.kinetic_energy += 0.5 * dot(local, inertia * local);
        }
    }
    return errors;
}

}  // namespace motley
