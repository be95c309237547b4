// People who fall: a person's body becomes a rigid one in place, the pelvis of a figure or the whole person, and a person
// again on rising. What the host does is here: the other bodies of the figure, its joints and its capsules.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "worlds/rig.h"
#include "worlds/view.h"

namespace motley::bench {

/// Of what a fallen person consists: boxes that lie to each other as they do in somebody who stands at the origin, z up,
/// of `mass` kg in all. The first box takes over the person's body.
class FallenShape {
  public:
    /// Eleven boxes with joints that have limits.
    static FallenShape figure(float mass);
    /// One box.
    static FallenShape single(float mass);

    Rig rig;
    Vec3<double> centre{};  ///< m, the centre of mass from that of the first box; above it
    float mass = 0;         ///< kg
    Sym3<float> inertia{};  ///< kg m2, of the whole about its centre of mass

  private:
    FallenShape(Rig parts, float wanted_mass);
};

/// A person who stands: a uniform disc, or a particle with the same mass.
struct Standing {
    float mass = 80;                                                              ///< kg
    float radius = 0.2F;                                                          ///< m
    [[nodiscard]] float moment() const { return 0.5F * mass * radius * radius; }  ///< kg m2, about z
};

/// A person who has fallen.
struct Fallen {
    const FallenShape* shape = nullptr;
    std::vector<BodyId> bodies;  ///< the first one is the person's
    std::uint32_t number = 0;    ///< of the person
    ShapeId capsule{};           ///< of the person's own body
};

/// Momentum, kg m/s, and angular momentum about the centre of mass, kg m2/s.
struct Momenta {
    Vec3<double> linear{}, angular{};
};
[[nodiscard]] Momenta momenta_of(const Scene& scene, BodyId body, const Standing& person);
[[nodiscard]] Momenta momenta_of(const Scene& scene, const Fallen& fallen);

/// The person's body becomes the first of the shape and the others are added, all moving as one rigid body with the momenta
/// that the person had. The person is planar without a disc, or a particle, its centre about as high as that of the first box.
Fallen fall(Scene& scene, BodyId body, const FallenShape& shape, std::uint32_t number);
/// Appends the person and the capsules, each with the pressure of what touches it, the floor included.
void add_silhouettes(const Scene& scene, const Fallen& fallen, View& view);
/// Appends how far each joint has come apart, m.
void add_drifts(const Scene& scene, const Fallen& fallen, std::vector<double>& drifts);
/// Pushes those who have just fallen: adds `rate`, rad/s, about a level axis through where they stand on the floor.
void tip_over(Scene& scene, const Fallen& fallen, float rate);
/// All bodies but the person's are removed. That one becomes planar, upright where the centre of mass is, `height` m above
/// the floor, with the momenta that the fallen had in the plane.
void rise(Scene& scene, const Fallen& fallen, const Standing& person, double height);

}  // namespace motley::bench
