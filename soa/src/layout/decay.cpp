// By what damping multiplies velocities in a substep, computed once a step for all rows of a kind.
#include <algorithm>

#include "layout/layout.h"

namespace motley {

/// Writes by what a substep h multiplies the velocities of a kind. Returns whether any of its bodies is damped.
bool Layout::find_decay(const BodyStore& bodies, BodyKind kind, float h)
{
    const BodyRows& rows = bodies.rows(kind);
    float* quad = decay_[static_cast<std::size_t>(kind)].data();
    bool any = false;
    for (const std::uint32_t slot : rows.slot) {
        const Damping& damping = bodies.dampings[slot];
        const float linear = 1 / (1 + h * damping.linear), angular = 1 / (1 + h * damping.angular);
        const bool in_plane = kind == BodyKind::planar;
        quad[0] = quad[1] = linear;
        quad[2] = in_plane ? angular : linear;
        // The yaw of a planar body flies as its position does.
        quad[3] = damping.linear > 0 || (in_plane && damping.angular > 0) ? 0.0F : 1.0F;
        quad += 4;
        any = any || damping.is_any();
        if (quads_of(kind) == 1) continue;
        std::fill_n(quad, 4, angular);
        quad += 4;
    }
    return any;
}

}  // namespace motley
