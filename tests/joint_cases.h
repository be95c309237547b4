// For each type of joint, definitions between two given bodies that exercise what it can do. Tests of claims about
// every joint run over the type list with these. A type without cases does not compile.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "mixed_scene.h"
#include "stores/joint_store.h"

namespace motley::testing {

inline constexpr float without_end = std::numeric_limits<float>::infinity();

/// Two bodies between which a joint is wanted. Kinds: 0 particle, 1 planar, 2 rigid, 3 static, 4 kinematic.
class JointPlace {
  public:
    BodyId a, b;
    int kind_a, kind_b;

    JointPlace(const Scene& scene, BodyId body_a, int a_kind, BodyId body_b, int b_kind, Random& random)
        : a(body_a),
          b(body_b),
          kind_a(a_kind),
          kind_b(b_kind),
          state_a_(scene.state(body_a)),
          state_b_(scene.state(body_b)),
          random_(&random)
    {
    }
    /// With a planar body the axes lie in the plane or are perpendicular to it, as in a host's scene: other axes
    /// would make rows dependent.
    [[nodiscard]] bool has_planar() const { return kind_a == 1 || kind_b == 1; }
    [[nodiscard]] double symmetric() const { return random_->symmetric(); }
    /// Three random numbers, drawn in order: as arguments of one call, compilers would choose the order.
    [[nodiscard]] Eigen::Vector3d vector() const
    {
        Eigen::Vector3d v;
        for (double& x : v) x = symmetric();
        return v;
    }

    /// A random place on a body; the centre of a particle.
    [[nodiscard]] Vec3<float> anchor_on_a() const { return anchor(kind_a, kind_b); }
    [[nodiscard]] Vec3<float> anchor_on_b() const { return anchor(kind_b, kind_a); }
    /// The distance of two anchors; for a planar pair, in the plane.
    [[nodiscard]] float distance(const Vec3<float>& on_a, const Vec3<float>& on_b) const
    {
        Eigen::Vector3d d = at(state_b_, on_b) - at(state_a_, on_a);
        if (is_in_plane()) d.z() = 0;
        return static_cast<float>(d.norm());
    }
    [[nodiscard]] bool is_in_plane() const
    {
        return has_planar() && kind_a != 0 && kind_b != 0 && kind_a != 2 && kind_b != 2;
    }
    /// A direction on a body; for a planar pair in its plane, or perpendicular to it if `across`.
    [[nodiscard]] Vec3<float> axis(bool across) const
    {
        if (has_planar()) return across ? Vec3<float>{0, 0, 1} : Vec3<float>{0.6F, -0.8F, 0};
        return narrow(vector() + Eigen::Vector3d(0, 0, 1.5));
    }
    /// The world position of a point on a body.
    [[nodiscard]] Vec3<double> where_a(const Vec3<float>& on_a) const { return in_world(state_a_, on_a); }
    [[nodiscard]] Vec3<double> where_b(const Vec3<float>& on_b) const { return in_world(state_b_, on_b); }
    /// A world position, or direction, in the frame of a body.
    [[nodiscard]] Vec3<float> on_a(const Vec3<double>& p) const { return from_world(state_a_, p); }
    [[nodiscard]] Vec3<float> on_b(const Vec3<double>& p) const { return from_world(state_b_, p); }
    [[nodiscard]] Vec3<float> along_a(const Vec3<double>& v) const
    {
        return narrow(turn(state_a_).conjugate() * Eigen::Vector3d(v.x, v.y, v.z));
    }
    /// Points on the two bodies that coincide to 2 cm; for a particle its centre, wherever that is.
    [[nodiscard]] std::pair<Vec3<float>, Vec3<float>> meeting_anchors() const
    {
        if (kind_a == 0 || kind_b == 0) return {anchor_on_a(), anchor_on_b()};
        const auto [frame_a, frame_b] = frames(false);
        return {frame_a.position, frame_b.position};
    }

