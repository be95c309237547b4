#include "worlds/steering/orca.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "worlds/steering/drive.h"

namespace motley::bench {
HalfPlane way_out(Vec2<float> offset, float radii, Vec2<float> relative)
{
    const float per_horizon = 1 / Orca::horizon;
    const float distance2 = dot(offset, offset);
    const Vec2<float> from_tip = relative - per_horizon * offset;  // from the middle of the round tip
    const float along = dot(from_tip, offset);
    const float length2 = dot(from_tip, from_tip);
    // The tip is nearest for velocities that lie before the two points where the sides of the cone touch it.
    if (along < 0 && along * along > radii * radii * length2) {
        const Vec2<float> normal = 1 / std::sqrt(length2) * from_tip;
        return {per_horizon * offset + radii * per_horizon * normal, normal};
    }
    // Else the side of the cone on which the velocity is. A side starts at zero and is a tangent of the disc of `radii`.
    const float tangent = std::sqrt(distance2 - radii * radii);
    const float turn = offset.x * relative.y - offset.y * relative.x > 0 ? 1.0F : -1.0F;
    const Vec2<float> side{(offset.x * tangent - turn * offset.y * radii) / distance2,
                           (turn * offset.x * radii + offset.y * tangent) / distance2};
    return {dot(relative, side) * side, {-turn * side.y, turn * side.x}};
}

namespace {

struct Near {
    float distance;
    std::size_t person;
};

void add_walls(const Crowd& crowd, std::size_t i, std::vector<HalfPlane>& planes)
{
    for (const Wall& wall : crowd.walls) {
        const Vec2<double> away = crowd.offset_from(wall, i);
        const double distance = std::sqrt(dot(away, away));
        if (distance < 1e-6 || distance > static_cast<double>(Orca::reach)) continue;
        const Vec2<float> normal{static_cast<float>(away.x / distance),
                                 static_cast<float>(away.y / distance)};
        const float gap = std::max(0.0F, static_cast<float>(distance) - crowd.agents[i].radius);
        planes.push_back({-gap / Orca::wall_horizon * normal, normal});
    }
}

void add_people(const Crowd& crowd, std::size_t i, std::span<const Near> nearest,
                std::vector<HalfPlane>& planes)
{
    const Vec2<float> mine{crowd.velocities[i].x, crowd.velocities[i].y};
    for (const Near& near : nearest) {
        const Vec2<double> exact = crowd.offset(i, near.person);
        const Vec2<float> offset{static_cast<float>(exact.x), static_cast<float>(exact.y)};
        const Vec2<float> relative =
            mine - Vec2<float>{crowd.velocities[near.person].x, crowd.velocities[near.person].y};
        // People who are nearer than that are taken to be just apart: contacts keep them so.
        const float radii =
            std::min(crowd.agents[i].radius + crowd.agents[near.person].radius + Orca::clearance,
                     0.999F * near.distance);
        const HalfPlane out = way_out(offset, radii, relative);
        const Vec2<float> change = out.point - relative;
        planes.push_back({mine + 0.5F * change, out.normal});
    }
}

}  // namespace

void Orca::find_forces(const Crowd& crowd, std::span<Vec3<float>> forces, Executor& executor)
{
    neighbours_.find(crowd, reach, executor);
    const auto count = static_cast<std::int64_t>(forces.size());
    parallel_for(executor, count, 256, [&](std::int64_t begin, std::int64_t end) {
        std::vector<HalfPlane> planes;
        std::vector<Near> nearest;
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            const Agent& person = crowd.agents[i];
            nearest.clear();
            for (const std::int32_t other : neighbours_.of(i)) {
                const Vec2<double> offset = crowd.offset(i, static_cast<std::size_t>(other));
                const auto distance = static_cast<float>(std::sqrt(dot(offset, offset)));
                if (distance > 1e-6F) nearest.push_back({distance, static_cast<std::size_t>(other)});
            }
            const std::size_t considered = std::min(nearest.size(), most);
            std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(considered),
                              nearest.end(), [](const Near& a, const Near& b) {
                                  return a.distance != b.distance ? a.distance < b.distance
                                                                  : a.person < b.person;
                              });
            nearest.resize(considered);
            planes.clear();
            add_walls(crowd, i, planes);
            const std::size_t hard = planes.size();
            add_people(crowd, i, nearest, planes);
            const Vec2<float> velocity =
                nearest_allowed(planes, hard, person.desired_speed, desired_velocity(crowd, i));
            const Vec2<float> now{crowd.velocities[i].x, crowd.velocities[i].y};
            Vec2<float> force = person.mass / reaction_time * (velocity - now);
            const float strength = std::sqrt(dot(force, force));
            const float limit = person.mass * person.desired_speed / crowd.relaxation_time;
            if (strength > limit) force = limit / strength * force;
            forces[i] = {force.x, force.y, 0};
        }
    });
}

}  // namespace motley::bench
