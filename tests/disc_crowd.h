// A crowd of discs whose contacts the library finds: people of different sizes in a box of walls, some with friction.
#pragma once

#include <cmath>
#include <vector>

#include "mixed_scene.h"

namespace motley::testing {

/// A planar person as a solid disc, kg and m.
inline BodyDefinition person_at(double x, double y, float mass = 80, float radius = 0.2F)
{
    BodyDefinition body;
    body.model = BodyModel::planar;
    body.position = {x, y, 0};
    body.mass = mass;
    body.inertia.zz = 0.5F * mass * radius * radius;
    return body;
}

/// A queue along x of people who touch each other, and a wall along y at the origin: each is driven towards it with so many N.
inline std::vector<BodyId> add_queue(Scene& scene, int count, float radius, float force)
{
    std::vector<BodyId> people;
    for (int i = 0; i < count; ++i) {
        people.push_back(scene.add_body(person_at(static_cast<double>(radius) * (1 + 2 * i), 0)));
        scene.set_disc(people.back(), {.radius = radius});
        scene.set_force(people.back(), {-force, 0, 0}, {});
    }
    return people;
}

struct DiscCrowdOptions {
    int people = 1500;
    float friction = 0;     ///< of every third person
    float speed = 1.5F;     ///< m/s, at most
    double spacing = 0.46;  ///< m
    double far_x = 0;       ///< m: where the crowd is
    bool walls = true;
};

class DiscCrowd {
  public:
    Scene scene;
    std::vector<BodyId> people;
    std::vector<DiscDefinition> discs;
    double side = 0;  ///< m, of the box

    explicit DiscCrowd(const DiscCrowdOptions& options = {}, const std::vector<int>& order = {})
    {
        const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(options.people))));
        side = options.spacing * columns;
        Random random;
        std::vector<BodyDefinition> bodies;
        for (int i = 0; i < options.people; ++i) {
            DiscDefinition disc;
            disc.radius = static_cast<float>(0.2 * (1 + 0.08 * random.symmetric()));
            if (i % 3 == 0) disc.friction = options.friction;
            if (i % 3 == 1) disc.friction = options.friction / 2;
            BodyDefinition body;
            body.model = BodyModel::planar;
            body.mass = static_cast<float>(80 + 20 * random.symmetric());
            body.inertia.zz = 0.5F * body.mass * disc.radius * disc.radius;
            body.position = {
                options.far_x + options.spacing * (i % columns + 0.5) + 0.02 * random.symmetric(),
                options.spacing * (i / columns + 0.5) + 0.02 * random.symmetric(), 0};
            body.linear_velocity = {options.speed * static_cast<float>(random.symmetric()),
                                    options.speed * static_cast<float>(random.symmetric()), 0};
            bodies.push_back(body);
            discs.push_back(disc);
        }
        people.resize(bodies.size());
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const std::size_t who = order.empty() ? i : static_cast<std::size_t>(order[i]);
            people[who] = scene.add_body(bodies[who]);
        }
        scene.set_discs(people, std::span<const DiscDefinition>(discs));
        if (!options.walls) return;
        const double low = options.far_x, high = options.far_x + side;
        const Vec2<double> corners[] = {{low, 0}, {high, 0}, {high, side}, {low, side}};
        scene.add_wall({.points = corners, .closed = true, .friction = options.friction});
    }

    /// Pulls everybody towards the middle, with so many N.
    void pull_together(float force)
    {
        std::vector<Vec3<double>> at(people.size());
        scene.read_positions(people, std::span(at));
        std::vector<Vec3<float>> forces;
        for (const Vec3<double>& p : at) {
            const double x = side / 2 - p.x, y = side / 2 - p.y, length = std::sqrt(x * x + y * y) + 1e-3;
            forces.push_back(
                {force * static_cast<float>(x / length), force * static_cast<float>(y / length), 0});
        }
        scene.set_forces(people, std::span<const Vec3<float>>(forces));
    }

    /// The deepest overlap of any two people, m, by testing every pair.
    [[nodiscard]] double deepest_overlap() const
    {
        std::vector<Vec3<double>> at(people.size());
        scene.read_positions(people, std::span(at));
        double deepest = 0;
        for (std::size_t i = 0; i < at.size(); ++i) {
            for (std::size_t j = i + 1; j < at.size(); ++j) {
                const double x = at[i].x - at[j].x, y = at[i].y - at[j].y;
                const double near =
                    static_cast<double>(discs[i].radius) + static_cast<double>(discs[j].radius);
                if (x * x + y * y < near * near) deepest = std::max(deepest, near - std::sqrt(x * x + y * y));
            }
        }
        return deepest;
    }
};

}  // namespace motley::testing
