// Figures of capsules that fall among people in a walled room: every kind of shape meets every other.
#pragma once

#include <cmath>
#include <vector>

#include "disc_crowd.h"

namespace motley::testing {

class ShapeCrowd {
  public:
    Scene scene;
    std::vector<BodyId> rigid, people, particles;
    BodyId sweeper;  ///< kinematic, with a capsule that sweeps through the room
    std::vector<CapsuleDefinition> capsules;
    static constexpr double side = 8;  ///< m, of the room

    explicit ShapeCrowd(int figures = 30, int walkers = 60)
    {
        const Vec2<double> corners[] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
        scene.add_wall({.points = corners, .closed = true, .friction = 0.3F});
        scene.add_half_space({.friction = 0.4F});
        scene.add_half_space({.point = {0, 0, 20}, .normal = {0, 0, -1}});
        for (int i = 0; i < figures; ++i) add_pair();
        for (int i = 0; i < walkers; ++i) add_walker(i);
        for (int i = 0; i < 10; ++i) {
            BodyDefinition ball = anywhere(1.5);
            ball.model = BodyModel::particle;
            ball.angular_velocity = {};
            particles.push_back(scene.add_body(ball));
            add({.body = particles.back(), .radius = 0.08F, .restitution = 0.5F});
        }
        sweeper = scene.add_body({.motion = BodyMotion::kinematic_body,
                                  .position = {side / 2, side / 2, 0.3},
                                  .angular_velocity = {0, 0, 0.8F}});
        add({.body = sweeper, .from = {-2, 0, 0}, .to = {2, 0, 0}, .radius = 0.1F, .friction = 0.2F});
    }
    [[nodiscard]] const CapsuleDefinition& capsule(std::size_t i) const { return capsules[i]; }

  private:
    Random random_;

    float some(double low, double high)
    {
        return static_cast<float>(low + (high - low) * 0.5 * (random_.symmetric() + 1));
    }
    BodyDefinition anywhere(double height)
    {
        BodyDefinition body;
        body.mass = some(3, 20);
        body.inertia = {0.3F, 0, 0, 0.4F, 0, 0.35F};
        body.position = {some(0.7, side - 0.7), some(0.7, side - 0.7), height + 2 * some(0, 1)};
        body.orientation = {random_.symmetric(), random_.symmetric(), random_.symmetric(), 1};
        body.linear_velocity = {some(-2, 2), some(-2, 2), some(-2, 0)};
        body.angular_velocity = {some(-2, 2), some(-2, 2), some(-2, 2)};
        return body;
    }
    void add(const CapsuleDefinition& capsule)
    {
        scene.add_capsule(capsule);
        capsules.push_back(capsule);
    }
    /// Two limbs and a joint; the second limb has a sphere as well.
    void add_pair()
    {
        BodyDefinition upper = anywhere(1), lower = upper;
        const Quat<double> q = normalised_exactly(upper.orientation);
        lower.position = upper.position + rotate(q, Vec3<double>{0.6, 0, 0});
        for (const BodyDefinition& limb : {upper, lower}) {
            rigid.push_back(scene.add_body(limb));
            add({.body = rigid.back(),
                 .from = {-0.3F, 0, 0},
                 .to = {0.3F, 0, 0},
                 .radius = 0.1F,
                 .friction = 0.5F,
                 .restitution = 0.1F});
        }
        add({.body = rigid.back(), .from = {0.3F, 0.1F, 0}, .to = {0.3F, 0.1F, 0}, .radius = 0.15F});
        scene.add_joint(
            BallSocketDefinition{rigid[rigid.size() - 2], rigid.back(), {0.3F, 0, 0}, {-0.3F, 0, 0}});
    }
    static Quat<double> normalised_exactly(const Quat<double>& q)
    {
        const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
        return {q.x / length, q.y / length, q.z / length, q.w / length};
    }
    /// A third are discs, a third capsules across the shoulders, a third torsos of three discs.
    void add_walker(int i)
    {
        BodyDefinition body = person_at(some(0.5, side - 0.5), some(0.5, side - 0.5));
        body.yaw = some(-3, 3);
        body.linear_velocity = {some(-2, 2), some(-2, 2), 0};
        people.push_back(scene.add_body(body));
        const BodyId person = people.back();
        if (i % 3 == 0) {
            scene.set_disc(person, {.radius = 0.2F, .friction = 0.2F});
        } else if (i % 3 == 1) {
            add({.body = person,
                 .from = {0, -0.13F, 0},
                 .to = {0, 0.13F, 0},
                 .radius = 0.12F,
                 .friction = 0.2F});
        } else {
            for (const float y : {-0.15F, 0.0F, 0.15F})
                add({.body = person, .from = {0, y, 0}, .to = {0, y, 0}, .radius = y == 0 ? 0.14F : 0.1F});
        }
    }
};

}  // namespace motley::testing
