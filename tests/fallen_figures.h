// People of eleven boxes who fall on a floor: the corners of their boxes touch it, and nothing else.
#pragma once

#include <cmath>
#include <vector>

#include "mixed_scene.h"
#include "rig.h"

namespace motley::testing {

/// A person in T-pose: boxes on ball-sockets with cones and bounded twist, hinges with limits at elbows and knees.
class Ragdoll {
  public:
    static constexpr std::size_t bodies = 11;
    static constexpr std::int64_t joints = 26;
    static constexpr double mass = 61;  ///< kg, of all
    Figure figure;
    std::vector<Vec3<float>> half_extents;  ///< m, of each body
    std::vector<double> masses;             ///< kg, likewise

    Ragdoll()
    {
        add({0, 0, 0}, 10, {.16F, .1F, .1F});     // pelvis
        add({0, .35, 0}, 15, {.18F, .22F, .1F});  // torso
        add({0, .75, 0}, 5, {.1F, .13F, .1F});    // head
        for (const double side : {-1.0, 1.0})
            add({.36 * side, .5, 0}, 2.5F, {.15F, .05F, .05F});                                  // upper arms
        for (const double side : {-1.0, 1.0}) add({.66 * side, .5, 0}, 2, {.15F, .04F, .04F});   // fore arms
        for (const double side : {-1.0, 1.0}) add({.1 * side, -.32, 0}, 7, {.07F, .21F, .07F});  // thighs
        for (const double side : {-1.0, 1.0}) add({.1 * side, -.75, 0}, 4, {.05F, .21F, .05F});  // shins
        socket(0, 1, {0, .12, 0}, 1, .3F, .3F);
        socket(1, 2, {0, .6, 0}, 1, .5F, .4F);
        for (const int side : {0, 1}) {
            const double x = side == 0 ? -1 : 1;
            socket(1, 3 + side, {.2 * x, .5, 0}, 0, .5F, .8F);
            hinge(3 + side, 5 + side, {.51 * x, .5, 0}, 2, .6F);
            socket(0, 7 + side, {.1 * x, -.1, 0}, 1, .4F, .6F);
            hinge(7 + side, 9 + side, {.1 * x, -.53, 0}, 0, .6F);
        }
    }

  private:
    std::vector<BodyId> ids_;
    std::vector<Vec3<double>> at_;

    void add(Vec3<double> position, float kilograms, Vec3<float> half)
    {
        BodyDefinition body;
        body.position = position;
        body.mass = kilograms;
        const Vec3<float> s{half.x * half.x, half.y * half.y, half.z * half.z};
        const float third = kilograms / 3;
        body.inertia = {third * (s.y + s.z), 0, 0, third * (s.x + s.z), 0, third * (s.x + s.y)};
        ids_.push_back(figure.add_body(body));
        at_.push_back(position);
        half_extents.push_back(half);
        masses.push_back(kilograms);
    }
    [[nodiscard]] JointFrame frame(int body, Vec3<double> point, int axis) const
    {
        return {convert<float>(point - at_[static_cast<std::size_t>(body)]), axis_along(axis)};
    }
    [[nodiscard]] BodyId id(int body) const { return ids_[static_cast<std::size_t>(body)]; }
    void limit_twist(int a, int b, Vec3<double> point, int axis, float most)
    {
        TwistDriveDefinition twist{id(a), id(b), frame(a, point, axis), frame(b, point, axis)};
        twist.lower = -most;
        twist.upper = most;
        figure.add_joint(twist);
    }
    void socket(int a, int b, Vec3<double> point, int axis, float most_twist, float most_swing)
    {
        figure.add_joint(BallSocketDefinition{id(a), id(b), frame(a, point, axis).position,
                                              frame(b, point, axis).position});
        limit_twist(a, b, point, axis, most_twist);
        SwingLimitDefinition cone{id(a), id(b)};
        cone.frame_a = frame(a, point, axis);
        cone.frame_b = frame(b, point, axis);
        cone.max_angle = most_swing;
        figure.add_joint(cone);
    }
    void hinge(int a, int b, Vec3<double> point, int axis, float most)
    {
        HingeDefinition hinge{id(a), id(b)};
        hinge.frame_a = frame(a, point, axis);
        hinge.frame_b = frame(b, point, axis);
        figure.add_joint(hinge);
        limit_twist(a, b, point, axis, most);
    }
};

/// Copies of the ragdoll that fall, each turned another way, on the ground at y = 0.
class FallenFigures {
  public:
    struct Options {
        int copies = 32;
        /// Boxes touch smoothly, with friction, or bounce, in turn. Else all have a friction of 0.5.
        bool all_touches = false;
        /// Every other copy is above a kinematic turntable that also moves up and down.
        bool turntable = false;
        /// Not 0: each falls at random, turned any way, from 1 to 1.6 m, at up to 1.4 m/s.
        std::uint64_t seed = 0;
    };
    Ragdoll ragdoll;
    Scene scene;
    std::vector<BodyId> ids;
    BodyId turntable;

