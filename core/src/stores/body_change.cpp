// A body that gets another model moves into a row of another kind, with all of its motion that the new model has.
#include <cmath>

#include "stores/body_store.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// The orientation of a planar body.
Quat<double> upright(PoseReal yaw)
{
    const double half = static_cast<double>(yaw) / 2;
    return {0, 0, std::sin(half), std::cos(half)};
}

/// The angle, rad from -pi to pi, of the rotation about z that is left of q when the least tilt is taken away. It is
/// exactly 0 for a q without rotation about z, and where nothing is left: upside down.
double turn_about_z(const Quat<double>& q)
{
    return q.w < 0 ? 2 * std::atan2(-q.z, -q.w) : 2 * std::atan2(q.z, q.w);
}

/// x of m x = b, for a symmetric and positive definite m, by Cramer's rule.
Vec3<double> solution(const Sym3<double>& m, const Vec3<double>& b)
{
    const Vec3<double> first{m.xx, m.xy, m.xz}, second{m.xy, m.yy, m.yz}, third{m.xz, m.yz, m.zz};
    const Vec3<double> sum =
        b.x * cross(second, third) + b.y * cross(third, first) + b.z * cross(first, second);
    return 1 / determinant(m) * sum;
}

Sym3<double> in_double(const Sym3<float>& m)
{
    return {m.xx, m.xy, m.xz, m.yy, m.yz, m.zz};
}

}  // namespace

void BodyStore::make_room_to_change(BodyId body, BodyModel model)
{
    make_room_in_rows(static_cast<BodyKind>(model), 1);
    make_room_for(rows(row_of(body).kind()).free_rows, 1);
}

BodyStore::Content BodyStore::read(BodyRow where) const
{
    const BodyRows& r = rows(where.kind());
    const std::size_t first = std::size_t{4} * static_cast<std::size_t>(quads_of(where.kind())) * where.row();
    const float *v = &r.velocity[first], *a = &r.acceleration[first];
    Content content;
    content.pose = r.pose[where.row()];
    content.linear = {v[0], v[1], v[2]};
    content.acceleration = {a[0], a[1], a[2]};
    if (where.kind() == BodyKind::planar) {
        content.linear.z = content.acceleration.z = 0;
        content.angular = {0, 0, v[2]};
        content.torque = {0, 0, a[2] / inverse_inertias[r.slot[where.row()]]};
    } else if (quads_of(where.kind()) == 2) {
        content.orientation = r.orientation[where.row()];
        content.angular = {v[4], v[5], v[6]};
        content.torque = {a[4], a[5], a[6]};
    }
    return content;
}

Vec3<double> BodyStore::angular_velocity_after(BodyId body, const BodyChange& change) const
{
    if (change.model == BodyModel::particle) return {};
    const BodyRow where = row_of(body);
    const Content now = read(where);
    Quat<double> orientation = upright(now.pose.yaw);
    Vec3<double> momentum{};
    if (where.kind() == BodyKind::planar) {
        momentum.z = static_cast<double>(now.angular.z) / static_cast<double>(inverse_inertias[body.slot]);
    } else if (where.kind() == BodyKind::rigid) {
        orientation = convert<double>(now.orientation);
        const Vec3<double> local = rotate(conjugate(orientation), convert<double>(now.angular));
        momentum = rotate(orientation, in_double(rows(where.kind()).inertia[where.row()]) * local);
    }
    // As a planar body has it: by the inverse moment.
    if (change.model == BodyModel::planar)
        return {0, 0, static_cast<double>(1 / change.inertia.zz) * momentum.z};
    const Vec3<double> local = rotate(conjugate(orientation), momentum);
    return rotate(orientation, solution(in_double(change.inertia), local));
}

void BodyStore::change(BodyId body, const BodyChange& change)
{
    const BodyRow from = row_of(body);
    const auto kind = static_cast<BodyKind>(change.model);
    Content content = read(from);
    content.angular = convert<float>(angular_velocity_after(body, change));
    rows(from.kind()).set_awake(from.row(), false);  // it is awake, and write() notes it anew
    if (from.kind() != kind) {
        if (from.kind() == BodyKind::rigid) {
            const Quat<double> past = conjugate(upright(content.pose.yaw));
            content.pose.yaw +=
                static_cast<PoseReal>(turn_about_z(past * convert<double>(content.orientation)));
        } else {
            content.orientation = convert<PoseReal>(upright(content.pose.yaw));
        }
        free_row(from);
    }
    write(body.slot, from.kind() == kind ? from : BodyRow(kind, take_row(kind)), content, change.inertia);
    models_[body.slot] = change.model;
}

}  // namespace motley
