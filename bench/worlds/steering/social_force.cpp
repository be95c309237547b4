#include "worlds/steering/social_force.h"

#include <algorithm>
#include <cmath>

#include "worlds/steering/drive.h"

namespace motley::bench {
namespace {

/// Away from what is `offset` behind a person, with `gap` between the surfaces.
Vec2<float> repulsion(Vec2<double> offset, double gap)
{
    const double distance = std::sqrt(dot(offset, offset));
    if (distance < 1e-9) return {};
    const auto force = SocialForce::strength * std::exp(static_cast<float>(-gap) / SocialForce::range);
    return {force * static_cast<float>(offset.x / distance), force * static_cast<float>(offset.y / distance)};
}

}  // namespace

void SocialForce::find_forces(const Crowd& crowd, std::span<Vec3<float>> forces, Executor& executor)
{
    neighbours_.find(crowd, reach, executor);
    parallel_for(
        executor, static_cast<std::int64_t>(forces.size()), 256, [&](std::int64_t begin, std::int64_t end) {
            for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                const Agent& person = crowd.agents[i];
                const auto radius = static_cast<double>(person.radius);
                Vec2<float> force = towards(desired_velocity(crowd, i), crowd, i);
                for (const std::int32_t other : neighbours_.of(i)) {
                    const auto j = static_cast<std::size_t>(other);
                    const Vec2<double> away = crowd.offset(j, i);
                    const double gap =
                        std::sqrt(dot(away, away)) - radius - static_cast<double>(crowd.agents[j].radius);
                    force = force + repulsion(away, gap);
                }
                for (const Wall& wall : crowd.walls) {
                    const Vec2<double> away = crowd.offset_from(wall, i);
                    const double gap = std::sqrt(dot(away, away)) - radius;
                    if (gap < static_cast<double>(reach)) force = force + repulsion(away, gap);
                }
                forces[i] = {force.x, force.y, 0};
            }
        });
}

}  // namespace motley::bench