    /// Random frames that satisfy a joint to 2 cm and 0.02 rad.
    [[nodiscard]] std::pair<JointFrame, JointFrame> frames(bool x_across) const
    {
        const bool planar = has_planar();
        const auto vector_of = [&](double size) {
            Eigen::Vector3d v = size * vector();
            if (planar) v.z() = 0;
            return v;
        };
        const Eigen::Quaterniond turn_a = turn(state_a_), turn_b = turn(state_b_);
        const Eigen::Vector3d imaginary = vector();
        Eigen::Quaterniond world =
            Eigen::Quaterniond(symmetric(), imaginary.x(), imaginary.y(), imaginary.z()).normalized();
        Eigen::Vector3d tilt = vector_of(0.02);
        if (planar) {
            world = Eigen::AngleAxisd(3 * symmetric(), Eigen::Vector3d::UnitZ());
            if (x_across) world = world * Eigen::AngleAxisd(-EIGEN_PI / 2, Eigen::Vector3d::UnitY());
            tilt = {0, 0, 0.02 * symmetric()};
        }
        const JointFrame frame_a{narrow(vector_of(0.4)), narrow(turn_a.conjugate() * world)};
        const Eigen::Vector3d anchor = at(state_a_, frame_a.position) + vector_of(0.02);
        const Eigen::Quaterniond tilted =
            Eigen::Quaterniond(1, tilt.x() / 2, tilt.y() / 2, tilt.z() / 2).normalized();
        const Eigen::Vector3d centre(state_b_.position.x, state_b_.position.y, state_b_.position.z);
        return {
            frame_a,
            {narrow(turn_b.conjugate() * (anchor - centre)), narrow(turn_b.conjugate() * tilted * world)}};
    }

  private:
    BodyState state_a_, state_b_;
    Random* random_;

    static Eigen::Quaterniond turn(const BodyState& state)
    {
        const Quat<double>& q = state.orientation;
        return Eigen::Quaterniond(q.w, q.x, q.y, q.z);
    }
    static Eigen::Vector3d at(const BodyState& state, const Vec3<float>& local)
    {
        return Eigen::Vector3d(state.position.x, state.position.y, state.position.z) +
               turn(state) * Eigen::Vector3d(local.x, local.y, local.z);
    }
    static Vec3<double> in_world(const BodyState& state, const Vec3<float>& local)
    {
        const Eigen::Vector3d p = at(state, local);
        return {p.x(), p.y(), p.z()};
    }
    static Vec3<float> from_world(const BodyState& state, const Vec3<double>& p)
    {
        const Vec3<double> d = p - state.position;
        return narrow(turn(state).conjugate() * Eigen::Vector3d(d.x, d.y, d.z));
    }
    static Vec3<float> narrow(const Eigen::Vector3d& v)
    {
        return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
    }
    static Quat<float> narrow(const Eigen::Quaterniond& q)
    {
        return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                static_cast<float>(q.w())};
    }
    [[nodiscard]] Vec3<float> anchor(int kind, int partner) const
    {
        const bool planar = (kind == 1 && partner != 0 && partner != 2) || (partner == 1 && kind >= 3);
        const auto r = [&] { return static_cast<float>(0.5 * symmetric()); };
        return kind == 0 ? Vec3<float>{} : Vec3<float>{r(), r(), planar ? 0 : r()};
    }
};

/// Which sums over its two bodies a joint conserves.
enum class Keeps { nothing, linear_momentum, both_momenta };

/// The cases of a type: `of` returns them; `is_passive` tells of one whether it neither stores nor adds energy.
template <class Definition>
struct JointCases;

template <>
struct JointCases<BallSocketDefinition> {
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const BallSocketDefinition&) { return true; }
    static std::vector<BallSocketDefinition> of(const JointPlace& at)
    {
        const auto [on_a, on_b] = at.meeting_anchors();
        return {{at.a, at.b, on_a, on_b}};
    }
};

