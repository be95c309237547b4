// Rows of discs along x that do not affect each other: crowds whose laws are known exactly.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"

namespace motley::bench {

/// The root of the mean of squares.
class MeanSquare {
  public:
    void add(double value)
    {
        sum_ += value * value;
        ++count_;
    }
    [[nodiscard]] double root() const
    {
        return std::sqrt(sum_ / static_cast<double>(std::max<std::int64_t>(1, count_)));
    }

  private:
    double sum_ = 0;
    std::int64_t count_ = 0;
};

/// Rows of planar discs that touch only their neighbours in the row, so that no search is needed.
class Rows : public BenchScene {
  public:
    void steer(double, Executor&) override {}

  protected:
    static constexpr double radius = 0.2;
    static constexpr float mass = 80;
    static constexpr double margin = 0.05;  ///< m: a pair with a gap up to this becomes a contact
    std::vector<BodyId> bodies_;
    std::vector<Vec3<double>> positions_;
    std::vector<Contact> contacts_;
    int length_ = 0;         ///< discs a row
    float restitution_ = 0;  ///< of each contact between them

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
    /// Adds a contact of each disc with the next in its row if that is near.
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
        contact.restitution = restitution_;
        contact.arm_a = {arm_a, 0, 0};
        contact.arm_b = {-static_cast<float>(radius + gap / 2), 0, 0};
        contacts_.push_back(contact);
    }
};

/// Rows of `length`, each disc leaning on the next with 50 N towards a wall: contact k from the back carries 50 k N.
template <int length>
class Lean final : public Rows {
  public:
    static constexpr double force = 50;  ///< N
    static constexpr double settle = 4;  ///< s until the load has run through a row and back
    explicit Lean(const RunOptions& options)
    {
        add_rows(options.agents, length, 0);
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
                (static_cast<double>(impulses[i].normal) / static_cast<double>(scene.last_step()) -
                 behind * force) /
                (length_ * force);
            off_.add(off);
        }
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"force profile off kF, rms (share of nF)", off_.root()};
    }

  private:
    MeanSquare off_;
};

/// Rows of discs with gaps between them, the first of which starts with some speed.
class Pulse : public Rows {
  public:
    struct Shape {
        int length;         ///< discs a row
        double gap, speed;  ///< m, m/s
        float restitution;
    };
    std::span<const Contact> find_contacts(Executor&) override
    {
        touch_neighbours();
        return contacts_;
    }

  protected:
    Pulse(const RunOptions& options, const Shape& shape) : shape_(shape), dt_(static_cast<double>(options.dt))
    {
        restitution_ = shape.restitution;
        add_rows(options.agents, shape.length, shape.gap);
        for (std::size_t i = 0; i < bodies_.size(); i += static_cast<std::size_t>(length_))
            scene.set_velocity(bodies_[i], {static_cast<float>(shape.speed), 0, 0}, {});
    }
    Shape shape_;
    double dt_;
    MeanSquare off_;  ///< share of the gap
    /// How far disc `i` of the first row has moved.
    [[nodiscard]] double moved(int i) const
    {
        return scene.state(bodies_[static_cast<std::size_t>(i)]).position.x - (2 * radius + shape_.gap) * i;
    }
};

/// Restitution 0: the first disc pushes all discs that it meets along. n + 1 of them move at v/(n + 1) once the n-th
/// is hit, at t = g n (n + 1)/(2 v).
class InelasticPulse final : public Pulse {
  public:
    static constexpr Shape row{20, 0.1, 1.5, 0};
    /// A push of 150 N s into a crowd with gaps of 2 cm, taken as a single row.
    static constexpr Shape strip{100, 0.02, 150 / static_cast<double>(mass), 0};
    InelasticPulse(const RunOptions& options, const Shape& shape) : Pulse(options, shape) {}

    void observe(double time, const Solver&) override
    {
        off_.add((moved(0) - exact(time + dt_)) / shape_.gap);
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"first body off the exact law, rms (share of the gap)", off_.root()};
    }

  private:
    /// Where the first disc is: it crosses the n-th gap in n times the time of the first.
    [[nodiscard]] double exact(double time) const
    {
        double left = time, x = 0;
        for (int moving = 1; moving < length_; ++moving) {
            const double takes = shape_.gap * moving / shape_.speed;
            if (left < takes) return x + left * shape_.speed / moving;
            left -= takes;
            x += shape_.gap;
        }
        return x + left * shape_.speed / length_;
    }
};

/// Restitution 1: each disc passes its speed to the next and stops, so that the front runs at v (1 + d/g), d the
/// diameter, g the gap.
class ElasticPulse final : public Pulse {
  public:
    explicit ElasticPulse(const RunOptions& options) : Pulse(options, {20, 0.1, 1.5, 1}) {}

    void observe(double time, const Solver&) override
    {
        for (int i = 0; i < length_; ++i) {
            const double since = (time + dt_) * shape_.speed - shape_.gap * i;
            // Nothing stops the last disc.
            const double exact = i + 1 < length_ ? std::clamp(since, 0.0, shape_.gap) : std::max(since, 0.0);
            off_.add((moved(i) - exact) / shape_.gap);
        }
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"bodies off the exact law, rms (share of the gap)", off_.root()};
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        double energy = 0;
        for (int i = 0; i < length_; ++i) {
            const float v = scene.state(bodies_[static_cast<std::size_t>(i)]).linear_velocity.x;
            energy += static_cast<double>(v * v);
        }
        return {{"kinetic energy kept (%)", 100 * energy / (shape_.speed * shape_.speed)}};
    }
};

}  // namespace motley::bench
