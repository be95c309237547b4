// The checks that joint definitions share.
#include "motley/core/joint_checks.h"

#include <string>

#include "motley/core/invalid_input.h"

namespace motley {

void check_range(std::string_view field, float value, float low, float high, std::string_view expected)
{
    // Written so that NaN fails.
    if (!(value >= low && value <= high)) refuse(field, value, expected);
}

void check_anchor(std::string_view field, const Vec3<float>& anchor, BodyModel model, bool fixed)
{
    const float components[3] = {anchor.x, anchor.y, anchor.z};
    const char* names[3] = {".x", ".y", ".z"};
    const bool needs_zero = model == BodyModel::particle && !fixed;
    for (int i = 0; i < 3; ++i) {
        const std::string name = std::string(field) + names[i];
        if (needs_zero) {
            check_range(name, components[i], 0, 0,
                        "0 on a particle, which has no orientation to carry an anchor (m)");
        } else {
            check_range(name, components[i], -largest_length, largest_length,
                        "a finite value from -1e9 to 1e9 (m)");
        }
    }
}

void check_joint_frame(std::string_view field, const JointFrame& frame, BodyModel model, bool fixed)
{
    const std::string name(field);
    if (model == BodyModel::particle && !fixed) {
        refuse(name, "on a particle", "a body that turns: rigid, planar, static or kinematic");
    }
    check_anchor(name + ".position", frame.position, model, fixed);
    const Quat<float>& q = frame.rotation;
    check_range(name + ".rotation", q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1e-12F, 1e12F,
                "a quaternion with a length from 1e-6 to 1e6 (squared shown)");
}

}  // namespace motley
