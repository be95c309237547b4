// Steering, and contacts from neighbours and walls.
#include "crowd.h"

#include <algorithm>
#include <cmath>

namespace motley::bench {
namespace {

constexpr std::int64_t agents_per_chunk = 4096;

}  // namespace

void Crowd::add(Scene& scene, Agent agent, Vec2<double> position)
{
    BodyDefinition body;
    body.model = BodyModel::planar;
    body.position = {position.x, position.y, 0};
    body.mass = agent.mass;
    body.inertia.zz = 0.5F * agent.mass * agent.radius * agent.radius;
    agent.body = scene.add_body(body);
    agents.push_back(agent);
    bodies_.push_back(agent.body);
    serial_.push_back(next_serial_++);
}

void Crowd::remove(Scene& scene, std::size_t index)
{
    scene.remove_body(agents[index].body);
    agents[index] = agents.back();
    bodies_[index] = bodies_.back();
    serial_[index] = serial_.back();
    agents.pop_back();
    bodies_.pop_back();
    serial_.pop_back();
}

void Crowd::observe(const Scene& scene, Executor& executor)
{
    positions.resize(agents.size());
    velocities.resize(agents.size());
    parallel_for(executor, static_cast<std::int64_t>(agents.size()), agents_per_chunk,
                 [&](std::int64_t begin, std::int64_t end) {
                     const auto first = static_cast<std::size_t>(begin),
                                count = static_cast<std::size_t>(end - begin);
                     const auto some = std::span<const BodyId>(bodies_).subspan(first, count);
                     scene.read_positions(some, std::span(positions).subspan(first, count));
                     scene.read_velocities(some, std::span(velocities).subspan(first, count));
                 });
}

void Crowd::steer(Scene& scene, Executor& executor)
{
    forces_.resize(agents.size());
    parallel_for(executor, static_cast<std::int64_t>(agents.size()), agents_per_chunk,
                 [&](std::int64_t begin, std::int64_t end) {
                     for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         const Agent& agent = agents[i];
                         const double dx = agent.goal.x - positions[i].x, dy = agent.goal.y - positions[i].y;
                         const double distance = std::sqrt(dx * dx + dy * dy);
                         const double speed = agent.desired_speed / std::max(distance, 1e-3);
                         const double gain = agent.mass / relaxation_time;
                         forces_[i] = {static_cast<float>(gain * (speed * dx - velocities[i].x)),
                                       static_cast<float>(gain * (speed * dy - velocities[i].y)), 0};
                     }
                     const auto first = static_cast<std::size_t>(begin),
                                count = static_cast<std::size_t>(end - begin);
                     scene.set_forces(std::span<const BodyId>(bodies_).subspan(first, count),
                                      std::span<const Vec3<float>>(forces_).subspan(first, count));
                 });
}

std::span<const Contact> Crowd::find_contacts(const Scene& scene, Executor& executor)
{
    float largest = 0;
    for (const Agent& agent : agents) largest = std::max(largest, agent.radius);
    const float reach = 2 * largest + contact_margin;
    grid_.sort(positions, reach, executor);

    // Pairs first, a list a chunk; then every chunk knows where its contacts go and writes them there.
    const auto chunks = static_cast<std::size_t>(grid_.chunk_count());
    if (chunk_pairs_.size() < chunks) chunk_pairs_.resize(chunks);
    for (auto& pairs : chunk_pairs_) pairs.clear();
    grid_.for_each_pair(reach, executor, [&](std::int64_t chunk, std::int32_t i, std::int32_t j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const double dx = positions[b].x - positions[a].x, dy = positions[b].y - positions[a].y;
        const double near = static_cast<double>(agents[a].radius + agents[b].radius + contact_margin);
        if (dx * dx + dy * dy >= near * near) return;
        // The elder is `a`, so that a pair keeps its roles whoever is sorted first.
        chunk_pairs_[static_cast<std::size_t>(chunk)].push_back(serial_[a] < serial_[b] ? Pair{i, j}
                                                                                        : Pair{j, i});
    });
    for (std::size_t w = 0; w < walls.size(); ++w) {
        parallel_for(executor, static_cast<std::int64_t>(chunks), 1, [&](std::int64_t chunk, std::int64_t) {
            grid_.for_each_disc(chunk, [&](std::int32_t i) {
                if (is_near(walls[w], static_cast<std::size_t>(i))) {
                    chunk_pairs_[static_cast<std::size_t>(chunk)].push_back(
                        {i, -1 - static_cast<std::int32_t>(w)});
                }
            });
        });
    }
    if (period_y > 0) add_pairs_across_the_seam();
    std::size_t total = 0;
    chunk_starts_.resize(chunks);
    for (std::size_t c = 0; c < chunks; ++c) {
        chunk_starts_[c] = total;
        total += chunk_pairs_[c].size();
    }
    contacts_.resize(total);
    pairs_.resize(total);
    parallel_for(executor, static_cast<std::int64_t>(chunks), 1, [&](std::int64_t chunk, std::int64_t) {
        std::size_t at = chunk_starts_[static_cast<std::size_t>(chunk)];
        for (const Pair& pair : chunk_pairs_[static_cast<std::size_t>(chunk)]) {
            pairs_[at] = {pair.a, std::max(pair.b, -1)};
            contacts_[at] = pair.b >= 0 ? between(pair.a, pair.b) : with_wall(scene, pair.a, -1 - pair.b);
            ++at;
        }
    });
    return contacts_;
}

