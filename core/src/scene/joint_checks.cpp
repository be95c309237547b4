// The checks that joint definitions share.
#include "scene/joint_checks.h"

#include <limits>
#include <string>

#include "motley/core/invalid_input.h"

namespace motley {

std::string FieldName::text() const
{
    std::string text(of);
    text += member;
    text += component;
    return text;
}

void check_range(const FieldName& field, float value, float low, float high, std::string_view expected)
{
    // Written so that NaN fails.
    if (!(value >= low && value <= high)) refuse(field.text(), value, expected);
}

void check_bound(std::string_view field, float value)
{
    check_range(field, value, 0, std::numeric_limits<float>::infinity(),
                ">= 0 (N or N m), infinite for none");
}

void check_one_spring(std::string_view field, float hertz, float stiffness, float damping)
{
    if (hertz > 0 && (stiffness > 0 || damping > 0))
        refuse(field, hertz, "0 where spring_stiffness or spring_damping say what the spring is");
}

void check_length_range(std::string_view definition, float min_length, float max_length)
{
    const FieldName least(definition, ".min_length");
    check_range(least, min_length, 0, largest_length, "0 to max_length, at most 1e9 (m)");
    if (!std::isinf(max_length))
        check_range({definition, ".max_length"}, max_length, 0, largest_length, "0 to 1e9 (m) or infinite");
    if (!(min_length <= max_length)) refuse(least.text(), min_length, "at most max_length");
}

void check_anchor(const FieldName& field, const Vec3<float>& anchor, BodyModel model, bool fixed)
{
    const float components[3] = {anchor.x, anchor.y, anchor.z};
    const char* names[3] = {".x", ".y", ".z"};
    const bool needs_zero = model == BodyModel::particle && !fixed;
    for (int i = 0; i < 3; ++i) {
        const FieldName name(field.of, field.member, names[i]);
        if (needs_zero) {
            check_range(name, components[i], 0, 0,
                        "0 on a particle, which has no orientation to carry an anchor (m)");
        } else {
            check_range(name, components[i], -largest_length, largest_length,
                        "a finite value from -1e9 to 1e9 (m)");
        }
    }
}

void check_world_point(std::string_view field, const Vec3<double>& point)
{
    const double components[3] = {point.x, point.y, point.z};
    const char* names[3] = {".x", ".y", ".z"};
    for (int i = 0; i < 3; ++i) {
        if (!(std::abs(components[i]) <= 1e9))
            refuse(std::string(field) + names[i], components[i], "a finite value from -1e9 to 1e9 (m)");
    }
}

void check_direction(std::string_view field, const Vec3<float>& direction)
{
    check_range(field, dot(direction, direction), 1e-12F, 1e12F,
                "a vector with a length from 1e-6 to 1e6 (squared shown)");
}

void check_turns(std::string_view field, BodyModel model, bool fixed)
{
    if (model == BodyModel::particle && !fixed)
        refuse(field, "on a particle", "a body that turns: rigid, planar, static or kinematic");
}

void check_joint_frame(std::string_view field, const JointFrame& frame, BodyModel model, bool fixed)
{
    check_turns(field, model, fixed);
    check_anchor({field, ".position"}, frame.position, model, fixed);
    const Quat<float>& q = frame.rotation;
    check_range({field, ".rotation"}, q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1e-12F, 1e12F,
                "a quaternion with a length from 1e-6 to 1e6 (squared shown)");
}

}  // namespace motley
