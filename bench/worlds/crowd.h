// A crowd of discs: people, their goals, and their contacts. Steering and the neighbour search are the host's part of
// a crowd simulation; this is just enough of a host for real scenes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "worlds/neighbour_grid.h"
#include "worlds/steering.h"

namespace motley::bench {

/// One person: a disc with a goal.
struct Agent {
    BodyId body{};
    float radius = 0.2F;          ///< m; contacts use its value at add()
    float mass = 80;              ///< kg
    float desired_speed = 1.34F;  ///< m/s
    Vec2<double> goal{};          ///< m
};

/// A person as a planar body: a uniform disc.
inline BodyDefinition body_of(const Agent& agent, const Vec2<double>& position)
{
    BodyDefinition body;
    body.model = BodyModel::planar;
    body.position = {position.x, position.y, 0};
    body.mass = agent.mass;
    body.inertia.zz = 0.5F * agent.mass * agent.radius * agent.radius;
    return body;
}

/// Plain steering: the force that brings a person to the desired velocity, m (v0 e - v) / tau, e towards the goal, N.
inline Vec3<float> walking_force(const Agent& agent, float relaxation_time, const Vec3<double>& position,
                                 const Vec3<float>& velocity)
{
    const auto dx = static_cast<float>(agent.goal.x - position.x),
               dy = static_cast<float>(agent.goal.y - position.y);
    const float speed = agent.desired_speed / std::max(std::sqrt(dx * dx + dy * dy), 1e-3F);
    const float gain = agent.mass / relaxation_time;
    return {gain * (speed * dx - velocity.x), gain * (speed * dy - velocity.y), 0};
}

/// A wall: a segment of no thickness, touched from both sides.
struct Wall {
    Vec2<double> from{}, to{};
};

/// A contact that pushed in the last step, found or listed.
struct Touch {
    std::int32_t a = -1;     ///< index in `agents`; -1: a wall
    std::int32_t b = -1;     ///< index in `agents`
    std::int32_t wall = -1;  ///< index in `walls`; -1: two people, or a wall that the scene itself added
    Vec2<float> normal{};    ///< unit, from a to b
    double separation = 0;   ///< m, as the step began; negative when overlapping
    double force = 0;        ///< N, on b along the normal
    double friction = 0;     ///< N, on b along the normal turned by +90 degrees
};

class Crowd {
  public:
    static constexpr float default_relaxation_time = 0.5F;  ///< s
    float relaxation_time = default_relaxation_time;  ///< s: how fast people take up their desired velocity
    float friction = 0;                               ///< between people, and between people and walls
    float contact_margin =
        0.03F;  ///< m: gaps up to this become contacts, so that nothing is missed within a step

    /// m: above 0, y has this period: a strip without ends. The library knows no periods, so the contacts across the
    /// seam stay listed when all others are found.
    double period_y = 0;
    /// People are capsules across the shoulders, 2.3 radii wide and 1.2 deep, and turn to where they walk. Their contacts
    /// must be found by the library; across a seam they meet as discs as wide as they are deep.
    bool are_torsos = false;
    std::unique_ptr<Steering> steering;  ///< null: the plain one of steer()

    AlignedVector<Agent> agents;
    std::vector<Wall> walls;
    /// As of the last observe().
    AlignedVector<Vec3<double>> positions;
    AlignedVector<Vec3<float>> velocities;
    AlignedVector<double> yaws;  ///< rad; of torsos only

    /// Adds a person by body_of().
    void add(Scene& scene, Agent agent, Vec2<double> position);
    /// Forgets agent `index` and removes its body; the last agent takes its place.
    void remove(Scene& scene, std::size_t index);

    /// From the centre of a torso that looks along x to an end of its axis, m.
    [[nodiscard]] static Vec2<float> shoulder(const Agent& agent) { return {0, 0.55F * agent.radius}; }
    [[nodiscard]] static float depth_radius(const Agent& agent) { return 0.6F * agent.radius; }
    /// Gives everybody a disc, or a torso, and makes the walls walls of the scene, so that the solver finds the contacts. People who
    /// are added later get one as well.
    void hand_over(Scene& scene);
    [[nodiscard]] bool is_handed_over() const { return is_handed_over_; }

