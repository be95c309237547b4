// Simulates a rig with motley.
#include <cmath>

#include "engines/engine.h"
#include "worlds/box_contacts.h"

namespace motley::bench {
namespace {

/// A rotation that takes x to this unit vector.
Quat<float> turn_of_x_to(const Vec3<float>& axis)
{
    // The quaternion half way between the two axes. For opposite axes it is half a turn about z.
    if (axis.x < -0.999999F) return {0, 0, 1, 0};
    const float w = std::sqrt(0.5F * (1 + axis.x));
    return {0, -axis.z / (2 * w), axis.y / (2 * w), w};
}

class MotleyEngine final : public Engine {
  public:
    MotleyEngine(const Rig& rig, const SolverSettings& settings, const SolverOptions& options)
        : solver_(settings, options), poses_(rig.bodies.size()), bodies_(add_rig(scene_, rig))
    {
        if (rig.collides) boxes_ = std::make_unique<BoxContacts>(rig, bodies_);
    }

    void step(float dt) override
    {
        std::span<const Contact> contacts;
        if (boxes_) {
            read(poses_);
            contacts = boxes_->find(poses_, scene_.ground());
        }
        const StepReport report = solver_.step(scene_, dt, contacts);
        if (report.status != StepStatus::done) throw std::runtime_error("motley: " + report.error);
    }
    void read(std::span<RigPose> poses) const override
    {
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const BodyState state = scene_.state(bodies_[i]);
            poses[i] = {state.position, state.orientation};
        }
    }

  private:
    Scene scene_;
    Solver solver_;
    std::vector<RigPose> poses_;
    std::vector<BodyId> bodies_;
    std::unique_ptr<BoxContacts> boxes_;
};

}  // namespace

std::vector<BodyId> add_rig(Scene& scene, const Rig& rig)
{
    std::vector<BodyId> ids;
    for (const RigBody& from : rig.bodies) {
        BodyDefinition body;
        body.position = from.position;
        body.motion = from.moves ? BodyMotion::dynamic_body : BodyMotion::static_body;
        body.mass = from.mass;
        body.inertia = {from.inertia.x, 0, 0, from.inertia.y, 0, from.inertia.z};
        body.linear_velocity = from.velocity;
        body.angular_velocity = from.spin;
        ids.push_back(scene.add_body(body));
    }
    tie_rig(scene, rig, ids);
    return ids;
}

void tie_rig(Scene& scene, const Rig& rig, std::span<const BodyId> bodies)
{
    for (const RigJoint& joint : rig.joints) {
        const auto end = [&](int body) -> std::pair<BodyId, Vec3<float>> {
            if (body == rig_world) return {scene.ground(), convert<float>(joint.anchor)};
            const auto i = static_cast<std::size_t>(body);
            return {bodies[i], convert<float>(joint.anchor - rig.bodies[i].position)};
        };
        const auto [a, anchor_a] = end(joint.a);
        const auto [b, anchor_b] = end(joint.b);
        const Quat<float> turn = turn_of_x_to(joint.axis);
        const JointFrame frame_a{anchor_a, turn}, frame_b{anchor_b, turn};
        if (joint.tie == RigTie::hinge) {
            scene.add_joint(HingeDefinition{a, b, frame_a, frame_b});
        } else {
            scene.add_joint(BallSocketDefinition{a, b, anchor_a, anchor_b});
        }
        if (joint.tie == RigTie::swing_twist)
            scene.add_joint(SwingLimitDefinition{a, b, frame_a, frame_b, joint.cone});
        if (joint.lower < joint.upper) {
            TwistDriveDefinition limit{a, b, frame_a, frame_b};
            limit.lower = joint.lower;
            limit.upper = joint.upper;
            scene.add_joint(limit);
        }
    }
}

std::unique_ptr<Engine> make_motley_engine(const Rig& rig, SolverSettings settings,
                                           const SolverOptions& options)
{
    settings.gravity = rig_gravity;
    return std::make_unique<MotleyEngine>(rig, settings, options);
}

}  // namespace motley::bench
