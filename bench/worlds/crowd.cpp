// Steering, and contacts from neighbours and walls.
#include "worlds/crowd.h"

#include <algorithm>
#include <cmath>

#include "worlds/slot_index.h"

namespace motley::bench {
namespace {

constexpr std::int64_t agents_per_chunk = 1024;
/// The part of a wall contact's key that names the wall.
constexpr std::uint64_t wall_bits = 0xFFFF;

}  // namespace

void Crowd::add(Scene& scene, Agent agent, Vec2<double> position)
{
    agent.body = scene.add_body(body_of(agent, position));
    agents.push_back(agent);
    bodies_.push_back(agent.body);
    radii_.push_back(agent.radius);
    serial_.push_back(next_serial_++);
    if (is_handed_over_) give_shapes(scene, agents.size() - 1);
}

/// Shapes for the agents from this one on.
void Crowd::give_shapes(Scene& scene, std::size_t from) const
{
    const std::span<const Agent> some = std::span(agents).subspan(from);
    if (!are_torsos) {
        std::vector<DiscDefinition> discs;
        for (const Agent& agent : some) discs.push_back({.radius = agent.radius, .friction = friction});
        return scene.set_discs(bodies().subspan(from), std::span<const DiscDefinition>(discs));
    }
    for (const Agent& agent : some) {
        const Vec2<float> end = shoulder(agent);
        scene.add_capsule({.body = agent.body,
                           .from = {-end.x, -end.y, 0},
                           .to = {end.x, end.y, 0},
                           .radius = depth_radius(agent),
                           .friction = friction});
    }
}

void Crowd::hand_over(Scene& scene)
{
    give_shapes(scene, 0);
    for (const Wall& wall : walls) {
        const Vec2<double> ends[] = {wall.from, wall.to};
        wall_ids_.push_back(scene.add_wall({.points = ends, .friction = friction}));
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
    if (!are_torsos) return;
    yaws.resize(agents.size());
    scene.read_yaws(bodies_, std::span(yaws));
}

/// Torques that turn everyone to the goal, critically damped within the relaxation time.
void Crowd::turn_torsos(const Scene& scene)
{
    spins_.resize(agents.size());
    torques_.resize(agents.size());
    scene.read_velocities(bodies_, {}, std::span(spins_));
    constexpr double turn = 6.283185307179586;
    for (std::size_t i = 0; i < agents.size(); ++i) {
        const Agent& agent = agents[i];
        const double ahead = std::atan2(agent.goal.y - positions[i].y, agent.goal.x - positions[i].x);
        const auto off = static_cast<float>(std::remainder(ahead - yaws[i], turn));
        const float rate = 2 / relaxation_time, moment = 0.5F * agent.mass * agent.radius * agent.radius;
        torques_[i] = {0, 0, moment * rate * (rate * off - 2 * spins_[i].z)};
    }
}

std::int32_t Crowd::index_of(WallId wall) const
{
    const auto found = std::find(wall_ids_.begin(), wall_ids_.end(), wall);
    return found != wall_ids_.end() ? static_cast<std::int32_t>(found - wall_ids_.begin()) : -1;
}

std::vector<Touch> Crowd::found_touches(const Scene& scene) const
{
    SlotIndex index;
    index.build(bodies_);
    std::vector<Touch> all;
    for (const DiscContact& contact : scene.disc_contacts()) {
        Touch touch{.b = index.of(contact.b),
                    .normal = contact.normal,
                    .separation = static_cast<double>(contact.separation),
                    .force = static_cast<double>(contact.normal_force),
                    .friction = static_cast<double>(contact.friction_force)};
        if (contact.wall == WallId{}) {
            touch.a = index.of(contact.a);
        } else {
            touch.wall = index_of(contact.wall);
        }
        all.push_back(touch);
    }
    for (const ShapeContact& contact : scene.shape_contacts()) {
        if (contact.normal_force <= 0) continue;
        const Vec2<float> normal{contact.normal.x, contact.normal.y};
        const bool is_wall = contact.wall != WallId{};
        all.push_back({.a = is_wall ? -1 : index.of(contact.a),
                       .b = index.of(contact.b),
                       .wall = is_wall ? index_of(contact.wall) : -1,
                       .normal = normal,
                       .separation = static_cast<double>(contact.separation),
                       .force = static_cast<double>(contact.normal_force),
                       .friction = static_cast<double>(normal.x * contact.friction_force.y -
                                                       normal.y * contact.friction_force.x)});
    }
    return all;
}

std::vector<Touch> Crowd::touches(const Scene& scene) const
{
    std::vector<Touch> all;
    if (is_handed_over_) all = found_touches(scene);
    const auto impulses = scene.contact_impulses();
    const double per_second = scene.last_step() > 0 ? 1 / static_cast<double>(scene.last_step()) : 0;
    for (std::size_t k = 0; k < impulses.size() && k < contact_count_; ++k) {
        if (impulses[k].normal <= 0) continue;
        const Contact& contact = contacts_[k];
        const bool is_wall = pairs_[k].b < 0;
        const Vec2<float> normal{contact.normal.x, contact.normal.y};
        all.push_back({.a = is_wall ? -1 : pairs_[k].a,
                       .b = is_wall ? pairs_[k].a : pairs_[k].b,
                       .wall = is_wall ? static_cast<std::int32_t>(contact.key & wall_bits) : -1,
                       .normal = normal,
                       .separation = static_cast<double>(contact.separation),
                       .force = static_cast<double>(impulses[k].normal) * per_second,
                       .friction = static_cast<double>(normal.x * impulses[k].friction.y -
                                                       normal.y * impulses[k].friction.x) *
                                   per_second});
    }
    return all;
}

void Crowd::steer(Scene& scene, Executor& executor)
{
    forces_.resize(agents.size());
    if (are_torsos) turn_torsos(scene);
    const std::span<const Vec3<float>> torques(torques_);
    if (steering) {
        steering->find_forces(*this, forces_, executor);
        scene.set_forces(bodies_, std::span<const Vec3<float>>(forces_), torques);
        return;
    }
    parallel_for(executor, static_cast<std::int64_t>(agents.size()), agents_per_chunk,
                 [&](std::int64_t begin, std::int64_t end) {
                     for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                         forces_[i] = walking_force(agents[i], relaxation_time, positions[i], velocities[i]);
                     // The chunks have no body in common, and nobody else calls the scene meanwhile: see Scene for what may
                     // run at once.
                     const auto first = static_cast<std::size_t>(begin),
                                count = static_cast<std::size_t>(end - begin);
                     scene.set_forces(std::span<const BodyId>(bodies_).subspan(first, count),
                                      std::span<const Vec3<float>>(forces_).subspan(first, count),
                                      are_torsos ? torques.subspan(first, count) : torques);
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

void Crowd::find_pairs_across_the_seam(std::vector<Pair>& pairs) const
{
    std::vector<std::int32_t> low, high;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (std::abs(positions[i].y) < 1) low.push_back(static_cast<std::int32_t>(i));
        if (std::abs(positions[i].y - period_y) < 1) high.push_back(static_cast<std::int32_t>(i));
    }
    for (const std::int32_t a : low) {
        for (const std::int32_t b : high) {
            const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
            const Vec2<double> d{positions[j].x - positions[i].x, positions[j].y - period_y - positions[i].y};
            const auto reach = static_cast<double>(radii_[i] + radii_[j] + contact_margin);
            if (dot(d, d) < reach * reach) pairs.push_back({a, b});
        }
    }
}

void Crowd::add_pairs_across_the_seam()
{
    Findings& found = findings_.front();
    found.pairs.resize(found.pair_count);
    find_pairs_across_the_seam(found.pairs);
    found.pair_count = found.pairs.size();
}

std::span<const Contact> Crowd::find_seam_contacts()
{
    std::vector<Pair> seam;
    if (period_y > 0) find_pairs_across_the_seam(seam);
    contact_count_ = seam.size();
    if (contacts_.size() < contact_count_) {
        contacts_.resize(contact_count_);
        pairs_.resize(contact_count_);
    }
    for (std::size_t k = 0; k < contact_count_; ++k) {
        pairs_[k] = seam[k];
        write_contact(contacts_[k], pairs_[k]);
    }
    return contacts();
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
    // Subtracted in double: people near each other may be far from the origin.
    const Vec2<double> d = offset(a, b);
    const auto dx = static_cast<float>(d.x), dy = static_cast<float>(d.y);
    const float distance = std::sqrt(dx * dx + dy * dy);
    // Two people at the same point are pushed apart along x.
    const bool apart = distance > 1e-9F;
    const float inverse = apart ? 1 / distance : 0;
    const float radius_a = listed_radius(a), radius_b = listed_radius(b);
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
