// A heap of boxes in which some contacts stick, most slide and some separate, and measures of it that tests of
// Coulomb's and Newton's laws use. They are computed in double from the velocities and impulses that a step reports.
#pragma once

#include "mixed_scene.h"
#include "rig.h"
#include "scene/scene_core.h"

namespace motley::testing {

using Vector = Vec3<double>;

/// The part of v that is perpendicular to the unit vector n.
inline Vector across(const Vector& v, const Vector& n)
{
    return v - dot(n, v) * n;
}
/// Velocity of the point at `arm` from the centre of mass.
inline Vector velocity_at(const BodyState& state, const Vec3<float>& arm)
{
    return convert<double>(state.linear_velocity) +
           cross(convert<double>(state.angular_velocity), convert<double>(arm));
}
/// The angle between two vectors in degrees, accurate where it is small.
inline double degrees_between(const Vector& u, const Vector& v)
{
    return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / 3.14159265358979;
}

/// weightless_sweeps() with gravity.
inline SolverSettings plain_sweeps(int iterations)
{
    SolverSettings settings = weightless_sweeps(iterations);
    settings.gravity = {0, -9.81F, 0};
    return settings;
}

/// Nine columns of three slabs. Each slab stands on four corners on the one below and leans on its neighbours, and
/// everything moves: some contacts stick, most slide, some separate. Every other box is `ratio` times as heavy.
struct HeapOfBoxes {
    static constexpr Vec3<float> half{0.5F, 0.15F, 0.3F};  ///< of every box
    Scene scene;
    std::vector<BodyId> boxes;
    std::vector<Contact> contacts;

    explicit HeapOfBoxes(float ratio)
    {
        Random random(7);
        const auto r = [&] { return static_cast<float>(random.symmetric()); };
        for (int i = 0; i < 27; ++i) {
            const int x = i % 3, z = i / 3 % 3, level = i / 9;
            BodyDefinition box;
            box.position = {2.0 * static_cast<double>(half.x) * x,
                            static_cast<double>(half.y) * (2 * level + 1),
                            2.0 * static_cast<double>(half.z) * z};
            box.mass = (i % 2 == 0 ? 1.0F : ratio) * (1 + 0.3F * r());
            const float third = box.mass / 3;
            box.inertia = {
                third * (half.y * half.y + half.z * half.z), 0, 0,
                third * (half.x * half.x + half.z * half.z), 0, third * (half.x * half.x + half.y * half.y)};
            box.linear_velocity = {r(), 0.3F * r(), r()};
            box.angular_velocity = {r(), r(), r()};
            boxes.push_back(scene.add_body(box));
        }
        for (int i = 0; i < 27; ++i) {
            for (const float x : {-1.0F, 1.0F}) {
                for (const float z : {-1.0F, 1.0F}) {
                    const Vec3<float> up{0.1F * r(), 1, 0.1F * r()};
                    touch(i < 9 ? -1 : i - 9, i, up, {x * half.x, -half.y, z * half.z});
                }
            }
            // Each in a statement of its own: compilers choose the order in which arguments of a call are evaluated.
            const Vec3<float> along_x{1, 0.1F * r(), 0.1F * r()}, left{-half.x, 0.1F * r(), 0.2F * r()};
            const Vec3<float> along_z{0.1F * r(), 0.1F * r(), 1}, back{0.4F * r(), 0.1F * r(), -half.z};
            if (i % 3 > 0) touch(i - 1, i, along_x, left);
            if (i / 3 % 3 > 0) touch(i - 3, i, along_z, back);
        }
    }
    /// `a` or `b` below 0 is the ground.
    void touch(int a, int b, const Vec3<float>& normal, const Vec3<float>& arm_b)
    {
        Contact contact;
        contact.body_b = boxes[static_cast<std::size_t>(b)];
        contact.body_a = a < 0 ? scene.ground() : boxes[static_cast<std::size_t>(a)];
        contact.key = contacts.size() + 1;
        contact.normal = 1 / std::sqrt(dot(normal, normal)) * normal;
        contact.arm_b = arm_b;
        const Vector between =
            scene.state(contact.body_b).position - (a < 0 ? Vector{} : scene.state(contact.body_a).position);
        contact.arm_a = convert<float>(between + convert<double>(arm_b));
        contact.friction = 0.4F;
        contacts.push_back(contact);
    }
    [[nodiscard]] double mass_of(BodyId body) const
    {
        return body == scene.ground()
                   ? 1e30
                   : 1 / static_cast<double>(core_of(scene).bodies.inverse_masses[body.slot]);
    }
    [[nodiscard]] Vector speed(const Contact& c) const
    {
        const Vector a = c.body_a == scene.ground() ? Vector{} : velocity_at(scene.state(c.body_a), c.arm_a);
        return velocity_at(scene.state(c.body_b), c.arm_b) - a;
    }
    /// The largest relative speed of the points of a contact.
    [[nodiscard]] double fastest() const
    {
        double most = 0;
        for (const Contact& c : contacts) most = std::max(most, length(speed(c)));
        return most;
    }
    /// How far the last step is from Coulomb's law, m/s: the largest part of the natural map lambda - P(lambda - m
    /// w), divided by m. P projects onto the half line of normal impulses and onto the disc of friction impulses; m
    /// is the effective mass of two points with these bodies' masses.
    [[nodiscard]] double residual() const
    {
        double most = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const Contact& c = contacts[i];
            const Vector n = convert<double>(c.normal), w = speed(c);
            const double m = 1 / (1 / mass_of(c.body_a) + 1 / mass_of(c.body_b));
            const auto push = static_cast<double>(scene.contact_impulses()[i].normal);
            const Vector friction = convert<double>(scene.contact_impulses()[i].friction);
            most = std::max(most, std::abs(push - std::max(push - m * dot(n, w), 0.0)) / m);
            Vector nearest = friction - m * across(w, n);
            const double bound = static_cast<double>(c.friction) * push;
            if (length(nearest) > bound) nearest = bound / length(nearest) * nearest;
            most = std::max(most, length(friction - nearest) / m);
        }
        return most;
    }
};

}  // namespace motley::testing