template <>
struct JointCases<DistanceDefinition> {
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const DistanceDefinition& joint) { return !joint.has_spring(); }
    static std::vector<DistanceDefinition> of(const JointPlace& at)
    {
        DistanceDefinition rod{at.a, at.b, at.anchor_on_a(), at.anchor_on_b()};
        const float length = at.distance(rod.local_anchor_a, rod.local_anchor_b);
        rod.min_length = rod.max_length = 0.99F * length;
        DistanceDefinition rope = rod, spring = rod;
        rope.min_length = 0;
        rope.max_length = 1.01F * length;
        spring.min_length = 0.95F * length;
        spring.max_length = 1.2F * length;
        spring.rest_length = 1.1F * length;
        spring.spring_hertz = 2;
        spring.spring_damping_ratio = 0.3F;
        DistanceDefinition weak = spring;
        weak.max_length = without_end;
        weak.spring_max_force = 1;
        DistanceDefinition stiff = weak;
        stiff.spring_hertz = stiff.spring_damping_ratio = 0;
        stiff.spring_stiffness = 200;
        stiff.spring_damping = 20;
        stiff.spring_max_force = without_end;
        return {rod, rope, spring, weak, stiff};
    }
};

template <LinearLock linear, AngularLock angular>
struct JointCases<FrameJointDefinition<linear, angular>> {
    using Definition = FrameJointDefinition<linear, angular>;
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const Definition& joint) { return joint.stiffness.hertz == 0; }
    static std::vector<Definition> of(const JointPlace& at)
    {
        const auto [frame_a, frame_b] = at.frames(angular == AngularLock::swing);
        return {{at.a, at.b, frame_a, frame_b, {}}, {at.a, at.b, frame_a, frame_b, {5, 0.5F}}};
    }
};

template <DriveAxis axis>
struct JointCases<DriveDefinition<axis>> {
    using Definition = DriveDefinition<axis>;
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const Definition& drive)
    {
        return !drive.has_spring() && drive.motor_speed == 0 && drive.armature == 0;
    }
    /// A twist is undefined where the axes are opposite. The drive is meant to be used with a joint that keeps the
    /// axes together; near that pose it accelerates free bodies violently.
    static bool is_regular(const Definition& drive, const BodyState& a, const BodyState& b)
    {
        if (axis == DriveAxis::slide) return true;
        if (axis == DriveAxis::euler) {
            const auto axis_of = [](const BodyState& body, const JointFrame& frame,
                                    const Vec3<double>& local) {
                return rotate(body.orientation * unit(convert<double>(frame.rotation)), local);
            };
            return std::abs(dot(axis_of(a, drive.frame_a, {1, 0, 0}), axis_of(b, drive.frame_b, {0, 0, 1}))) <
                   0.9;
        }
        const auto axis_of = [](const BodyState& body, const JointFrame& frame) {
            return rotate(body.orientation * unit(convert<double>(frame.rotation)), Vec3<double>{1, 0, 0});
        };
        return dot(axis_of(a, drive.frame_a), axis_of(b, drive.frame_b)) > -0.8;
    }
    static std::vector<Definition> of(const JointPlace& at)
    {
        Definition limits{.body_a = at.a, .body_b = at.b};
        std::tie(limits.frame_a, limits.frame_b) = at.frames(axis == DriveAxis::twist);
        Definition lock = limits, motor = limits, spring = limits, weak;
        limits.lower = -0.05F;
        limits.upper = 0.1F;
        lock.lower = lock.upper = 0.05F;
        motor.upper = 0.2F;
        motor.motor_speed = 2;
        motor.motor_max_force = axis == DriveAxis::slide ? 5 : 0.5F;
        spring.motor_max_force = axis == DriveAxis::slide ? 1 : 0.1F;
        spring.spring_hertz = 3;
        spring.spring_damping_ratio = 0.4F;
        spring.spring_target = 0.1F;
        weak = spring;
        weak.spring_max_force = 0.2F;
        Definition stiff = spring, damper = motor;
        stiff.spring_hertz = stiff.spring_damping_ratio = 0;
        stiff.spring_stiffness = axis == DriveAxis::slide ? 200.0F : 20.0F;
        stiff.spring_damping = axis == DriveAxis::slide ? 3.0F : 0.3F;
        damper.spring_damping = axis == DriveAxis::slide ? 5.0F : 0.5F;
        Definition rotor = limits, geared = stiff;
        // One limit only. Where C lands on a limit exactly, rounding decides whether the next substep sees room, and C
        // differs by 1e-5 m afterwards. Landing on a second limit would divide that by the substep.
        rotor.lower = -std::numeric_limits<float>::infinity();
        rotor.armature = axis == DriveAxis::slide ? 3.0F : 0.3F;
        geared.armature = 2 * rotor.armature;
        if (axis == DriveAxis::euler) {
            lock.angle = spring.angle = damper.angle = EulerAngle::y;
            motor.angle = stiff.angle = rotor.angle = EulerAngle::z;
        }
        return {limits, lock, motor, spring, weak, stiff, damper, rotor, geared};
    }
};

