// The end of a step: rows of bodies are moved. Sixteen rows at a time are moved in lanes instead, with the same bits
// (soa/src/kernels/kernel_commit.h); the rows that those refuse are moved here.
#include <algorithm>

#include "stores/body_store.h"

namespace motley {
namespace {

/// Whether all values are finite: infinity and NaN times zero are NaN.
bool all_finite(const float* values, int count)
{
    float zero = 0;
    for (int i = 0; i < count; ++i) zero += values[i] * 0.0F;
    return zero == 0.0F;
}

}  // namespace

void BodyStore::restore_planar_inertia()
{
    BodyRows& r = rows(BodyKind::planar);
    for (std::uint32_t row = 1; row < r.size(); ++row) {
        const std::uint32_t slot = r.slot[row];
        if (slot != 0 && contained[slot] == 0 && !is_asleep(slot))
            r.delta[std::size_t{4} * row + 3] = inverse_inertias[slot];
    }
}

int BodyStore::commit(BodyKind kind, std::uint32_t begin, std::uint32_t end, const Flight& flight,
                      std::uint32_t& contained_slot)
{
    BodyRows& r = rows(kind);
    const int quads = quads_of(kind);
    int count = 0;
    for (std::uint32_t row = begin; row < end; ++row) {
        if (r.slot[row] == 0) continue;
        float* velocity = &r.velocity[std::size_t{4} * quads * row];
        float* delta = &r.delta[std::size_t{4} * quads * row];
        if (!all_finite(velocity, 4 * quads) || !all_finite(delta, 4 * quads)) {
            // Frozen at its last finite pose: without inverse mass nothing can move it until the host revives it.
            freeze(r.slot[row]);
            count += contained[r.slot[row]] == 0 ? 1 : 0;
            contained[r.slot[row]] = 1;
            contained_slot = std::min(contained_slot, r.slot[row]);
        } else if (!is_asleep(r.slot[row])) {
            BodyPose& pose = r.pose[row];
            const float* a = &r.acceleration[std::size_t{4} * quads * row];
            const bool in_plane = kind == BodyKind::planar;
            const Vec3<float>& g = flight.gravity;
            const Vec3<float> acceleration{a[0] + g.x, a[1] + g.y, in_plane ? 0 : a[2] + g.z};
            const Vec3<float> now{velocity[0], velocity[1], in_plane ? 0 : velocity[2]};
            // Bodies without inverse mass, fixed or contained, do not fall; the acceleration of a contained one may be
            // infinite.
            const bool falls = velocity[3] > 0 && flight.is_jointed[row] == 0 &&
                               flew_freely(flight.start_along[row], dot(now, acceleration),
                                           flight.seconds * dot(acceleration, acceleration));
            const auto moved = [&](int i, float along) {
                const float back = falls ? flight.excess * along : 0.0F;
                return static_cast<PoseReal>(delta[i]) - static_cast<PoseReal>(back);
            };
            pose.position.x += moved(0, acceleration.x);
            pose.position.y += moved(1, acceleration.y);
            if (in_plane) {
                pose.yaw += moved(2, a[2]);
            } else {
                pose.position.z += moved(2, acceleration.z);
            }
            if (quads == 2) {
                const Quat<PoseReal> turn{delta[4], delta[5], delta[6], delta[7]};
                const Quat<PoseReal> q = normalised(turn * r.orientation[row]);
                r.orientation[row] = normalised(q);
                if (kind == BodyKind::rigid && contained[r.slot[row]] == 0) refresh_world_inertia(row);
            }
        }
        delta[0] = delta[1] = delta[2] = 0;
        if (quads == 2) {
            delta[4] = delta[5] = delta[6] = 0;
            delta[7] = 1;
        }
        if (kind == BodyKind::planar && contained[r.slot[row]] != 0) delta[3] = 0;
    }
    return count;
}

}  // namespace motley
