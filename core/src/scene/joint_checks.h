// The checks that joint definitions share.
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "motley/core/body.h"
#include "motley/core/constraints/frame_joint_definition.h"

namespace motley {

/// What a joint's validation may need to know of its bodies.
struct JointBodies {
    BodyModel model_a, model_b;
    bool fixed_a, fixed_b;  ///< static or kinematic
};

inline constexpr float largest_length = 1e9F;
/// N or N m: replaces an infinite bound on a force. Its impulse over the longest step, 1 s, is still finite.
inline constexpr float largest_force = 1e30F;

/// The name of a field in up to three parts, which become one text only if its value is refused.
struct FieldName {
    std::string_view of, member, component;
    // NOLINTBEGIN(google-explicit-constructor): a name in one part is a name
    FieldName(const char* name) : of(name) {}
    FieldName(std::string_view name) : of(name) {}
    // NOLINTEND(google-explicit-constructor)
    FieldName(std::string_view name, std::string_view member_, std::string_view component_ = {})
        : of(name), member(member_), component(component_)
    {
    }
    [[nodiscard]] std::string text() const;
};

/// Refuses a value outside [low, high] or not finite.
void check_range(const FieldName& field, float value, float low, float high, std::string_view expected);
/// Refuses a bound on a force or torque that is negative or NaN; infinity means no bound.
void check_bound(std::string_view field, float value);
/// Refuses a spring that is given both by a frequency and by a stiffness or damping. `field`: its frequency.
void check_one_spring(std::string_view field, float hertz, float stiffness, float damping);
/// Refuses lengths that are not 0 <= min_length <= max_length, at most 1e9 m; max_length may be infinite.
void check_length_range(std::string_view definition, float min_length, float max_length);
/// Refuses an anchor that is not finite or longer than 1e9 m, or not at the centre of a particle, which has
/// no orientation to carry it.
void check_anchor(const FieldName& field, const Vec3<float>& anchor, BodyModel model, bool fixed);

/// Refuses a coordinate that is not within 1e9 m.
void check_world_point(std::string_view field, const Vec3<double>& point);
/// Refuses a direction whose length is not from 1e-6 to 1e6.
void check_direction(std::string_view field, const Vec3<float>& direction);
/// Refuses a particle, which cannot turn.
void check_turns(std::string_view field, BodyModel model, bool fixed);

/// Refuses a frame whose position check_anchor() refuses, whose rotation has a length that is not from 1e-6 to 1e6, or
/// that is on a particle, which cannot turn.
void check_joint_frame(std::string_view field, const JointFrame& frame, BodyModel model, bool fixed);

/// The unit vector along a vector; exact to rounding.
template <class Real>
Vec3<Real> unit(const Vec3<Real>& v)
{
    return Real(1) / std::sqrt(dot(v, v)) * v;
}
/// A quaternion normalised; exact to rounding.
template <class Real>
Quat<Real> unit(const Quat<Real>& q)
{
    const Real scale = Real(1) / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {scale * q.x, scale * q.y, scale * q.z, scale * q.w};
}

}  // namespace motley
