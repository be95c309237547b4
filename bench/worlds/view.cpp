// See view.h.
#include "worlds/view.h"

#include <algorithm>
#include <cmath>

namespace motley::bench {
namespace {

/// From the centre of a torso to the end of its axis, m, world.
Vec2<double> shoulder_of(const Agent& agent, double yaw)
{
    const Vec2<float> end = Crowd::shoulder(agent);
    const auto x = static_cast<double>(end.x), y = static_cast<double>(end.y);
    return {std::cos(yaw) * x - std::sin(yaw) * y, std::sin(yaw) * x + std::cos(yaw) * y};
}

double circumference_of(const Agent& agent, bool is_torso)
{
    constexpr double turn = 6.283185307179586;
    if (!is_torso) return turn * static_cast<double>(agent.radius);
    return turn * static_cast<double>(Crowd::depth_radius(agent)) +
           4 * static_cast<double>(Crowd::shoulder(agent).y);
}

}  // namespace

/// A person leans on the wall over the width of the shoulders and not at a point.
std::vector<double> wall_pressures(const Wall& wall, const std::vector<PressOnWall>& presses)
{
    const Vec2<double> along = wall.to - wall.from;
    const double length = std::max(std::sqrt(dot(along, along)), 1e-9);
    std::vector<double> bands(static_cast<std::size_t>(std::ceil(length)), 0.0);
    for (const auto& [at, radius, force] : presses) {
        const double place = dot(along, at - wall.from) / length;
        for (std::size_t band = 0; band < bands.size(); ++band) {
            const double from = std::max(place - radius, static_cast<double>(band)),
                         to = std::min({place + radius, static_cast<double>(band) + 1, length});
            if (to > from) bands[band] += force * (to - from) / (2 * radius);
        }
    }
    const double rest = length - static_cast<double>(bands.size() - 1);
    bands.back() /= std::max(rest, 0.1);
    return bands;
}

View view_of(const Crowd& crowd, const Scene& scene)
{
    View view;
    view.walls = crowd.walls;
    view.period_y = crowd.period_y;
    std::vector<double> load(crowd.agents.size(), 0.0);
    std::vector<std::vector<PressOnWall>> presses(crowd.walls.size());
    for (const Touch& touch : crowd.touches(scene)) {
        const auto b = static_cast<std::size_t>(touch.b);
        if (touch.a >= 0) load[static_cast<std::size_t>(touch.a)] += touch.force;
        load[b] += touch.force;
        if (touch.wall < 0) continue;
        const Vec3<double>& at = crowd.positions[b];
        presses[static_cast<std::size_t>(touch.wall)].push_back(
            {{at.x, at.y}, static_cast<double>(crowd.agents[b].radius), touch.force});
    }
    for (std::size_t i = 0; i < std::min(crowd.positions.size(), load.size()); ++i) {
        const Agent& agent = crowd.agents[i];
        const Vec2<double> at{crowd.positions[i].x, crowd.positions[i].y};
        const Vec2<double> end = crowd.are_torsos ? shoulder_of(agent, crowd.yaws[i]) : Vec2<double>{};
        view.people.push_back(at);
        view.numbers.push_back(crowd.number_of(i));
        view.shapes.push_back(
            {at - end, at + end,
             static_cast<double>(crowd.are_torsos ? Crowd::depth_radius(agent) : agent.radius),
             load[i] / circumference_of(agent, crowd.are_torsos), i});
    }
    for (std::size_t w = 0; w < crowd.walls.size(); ++w)
        view.wall_pressures.push_back(wall_pressures(crowd.walls[w], presses[w]));
    return view;
}

}  // namespace motley::bench
