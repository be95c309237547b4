// Steering, and contacts from neighbours and walls.
#include "worlds/crowd.h"

#include <algorithm>
#include <cmath>

namespace motley::bench {
namespace {

constexpr std::int64_t agents_per_chunk = 1024;

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
    radii_.push_back(agent.radius);
    serial_.push_back(next_serial_++);
    if (is_handed_over_) scene.set_disc(agent.body, {.radius = agent.radius, .friction = friction});
}

void Crowd::hand_over(Scene& scene)
{
    std::vector<DiscDefinition> discs;
    for (const Agent& agent : agents) discs.push_back({.radius = agent.radius, .friction = friction});
    scene.set_discs(bodies_, std::span<const DiscDefinition>(discs));
    for (const Wall& wall : walls) {
        const Vec2<double> ends[] = {wall.from, wall.to};
        scene.add_wall({.points = ends, .friction = friction});
    }
    is_handed_over_ = true;
}

void Crowd::remove(Scene& scene, std::size_t index)
{
    scene.remove_body(agents[index].body);
    agents[index] = agents.back();
    bodies_[index] = bodies_.back();
    radii_[index] = radii_.back();
    serial_[index] = serial_.back();
    agents.pop_back();
    bodies_.pop_back();
    radii_.pop_back();
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
    parallel_for(
        executor, static_cast<std::int64_t>(agents.size()), agents_per_chunk,
        [&](std::int64_t begin, std::int64_t end) {
            for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                const Agent& agent = agents[i];
                const auto dx = static_cast<float>(agent.goal.x - positions[i].x),
                           dy = static_cast<float>(agent.goal.y - positions[i].y);
                const float speed = agent.desired_speed / std::max(std::sqrt(dx * dx + dy * dy), 1e-3F);
                const float gain = agent.mass / relaxation_time;
                forces_[i] = {gain * (speed * dx - velocities[i].x), gain * (speed * dy - velocities[i].y),
                              0};
            }
            // The chunks have no body in common, and nobody else calls the scene meanwhile: see Scene for what may
            // run at once.
            const auto first = static_cast<std::size_t>(begin), count = static_cast<std::size_t>(end - begin);
            scene.set_forces(std::span<const BodyId>(bodies_).subspan(first, count),
                             std::span<const Vec3<float>>(forces_).subspan(first, count));
        });
}

std::span<const Contact> Crowd::find_contacts(const Scene& scene, Executor& executor)
{
    grid_.sort(positions, radii_, contact_margin, executor);

    // Every chunk first lists its pairs. Then the place of its contacts in the whole list is known, and it writes
    // them there.
    const std::int64_t chunks = grid_.chunk_count();
    if (findings_.size() < static_cast<std::size_t>(chunks))
        findings_.resize(static_cast<std::size_t>(chunks));
    parallel_for(executor, chunks, 1, [&](std::int64_t chunk, std::int64_t) {
        Findings& found = findings_[static_cast<std::size_t>(chunk)];
        found.pair_count = grid_.find_pairs(chunk, found.pairs);
        found.touches.clear();
        for (std::size_t w = 0; w < walls.size(); ++w) {
            const Wall& wall = walls[w];
            const double reach = grid_.longest_reach();
            grid_.for_each_disc_in(
                chunk, {std::min(wall.from.x, wall.to.x) - reach, std::min(wall.from.y, wall.to.y) - reach},
                {std::max(wall.from.x, wall.to.x) + reach, std::max(wall.from.y, wall.to.y) + reach},
                [&](std::int32_t i) {
                    if (is_near(wall, static_cast<std::size_t>(i)))
                        found.touches.push_back({i, static_cast<std::int32_t>(w)});
                });
        }
    });
    if (period_y > 0) add_pairs_across_the_seam();
    std::size_t total = 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(chunks); ++c) {
        findings_[c].first_contact = total;
        total += findings_[c].pair_count + findings_[c].touches.size();
    }
    if (contacts_.size() < total) {
        contacts_.resize(total + total / 4);
        pairs_.resize(total + total / 4);
    }
    contact_count_ = total;
    parallel_for(executor, chunks, 1, [&](std::int64_t chunk, std::int64_t) {
        const Findings& found = findings_[static_cast<std::size_t>(chunk)];
        std::size_t at = found.first_contact;
        for (std::size_t k = 0; k < found.pair_count; ++k, ++at) {
            constexpr std::size_t ahead = 16;
            if (k + ahead < found.pair_count) prefetch(found.pairs[k + ahead]);
            pairs_[at] = found.pairs[k];
            write_contact(contacts_[at], pairs_[at]);
        }
        for (const Pair& touch : found.touches) {
            pairs_[at] = {touch.a, -1};
            write_wall_contact(contacts_[at++], touch, scene.ground());
        }
    });
    return contacts();
}

