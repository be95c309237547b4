// What a host says of a contact: one point where two bodies touch or soon will.
#pragma once

#include <cstdint>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// One contact point of a step's bulk list. C = n . (p_b - p_a) >= 0; lambda_n >= 0; |lambda_t| <= mu
/// lambda_n. Both arms lead to the same world point, which is what keeps angular momentum.
struct Contact {
    BodyId body_a{};
    BodyId body_b{};
    std::uint64_t key = 0;  ///< unique in the list; the same key and bodies next step start warm
    Vec3<float> normal{};   ///< unit (1 +- 1e-3), from a to b, world; of two planar bodies: z = 0
    float separation = 0;   ///< m along the normal, negative when overlapping; finite
    Vec3<float> arm_a{};    ///< contact point minus centre of mass of a, world, m
    float friction = 0;     ///< coefficient, >= 0, finite; 0 has no friction rows at all
    Vec3<float> arm_b{};    ///< contact point minus centre of mass of b, world, m
    float restitution = 0;  ///< 0 to 1
};

/// What a body bears of its contacts, on average over the last step.
struct BodyLoad {
    float normal_force = 0;          ///< N, the sum of what its contacts press with
    float largest_normal_force = 0;  ///< N, of one contact
    Vec3<float> net_force{};         ///< N, world: all its contacts together, friction with them
    float pressure = 0;  ///< N/m: normal_force over the body's circumference; 0 where none was given
};

/// What a contact did in a step or in a substep.
struct ContactImpulse {
    float normal = 0;        ///< N s, >= 0, along the normal on b
    Vec3<float> friction{};  ///< N s, world, on b
};

}  // namespace motley
