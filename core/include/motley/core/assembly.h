// An assembly: many copies of one articulated figure. The copies are ordinary bodies, joints and capsules, which the host may
// join, push, break and remove like any others. The solver itself finds out that they are alike, and solves sixteen of
// them together, one copy in each lane, as long as they touch no other body that moves.
#pragma once

#include <span>
#include <vector>

#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

struct SixDofDefinition;

/// Bodies, joints and capsules to be copied, in the frame of the figure.
class Figure {
  public:
    /// Adds a body. Its handle is valid only in joints of this figure. Refuses what Scene::add_body refuses.
    BodyId add_body(const BodyDefinition& definition);
    /// Adds a joint between bodies of this figure. Refuses what Scene::add_joint refuses. Pulleys do not compile here:
    /// their points are fixed in the world. To attach a figure to the world, give it a static body.
    template <class Definition>
    void add_joint(const Definition& definition)
    {
        static_assert(
            !requires { definition.point_a; }, "points of the world cannot be copied");
        refuse_ground(definition.body_a);
        refuse_ground(definition.body_b);
        sketch_.add_joint(definition);
    }
    /// Adds the joints of a joint of six degrees of freedom between bodies of this figure. Refuses what motley::add_six_dof
    /// refuses; then nothing is added.
    void add_six_dof(const SixDofDefinition& definition);
    /// Gives a body of this figure a capsule. Refuses what Scene::add_capsule refuses. The groups of each copy are its own:
    /// capsules of one group do not touch in one copy, but do in two.
    void add_capsule(const CapsuleDefinition& capsule);
    [[nodiscard]] std::span<const BodyDefinition> bodies() const { return bodies_; }
    [[nodiscard]] std::size_t joint_count() const { return sketch_.joint_count(); }
    /// Adds this figure's joints and capsules to a scene, between and on `bodies`, which take the place of the figure's
    /// own in the same order.
    void join(Scene& scene, std::span<const BodyId> bodies) const;

  private:
    Scene sketch_;  ///< a copy of the figure: it checks what is added, and keeps the joints
    std::vector<BodyDefinition> bodies_;

    [[nodiscard]] bool is_ground(BodyId body) const;
    void refuse_ground(BodyId body) const;
};

/// Where a copy is placed and how it moves as a whole, world frame.
struct Placing {
    Vec3<double> position{};               ///< m, of the origin of the figure's frame
    Quat<double> orientation{0, 0, 0, 1};  ///< finite, not zero, normalised on entry; planar bodies: about z
    Vec3<float> linear_velocity{};         ///< m/s, added to that of its bodies that are not static
};

/// Adds one copy for each placing. Returns the bodies copy after copy, those of a copy in the order of the figure.
/// Refuses a bad orientation, and what Scene::add_body refuses, naming a body's field; then nothing is added.
std::vector<BodyId> add_assembly(Scene& scene, const Figure& figure, std::span<const Placing> copies);

}  // namespace motley
#pragma GCC visibility pop
