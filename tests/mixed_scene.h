// A small scene in which every pair of body kinds meets in every constraint: balls of all models that fall on a
// static floor, past a kinematic paddle, joined by ball-sockets, rods, ropes and springs. Used wherever a claim must
// hold for all of them at once.
#pragma once

#include <cmath>
#include <vector>

#include "motley/motley.h"

namespace motley::testing {

/// Random numbers that are the same everywhere: Knuth's 64-bit LCG, the top 24 bits.
class Random {
  public:
    explicit Random(std::uint64_t seed = 12345) : state_(seed) {}
    /// Uniform in [-1, 1).
    double symmetric()
    {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return 2 * static_cast<double>(state_ >> 40) / 16777216.0 - 1;
    }
    /// Uniform in [0, bound).
    int below(int bound) { return static_cast<int>((symmetric() + 1) / 2 * bound); }

  private:
    std::uint64_t state_;
};

class MixedScene {
  public:
    static constexpr double radius = 0.25;
    static constexpr double floor_height = 0;
    Scene scene;
    std::vector<BodyId> balls;
    std::vector<ConstraintId> joints;
    BodyId paddle;
    float friction = 0.3F, restitution = 0.4F;

    /// `count` balls of each model, in the plane z = 0, in which planar bodies live.
    explicit MixedScene(int count = 20, std::uint64_t seed = 12345)
    {
        Random random(seed);
        for (int i = 0; i < 3 * count; ++i) {
            BodyDefinition ball;
            ball.model = static_cast<BodyModel>(i % 3);
            ball.mass = static_cast<float>(1.5 + random.symmetric());
            const float inertia = 0.4F * ball.mass * static_cast<float>(radius * radius);
            ball.inertia = {inertia, 0.1F * inertia, 0, 1.1F * inertia, 0, 0.9F * inertia};
            ball.position = {0.55 * (i % 8) + 0.02 * random.symmetric(), 0.6 + 0.55 * (i / 8), 0};
            ball.linear_velocity = {static_cast<float>(random.symmetric()),
                                    static_cast<float>(random.symmetric()), 0};
            if (ball.model == BodyModel::rigid)
                ball.angular_velocity = {0.5F, static_cast<float>(random.symmetric()), 1};
            if (ball.model == BodyModel::planar) ball.yaw = 3 * random.symmetric();
            balls.push_back(scene.add_body(ball));
        }
        BodyDefinition moving_wall;
        moving_wall.motion = BodyMotion::kinematic_body;
        moving_wall.position = {-1.5, 1, 0};
        moving_wall.linear_velocity = {0.4F, 0, 0};
        moving_wall.angular_velocity = {0, 0, 0.5F};
        paddle = scene.add_body(moving_wall);

        for (int i = 0; i + 9 < 3 * count; i += 4) {
            const BodyId a = balls[static_cast<std::size_t>(i)],
                         b = balls[static_cast<std::size_t>(i + 8 + i % 2)];
            DistanceDefinition distance;
            distance.body_a = a;
            distance.body_b = b;
            // Rods, ropes, and springs with limits.
            const int mode = (i / 4) % 3;
            distance.min_length = mode == 0 ? 0.6F : mode == 1 ? 0 : 0.3F;
            distance.max_length = mode == 2 ? 0.9F : 0.6F;
            distance.spring_hertz = mode == 2 ? 3 : 0;
            distance.spring_damping_ratio = 0.2F;
            distance.rest_length = 0.6F;
            joints.push_back(scene.add_joint(distance));
        }
        for (int i = 1; i + 1 < 3 * count; i += 5) {
            const BodyId a = balls[static_cast<std::size_t>(i)], b = balls[static_cast<std::size_t>(i + 1)];
            const auto anchor = [&](BodyId body, float x) {
                return scene.model(body) == BodyModel::particle ? Vec3<float>{} : Vec3<float>{x, 0, 0};
            };
            joints.push_back(
                scene.add_joint(BallSocketDefinition{a, b, anchor(a, 0.27F), anchor(b, -0.27F)}));
        }
        // One body of each model hangs on the world, which is body a or body b of the definition.
        for (int i = 0; i < 3; ++i) {
            const BodyState s = scene.state(balls[static_cast<std::size_t>(i)]);
            const Vec3<float> hook = convert<float>(s.position);
            const BodyId ball = balls[static_cast<std::size_t>(i)];
            joints.push_back(scene.add_joint(i % 2 == 0
                                                 ? BallSocketDefinition{scene.ground(), ball, hook, {}}
                                                 : BallSocketDefinition{ball, scene.ground(), {}, hook}));
        }
    }

    /// The contacts of the present positions; tests every pair.
    const std::vector<Contact>& contacts()
    {
        contacts_.clear();
        std::vector<Vec3<double>>& at = positions_;
        at.resize(balls.size());
        scene.read_positions(balls, at);
        for (std::size_t i = 0; i < balls.size(); ++i) {
            if (scene.is_contained(balls[i])) continue;
            for (std::size_t j = i + 1; j < balls.size(); ++j) {
                const Vec3<double> d = at[j] - at[i];
                const double distance = std::sqrt(dot(d, d));
                if (distance > 2.2 * radius || distance < 1e-9 || scene.is_contained(balls[j])) continue;
                add(balls[i], balls[j], std::uint64_t{i} << 32 | j, (1 / distance) * d, distance - 2 * radius,
                    radius, radius);
            }
            const double above = at[i].y - floor_height;
            if (above < 1.2 * radius) {
                // The ground is at the origin, so its lever arm is the contact point.
                Contact floor = make(scene.ground(), balls[i], std::uint64_t{i} << 32 | 0xFFFFFFFF, {0, 1, 0},
                                     above - radius);
                floor.arm_a = {static_cast<float>(at[i].x), 0, static_cast<float>(at[i].z)};
                floor.arm_b = {0, static_cast<float>(-above), 0};
                if (i % 2 == 0) {  // the same contact with the bodies exchanged
                    std::swap(floor.body_a, floor.body_b);
                    std::swap(floor.arm_a, floor.arm_b);
                    floor.normal = -floor.normal;
                }
                contacts_.push_back(floor);
            }
        }
        return contacts_;
    }

  private:
    std::vector<Contact> contacts_;
    std::vector<Vec3<double>> positions_;

    Contact make(BodyId a, BodyId b, std::uint64_t key, const Vec3<double>& normal, double separation) const
    {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = key;
        contact.normal = convert<float>(normal);
        contact.separation = static_cast<float>(separation);
        // A third of the contacts each are smooth, have friction, or bounce, so that all kinds share colours.
        contact.friction = key % 3 == 0 ? 0 : friction;
        contact.restitution = key % 3 == 2 ? restitution : 0;
        return contact;
    }
    void add(BodyId a, BodyId b, std::uint64_t key, Vec3<double> normal, double separation, double ra,
             double rb)
    {
        // For two planar bodies rounding must not turn the normal out of the plane.
        if (scene.model(a) == BodyModel::planar && scene.model(b) == BodyModel::planar) normal.z = 0;
        Contact contact = make(a, b, key, normal, separation);
        contact.arm_a = static_cast<float>(ra + separation / 2) * contact.normal;
        contact.arm_b = static_cast<float>(-(rb + separation / 2)) * contact.normal;
        contacts_.push_back(contact);
    }
};

}  // namespace motley::testing
