// A crowd that is large enough for patches: discs and balls in a lattice. Neighbours always have a contact, touching
// or not. Contacts are listed square by square, as a neighbour search would list them, or shuffled.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "mixed_scene.h"

namespace motley::testing {

class LatticeCrowd {
  public:
    static constexpr int side = 144;
    static constexpr double radius = 0.2, spacing = 0.39;
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<std::pair<int, int>> pairs;  ///< indices of bodies, in the order of the list

    /// Every fifth body is rigid. Every `still`-th body is static; with 0 none is.
    explicit LatticeCrowd(int still = 97)
    {
        Random random;
        for (int i = 0; i < side * side; ++i) {
            BodyDefinition body;
            body.model = i % 5 == 0 ? BodyModel::rigid : BodyModel::planar;
            body.mass = static_cast<float>(80 + 20 * random.symmetric());
            const float inertia = 0.5F * body.mass * static_cast<float>(radius * radius);
            body.inertia = {inertia, 0, 0, inertia, 0, inertia};
            body.position = {spacing * (i % side) + 0.02 * random.symmetric(),
                             spacing * (i / side) + 0.02 * random.symmetric(), 0};
            body.linear_velocity = {static_cast<float>(random.symmetric()),
                                    static_cast<float>(random.symmetric()), 0};
            if (still != 0 && i % still == 0) {
                body.motion = BodyMotion::static_body;
                body.linear_velocity = {};
            }
            bodies.push_back(scene.add_body(body));
        }
        constexpr int square = 16;
        for (int s = 0; s < side / square * (side / square); ++s) {
            for (int cell = 0; cell < square * square; ++cell) {
                add_neighbours_of(s % (side / square) * square + cell % square,
                                  s / (side / square) * square + cell / square);
            }
        }
    }

    /// Shuffles the list.
    void shuffle()
    {
        Random random;
        for (std::size_t i = pairs.size(); i > 1; --i)
            std::swap(pairs[i - 1], pairs[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    }

    [[nodiscard]] std::vector<Contact> contacts() const
    {
        std::vector<Vec3<double>> positions(bodies.size());
        scene.read_positions(bodies, positions);
        std::vector<Contact> list(pairs.size());
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const auto a = static_cast<std::size_t>(pairs[i].first),
                       b = static_cast<std::size_t>(pairs[i].second);
            const double dx = positions[b].x - positions[a].x, dy = positions[b].y - positions[a].y;
            const double distance = std::sqrt(dx * dx + dy * dy);
            Contact& contact = list[i];
            contact.body_a = bodies[a];
            contact.body_b = bodies[b];
            contact.key = std::uint64_t{a} << 32 | b;
            contact.normal = {static_cast<float>(dx / distance), static_cast<float>(dy / distance), 0};
            contact.separation = static_cast<float>(distance - 2 * radius);
            contact.arm_a = static_cast<float>(distance / 2) * contact.normal;
            contact.arm_b = -contact.arm_a;
            contact.friction = i % 3 == 0 ? 0.5F : 0;
        }
        return list;
    }

  private:
    void add_neighbours_of(int x, int y)
    {
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
            if (x + dx < 0 || x + dx >= side || y + dy >= side) continue;
            const int a = y * side + x, b = (y + dy) * side + x + dx;
            const auto moves = [&](int body) {
                return scene.motion(bodies[static_cast<std::size_t>(body)]) == BodyMotion::dynamic_body;
            };
            if (moves(a) || moves(b)) pairs.emplace_back(a, b);
        }
    }
};

}  // namespace motley::testing
