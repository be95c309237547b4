// Bullet, with a hinge, a point-to-point and a cone-twist set up as in its manual. It runs on one thread, because
// Debian's build has no task scheduler. Islands are not split: its code for that is quadratic in their number.
#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <btBulletDynamicsCommon.h>

#include <fmt/format.h>

#include <cmath>

#include "engines/engine.h"
#include "engines/peers.h"
#include "measuring/clock.h"

namespace motley::bench {
namespace {

btVector3 vector(const Vec3<double>& v)
{
    return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}
btVector3 vector(const Vec3<float>& v)
{
    return vector(convert<double>(v));
}

/// Times the solver alone; the rest of a step is collision detection and islands.
class TimedWorld final : public btDiscreteDynamicsWorld {
  public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
    double solver_seconds = 0;

  protected:
    void solveConstraints(btContactSolverInfo& info) override
    {
        const double began = now();
        btDiscreteDynamicsWorld::solveConstraints(info);
        solver_seconds += now() - began;
    }
};

class BulletEngine final : public Engine {
  public:
    BulletEngine(const Rig& rig, const PeerSetting& setting) : substeps_(setting.substeps)
    {
        dispatcher_ = std::make_unique<btCollisionDispatcher>(&configuration_);
        world_ = std::make_unique<TimedWorld>(dispatcher_.get(), &broadphase_, &solver_, &configuration_);
        world_->setGravity(vector(rig_gravity));
        world_->getSolverInfo().m_numIterations = setting.iterations;
        world_->getSolverInfo().m_erp = setting.erp;
        world_->getSimulationIslandManager()->setSplitIslands(false);
        if (rig.collides) {
            shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0)));
            add_body(0, nullptr, *shapes_.back(), btTransform::getIdentity(), true)->setFriction(1);
        } else {
            shapes_.push_back(std::make_unique<btSphereShape>(btScalar(0.1)));
        }
        for (const RigBody& from : rig.bodies) {
            if (rig.collides) shapes_.push_back(std::make_unique<btBoxShape>(vector(from.half_extents)));
            const btVector3 inertia = vector(from.inertia);
            btTransform at = btTransform::getIdentity();
            at.setOrigin(vector(from.position));
            btRigidBody* body =
                add_body(from.moves ? from.mass : 0, &inertia, *shapes_.back(), at, rig.collides);
            // Bullet multiplies the friction of the two bodies.
            body->setFriction(rig.collides ? std::sqrt(0.6F) : 0);
            body->setLinearVelocity(vector(from.velocity));
            body->setAngularVelocity(vector(from.spin));
            rig_bodies_.push_back(body);
        }
        for (const RigJoint& joint : rig.joints) add_joint(rig, joint);
    }
    ~BulletEngine() override
    {
        for (const auto& joint : joints_) world_->removeConstraint(joint.get());
        for (const auto& body : bodies_) world_->removeRigidBody(body.get());
    }

    void step(float dt) override
    {
        world_->solver_seconds = 0;
        for (int i = 0; i < substeps_; ++i)
            world_->stepSimulation(dt / static_cast<float>(substeps_),
                                   0);  // 0: exactly one step of this length
    }
    [[nodiscard]] double solver_seconds() const override { return world_->solver_seconds; }
    void read(std::span<RigPose> poses) const override
    {
        for (std::size_t i = 0; i < rig_bodies_.size(); ++i) {
            const btTransform& at = rig_bodies_[i]->getWorldTransform();
            const btVector3& p = at.getOrigin();
            const btQuaternion q = at.getRotation();
            poses[i] = {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}};
        }
    }

  private:
    btDefaultCollisionConfiguration configuration_;
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    std::unique_ptr<btCollisionDispatcher> dispatcher_;
    std::unique_ptr<TimedWorld> world_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
    std::vector<btRigidBody*> rig_bodies_;
    int substeps_;

    btRigidBody* add_body(float mass, const btVector3* inertia, btCollisionShape& shape,
                          const btTransform& at, bool collides)
    {
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape,
                                                      inertia != nullptr ? *inertia : btVector3(0, 0, 0));
        info.m_startWorldTransform = at;
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        btRigidBody* body = bodies_.back().get();
        body->setActivationState(DISABLE_DEACTIVATION);
        world_->addRigidBody(body, collides ? 1 : 0, collides ? 1 : 0);
        return body;
    }
    void add_joint(const Rig& rig, const RigJoint& joint)
    {
        const auto body = [&](int i) -> btRigidBody& {
            return i == rig_world ? btTypedConstraint::getFixedBody()
                                  : *rig_bodies_[static_cast<std::size_t>(i)];
        };
        const auto anchor = [&](int i) {
            return vector(i == rig_world ? joint.anchor
                                         : joint.anchor - rig.bodies[static_cast<std::size_t>(i)].position);
        };
        const btVector3 axis = vector(joint.axis);
        btRigidBody &a = body(joint.a), &b = body(joint.b);
        if (joint.tie == RigTie::hinge) {
            auto hinge =
                std::make_unique<btHingeConstraint>(a, b, anchor(joint.a), anchor(joint.b), axis, axis);
            if (joint.lower < joint.upper) hinge->setLimit(joint.lower, joint.upper);
            joints_.push_back(std::move(hinge));
        } else if (joint.tie == RigTie::swing_twist) {
            const btQuaternion turn = shortestArcQuat(btVector3(1, 0, 0), axis);
            auto cone = std::make_unique<btConeTwistConstraint>(a, b, btTransform(turn, anchor(joint.a)),
                                                                btTransform(turn, anchor(joint.b)));
            cone->setLimit(joint.cone, joint.cone, joint.upper);
            joints_.push_back(std::move(cone));
        } else {
            joints_.push_back(
                std::make_unique<btPoint2PointConstraint>(a, b, anchor(joint.a), anchor(joint.b)));
        }
        world_->addConstraint(joints_.back().get(), true);
    }
};

std::unique_ptr<Engine> make(const Rig& rig, const PeerSetting& setting)
{
    return std::make_unique<BulletEngine>(rig, setting);
}

}  // namespace

Peer bullet()
{
    Peer peer{fmt::format("Bullet {}.{}", btGetVersion() / 100, btGetVersion() % 100), {}, make};
    for (const int iterations : {4, 10, 30, 100}) {
        for (const float erp : {0.2F, 0.8F})
            peer.settings.push_back({fmt::format("{} iterations, erp {}", iterations, erp), iterations, erp});
    }
    for (const int substeps : {2, 4, 8, 16})
        peer.settings.push_back({fmt::format("{} steps of 10, erp 0.8", substeps), 10, 0.8F, substeps});
    return peer;
}

}  // namespace motley::bench
