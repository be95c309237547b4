// The checks that joint definitions share.
#pragma once

#include <string_view>

#include "motley/core/body.h"

namespace motley {

/// What a joint's validation may need to know of its bodies.
struct JointBodies {
    BodyModel model_a, model_b;
    bool fixed_a, fixed_b;  ///< static or kinematic
};

inline constexpr float largest_length = 1e9F;

/// Refuses a value outside [low, high] or not finite.
void check_range(std::string_view field, float value, float low, float high, std::string_view expected);
/// Refuses an anchor that is not finite or longer than 1e9 m, or not at the centre of a particle, which has
/// no orientation to carry it.
void check_anchor(std::string_view field, const Vec3<float>& anchor, BodyModel model, bool fixed);

}  // namespace motley