    /// Reads positions and velocities from the scene.
    void observe(const Scene& scene, Executor& executor);
    /// The forces of `steering`; without one walking_force().
    void steer(Scene& scene, Executor& executor);
    /// The contacts of the observed positions.
    std::span<const Contact> find_contacts(const Scene& scene, Executor& executor);
    /// Only those across the seam of a period.
    std::span<const Contact> find_seam_contacts();
    /// What pushed in the last step. Nobody may have been added or removed since.
    [[nodiscard]] std::vector<Touch> touches(const Scene& scene) const;
    /// From the observed position of a to that of b, the shorter way round a period.
    [[nodiscard]] Vec2<double> offset(std::size_t a, std::size_t b) const
    {
        double y = positions[b].y - positions[a].y;
        if (period_y > 0 && std::abs(y) > period_y / 2) y -= y > 0 ? period_y : -period_y;
        return {positions[b].x - positions[a].x, y};
    }
    /// From the nearest point of a wall to the observed position of a person.
    [[nodiscard]] Vec2<double> offset_from(const Wall& wall, std::size_t agent) const
    {
        return Vec2<double>{positions[agent].x, positions[agent].y} - nearest_point(wall, agent);
    }

    /// The number of an agent in the order of arrival, from 0; never reused.
    [[nodiscard]] std::uint32_t number_of(std::size_t agent) const { return serial_[agent]; }
    /// The bodies in the order of `agents`.
    [[nodiscard]] std::span<const BodyId> bodies() const { return bodies_; }
    [[nodiscard]] std::span<const float> radii() const { return radii_; }
    /// The last list that find_contacts() made.
    [[nodiscard]] std::span<const Contact> contacts() const { return {contacts_.data(), contact_count_}; }
    /// Index in `agents` of each contact's people; the second is -1 for a wall.
    using Pair = NeighbourGrid::Pair;
    [[nodiscard]] std::span<const Pair> pairs() const { return {pairs_.data(), contact_count_}; }

  private:
    AlignedVector<BodyId> bodies_;
    AlignedVector<float> radii_;  ///< of the agents, contiguous
    AlignedVector<Vec3<float>> forces_, torques_, spins_;
    NeighbourGrid grid_;
    AlignedVector<Contact> contacts_;  // the first contact_count_ of them
    AlignedVector<Pair> pairs_;
    std::size_t contact_count_ = 0;
    AlignedVector<std::uint32_t> serial_;  ///< each agent's order of arrival; part of contact keys
    std::uint32_t next_serial_ = 0;
    bool is_handed_over_ = false;
    std::vector<WallId> wall_ids_;  ///< of `walls`, once handed over

    /// What a chunk of the grid found: people near each other, and people near walls (b is the wall).
    struct Findings {
        std::vector<Pair> pairs, touches;
        std::size_t pair_count = 0;
        std::size_t first_contact = 0;
    };
    std::vector<Findings> findings_;

    void give_shapes(Scene& scene, std::size_t from) const;
    void turn_torsos(const Scene& scene);
    [[nodiscard]] std::int32_t index_of(WallId wall) const;
    /// The radius of a person in a list of contacts, m.
    [[nodiscard]] float listed_radius(std::size_t agent) const
    {
        return are_torsos ? depth_radius(agents[agent]) : radii_[agent];
    }
    [[nodiscard]] Vec2<double> nearest_point(const Wall& wall, std::size_t agent) const;
    [[nodiscard]] bool is_near(const Wall& wall, std::size_t agent) const;
    void find_pairs_across_the_seam(std::vector<Pair>& pairs) const;
    void add_pairs_across_the_seam();
    [[nodiscard]] std::vector<Touch> found_touches(const Scene& scene) const;
    void prefetch(Pair pair) const;
    void write_contact(Contact& contact, Pair& pair) const;
    void write_wall_contact(Contact& contact, Pair touch, BodyId ground) const;
};

}  // namespace motley::bench
