// Checks of what a host says of bodies. Each names the field, the value and what was expected.
#pragma once

#include "motley/core/body.h"

namespace motley {

/// kg, and kg m2 of each moment: what a dynamic body may have.
inline constexpr float lightest_body = 1e-10F, heaviest_body = 1e10F;
inline constexpr float least_moment = 1e-20F, most_moment = 1e20F;

bool is_finite(const Vec3<float>& v);
/// Refuses a value outside [low, high] or not finite.
void check(const char* field, double value, double low, double high, const char* expected);
/// Each component by name: `who`.x, `who`.y, `who`.z.
void check_position(const char* who, const Vec3<double>& p);
void check_vector(const char* who, const Vec3<float>& v, float limit, const char* expected);
/// Null: not given. The components that a body does not have must be zero: a silent loss would be a wrong answer.
void check_velocity_of(BodyModel model, BodyMotion motion, const Vec3<float>* linear,
                       const Vec3<float>* angular);
/// Of a rigid body: positive definite, with moments that a body can have.
void check_inertia(const Sym3<float>& inertia);
void check_definition(const BodyDefinition& definition);

}  // namespace motley
