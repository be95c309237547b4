// The Open Dynamics Engine, on one thread: its thread pool makes it slower. A cone and twist limit is a ball joint
// and an angular motor in Euler mode with stops, as in its manual's ragdolls.
#include <fmt/format.h>
#include <ode/ode.h>

#include "engines/engine.h"
#include "engines/peers.h"

namespace motley::bench {
namespace {

class OdeEngine final : public Engine {
  public:
    OdeEngine(const Rig& rig, const PeerSetting& setting)
        : substeps_(setting.substeps), is_direct_(setting.is_direct)
    {
        world_ = dWorldCreate();
        contacts_ = dJointGroupCreate(0);
        const Vec3<float> g = rig_gravity;
        dWorldSetGravity(world_, g.x, g.y, g.z);
        dWorldSetQuickStepNumIterations(world_, setting.iterations);
        dWorldSetERP(world_, setting.erp);
        dWorldSetCFM(world_, 1e-10F);
        dWorldSetAutoDisableFlag(world_, 0);
        if (rig.collides) {
            space_ = dHashSpaceCreate(nullptr);
            dCreatePlane(space_, 0, 1, 0, 0);
        }
        for (const RigBody& from : rig.bodies) add_body(from);
        for (const RigJoint& joint : rig.joints) add_joint(joint);
    }
    ~OdeEngine() override
    {
        dJointGroupDestroy(contacts_);
        if (space_ != nullptr) dSpaceDestroy(space_);
        dWorldDestroy(world_);
    }

    void step(float dt) override
    {
        const dReal part = static_cast<dReal>(dt) / static_cast<dReal>(substeps_);
        for (int i = 0; i < substeps_; ++i) {
            if (space_ != nullptr) dSpaceCollide(space_, this, &OdeEngine::touch);
            const int done = is_direct_ ? dWorldStep(world_, part) : dWorldQuickStep(world_, part);
            if (done == 0) throw std::runtime_error("ODE: out of memory");
            dJointGroupEmpty(contacts_);
        }
    }
    void read(std::span<RigPose> poses) const override
    {
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const dReal* p = dBodyGetPosition(bodies_[i]);
            const dReal* q = dBodyGetQuaternion(bodies_[i]);
            poses[i] = {{p[0], p[1], p[2]}, {q[1], q[2], q[3], q[0]}};
        }
    }

  private:
    dWorldID world_;
    dJointGroupID contacts_;
    dSpaceID space_ = nullptr;
    std::vector<dBodyID> bodies_;
    int substeps_;
    bool is_direct_;

    void add_body(const RigBody& from)
    {
        dBodyID body = dBodyCreate(world_);
        dBodySetPosition(body, static_cast<dReal>(from.position.x), static_cast<dReal>(from.position.y),
                         static_cast<dReal>(from.position.z));
        dMass mass;
        dMassSetParameters(&mass, from.mass, 0, 0, 0, from.inertia.x, from.inertia.y, from.inertia.z, 0, 0,
                           0);
        dBodySetMass(body, &mass);
        dBodySetLinearVel(body, from.velocity.x, from.velocity.y, from.velocity.z);
        dBodySetAngularVel(body, from.spin.x, from.spin.y, from.spin.z);
        if (!from.moves) dBodySetKinematic(body);
        if (space_ != nullptr) {
            const Vec3<float>& h = from.half_extents;
            dGeomID box = dCreateBox(space_, 2 * h.x, 2 * h.y, 2 * h.z);
            dGeomSetBody(box, body);
        }
        bodies_.push_back(body);
    }
    void add_joint(const RigJoint& joint)
    {
        // ODE wants a body as the first argument, so a joint to the world passes the world as the second.
        dBodyID a = joint.a == rig_world ? nullptr : bodies_[static_cast<std::size_t>(joint.a)];
        dBodyID b = bodies_[static_cast<std::size_t>(joint.b)];
        const auto x = static_cast<dReal>(joint.anchor.x), y = static_cast<dReal>(joint.anchor.y),
                   z = static_cast<dReal>(joint.anchor.z);
        const Vec3<float>& u = joint.axis;
        if (joint.tie == RigTie::hinge) {
            dJointID hinge = dJointCreateHinge(world_, nullptr);
            dJointAttach(hinge, b, a);
            dJointSetHingeAnchor(hinge, x, y, z);
            dJointSetHingeAxis(hinge, u.x, u.y, u.z);
            if (joint.lower < joint.upper) {
                dJointSetHingeParam(hinge, dParamLoStop, joint.lower);
                dJointSetHingeParam(hinge, dParamHiStop, joint.upper);
            }
            return;
        }
        dJointID ball = dJointCreateBall(world_, nullptr);
        dJointAttach(ball, b, a);
        dJointSetBallAnchor(ball, x, y, z);
        if (joint.tie != RigTie::swing_twist) return;
        // Euler angles: the twist about the joint's axis, which is fixed to b, then two swings. The third axis is
        // perpendicular to it.
        dJointID motor = dJointCreateAMotor(world_, nullptr);
        dJointAttach(motor, b, a);
        dJointSetAMotorMode(motor, dAMotorEuler);
        const Vec3<float> across = std::abs(u.x) > 0.5F ? Vec3<float>{0, 1, 0} : Vec3<float>{1, 0, 0};
        dJointSetAMotorAxis(motor, 0, 1, u.x, u.y, u.z);
        dJointSetAMotorAxis(motor, 2, 2, across.x, across.y, across.z);
        const float limits[3] = {joint.upper, joint.cone, joint.cone};
        const int low[3] = {dParamLoStop, dParamLoStop2, dParamLoStop3},
                  high[3] = {dParamHiStop, dParamHiStop2, dParamHiStop3};
        for (int i = 0; i < 3; ++i) {
            dJointSetAMotorParam(motor, low[i], -limits[i]);
            dJointSetAMotorParam(motor, high[i], limits[i]);
        }
    }
    static void touch(void* self, dGeomID one, dGeomID two)
    {
        const auto* engine = static_cast<OdeEngine*>(self);
        dContact found[8];
        const int count = dCollide(one, two, 8, &found[0].geom, sizeof(dContact));
        for (int i = 0; i < count; ++i) {
            found[i].surface.mode = dContactApprox1;
            found[i].surface.mu = 0.6F;
            dJointID joint = dJointCreateContact(engine->world_, engine->contacts_, &found[i]);
            dJointAttach(joint, dGeomGetBody(one), dGeomGetBody(two));
        }
    }
};

std::unique_ptr<Engine> make(const Rig& rig, const PeerSetting& setting)
{
    static const struct Library {
        Library() { dInitODE2(0); }
        ~Library() { dCloseODE(); }
    } library;
    return std::make_unique<OdeEngine>(rig, setting);
}

}  // namespace

Peer ode()
{
    Peer peer{"ODE 0.16", {}, make};
    for (const int iterations : {5, 20, 60, 200}) {
        for (const float erp : {0.2F, 0.8F})
            peer.settings.push_back({fmt::format("{} iterations, erp {}", iterations, erp), iterations, erp});
    }
    for (const int substeps : {4, 16})
        peer.settings.push_back({fmt::format("{} steps of 20, erp 0.8", substeps), 20, 0.8F, substeps});
    for (const int substeps : {1, 4})
        peer.settings.push_back(
            {fmt::format("direct, {} step{}", substeps, substeps == 1 ? "" : "s"), 1, 0.8F, substeps, true});
    return peer;
}

}  // namespace motley::bench
