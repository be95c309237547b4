// A crowd of discs: people, their goals, and their contacts. Steering and the neighbour search are the host's part of
// a crowd simulation; this is just enough of a host for real scenes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "worlds/neighbour_grid.h"

namespace motley::bench {

/// One person: a disc with a goal.
struct Agent {
    BodyId body{};
    float radius = 0.2F;          ///< m; contacts use its value at add()
    float mass = 80;              ///< kg
    float desired_speed = 1.34F;  ///< m/s
    Vec2<double> goal{};          ///< m
};

/// A wall: a segment of no thickness, touched from both sides.
struct Wall {
    Vec2<double> from{}, to{};
};

class Crowd {
  public:
    float relaxation_time = 0.5F;  ///< s: how fast people take up their desired velocity
    float friction = 0;            ///< between people, and between people and walls
    float contact_margin =
        0.03F;  ///< m: gaps up to this become contacts, so that nothing is missed within a step

    double period_y = 0;  ///< m: above 0, y has this period: a strip without ends

    AlignedVector<Agent> agents;
    std::vector<Wall> walls;
    /// As of the last observe().
    AlignedVector<Vec3<double>> positions;
    AlignedVector<Vec3<float>> velocities;

    /// Adds a person as a planar body: a uniform disc.
    void add(Scene& scene, Agent agent, Vec2<double> position);
    /// Forgets agent `index` and removes its body; the last agent takes its place.
    void remove(Scene& scene, std::size_t index);

    /// Gives everybody a disc and makes the walls walls of the scene, so that the solver finds the contacts. People who
    /// are added later get a disc as well.
    void hand_over(Scene& scene);
    [[nodiscard]] bool is_handed_over() const { return is_handed_over_; }

    /// Reads positions and velocities from the scene.
    void observe(const Scene& scene, Executor& executor);
    /// Forces that bring everyone to the desired velocity: m (v0 e - v) / tau, e towards the goal.
    void steer(Scene& scene, Executor& executor);
    /// The contacts of the observed positions.
    std::span<const Contact> find_contacts(const Scene& scene, Executor& executor);

    /// The number of an agent in the order of arrival, from 0; never reused.
    [[nodiscard]] std::uint32_t number_of(std::size_t agent) const { return serial_[agent]; }
    /// The bodies in the order of `agents`.
    [[nodiscard]] std::span<const BodyId> bodies() const { return bodies_; }
    /// The last list that find_contacts() made.
    [[nodiscard]] std::span<const Contact> contacts() const { return {contacts_.data(), contact_count_}; }
    /// Index in `agents` of each contact's people; the second is -1 for a wall.
    using Pair = NeighbourGrid::Pair;
    [[nodiscard]] std::span<const Pair> pairs() const { return {pairs_.data(), contact_count_}; }

  private:
    AlignedVector<BodyId> bodies_;
    AlignedVector<float> radii_;  ///< of the agents, contiguous
    AlignedVector<Vec3<float>> forces_;
    NeighbourGrid grid_;
    AlignedVector<Contact> contacts_;  // the first contact_count_ of them
    AlignedVector<Pair> pairs_;
    std::size_t contact_count_ = 0;
    AlignedVector<std::uint32_t> serial_;  ///< each agent's order of arrival; part of contact keys
    std::uint32_t next_serial_ = 0;
    bool is_handed_over_ = false;

    /// What a chunk of the grid found: people near each other, and people near walls (b is the wall).
    struct Findings {
        std::vector<Pair> pairs, touches;
        std::size_t pair_count = 0;
        std::size_t first_contact = 0;
    };
    std::vector<Findings> findings_;

    [[nodiscard]] Vec2<double> nearest_point(const Wall& wall, std::size_t agent) const;
    [[nodiscard]] bool is_near(const Wall& wall, std::size_t agent) const;
    void add_pairs_across_the_seam();
    void prefetch(Pair pair) const;
    void write_contact(Contact& contact, Pair& pair) const;
    void write_wall_contact(Contact& contact, Pair touch, BodyId ground) const;
};

}  // namespace motley::bench
