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

}  // namespace motley
