// Rows of bodies: added, changed and removed.
#include "stores/body_store.h"

#include <algorithm>
#include <cmath>

#include "maths/lane_body.h"
#include "stores/array.h"
#include "stores/generations.h"
#include "stores/growth.h"

namespace motley {
namespace {

void set_quad(AlignedVector<float>& rows, std::size_t quad, float x, float y, float z, float w)
{
    float* q = &rows[quad * 4];
    q[0] = x;
    q[1] = y;
    q[2] = z;
    q[3] = w;
}

Sym3<float> inverse_of(const Sym3<float>& m)
{
    const double xx = m.xx, xy = m.xy, xz = m.xz, yy = m.yy, yz = m.yz, zz = m.zz;
    const double d = 1 / determinant(Sym3<double>{xx, xy, xz, yy, yz, zz});
    const auto f = [d](double v) { return static_cast<float>(d * v); };
    return {f(yy * zz - yz * yz), f(xz * yz - xy * zz), f(xy * yz - xz * yy),
            f(xx * zz - xz * xz), f(xz * xy - xx * yz), f(xx * yy - xy * xy)};
}

}  // namespace

BodyStore::BodyStore()
{
    slots_.emplace_back();
    live_.push_back(0);
    models_.push_back(BodyModel::rigid);
    motions_.push_back(BodyMotion::static_body);
    first_ends.push_back(0);
    contained.push_back(0);
    sleep.push_back(Sleep::awake);
    slow_for.push_back(0);
    inverse_masses.push_back(0);
    inverse_inertias.push_back(0);
    dampings.emplace_back();
    for (int kind = 0; kind < body_kind_count; ++kind)
        take_row(static_cast<BodyKind>(kind));  // the null bodies
}

namespace {

BodyKind kind_of(const BodyDefinition& d)
{
    return d.motion == BodyMotion::dynamic_body ? static_cast<BodyKind>(d.model) : BodyKind::fixed;
}

std::size_t more_than(std::size_t wanted, const Array<std::uint32_t>& free)
{
    return wanted > free.size() ? wanted - free.size() : 0;
}

}  // namespace

void BodyStore::make_room(std::span<const BodyDefinition> definitions)
{
    std::array<std::size_t, body_kind_count> wanted{};
    for (const BodyDefinition& d : definitions) ++wanted[static_cast<std::size_t>(kind_of(d))];
    for (std::size_t kind = 0; kind < body_kind_count; ++kind)
        make_room_in_rows(static_cast<BodyKind>(kind), wanted[kind]);
    const std::size_t more = more_than(definitions.size(), free_slots_);
    if (more == 0) return;
    make_room_for(slots_, more);
    make_room_for(live_, more);
    make_room_for(models_, more);
    make_room_for(motions_, more);
    make_room_for(first_ends, more);
    make_room_for(contained, more);
    make_room_for(sleep, more);
    make_room_for(slow_for, more);
    make_room_for(inverse_masses, more);
    make_room_for(inverse_inertias, more);
    make_room_for(dampings, more);
}

void BodyStore::make_room_in_rows(BodyKind kind, std::size_t wanted)
{
    BodyRows& r = rows(kind);
    const std::size_t more = more_than(wanted, r.free_rows);
    if (more == 0) return;
    for (AlignedVector<float>* values : {&r.velocity, &r.delta, &r.unpushed, &r.acceleration})
        make_room_for(*values, more * 4 * static_cast<std::size_t>(quads_of(kind)));
    make_room_for(r.pose, more);
    make_room_for(r.slot, more);
    make_room_for(r.awake, more / BodyRows::rows_per_group + 1);
    if (quads_of(kind) == 2) {
        make_room_for(r.orientation, more);
        make_room_for(r.world_inverse_inertia, 8 * more);
    }
    if (kind != BodyKind::rigid) return;
    make_room_for(r.start_inverse_inertia, 8 * more);
    make_room_for(r.inertia, more);
    make_room_for(r.inverse_inertia, more);
}

void BodyStore::make_room_to_remove(std::span<const BodyId> bodies)
{
    std::array<std::size_t, body_kind_count> going{};
    for (const BodyId body : bodies) ++going[static_cast<std::size_t>(row_of(body).kind())];
    for (std::size_t kind = 0; kind < body_kind_count; ++kind)
        make_room_for(rows_[kind].free_rows, going[kind]);
    make_room_for(free_slots_, bodies.size());
}

std::uint32_t BodyStore::take_row(BodyKind kind)
{
    BodyRows& r = rows(kind);
    std::uint32_t row;
    if (r.free_rows.empty()) {
        row = r.size();
        const std::size_t floats = static_cast<std::size_t>(quads_of(kind)) * 4 * (row + 1);
        r.slot.push_back(0);
        if (row % BodyRows::rows_per_group == 0) r.awake.push_back(0);
        r.velocity.resize(floats);
        r.delta.resize(floats);
        r.unpushed.resize(floats);
        r.acceleration.resize(floats);
        r.pose.resize(row + 1);
        if (kind == BodyKind::rigid || kind == BodyKind::fixed) r.orientation.resize(row + 1, {0, 0, 0, 1});
        if (quads_of(kind) == 2) r.world_inverse_inertia.resize(std::size_t{8} * (row + 1));
        if (kind == BodyKind::rigid) {
            r.start_inverse_inertia.resize(std::size_t{8} * (row + 1));
            r.inertia.resize(row + 1);
            r.inverse_inertia.resize(row + 1);
        }
    } else {
        row = r.free_rows.back();
        r.free_rows.pop_back();
    }
    if (quads_of(kind) == 2) {
        set_quad(r.delta, std::size_t{2} * row, 0, 0, 0, 0);
        set_quad(r.delta, std::size_t{2} * row + 1, 0, 0, 0, 1);
    }
    return row;
}

BodyId BodyStore::add(const BodyDefinition& d)
{
    const bool dynamic = d.motion == BodyMotion::dynamic_body;
    const BodyKind kind = kind_of(d);
    const std::uint32_t row = take_row(kind);

    std::uint32_t slot;
    if (free_slots_.empty()) {
        slot = slot_count();
        slots_.push_back({slots_[0].generation, BodyRow(kind, row)});
        live_.push_back(1);
        models_.push_back(d.model);
        motions_.push_back(d.motion);
        first_ends.push_back(0);
        contained.push_back(0);
        sleep.push_back(Sleep::awake);
        slow_for.push_back(0);
        inverse_masses.push_back(0);
        inverse_inertias.push_back(0);
        dampings.emplace_back();
    } else {
        slot = free_slots_.back();
        free_slots_.pop_back();
        live_[slot] = 1;
        slots_[slot].row = BodyRow(kind, row);
        models_[slot] = d.model;
        motions_[slot] = d.motion;
        first_ends[slot] = 0;
        contained[slot] = 0;
        slow_for[slot] = 0;
    }

    inverse_masses[slot] = dynamic ? 1 / d.mass : 0.0F;
    if (dynamic) set_damping(slot, {d.linear_damping, d.angular_damping});
    Content content;
    content.pose = {convert<PoseReal>(d.position), static_cast<PoseReal>(d.yaw)};
    if (quads_of(kind) == 2) {  // only then is it checked
        const Quat<double>& q = d.orientation;
        const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
        content.orientation =
            convert<PoseReal>(Quat<double>{q.x / length, q.y / length, q.z / length, q.w / length});
    }
    content.linear = d.linear_velocity;
    content.angular = d.angular_velocity;
    write(slot, slots_[slot].row, content, d.inertia);
    return {slot, slots_[slot].generation};
}

void BodyStore::write(std::uint32_t slot, BodyRow where, const Content& content, const Sym3<float>& inertia)
{
    const BodyKind kind = where.kind();
    const std::uint32_t row = where.row();
    BodyRows& r = rows(kind);
    slots_[slot].row = where;
    r.slot[row] = slot;
    r.set_awake(row, true);
    r.pose[row] = content.pose;
    const float inverse_mass = inverse_masses[slot];
    inverse_inertias[slot] = kind == BodyKind::planar ? 1 / inertia.zz : 0.0F;
    const auto& [x, y, z] = content.linear;
    const Vec3<float>& w = content.angular;
    const Vec3<float>& a = content.acceleration;
    const Vec3<float>& torque = content.torque;
    const std::size_t quad = static_cast<std::size_t>(quads_of(kind)) * row;
    switch (kind) {
        case BodyKind::particle:
            set_quad(r.velocity, quad, x, y, z, inverse_mass);
            set_quad(r.delta, quad, 0, 0, 0, 0);
            set_quad(r.acceleration, quad, a.x, a.y, a.z, 0);
            break;
        case BodyKind::planar:
            set_quad(r.velocity, quad, x, y, w.z, inverse_mass);
            set_quad(r.delta, quad, 0, 0, 0, inverse_inertias[slot]);
            set_quad(r.acceleration, quad, a.x, a.y, inverse_inertias[slot] * torque.z, 0);
            break;
        case BodyKind::rigid:
        case BodyKind::fixed:
            set_quad(r.velocity, quad, x, y, z, inverse_mass);
            set_quad(r.velocity, quad + 1, w.x, w.y, w.z, 0);
            set_quad(r.acceleration, quad, a.x, a.y, a.z, 0);
            set_quad(r.acceleration, quad + 1, torque.x, torque.y, torque.z, 0);
            r.orientation[row] = content.orientation;
            if (kind == BodyKind::rigid) {
                r.inertia[row] = inertia;
                invert_inertia(row);
                refresh_world_inertia(row);
            }
            break;
    }
}

void BodyStore::set_mass(BodyId body, float mass, const Sym3<float>& inertia)
{
    const BodyRow where = row_of(body);
    BodyRows& r = rows(where.kind());
    const std::size_t first = std::size_t{4} * static_cast<std::size_t>(quads_of(where.kind())) * where.row();
    const bool planar = where.kind() == BodyKind::planar,
               moves = contained[body.slot] == 0 && !is_asleep(body.slot);
    // Accelerations are stored, not forces; of a rigid body the torque itself.
    const auto rescale = [&](std::size_t i, float inverse, float new_inverse) {
        r.acceleration[first + i] =
            static_cast<float>(static_cast<double>(r.acceleration[first + i]) *
                               static_cast<double>(new_inverse) / static_cast<double>(inverse));
    };
    const float inverse_mass = 1 / mass;
    for (std::size_t i = 0; i < (planar ? 2 : 3); ++i) rescale(i, inverse_masses[body.slot], inverse_mass);
    inverse_masses[body.slot] = inverse_mass;
    if (moves) r.velocity[first + 3] = inverse_mass;
    if (planar) {
        const float inverse_inertia = 1 / inertia.zz;
        rescale(2, inverse_inertias[body.slot], inverse_inertia);
        inverse_inertias[body.slot] = inverse_inertia;
        if (moves) r.delta[first + 3] = inverse_inertia;
    } else if (where.kind() == BodyKind::rigid) {
        r.inertia[where.row()] = inertia;
        invert_inertia(where.row());
        if (moves) refresh_world_inertia(where.row());
    }
}

void BodyStore::remove(BodyId body)
{
    free_row(row_of(body));
    if (contained[body.slot] != 0) --contained_count;
    contained[body.slot] = 0;
    if (is_asleep(body.slot)) --sleepers;
    rows(row_of(body).kind()).set_awake(row_of(body).row(), false);
    sleep[body.slot] = Sleep::awake;
    set_damping(body.slot, {});
    live_[body.slot] = 0;
    slots_[body.slot].generation = next_generation(slots_[body.slot].generation);
    free_slots_.push_back(body.slot);
}

void BodyStore::free_row(BodyRow where)
{
    BodyRows& r = rows(where.kind());
    const std::size_t quads = static_cast<std::size_t>(quads_of(where.kind()));
    // A free row must not move: no mass, no speed, no force, no displacement.
    for (std::size_t q = quads * where.row(); q < quads * (where.row() + 1); ++q) {
        set_quad(r.velocity, q, 0, 0, 0, 0);
        set_quad(r.delta, q, 0, 0, 0, 0);
        set_quad(r.acceleration, q, 0, 0, 0, 0);
        if (where.kind() == BodyKind::rigid) {
            set_quad(r.world_inverse_inertia, q, 0, 0, 0, 0);
            set_quad(r.start_inverse_inertia, q, 0, 0, 0, 0);
        }
    }
    r.slot[where.row()] = 0;
    r.free_rows.push_back(where.row());
}

void BodyStore::invert_inertia(std::uint32_t row)
{
    BodyRows& r = rows(BodyKind::rigid);
    r.inverse_inertia[row] = inverse_of(r.inertia[row]);
    // The trace is the same in every orientation, but for rounding.
    largest_response = std::fmax(largest_response, 1.01F * trace(r.inverse_inertia[row]));
}

void BodyStore::refresh_world_inertia(std::uint32_t row)
{
    BodyRows& r = rows(BodyKind::rigid);
    const Sym3<float> i = rotate_tensor(convert<float>(r.orientation[row]), r.inverse_inertia[row]);
    for (AlignedVector<float>* tensors : {&r.world_inverse_inertia, &r.start_inverse_inertia}) {
        set_quad(*tensors, std::size_t{2} * row, i.xx, i.xy, i.xz, i.yy);
        set_quad(*tensors, std::size_t{2} * row + 1, i.yz, i.zz, 0, 0);
    }
}

void BodyStore::note_awake(BodyKind kind)
{
    BodyRows& r = rows(kind);
    r.awake.assign((r.size() - 1) / BodyRows::rows_per_group + 1, 0);
    for (std::uint32_t row = 1; row < r.size(); ++row) {
        if (r.slot[row] != 0 && !is_asleep(r.slot[row])) r.set_awake(row, true);
    }
}

void BodyStore::derive()
{
    contained_count = static_cast<std::size_t>(std::count(contained.begin(), contained.end(), 1));
    damped = static_cast<std::size_t>(std::count_if(dampings.begin(), dampings.end(),
                                                    [](const Damping& damping) { return damping.is_any(); }));
    sleepers = 0;
    for (std::uint32_t slot = 1; slot < slot_count(); ++slot)
        sleepers += sleep[slot] != Sleep::awake && motions_[slot] == BodyMotion::dynamic_body ? 1 : 0;
    for (int k = 0; k < body_kind_count; ++k) {
        const auto kind = static_cast<BodyKind>(k);
        BodyRows& r = rows(kind);
        const auto quads = static_cast<std::size_t>(quads_of(kind));
        note_awake(kind);
        r.delta.assign(r.velocity.size(), 0);
        r.unpushed.assign(r.velocity.size(), 0);
        if (quads == 2) r.world_inverse_inertia.assign(r.velocity.size(), 0);
        if (kind == BodyKind::rigid) {
            r.start_inverse_inertia.assign(r.velocity.size(), 0);
            r.inverse_inertia.assign(r.size(), {});
        }
        for (std::uint32_t row = 0; row < r.size(); ++row) {
            const std::uint32_t slot = r.slot[row];
            const bool is_frozen = slot != 0 && is_asleep(slot);  // it may have got a speed for when it wakes
            const bool moves = slot != 0 && contained[slot] == 0 && !is_frozen;
            float* velocity = &r.velocity[4 * quads * row];
            float* delta = &r.delta[4 * quads * row];
            if (!moves && !is_frozen) std::fill_n(velocity, 4 * quads, 0.0F);
            velocity[3] = 0;
            if (slot == 0) std::fill_n(&r.acceleration[4 * quads * row], 4 * quads, 0.0F);
            if (quads == 2) delta[7] = 1;
            if (kind == BodyKind::rigid && slot != 0) invert_inertia(row);
            if (!moves) continue;
            velocity[3] = inverse_masses[slot];
            if (kind == BodyKind::planar) delta[3] = inverse_inertias[slot];
            if (kind == BodyKind::rigid) refresh_world_inertia(row);
        }
    }
}

}  // namespace motley