void Crowd::add_pairs_across_the_seam()
{
    const auto near = [&](double y, double edge) { return std::abs(y - edge) < 1; };
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!near(positions[i].y, 0)) continue;
        for (std::size_t j = 0; j < positions.size(); ++j) {
            if (!near(positions[j].y, period_y)) continue;
            const double dx = positions[j].x - positions[i].x,
                         dy = positions[j].y - period_y - positions[i].y;
            const double reach = static_cast<double>(agents[i].radius + agents[j].radius + contact_margin);
            if (dx * dx + dy * dy >= reach * reach) continue;
            const auto a = static_cast<std::int32_t>(i), b = static_cast<std::int32_t>(j);
            chunk_pairs_.front().push_back(serial_[i] < serial_[j] ? Pair{a, b} : Pair{b, a});
        }
    }
}

Contact Crowd::between(std::int32_t i, std::int32_t j) const
{
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    const double dx = positions[b].x - positions[a].x;
    double dy = positions[b].y - positions[a].y;
    if (period_y > 0 && std::abs(dy) > period_y / 2) dy -= dy > 0 ? period_y : -period_y;
    const double distance = std::sqrt(dx * dx + dy * dy);
    Contact contact;
    contact.body_a = bodies_[a];
    contact.body_b = bodies_[b];
    contact.key = std::uint64_t{serial_[a]} << 32 | serial_[b];
    // People in one point part along x.
    contact.normal =
        distance > 1e-9 ? Vec3<float>{static_cast<float>(dx / distance), static_cast<float>(dy / distance), 0}
                        : Vec3<float>{1, 0, 0};
    contact.separation = static_cast<float>(distance - static_cast<double>(agents[a].radius) -
                                            static_cast<double>(agents[b].radius));
    contact.arm_a = (agents[a].radius + contact.separation / 2) * contact.normal;
    contact.arm_b = -(agents[b].radius + contact.separation / 2) * contact.normal;
    contact.friction = friction;
    return contact;
}

Vec2<double> Crowd::nearest_point(const Wall& wall, std::size_t agent) const
{
    const Vec2<double> along = wall.to - wall.from;
    const Vec2<double> here{positions[agent].x, positions[agent].y};
    const double t = dot(along, here - wall.from) / std::max(dot(along, along), 1e-12);
    return wall.from + std::clamp(t, 0.0, 1.0) * along;
}

bool Crowd::is_near(const Wall& wall, std::size_t agent) const
{
    const double near = static_cast<double>(agents[agent].radius + contact_margin);
    const Vec3<double>& p = positions[agent];
    // Most people are far from most walls: four comparisons spare them the division.
    if (p.x < std::min(wall.from.x, wall.to.x) - near || p.x > std::max(wall.from.x, wall.to.x) + near ||
        p.y < std::min(wall.from.y, wall.to.y) - near || p.y > std::max(wall.from.y, wall.to.y) + near) {
        return false;
    }
    const Vec2<double> d = Vec2<double>{p.x, p.y} - nearest_point(wall, agent);
    return dot(d, d) < near * near;
}

Contact Crowd::with_wall(const Scene& scene, std::int32_t i, std::int32_t wall) const
{
    const auto a = static_cast<std::size_t>(i);
    const Vec2<double> point = nearest_point(walls[static_cast<std::size_t>(wall)], a);
    const Vec2<double> d{positions[a].x - point.x, positions[a].y - point.y};
    const double distance = std::sqrt(dot(d, d));
    Contact contact;
    contact.body_a = scene.ground();
    contact.body_b = bodies_[a];
    // Arrivals number less than 2^31, so the top bit tells walls from people.
    contact.key = std::uint64_t{1} << 63 | std::uint64_t{serial_[a]} << 16 | static_cast<std::uint64_t>(wall);
    contact.normal = distance > 1e-9 ? Vec3<float>{static_cast<float>(d.x / distance),
                                                   static_cast<float>(d.y / distance), 0}
                                     : Vec3<float>{1, 0, 0};
    contact.separation = static_cast<float>(distance - static_cast<double>(agents[a].radius));
    // The ground stands at the origin and never turns: its arm is the point.
    contact.arm_a = {static_cast<float>(point.x), static_cast<float>(point.y), 0};
    contact.arm_b = -static_cast<float>(distance) * contact.normal;
    contact.friction = friction;
    return contact;
}

}  // namespace motley::bench