template <>
struct JointCases<SwingLimitDefinition> {
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const SwingLimitDefinition&) { return true; }
    static std::vector<SwingLimitDefinition> of(const JointPlace& at)
    {
        const auto [frame_a, frame_b] = at.frames(false);
        return {{at.a, at.b, frame_a, frame_b, 0.1F}};
    }
};

template <>
struct JointCases<PointServoDefinition> {
    static constexpr Keeps keeps =
        Keeps::linear_momentum;  // where d is not 0 the force need not act along it
    static bool is_passive(const PointServoDefinition&) { return false; }
    static std::vector<PointServoDefinition> of(const JointPlace& at)
    {
        PointServoDefinition band{at.a, at.b, at.anchor_on_a(), at.anchor_on_b()};
        PointServoDefinition weak = band, motor = band;
        band.hertz = 3;
        band.damping_ratio = 0.4F;
        weak.max_force = 2;
        motor.hertz = 0;
        motor.target_velocity = {0.5F, -0.3F, at.is_in_plane() ? 0 : 0.2F};
        motor.max_force = 5;
        return {band, weak, motor};
    }
};

template <>
struct JointCases<AngularServoDefinition> {
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const AngularServoDefinition&) { return false; }
    static std::vector<AngularServoDefinition> of(const JointPlace& at)
    {
        const auto [frame_a, frame_b] = at.frames(false);
        AngularServoDefinition band{at.a, at.b, frame_a, frame_b, 3, 0.4F};
        AngularServoDefinition weak = band, motor = band;
        weak.max_torque = 0.3F;
        motor.hertz = 0;
        motor.target_velocity = {at.has_planar() ? 0 : 0.5F, at.has_planar() ? 0 : -0.3F, 0.4F};
        motor.max_torque = 1;
        return {band, weak, motor};
    }
};

template <>
struct JointCases<GearDefinition> {
    static constexpr Keeps keeps = Keeps::nothing;  // the rest goes to what carries the gears
    static bool is_passive(const GearDefinition&) { return true; }
    static std::vector<GearDefinition> of(const JointPlace& at)
    {
        return {{at.a, at.b, at.axis(true), at.axis(true), -0.7F}};
    }
};

template <>
struct JointCases<RackAndPinionDefinition> {
    static constexpr Keeps keeps = Keeps::nothing;
    static bool is_passive(const RackAndPinionDefinition&) { return true; }
    static std::vector<RackAndPinionDefinition> of(const JointPlace& at)
    {
        return {{at.a, at.b, at.axis(true), at.axis(false), 0.3F}};
    }
};

template <>
struct JointCases<ScrewDefinition> {
    static constexpr Keeps keeps = Keeps::both_momenta;
    static bool is_passive(const ScrewDefinition&) { return true; }
    static std::vector<ScrewDefinition> of(const JointPlace& at)
    {
        const Vec3<float> on_a = at.anchor_on_a(), on_b = at.anchor_on_b();
        return {{at.a, at.b, on_a, on_b, at.axis(false), 0.3F}, {at.a, at.b, on_a, on_b, at.axis(true), -2}};
    }
};

