// Rows of discs with gaps between them, the first of which runs into the others.
#pragma once

#include "worlds/scenes/rows.h"

namespace motley::bench {

/// Rows of discs with gaps between them, the first of which starts with some speed.
class Pulse : public Rows {
  public:
    struct Shape {
        int length;         ///< discs a row
        double gap, speed;  ///< m, m/s
        float restitution;
    };

  protected:
    Pulse(const RunOptions& options, const Shape& shape)
        : Rows(options.lists_contacts || shape.restitution > 0),
          shape_(shape),
          dt_(static_cast<double>(options.dt))
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
        // Disc n moves at v/(n + 1) from its hit to that of the next: where it is at the end of the step in which it was
        // hit tells when that was.
        for (; hits_ + 1 < length_ && moved(hits_ + 1) > 1e-6; ++hits_) {
            const int n = hits_ + 1;
            const double expected = shape_.gap * n * (n + 1) / (2 * shape_.speed);
            const double hit = time + dt_ - moved(n) * (n + 1) / shape_.speed;
            worst_hit_ = std::max(worst_hit_, std::abs(hit / expected - 1));
        }
        deepest_ = std::max(deepest_, deepest_overlap());
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"first body off the exact law, rms (share of the gap)", off_.root()};
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        return {{"discs hit in each row", static_cast<double>(hits_)}};
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        return {{"times of the hits off g n (n + 1) / (2 v), worst (share)", worst_hit_, 0.01},
                {"overlap, deepest of all steps (share of radius)", deepest_ / radius, 0.01}};
    }

  private:
    int hits_ = 0;  ///< of the first row
    double worst_hit_ = 0;
    double deepest_ = 0;  ///< m

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
        return {{"kinetic energy kept (%)", 100 * energy_kept()}};
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        return {{"kinetic energy off what it was (share)", std::abs(energy_kept() - 1), 0.01}};
    }

  private:
    [[nodiscard]] double energy_kept() const
    {
        double energy = 0;
        for (int i = 0; i < length_; ++i) {
            const float v = scene.state(bodies_[static_cast<std::size_t>(i)]).linear_velocity.x;
            energy += static_cast<double>(v * v);
        }
        return energy / (shape_.speed * shape_.speed);
    }
};

}  // namespace motley::bench
