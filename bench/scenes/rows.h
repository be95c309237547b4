// Rows of discs, each a world of its own along x: the laws of crowds that are known exactly.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "../bench_scene.h"

namespace motley::bench {

/// Rows of planar discs that touch only their neighbours in line; the host knows who they are.
class Rows : public BenchScene {
  public:
    void steer(double, Executor&) override {}

  protected:
    static constexpr double radius = 0.2;
    static constexpr float mass = 80;
    static constexpr double margin = 0.05;  ///< m: gaps up to this are contacts to come
    std::vector<BodyId> bodies_;
    std::vector<Vec3<double>> positions_;
    std::vector<Contact> contacts_;
    int length_ = 0;  ///< discs a row

    /// Adds rows of `length` discs from x = 0 on, `gap` apart.
    void add_rows(std::int64_t agents, int length, double gap)
    {
        length_ = length;
        for (std::int64_t row = 0; row < std::max<std::int64_t>(1, agents / length); ++row) {
            for (int i = 0; i < length; ++i) {
                BodyDefinition body{.model = BodyModel::planar, .mass = mass};
                body.position = {(2 * radius + gap) * i, static_cast<double>(row), 0};
                body.inertia.zz = 0.5F * mass * static_cast<float>(radius * radius);
                bodies_.push_back(scene.add_body(body));
            }
        }
        positions_.resize(bodies_.size());
    }
    /// A contact with the next in line of each disc whose neighbour is near.
    void touch_neighbours()
    {
        scene.read_positions(bodies_, positions_);
        contacts_.clear();
        for (std::size_t i = 0; i + 1 < bodies_.size(); ++i) {
            if ((i + 1) % static_cast<std::size_t>(length_) == 0) continue;
            const double gap = positions_[i + 1].x - positions_[i].x - 2 * radius;
            if (gap < margin) touch(bodies_[i], bodies_[i + 1], gap, i, static_cast<float>(radius + gap / 2));
        }
    }
    void touch(BodyId a, BodyId b, double gap, std::uint64_t key, float arm_a)
    {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = key;
        contact.normal = {1, 0, 0};
        contact.separation = static_cast<float>(gap);
        contact.arm_a = {arm_a, 0, 0};
        contact.arm_b = {-static_cast<float>(radius + gap / 2), 0, 0};
        contacts_.push_back(contact);
    }
};

/// Rows of 100, each disc leaning on the next with 50 N towards a wall: contact k from the back carries 50 k N.
class Lean final : public Rows {
  public:
    static constexpr double force = 50;  ///< N
    static constexpr double settle = 4;  ///< s until the load has run through a row and back
    explicit Lean(const RunOptions& options)
    {
        add_rows(options.agents, 100, 0);
        std::vector<Vec3<float>> forces(bodies_.size(), {-static_cast<float>(force), 0, 0});
        scene.set_forces(bodies_, forces);
    }
    std::span<const Contact> find_contacts(Executor&) override
    {
        touch_neighbours();
        for (std::size_t i = 0; i < bodies_.size(); i += static_cast<std::size_t>(length_)) {
            Contact wall;
            wall.body_a = scene.ground();
            wall.body_b = bodies_[i];
            wall.key = bodies_.size() + i;
            wall.normal = {1, 0, 0};
            wall.separation = static_cast<float>(positions_[i].x);
            wall.arm_a = {static_cast<float>(-radius), static_cast<float>(positions_[i].y), 0};
            wall.arm_b = {static_cast<float>(-radius), 0, 0};
            contacts_.push_back(wall);
        }
        return contacts_;
    }
    void observe(double time, const Solver&) override
    {
        if (time < settle) return;
        const auto impulses = scene.contact_impulses();
        for (std::size_t i = 0; i < contacts_.size(); ++i) {
            const bool at_wall = contacts_[i].key >= bodies_.size();
            const auto place = static_cast<int>(contacts_[i].key % static_cast<std::size_t>(length_));
            const double behind = at_wall ? length_ : length_ - 1 - place;
            const double off =
                (static_cast<double>(impulses[i].normal) / static_cast<double>(scene.last_substep) -
                 behind * force) /
                (length_ * force);
            squares_ += off * off;
            ++samples_;
        }
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"force profile off kF, rms (share of nF)",
                          std::sqrt(squares_ / static_cast<double>(std::max<std::int64_t>(1, samples_)))};
    }

  private:
    double squares_ = 0;
    std::int64_t samples_ = 0;
};

/// Rows of 20 discs 0.1 m apart; the first comes with 1.5 m/s and takes all with it (restitution 0): n + 1 of them move at
/// 1.5/(n + 1) m/s once the n-th is hit, at t = g n (n + 1)/(2 v).
class Pulse final : public Rows {
  public:
    static constexpr double gap = 0.1, speed = 1.5;
    explicit Pulse(const RunOptions& options) : dt_(static_cast<double>(options.dt))
    {
        add_rows(options.agents, 20, gap);
        for (std::size_t i = 0; i < bodies_.size(); i += static_cast<std::size_t>(length_))
            scene.set_velocity(bodies_[i], {static_cast<float>(speed), 0, 0}, {});
    }
    std::span<const Contact> find_contacts(Executor&) override
    {
        touch_neighbours();
        return contacts_;
    }
    void observe(double time, const Solver&) override
    {
        const double off = scene.state(bodies_[0]).position.x - exact(time + dt_);
        squares_ += off * off;
        ++samples_;
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{
            "first body off the exact law, rms (share of the gap)",
            std::sqrt(squares_ / static_cast<double>(std::max<std::int64_t>(1, samples_))) / gap};
    }

  private:
    double dt_, squares_ = 0;
    std::int64_t samples_ = 0;

    /// Where the first body is: each gap takes n times as long as the first one did.
    [[nodiscard]] double exact(double time) const
    {
        double left = time, x = 0;
        for (int moving = 1; moving < length_; ++moving) {
            const double takes = gap * moving / speed;
            if (left < takes) return x + left * speed / moving;
            left -= takes;
            x += gap;
        }
        return x + left * speed / length_;
    }
};

}  // namespace motley::bench
