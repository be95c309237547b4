// Checks of what a host says of bodies. Each names the field, the value and what was expected.
#pragma once

#include "motley/core/body.h"

namespace motley {

bool is_finite(const Vec3<float>& v);
/// Refuses a value outside [low, high] or not finite.
void check(const char* field, double value, double low, double high, const char* expected);
/// Each component by name: `who`.x, `who`.y, `who`.z.
void check_position(const char* who, const Vec3<double>& p);
void check_vector(const char* who, const Vec3<float>& v, float limit, const char* expected);
/// Null: not given. The components that a body does not have must be zero: a silent loss would be a wrong answer.
void check_velocity_of(BodyModel model, BodyMotion motion, const Vec3<float>* linear,
                       const Vec3<float>* angular);
void check_definition(const BodyDefinition& definition);

}  // namespace motley