void Crowd::add_pairs_across_the_seam()
{
    Findings& found = findings_.front();
    found.pairs.resize(found.pair_count);
    const auto near = [&](double y, double edge) { return std::abs(y - edge) < 1; };
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!near(positions[i].y, 0)) continue;
        for (std::size_t j = 0; j < positions.size(); ++j) {
            if (!near(positions[j].y, period_y)) continue;
            const double dx = positions[j].x - positions[i].x,
                         dy = positions[j].y - period_y - positions[i].y;
            const auto reach = static_cast<double>(radii_[i] + radii_[j] + contact_margin);
            if (dx * dx + dy * dy < reach * reach)
                found.pairs.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
        }
    }
    found.pair_count = found.pairs.size();
}

/// Prefetches what write_contact() reads: people of a pair are near each other in space, but anywhere in memory.
void Crowd::prefetch(Pair pair) const
{
    for (const std::int32_t agent : {pair.a, pair.b}) {
        const auto i = static_cast<std::size_t>(agent);
        __builtin_prefetch(&positions[i]);
        __builtin_prefetch(&radii_[i]);
        __builtin_prefetch(&serial_[i]);
        __builtin_prefetch(&bodies_[i]);
    }
}

/// Writes each field in place: a contact that is built first and then copied would have to wait for its own stores.
void Crowd::write_contact(Contact& contact, Pair& pair) const
{
    // The agent that arrived first is `a`, so that a pair keeps its roles in whatever order agents are sorted.
    if (serial_[static_cast<std::size_t>(pair.a)] > serial_[static_cast<std::size_t>(pair.b)])
        std::swap(pair.a, pair.b);
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    double y = positions[b].y - positions[a].y;
    if (period_y > 0 && std::abs(y) > period_y / 2) y -= y > 0 ? period_y : -period_y;
    // Subtracted in double: people near each other may be far from the origin.
    const auto dx = static_cast<float>(positions[b].x - positions[a].x), dy = static_cast<float>(y);
    const float distance = std::sqrt(dx * dx + dy * dy);
    // Two people at the same point are pushed apart along x.
    const bool apart = distance > 1e-9F;
    const float inverse = apart ? 1 / distance : 0;
    const float radius_a = radii_[a], radius_b = radii_[b];
    const float separation = distance - radius_a - radius_b;
    contact.body_a = bodies_[a];
    contact.body_b = bodies_[b];
    contact.key = std::uint64_t{serial_[a]} << 32 | serial_[b];
    contact.normal.x = apart ? dx * inverse : 1;
    contact.normal.y = dy * inverse;
    contact.normal.z = 0;
    contact.separation = separation;
    contact.arm_a = (radius_a + separation / 2) * contact.normal;
    contact.friction = friction;
    contact.arm_b = -(radius_b + separation / 2) * contact.normal;
    contact.restitution = 0;
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
    const double near = static_cast<double>(radii_[agent] + contact_margin);
    const Vec3<double>& p = positions[agent];
    // Most people are far from most walls, so four comparisons first avoid the division.
    if (p.x < std::min(wall.from.x, wall.to.x) - near || p.x > std::max(wall.from.x, wall.to.x) + near ||
        p.y < std::min(wall.from.y, wall.to.y) - near || p.y > std::max(wall.from.y, wall.to.y) + near) {
        return false;
    }
    const Vec2<double> d = Vec2<double>{p.x, p.y} - nearest_point(wall, agent);
    return dot(d, d) < near * near;
}

void Crowd::write_wall_contact(Contact& contact, Pair touch, BodyId ground) const
{
    const auto a = static_cast<std::size_t>(touch.a);
    const Vec2<double> point = nearest_point(walls[static_cast<std::size_t>(touch.b)], a);
    const auto dx = static_cast<float>(positions[a].x - point.x),
               dy = static_cast<float>(positions[a].y - point.y);
    const float distance = std::sqrt(dx * dx + dy * dy);
    contact = {};
    contact.body_a = ground;
    contact.body_b = bodies_[a];
    // Arrivals number less than 2^31, so the top bit tells walls from people.
    contact.key =
        std::uint64_t{1} << 63 | std::uint64_t{serial_[a]} << 16 | static_cast<std::uint64_t>(touch.b);
    contact.normal = distance > 1e-9F ? Vec3<float>{dx / distance, dy / distance, 0} : Vec3<float>{1, 0, 0};
    contact.separation = distance - radii_[a];
    // The ground is at the origin and never turns, so its lever arm is the contact point.
    contact.arm_a = {static_cast<float>(point.x), static_cast<float>(point.y), 0};
    contact.arm_b = -distance * contact.normal;
    contact.friction = friction;
}

}  // namespace motley::bench