template <>
struct JointCases<PulleyDefinition> {
    static constexpr Keeps keeps = Keeps::nothing;  // the wheels are fixed to the world
    static bool is_passive(const PulleyDefinition&) { return true; }
    static std::vector<PulleyDefinition> of(const JointPlace& at)
    {
        PulleyDefinition rope{at.a, at.b, at.anchor_on_a(), at.anchor_on_b()};
        // The wheels are above the anchors, so that the lengths stay well above 0.
        const Vec3<double> up{0.3, 2, at.is_in_plane() ? 0 : 0.4};
        const Vec3<double> end_a = at.where_a(rope.local_anchor_a), end_b = at.where_b(rope.local_anchor_b);
        rope.point_a = end_a + up;
        rope.point_b = end_b + up;
        rope.ratio = 1.5F;
        // Taut by 1 mm from the start: for a rope of exactly the largest length, rounding decides whether it is
        // slack.
        const double length = std::sqrt(dot(up, up)) * 2.5;
        rope.max_length = static_cast<float>(length - 1e-3);
        PulleyDefinition rod = rope;
        rod.min_length = rod.max_length;
        return {rope, rod};
    }
};

template <>
struct JointCases<ManifoldDefinition> {
    static constexpr Keeps keeps = Keeps::both_momenta;
    /// A resting contact is at C = 0, where rounding decides whether soft_step treats it as a contact with a gap
    /// (rigid) or without one (soft, which gives up a share of its impulse). From then on float and double differ by
    /// that share.
    static constexpr int soft_steps_until_rest = 6;
    static bool is_passive(const ManifoldDefinition& contact)
    {
        return contact.restitution == 0 && contact.surface_velocity.x == 0;
    }
    /// A manifold half way between the bodies, with some points separated and some not.
    static std::vector<ManifoldDefinition> of(const JointPlace& at)
    {
        const Vec3<double> from = at.where_a({}), to = at.where_b({});
        Vec3<double> d = to - from;
        if (at.has_planar()) d.z = 0;
        const Vec3<double> n = (1 / std::sqrt(dot(d, d))) * d, side{-n.y, n.x, 0};
        ManifoldDefinition contact{at.a, at.b, at.along_a(n)};
        for (int i = 0; i < 4; ++i) {
            const Vec3<double> off{0, 0, at.has_planar() || i < 2 ? 0 : 0.1 * i};
            const Vec3<double> p = 0.5 * (from + to) + (0.2 * (i % 2) - 0.1) * side + off;
            const double separation = i % 3 == 0 ? -0.004 : 0.006;
            contact.points[i] = {at.on_a(p - (0.5 * separation) * n), at.on_b(p + (0.5 * separation) * n)};
        }
        ManifoldDefinition rough = contact, belt = contact;
        rough.point_count = 3;
        rough.friction = 0.4F;
        belt.point_count = 4;
        belt.friction = 0.6F;
        belt.restitution = 0.5F;
        belt.torsional_radius = 0.2F;
        belt.rolling_radius = 0.1F;
        belt.surface_velocity = at.along_a(0.3 * side);
        return {contact, rough, belt};
    }
};

/// Calls visit.template operator()<Definition>() for each type of joint.
template <class... Types, class Visit>
void for_each_joint_type(TypeList<Types...>, const Visit& visit)
{
    (visit.template operator()<typename Types::Definition>(), ...);
}
/// Whether a joint of this definition is allowed between these kinds of bodies.
template <class Definition>
constexpr bool fits(int kind_a, int kind_b)
{
    constexpr int type = TypeOfDefinition<Definition, JointTypes>::index;
    using Store = std::tuple_element_t<static_cast<std::size_t>(type), decltype(JointStores::stores)>;
    if (kind_a > 2 && kind_b > 2) return false;
    if constexpr (Store::Type::needs_bodies_that_turn) return kind_a != 0 && kind_b != 0;
    return true;
}

}  // namespace motley::testing
