// Nets of one kind of constraint, every kind in turn.
#include "worlds/tie_net.h"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>

#include "worlds/random.h"

namespace motley::bench {

void TieNet::add_bodies(int side, BodyModel model, BodyOrder order)
{
    std::vector<int> places(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    std::iota(places.begin(), places.end(), 0);
    if (order == BodyOrder::shuffled) shuffle(places);
    bodies.resize(places.size());
    for (const int i : places) {
        BodyDefinition body{.model = model, .mass = 1};
        body.position = {0.4 * (i % side), 0.4 * (i / side), 0};
        body.inertia = {0.02F, 0, 0, 0.02F, 0, 0.02F};
        bodies[static_cast<std::size_t>(i)] = scene.add_body(body);
    }
}

std::unique_ptr<TieNet> make_net(const Tie& tie, BodyModel model, int side, BodyOrder order)
{
    auto net = std::make_unique<TieNet>();
    net->add_bodies(side, model, order);
    for (int i = 0; i < side * side; ++i) {
        const auto a = static_cast<std::size_t>(i);
        if (i % side + 1 < side) tie(*net, net->bodies[a], net->bodies[a + 1], {0.2F, 0, 0});
        if (i / side + 1 < side)
            tie(*net, net->bodies[a], net->bodies[a + static_cast<std::size_t>(side)], {0, 0.2F, 0});
    }
    return net;
}

Tie contact_tie(float friction, float restitution)
{
    return [=](TieNet& net, BodyId a, BodyId b, Vec3<float> arm) {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = net.contacts.size();
        contact.normal = 5.0F * arm;
        contact.separation = -0.001F;
        contact.arm_a = arm;
        contact.arm_b = -arm;
        contact.friction = friction;
        contact.restitution = restitution;
        net.contacts.push_back(contact);
    };
}

namespace {

/// A joint between frames at the point where the bodies meet; `fill` sets the fields that only this type has.
template <class Definition>
Tie frames(void (*fill)(Definition&) = [](Definition&) {})
{
    return [fill](TieNet& net, BodyId a, BodyId b, Vec3<float> arm) {
        Definition joint;
        joint.body_a = a;
        joint.body_b = b;
        joint.frame_a.position = arm;
        joint.frame_b.position = -arm;
        fill(joint);
        net.scene.add_joint(joint);
    };
}

/// A joint between two bodies; `fill` sets the fields that only this type has.
template <class Definition>
Tie joint(void (*fill)(Definition&, Vec3<float> arm) = [](Definition&, Vec3<float>) {})
{
    return [fill](TieNet& net, BodyId a, BodyId b, Vec3<float> arm) {
        Definition joint;
        joint.body_a = a;
        joint.body_b = b;
        fill(joint, arm);
        net.scene.add_joint(joint);
    };
}

template <class Definition>
void everything(Definition& drive)
{
    drive.lower = -1;
    drive.upper = 1;
    drive.motor_speed = 1;
    drive.motor_max_force = 1;
    drive.spring_hertz = 2;
}

template <class Definition>
void at_anchors(Definition& joint, Vec3<float> arm)
{
    joint.local_anchor_a = arm;
    joint.local_anchor_b = -arm;
}

/// Six degrees of freedom set up as a hinge.
void six_dof_hinge(TieNet& net, BodyId a, BodyId b, Vec3<float> arm)
{
    SixDofDefinition six;
    six.body_a = a;
    six.body_b = b;
    six.frame_a.position = arm;
    six.frame_b.position = -arm;
    six.rotation[0] = AxisSetup::free();
    add_six_dof(net.scene, six);
}

}  // namespace

std::vector<NamedTie> every_tie()
{
    const auto planar = BodyModel::planar, rigid = BodyModel::rigid;
    const Tie rod = joint<DistanceDefinition>(
        [](DistanceDefinition& j, Vec3<float>) { j.min_length = j.max_length = 0.4F; });
    const Tie strut = joint<DistanceDefinition>([](DistanceDefinition& j, Vec3<float>) {
        j.min_length = 0.3F;
        j.max_length = 0.5F;
        j.rest_length = 0.4F;
        j.spring_hertz = 2;
    });
    return {{"smooth_contact/planar", planar, contact_tie(0)},
            {"smooth_contact/particle", BodyModel::particle, contact_tie(0)},
            {"smooth_contact/rigid", rigid, contact_tie(0)},
            {"contact/planar", planar, contact_tie(0.5F)},
            {"contact/rigid", rigid, contact_tie(0.5F)},
            {"bouncing_contact/planar", planar, contact_tie(0.5F, 0.5F)},
            {"bouncing_contact/rigid", rigid, contact_tie(0.5F, 0.5F)},
            {"ball_socket/planar", planar, joint<BallSocketDefinition>(at_anchors<BallSocketDefinition>)},
            {"ball_socket/rigid", rigid, joint<BallSocketDefinition>(at_anchors<BallSocketDefinition>)},
            {"rod/planar", planar, rod},
            {"rod/rigid", rigid, rod},
            {"strut/rigid", rigid, strut},
            {"fixed/rigid", rigid, frames<FixedDefinition>()},
            {"hinge/rigid", rigid, frames<HingeDefinition>()},
            {"six_dof_hinge/rigid", rigid, six_dof_hinge},
            {"slider/rigid", rigid, frames<SliderDefinition>()},
            {"point_on_plane/rigid", rigid, frames<PointOnPlaneDefinition>()},
            {"point_on_line/rigid", rigid, frames<PointOnLineDefinition>()},
            {"rotation_lock/rigid", rigid, frames<RotationLockDefinition>()},
            {"parallel_axes/rigid", rigid, frames<ParallelAxesDefinition>()},
            {"perpendicular_axes/rigid", rigid, frames<PerpendicularAxesDefinition>()},
            {"slide_drive/rigid", rigid, frames<SlideDriveDefinition>(everything<SlideDriveDefinition>)},
            {"twist_drive/rigid", rigid, frames<TwistDriveDefinition>(everything<TwistDriveDefinition>)},
            {"euler_drive/rigid", rigid, frames<EulerDriveDefinition>(everything<EulerDriveDefinition>)},
            {"swing_limit/rigid", rigid, frames<SwingLimitDefinition>()},
            {"point_servo/rigid", rigid, joint<PointServoDefinition>(at_anchors<PointServoDefinition>)},
            {"angular_servo/rigid", rigid, frames<AngularServoDefinition>()},
            {"gear/rigid", rigid, joint<GearDefinition>()},
            {"rack_and_pinion/rigid", rigid, joint<RackAndPinionDefinition>()},
            {"screw/rigid", rigid, joint<ScrewDefinition>(at_anchors<ScrewDefinition>)},
            {"pulley/rigid", rigid, joint<PulleyDefinition>([](PulleyDefinition& pulley, Vec3<float> arm) {
                 at_anchors(pulley, arm);
                 pulley.point_a = {-1, 30, 0};
                 pulley.point_b = {1, 30, 0};
                 pulley.max_length = 40;
             })},
            {"manifold/rigid", rigid, joint<ManifoldDefinition>([](ManifoldDefinition& m, Vec3<float> arm) {
                 m.normal = arm;
                 m.point_count = 4;
                 for (int i = 0; i < 4; ++i) {
                     const Vec3<float> off{0.1F * arm.y * static_cast<float>(i % 2),
                                           0.1F * arm.x * static_cast<float>(i % 2),
                                           0.05F * static_cast<float>(i / 2)};
                     m.points[i] = {arm + off, off - arm};
                 }
                 m.friction = 0.5F;
                 m.torsional_radius = 0.1F;
                 m.rolling_radius = 0.01F;
             })}};
}

NamedTie tie_called(std::string_view name)
{
    for (NamedTie& tie : every_tie()) {
        if (tie.name == name) return tie;
    }
    throw std::runtime_error(fmt::format("{}: no such kernel", name));
}

}  // namespace motley::bench
