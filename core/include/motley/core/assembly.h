// An assembly: many copies of one articulated figure. The copies are ordinary bodies and joints, which the host may
// join, push, break and remove like any others; that they are alike is found by the solver, which keeps sixteen of
// them in lanes, a copy a lane, as long as nothing else touches them.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "motley/core/scene.h"

namespace motley {

/// Bodies and joints to be copied, as they stand around the origin.
class Figure {
  public:
    /// Adds a body. The handle is good for joints of this figure alone. Refuses what Scene::add_body refuses.
    BodyId add_body(const BodyDefinition& definition);
    /// Adds a joint between bodies of this figure. Refuses what Scene::add_joint refuses. Not of pulleys, whose
    /// points are the world's. What hangs on the world hangs on a static body of the figure.
    template <class Definition>
    void add_joint(const Definition& definition)
    {
        static_assert(
            !requires { definition.point_a; }, "points of the world cannot be copied");
        sketch_.add_joint(definition);
        joints_.push_back(
            [definition, this_a = index_of(definition.body_a), this_b = index_of(definition.body_b)](
                Scene& scene, std::span<const BodyId> bodies) {
                Definition copy = definition;
                copy.body_a = bodies[this_a];
                copy.body_b = bodies[this_b];
                scene.add_joint(copy);
            });
    }
    [[nodiscard]] std::span<const BodyDefinition> bodies() const { return bodies_; }
    [[nodiscard]] std::size_t joint_count() const { return joints_.size(); }
    /// Adds this figure's joints between bodies of a scene, which stand for its own in their order.
    void join(Scene& scene, std::span<const BodyId> bodies) const;

  private:
    Scene sketch_;  ///< checks what is added
    std::vector<BodyDefinition> bodies_;
    std::vector<BodyId> ids_;
    std::vector<std::function<void(Scene&, std::span<const BodyId>)>> joints_;

    [[nodiscard]] std::size_t index_of(BodyId body) const;
};

/// Where a copy stands and how it moves as a whole.
struct Placing {
    Vec3<double> position{};               ///< m, finite: of the figure's origin
    Quat<double> orientation{0, 0, 0, 1};  ///< finite, not zero; about z alone for figures with planar bodies
    Vec3<float> linear_velocity{};         ///< m/s, added to that of its bodies
};

/// Adds a copy a placing. Returns the bodies, those of one copy in line in the figure's order. Refuses what
/// Scene::add_body refuses, naming a body's field; then nothing is added.
std::vector<BodyId> add_assembly(Scene& scene, const Figure& figure, std::span<const Placing> copies);

}  // namespace motley
