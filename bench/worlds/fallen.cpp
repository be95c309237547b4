// See fallen.h.
#include "worlds/fallen.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engines/engine.h"
#include "worlds/rigs/nets.h"

namespace motley::bench {
namespace {

constexpr float friction = 0.6F;

/// Turns y up, as rigs have it, to z up.
template <class Real>
Vec3<Real> z_up(const Vec3<Real>& v)
{
    return {v.x, -v.z, v.y};
}
Rig z_up(Rig rig)
{
    const auto sizes = [](const Vec3<float>& v) { return Vec3<float>{v.x, v.z, v.y}; };
    for (RigBody& body : rig.bodies) {
        body.position = z_up(body.position);
        body.inertia = sizes(body.inertia);
        body.half_extents = sizes(body.half_extents);
    }
    for (RigJoint& joint : rig.joints) {
        joint.anchor = z_up(joint.anchor);
        joint.axis = z_up(joint.axis);
    }
    return rig;
}

Sym3<float> tensor_of(const RigBody& body)
{
    return {body.inertia.x, 0, 0, body.inertia.y, 0, body.inertia.z};
}

/// What a body of this mass adds to the momenta about a centre of mass that is at rest at the origin.
Momenta momenta_of(const BodyState& state, const RigBody& part)
{
    const Vec3<double> w = rotate(conjugate(state.orientation), convert<double>(state.angular_velocity));
    const Vec3<double> own =
        rotate(state.orientation, Vec3<double>{static_cast<double>(part.inertia.x) * w.x,
                                               static_cast<double>(part.inertia.y) * w.y,
                                               static_cast<double>(part.inertia.z) * w.z});
    const Vec3<double> linear = static_cast<double>(part.mass) * convert<double>(state.linear_velocity);
    return {linear, own + cross(state.position, linear)};
}

/// Where the centre of mass of the fallen is, m.
Vec3<double> centre_of(const Scene& scene, const Fallen& fallen)
{
    Vec3<double> sum{};
    double masses = 0;
    for (std::size_t i = 0; i < fallen.bodies.size(); ++i) {
        const auto mass = static_cast<double>(fallen.shape->rig.bodies[i].mass);
        sum = sum + mass * scene.state(fallen.bodies[i]).position;
        masses += mass;
    }
    return 1 / masses * sum;
}

/// The box as a capsule along its longest side.
CapsuleDefinition capsule_of(const RigBody& box, BodyId body, std::uint32_t group)
{
    const Vec3<float>& half = box.half_extents;
    const float longest = std::max({half.x, half.y, half.z});
    const float radius = (half.x + half.y + half.z - longest) / 2;
    const float reach = std::max(0.0F, longest - radius);
    const Vec3<float> end = half.x == longest   ? Vec3<float>{reach, 0, 0}
                            : half.y == longest ? Vec3<float>{0, reach, 0}
                                                : Vec3<float>{0, 0, reach};
    return {.body = body, .from = -end, .to = end, .radius = radius, .friction = friction, .group = group};
}

}  // namespace

FallenShape::FallenShape(Rig parts, float wanted_mass) : rig(std::move(parts)), mass(wanted_mass)
{
    float sum = 0;
    for (const RigBody& body : rig.bodies) sum += body.mass;
    for (RigBody& body : rig.bodies) {
        const float scale = wanted_mass / sum;
        body.mass *= scale;
        body.inertia = scale * body.inertia;
        centre = centre + static_cast<double>(body.mass / wanted_mass) * body.position;
    }
    for (const RigBody& body : rig.bodies) {
        const Vec3<float> r = convert<float>(body.position - centre);
        const float m = body.mass;
        inertia = inertia + tensor_of(body) +
                  Sym3<float>{m * (r.y * r.y + r.z * r.z), -m * r.x * r.y, -m * r.x * r.z,
                              m * (r.x * r.x + r.z * r.z), -m * r.y * r.z, m * (r.x * r.x + r.y * r.y)};
    }
}

FallenShape FallenShape::figure(float mass)
{
    return FallenShape(z_up(make_figure()), mass);
}

FallenShape FallenShape::single(float mass)
{
    const Vec3<float> half{0.2F, 0.12F, 0.85F};
    const float third = mass / 3;
    Rig rig;
    rig.bodies.push_back(
        {.mass = mass,
         .inertia = {third * (half.y * half.y + half.z * half.z), third * (half.x * half.x + half.z * half.z),
                     third * (half.x * half.x + half.y * half.y)},
         .half_extents = half});
    return FallenShape(std::move(rig), mass);
}

Momenta momenta_of(const Scene& scene, BodyId body, const Standing& person)
{
    const BodyState state = scene.state(body);
    return {static_cast<double>(person.mass) * convert<double>(state.linear_velocity),
            {0, 0, static_cast<double>(person.moment() * state.angular_velocity.z)}};
}

Momenta momenta_of(const Scene& scene, const Fallen& fallen)
{
    const Vec3<double> centre = centre_of(scene, fallen);
    Momenta all;
    for (std::size_t i = 0; i < fallen.bodies.size(); ++i) {
        BodyState state = scene.state(fallen.bodies[i]);
        state.position = state.position - centre;
        const Momenta part = momenta_of(state, fallen.shape->rig.bodies[i]);
        all = {all.linear + part.linear, all.angular + part.angular};
    }
    return all;
}

Fallen fall(Scene& scene, BodyId body, const FallenShape& shape, std::uint32_t number)
{
    // With the inertia of the whole the body turns as all of it will; its own mass then keeps that velocity.
    scene.change_body(body, {BodyModel::rigid, shape.inertia});
    const RigBody& first = shape.rig.bodies.front();
    scene.set_mass(body, first.mass, tensor_of(first));
    const BodyState state = scene.state(body);
    Fallen fallen{&shape, {body}, number, {}};
    for (std::size_t i = 1; i < shape.rig.bodies.size(); ++i) {
        const RigBody& part = shape.rig.bodies[i];
        const Vec3<double> arm = rotate(state.orientation, part.position);
        fallen.bodies.push_back(scene.add_body(
            {.position = state.position + arm,
             .orientation = state.orientation,
             .linear_velocity = state.linear_velocity + cross(state.angular_velocity, convert<float>(arm)),
             .angular_velocity = state.angular_velocity,
             .mass = part.mass,
             .inertia = tensor_of(part)}));
    }
    tie_rig(scene, shape.rig, fallen.bodies);
    // Parts of one person do not touch each other.
    for (std::size_t i = 0; i < fallen.bodies.size(); ++i) {
        const ShapeId capsule =
            scene.add_capsule(capsule_of(shape.rig.bodies[i], fallen.bodies[i], number + 1));
        if (i == 0) fallen.capsule = capsule;
    }
    return fallen;
}

void add_silhouettes(const Scene& scene, const Fallen& fallen, View& view)
{
    std::vector<BodyLoad> loads(fallen.bodies.size());
    scene.read_loads(fallen.bodies, {}, StridedSpan<BodyLoad>(loads));
    for (std::size_t i = 0; i < fallen.bodies.size(); ++i) {
        const CapsuleDefinition capsule = capsule_of(fallen.shape->rig.bodies[i], fallen.bodies[i], 0);
        const BodyState state = scene.state(fallen.bodies[i]);
        const Vec3<double> end = rotate(state.orientation, convert<double>(capsule.to));
        const Vec2<double> at{state.position.x, state.position.y}, along{end.x, end.y};
        const auto radius = static_cast<double>(capsule.radius);
        const double around = 6.283185307179586 * radius + 4 * std::sqrt(dot(end, end));
        view.shapes.push_back({at - along, at + along, radius,
                               static_cast<double>(loads[i].normal_force) / around, view.people.size()});
    }
    const Vec3<double> centre = centre_of(scene, fallen);
    view.people.push_back({centre.x, centre.y});
    view.numbers.push_back(fallen.bodies.front().slot);
}

void add_drifts(const Scene& scene, const Fallen& fallen, std::vector<double>& drifts)
{
    for (const RigJoint& joint : fallen.shape->rig.joints) {
        const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
        const auto on = [&](std::size_t body) {
            return convert<float>(joint.anchor - fallen.shape->rig.bodies[body].position);
        };
        const Vec3<double> apart =
            anchor_separation(scene.state(fallen.bodies[a]), scene.state(fallen.bodies[b]), on(a), on(b));
        drifts.push_back(std::sqrt(dot(apart, apart)));
    }
}

void tip_over(Scene& scene, const Fallen& fallen, float rate)
{
    const Vec3<double> first = scene.state(fallen.bodies.front()).position, foot{first.x, first.y, 0};
    const Vec3<float> tip{0, rate, 0};
    for (const BodyId body : fallen.bodies) {
        const BodyState state = scene.state(body);
        scene.set_velocity(body, state.linear_velocity + cross(tip, convert<float>(state.position - foot)),
                           state.angular_velocity + tip);
    }
}

void rise(Scene& scene, const Fallen& fallen, const Standing& person, double height)
{
    const Momenta momenta = momenta_of(scene, fallen);
    const Vec3<double> centre = centre_of(scene, fallen);
    const BodyId body = fallen.bodies.front();
    scene.remove_shape(fallen.capsule);
    scene.remove_bodies(std::span(fallen.bodies).subspan(1));
    // A ball with the moment of the disc takes the momenta of all.
    const float moment = person.moment();
    scene.set_mass(body, person.mass, {moment, 0, 0, moment, 0, moment});
    scene.set_velocity(body, convert<float>(1 / static_cast<double>(person.mass) * momenta.linear),
                       convert<float>(1 / static_cast<double>(moment) * momenta.angular));
    scene.change_body(body, {BodyModel::planar, {0, 0, 0, 0, 0, moment}});
    scene.set_pose(body, {centre.x, centre.y, height}, {0, 0, 0, 1}, scene.state(body).yaw);
}

}  // namespace motley::bench
