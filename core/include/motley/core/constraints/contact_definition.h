// The definition of a contact: one point where two bodies touch or soon will.
#pragma once

#include <cstdint>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// One contact point of the list that a step is given: C = n . (p_b - p_a) >= 0, lambda_n >= 0,
/// |lambda_t| <= mu lambda_n, with the normal n, the surface points p, the normal impulse lambda_n, the friction
/// impulse lambda_t and the friction coefficient mu. Both arms must lead to the same point of the world: then angular
/// momentum is kept.
struct Contact {
    BodyId body_a{};
    BodyId body_b{};
    std::uint64_t key = 0;  ///< unique in the list; the same key and bodies in the next step: a warm start
    Vec3<float> normal{};   ///< unit (1 +- 1e-3), from a to b, world; z = 0 where the pair stays in the plane
    float separation = 0;   ///< m along the normal, -1e9 to 1e9, negative when overlapping
    Vec3<float> arm_a{};    ///< m, world, -1e9 to 1e9: from the centre of mass of a to the contact point
    float friction = 0;     ///< coefficient mu, 0 to 1e9; 0: no friction rows at all
    Vec3<float> arm_b{};    ///< m, world, likewise from the centre of mass of b
    float restitution = 0;  ///< coefficient, 0 to 1
};

/// The load that its contacts put on a body, on average over the last step.
struct BodyLoad {
    float normal_force = 0;          ///< N, sum of the normal forces of its contacts
    float largest_normal_force = 0;  ///< N, of a single contact
    Vec3<float> net_force{};         ///< N, world: vector sum over its contacts, friction included
    float pressure = 0;  ///< N/m: normal_force over the body's circumference; 0 where none was given
};

/// The impulse of a contact in a step or in a substep.
struct ContactImpulse {
    float normal = 0;        ///< N s, >= 0, along the normal on b
    Vec3<float> friction{};  ///< N s, world, on b
};

}  // namespace motley
#pragma GCC visibility pop
