// Ten links of 1 kg and 0.5 m that bear a load: the smallest scene in which light bodies hold a heavy one.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "rig.h"

namespace motley::testing {

enum class ChainStart { hanging, level };
inline const char* name_of(ChainStart start)
{
    return start == ChainStart::hanging ? "hanging" : "from level";
}

class LoadedChain {
  public:
    static constexpr double g = 9.81, length = 0.5, inertia_of_unit_mass = 0.0233;
    static constexpr int links = 11;  ///< ten of 1 kg, and the load

    std::vector<BodyId> bodies;
    std::vector<ConstraintId> joints;
    std::vector<double> masses;

    explicit LoadedChain(Scene& scene, BodyModel model = BodyModel::rigid) : scene_(scene), model_(model) {}

    BodyId add(Vec3<double> position, double angle, double mass, Vec3<float> velocity, float spin)
    {
        BodyDefinition link;
        link.model = model_;
        link.position = position;
        if (model_ == BodyModel::planar) {
            link.yaw = angle;
        } else {
            link.orientation = {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
        }
        link.mass = static_cast<float>(mass);
        link.inertia = {0.005F * link.mass,
                        0,
                        0,
                        static_cast<float>(inertia_of_unit_mass) * link.mass,
                        0,
                        static_cast<float>(inertia_of_unit_mass) * link.mass};
        link.linear_velocity = velocity;
        link.angular_velocity = {0, 0, spin};
        masses.push_back(mass);
        bodies.push_back(scene_.add_body(link));
        return bodies.back();
    }
    /// Joins two links end to end, or a link to the ground at z. `angle` is b's angle at the ground, so that a joint
    /// between frames starts without an error.
    template <class Definition = BallSocketDefinition>
    void tie(BodyId a, BodyId b, double z = 0, double angle = 0)
    {
        const bool is_first = a == scene_.ground();
        const Vec3<float> at_a =
            is_first ? Vec3<float>{0, 0, static_cast<float>(z)} : Vec3<float>{0.25F, 0, 0};
        const Vec3<float> at_b{-0.25F, 0, 0};
        Definition joint;
        joint.body_a = a;
        joint.body_b = b;
        if constexpr (requires { joint.local_anchor_a; }) {
            joint.local_anchor_a = at_a;
            joint.local_anchor_b = at_b;
        } else {
            const Quat<float> turned{0, 0, static_cast<float>(std::sin(angle / 2)),
                                     static_cast<float>(std::cos(angle / 2))};
            joint.frame_a = {at_a, is_first ? turned * axis_along(2) : axis_along(2)};
            joint.frame_b = {at_b, axis_along(2)};
        }
        joints.push_back(scene_.add_joint(joint));
    }
    /// Hangs ten links and a load from a point of the ground. When hanging straight down, it is pushed aside at 1
    /// mm/s.
    template <class Definition = BallSocketDefinition>
    void hang(ChainStart start, double load, double z = 0)
    {
        const bool level = start == ChainStart::level;
        const double angle = level ? 0 : -std::numbers::pi / 2;
        BodyId before = scene_.ground();
        for (int i = 0; i < links; ++i) {
            const double middle = length * (i + 0.5), mass = i == links - 1 ? load : 1;
            const Vec3<double> at{level ? middle : 0, level ? 0 : -middle, z};
            const BodyId body = add(at, angle, mass, {level ? 0.0F : 0.001F, 0, 0}, 0);
            tie<Definition>(before, body, z, angle);
            before = body;
        }
    }
    /// Ten links between two loads, floating freely and spinning end over end, with slightly different velocities.
    void set_afloat(double load)
    {
        for (int i = 0; i < 12; ++i) {
            const double middle = length * i - 2.75;
            const auto across = static_cast<float>(2 * middle);
            add({middle, 0, 0}, 0, i == 0 || i == 11 ? load : 1, {0.1F, across + 0.05F * (i % 2), 0}, 2);
            if (i > 0) tie(bodies[static_cast<std::size_t>(i - 1)], bodies.back());
        }
    }
    /// Linear momentum along x and y, kg m/s, and angular momentum about z through the origin, kg m2/s.
    [[nodiscard]] Vec3<double> momenta() const
    {
        Vec3<double> sums{};
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const BodyState state = scene_.state(bodies[i]);
            const auto v = convert<double>(state.linear_velocity);
            sums.x += masses[i] * v.x;
            sums.y += masses[i] * v.y;
            sums.z += masses[i] * (state.position.x * v.y - state.position.y * v.x +
                                   inertia_of_unit_mass * static_cast<double>(state.angular_velocity.z));
        }
        return sums;
    }
    [[nodiscard]] double kinetic_energy() const
    {
        double sum = 0;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const BodyState state = scene_.state(bodies[i]);
            const auto v = convert<double>(state.linear_velocity),
                       w = convert<double>(state.angular_velocity);
            sum += masses[i] / 2 * (dot(v, v) + inertia_of_unit_mass * w.z * w.z);
        }
        return sum;
    }
    [[nodiscard]] double energy() const
    {
        double sum = kinetic_energy();
        for (std::size_t i = 0; i < bodies.size(); ++i)
            sum += masses[i] * g * scene_.state(bodies[i]).position.y;
        return sum;
    }
    /// An upper bound of the energy that its fall from level can release, J.
    [[nodiscard]] double height() const
    {
        double sum = 0;
        for (const double mass : masses) sum += mass * g * length * links;
        return sum;
    }
    [[nodiscard]] double separation() const
    {
        double most = 0;
        for (const ConstraintId joint : joints)
            most = std::max(most, std::abs(static_cast<double>(scene_.joint_report(joint).error)));
        return most;
    }

  private:
    Scene& scene_;
    BodyModel model_;
};

}  // namespace motley::testing
