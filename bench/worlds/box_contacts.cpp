#include "worlds/box_contacts.h"

#include <cmath>

namespace motley::bench {
namespace {

constexpr double margin = 0.02;     ///< m: a pair with a gap up to this becomes a contact
constexpr double overhang = 0.005;  ///< m: a corner so little beside a face touches the face's edge
constexpr float friction = 0.6F;

double part(const Vec3<double>& v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

}  // namespace

BoxContacts::BoxContacts(const Rig& rig, std::vector<BodyId> bodies) : rig_(rig), bodies_(std::move(bodies))
{
    for (int i = 0; i < static_cast<int>(rig.bodies.size()); ++i) {
        for (int j = i + 1; j < static_cast<int>(rig.bodies.size()); ++j) {
            const RigBody& a = rig.bodies[static_cast<std::size_t>(i)];
            const RigBody& b = rig.bodies[static_cast<std::size_t>(j)];
            const Vec3<double> d = b.position - a.position;
            const Vec3<double> reach = convert<double>(a.half_extents + b.half_extents);
            if (std::abs(d.x) < reach.x + 0.1 && std::abs(d.y) < reach.y + 0.1 &&
                std::abs(d.z) < reach.z + 0.1)
                pairs_.emplace_back(i, j);
        }
    }
}

void BoxContacts::add(BodyId a, BodyId b, Vec3<double> centre_a, Vec3<double> centre_b, Vec3<double> point,
                      Vec3<float> normal, double separation, std::uint64_t key)
{
    Contact contact;
    contact.body_a = a;
    contact.body_b = b;
    contact.key = key;
    contact.normal = normal;
    contact.separation = static_cast<float>(separation);
    contact.arm_a = convert<float>(point - centre_a);
    contact.arm_b = convert<float>(point - centre_b);
    contact.friction = friction;
    contacts_.push_back(contact);
}

/// Adds a contact for each corner of `box` that lies in the nearest face of `other`.
void BoxContacts::corners_in_face(int box, int other, std::uint64_t key)
{
    const auto i = static_cast<std::size_t>(box), j = static_cast<std::size_t>(other);
    const Placed &mine = placed_[i], &face = placed_[j];
    const Vec3<double> h = convert<double>(rig_.bodies[j].half_extents);
    const auto local = [&](const Vec3<double>& point) {
        const Vec3<double> from = point - face.centre;
        return Vec3<double>{dot(face.axes[0], from), dot(face.axes[1], from), dot(face.axes[2], from)};
    };
    // The face that looks most towards the box.
    const Vec3<double> towards = local(mine.centre);
    const Vec3<double> reach{std::abs(towards.x) / h.x, std::abs(towards.y) / h.y, std::abs(towards.z) / h.z};
    const int axis = reach.y >= reach.x && reach.y >= reach.z ? 1 : reach.x >= reach.z ? 0 : 2;
    const double side = part(towards, axis) > 0 ? 1 : -1;
    const Vec3<double> out = side * face.axes[axis];
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3<double>& world = mine.corners[corner];
        const double separation = dot(out, world - face.centre) - part(h, axis);
        if (separation > margin || separation < -0.25) continue;
        const Vec3<double> at = local(world);
        bool inside = true;
        Vec3<double> point = world;
        for (int k = 0; k < 3; ++k) {
            const double beside = std::abs(part(at, k)) - part(h, k);
            if (k == axis || beside <= 0) continue;
            inside = inside && beside <= overhang;
            point = point - (part(at, k) > 0 ? beside : -beside) * face.axes[k];
        }
        if (inside)
            add(bodies_[j], bodies_[i], face.centre, mine.centre, point, convert<float>(out), separation,
                key * 8 + static_cast<std::uint64_t>(corner));
    }
}

std::span<const Contact> BoxContacts::find(std::span<const RigPose> poses, BodyId ground)
{
    contacts_.clear();
    placed_.resize(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        Placed& box = placed_[i];
        const Vec3<double> h = convert<double>(rig_.bodies[i].half_extents);
        box.centre = poses[i].position;
        box.axes[0] = rotate(poses[i].orientation, Vec3<double>{1, 0, 0});
        box.axes[1] = rotate(poses[i].orientation, Vec3<double>{0, 1, 0});
        box.axes[2] = cross(box.axes[0], box.axes[1]);
        for (int corner = 0; corner < 8; ++corner) {
            const auto along = [&](int k) {
                return ((corner >> k & 1) != 0 ? part(h, k) : -part(h, k)) * box.axes[k];
            };
            box.corners[corner] = box.centre + along(0) + along(1) + along(2);
            if (box.corners[corner].y > margin) continue;
            add(ground, bodies_[i], {0, 0, 0}, box.centre, box.corners[corner], {0, 1, 0},
                box.corners[corner].y, i * 8 + static_cast<std::uint64_t>(corner));
        }
    }
    const std::uint64_t floor_keys = poses.size();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        // Four corners of one box in a face of the other are enough; with fewer, the other box's corners are added.
        const std::size_t before = contacts_.size();
        corners_in_face(pairs_[p].second, pairs_[p].first, floor_keys + 2 * p);
        if (contacts_.size() - before < 4)
            corners_in_face(pairs_[p].first, pairs_[p].second, floor_keys + 2 * p + 1);
    }
    return contacts_;
}

}  // namespace motley::bench