    explicit FallenFigures(const Options& options) : options_(options)
    {
        BodyDefinition table;
        table.motion = BodyMotion::kinematic_body;
        turntable = scene.add_body(table);
        std::vector<Placing> places;
        Random random(options.seed);
        for (int i = 0; i < options.copies; ++i) {
            const double turn = 0.7 * i, lean = 0.4 + 0.15 * (i % 9);
            Placing place{.position = {3.0 * (i % 32), 1.3, 3.0 * (i / 32)}};
            place.orientation = {std::cos(turn) * std::sin(lean), 0, std::sin(turn) * std::sin(lean),
                                 std::cos(lean)};
            place.linear_velocity = {0.3F * static_cast<float>(i % 5 - 2), 0, 0.5F};
            if (options.seed != 0) {
                const Quat<double> any{random.symmetric(), random.symmetric(), random.symmetric(),
                                       random.symmetric()};
                const double length =
                    std::sqrt(any.x * any.x + any.y * any.y + any.z * any.z + any.w * any.w);
                place.orientation = {any.x / length, any.y / length, any.z / length, any.w / length};
                place.position.y = 1.3 + 0.3 * random.symmetric();
                place.linear_velocity = {static_cast<float>(random.symmetric()), 0,
                                         static_cast<float>(random.symmetric())};
            }
            places.push_back(place);
        }
        ids = add_assembly(scene, ragdoll.figure, places);
    }

    /// Moves the turntable on. To be called before each step.
    void turn()
    {
        if (options_.turntable)
            scene.set_velocity(turntable, {0.2F, 0.3F * std::sin(0.1F * static_cast<float>(steps_++)), 0},
                               {0, 0.2F, 0});
    }

    /// The corners below or at most 2 cm above the floor, of boxes that are not lost.
    [[nodiscard]] std::vector<Contact> contacts() const
    {
        std::vector<Contact> found;
        const BodyState table = scene.state(turntable);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const std::size_t copy = i / Ragdoll::bodies;
            const BodyState state = scene.state(ids[i]);
            if (!(std::abs(state.position.y) < 100)) continue;
            const bool turns = options_.turntable && copy % 2 == 1;
            const BodyState floor = turns ? table : BodyState{};
            const Vec3<float> half = ragdoll.half_extents[i % Ragdoll::bodies];
            for (unsigned corner = 0; corner < 8; ++corner) {
                const Vec3<double> arm =
                    rotate(state.orientation, Vec3<double>{(corner & 1U) != 0 ? half.x : -half.x,
                                                           (corner & 2U) != 0 ? half.y : -half.y,
                                                           (corner & 4U) != 0 ? half.z : -half.z});
                const double height = state.position.y + arm.y - floor.position.y;
                if (height > 0.02) continue;
                Contact contact;
                contact.body_a = turns ? turntable : scene.ground();
                contact.body_b = ids[i];
                contact.key = 8 * i + corner;
                contact.normal = {0, 1, 0};
                contact.separation = static_cast<float>(height);
                contact.arm_a = convert<float>(state.position + arm - floor.position);
                contact.arm_b = convert<float>(arm);
                const std::size_t touch = options_.all_touches ? i % 3 : 1;
                contact.friction = touch == 0 ? 0 : 0.5F;
                contact.restitution = touch == 2 ? 0.3F : 0;
                if (copy % 4 >= 2 && options_.all_touches) {  // the floor as body b
                    std::swap(contact.body_a, contact.body_b);
                    std::swap(contact.arm_a, contact.arm_b);
                    contact.normal = {0, -1, 0};
                }
                found.push_back(contact);
            }
        }
        return found;
    }

  private:
    Options options_;
    int steps_ = 0;
};

}  // namespace motley::testing
