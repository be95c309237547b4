// Checks of the values that a host gives for bodies. A refusal names the field, the value and what was expected.
#pragma once

#include <cmath>

#include "motley/core/body.h"
#include "motley/core/crowd.h"

namespace motley {

/// The valid ranges of the mass (kg) and of each moment of inertia (kg m2) of a dynamic body.
inline constexpr float lightest_body = 1e-10F, heaviest_body = 1e10F;
inline constexpr float least_moment = 1e-20F, most_moment = 1e20F;

/// The largest damping of a body, 1/s.
inline constexpr float most_damping = 1e6F;

/// The largest component of a velocity that a host may give, m/s and rad/s.
inline constexpr float largest_speed = 1e9F;

inline bool is_finite(const Vec3<float>& v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
/// Refuses a value outside [low, high] or not finite.
void check(const char* field, double value, double low, double high, const char* expected);
/// Whether a coordinate is in the range of positions, -1e12 to 1e12 m.
bool is_coordinate(double value);
/// Each component by name: `who`.x, `who`.y, `who`.z.
void check_position(const char* who, const Vec3<double>& p);
void check_vector(const char* who, const Vec3<float>& v, float limit, const char* expected);
/// A null pointer means not given. Components that a body does not have must be zero, because dropping them silently
/// would give a wrong result.
void check_velocity_of(BodyModel model, BodyMotion motion, const Vec3<float>* linear,
                       const Vec3<float>* angular);
/// For a rigid body: must be positive definite, with moments that obey the triangle inequality.
void check_inertia(const char* who, const Sym3<float>& inertia);
/// Of `who`.inertia what the model has.
void check_inertia_of(const char* who, BodyModel model, const Sym3<float>& inertia);
/// `who`.mass, and of `who`.inertia what the model has.
void check_mass(const char* who, BodyModel model, float mass, const Sym3<float>& inertia);
/// `who`.linear_damping and `who`.angular_damping.
void check_damping(const char* who, float linear, float angular);
void check_definition(const BodyDefinition& definition);
/// Refuses a number that names no model.
void check_model(const char* field, BodyModel model);
void check_disc(const DiscDefinition& disc);
/// One piece of a wall, `name` being that of its first point.
void check_segment(const char* name, const Vec2<double>& from, const Vec2<double>& to);
void check_wall_surface(float friction, float surface_speed);
void check_wall_force(float max_force);

}  // namespace motley
