// A corridor of 50 x 5 m whose ends are joined: who leaves at one end is put back at the other.
#pragma once

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/neighbours.h"
#include "worlds/random.h"

namespace motley::bench {

class PeriodicCorridor : public CrowdScene {
  public:
    static constexpr double length = 50, width = 5;  ///< m, along y and x

    void steer(double time, Executor& executor) override
    {
        people.observe(scene, executor);
        put_back();
        aim(executor);
        people.steer(scene, executor);
        is_measured_ = time > settle;
    }
    void observe(double, const Solver&) override
    {
        for (const Vec3<double>& p : people.positions) breaches_ += p.x <= 0 || p.x >= width ? 1 : 0;
        for (const Touch& touch : people.touches(scene)) {
            // Torsos meet as discs across the seam, and overlap where they are put back.
            const double y = people.positions[static_cast<std::size_t>(touch.b)].y;
            if (people.are_torsos && (y < 1 || y > length - 1)) continue;
            deepest_ = std::max(deepest_, -touch.separation);
        }
        if (is_measured_) measure();
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        return {{"people through a wall, summed over the steps", static_cast<double>(breaches_), 0}};
    }

  protected:
    static constexpr double settle = 20;  ///< s before speeds are measured
    double deepest_ = 0;                  ///< m

    explicit PeriodicCorridor(const RunOptions& options)
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        people.period_y = length;
        people.walls = {{{0, -2}, {0, length + 2}}, {{width, -2}, {width, length + 2}}};
        Random random(options.seed);
        const auto count = static_cast<std::size_t>(
            options.density > 0 ? std::llround(options.density * length * width) : options.agents);
        const auto columns =
            static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count) * width / length)));
        const std::size_t rows = (count + columns - 1) / columns;
        const double across = width / static_cast<double>(columns),
                     along = length / static_cast<double>(rows);
        for (std::size_t i = 0; i < count; ++i) {
            Agent agent;
            agent.radius = static_cast<float>(0.20 * (1 + 0.08 * random.symmetric()));
            people.add(scene, agent,
                       {across * (0.5 + static_cast<double>(i % columns)) + 0.01 * random.symmetric(),
                        along * (0.5 + static_cast<double>(i / columns)) + 0.01 * random.symmetric()});
        }
    }
    /// Sets goals and desired speeds.
    virtual void aim(Executor& executor) = 0;
    /// Called after each step once the crowd has settled.
    virtual void measure() = 0;

  private:
    bool is_measured_ = false;
    std::int64_t breaches_ = 0;

    void put_back()
    {
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            Vec3<double>& p = people.positions[i];
            if (p.y >= 0 && p.y < length) continue;
            p.y += p.y < 0 ? length : -length;
            scene.set_pose(people.agents[i].body, p, {0, 0, 0, 1}, people.are_torsos ? people.yaws[i] : 0);
        }
    }
};

/// Half of the people walk up, half down. Lanes form by themselves where people give way.
class Counterflow final : public PeriodicCorridor {
  public:
    explicit Counterflow(const RunOptions& options) : PeriodicCorridor(options)
    {
        for (std::size_t i = 0; i < people.agents.size(); ++i) upward_.push_back(i % 2 == 0 ? 1.0 : -1.0);
        shuffle(upward_);
        people.steering = make_steering(options.steering);
        share_out_contacts(options);
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        const double samples = std::max(1.0, samples_);
        return {{"people per m2", static_cast<double>(people.agents.size()) / (length * width)},
                {"speed along each one's way, mean (m/s)", speed_ / samples},
                {"of it those who walk up (m/s)", up_ / std::max(1.0, ups_)},
                {"of it those who walk down (m/s)", (speed_ - up_) / std::max(1.0, samples_ - ups_)},
                {"lanes, 0 mixed to 1 parted: at the start", lanes_at_start_},
                {"lanes at the end", people.positions.empty() ? 0 : lanes()},
                {"overlap, deepest of all steps (% of radius)", 100 * deepest_ / 0.2}};
    }

  private:
    std::vector<double> upward_;  ///< 1 or -1
    double speed_ = 0, up_ = 0, samples_ = 0, ups_ = 0, lanes_at_start_ = -1;

    void aim(Executor&) override
    {
        if (lanes_at_start_ < 0) lanes_at_start_ = lanes();
        for (std::size_t i = 0; i < people.agents.size(); ++i)
            people.agents[i].goal = {people.positions[i].x, people.positions[i].y + 10 * upward_[i]};
    }
    void measure() override
    {
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            const double speed = upward_[i] * static_cast<double>(people.velocities[i].y);
            speed_ += speed;
            ++samples_;
            if (upward_[i] < 0) continue;
            up_ += speed;
            ++ups_;
        }
    }
    /// The mean of ((same - opposite) / (same + opposite))^2 of those within 5 m before or behind each person and 0.3 m
    /// beside (the order parameter of Rex and Loewen, 2007).
    [[nodiscard]] double lanes() const
    {
        double sum = 0;
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            double same = 0, all = 0;
            for (std::size_t j = 0; j < people.agents.size(); ++j) {
                const Vec2<double> d = people.offset(i, j);
                if (i == j || std::abs(d.x) > 0.3 || std::abs(d.y) > 5) continue;
                same += upward_[i] * upward_[j];
                ++all;
            }
            if (all > 0) sum += same * same / (all * all);
        }
        return sum / static_cast<double>(std::max<std::size_t>(1, people.agents.size()));
    }
};

/// Everybody walks up, no faster than the gap to whoever is ahead allows. The speed tests this rule and not the solver:
/// it is printed beside Weidmann's curve.
class Corridor final : public PeriodicCorridor {
  public:
    /// s. With this value the rule comes near the curve: the curve is a property of the rule.
    static constexpr float time_gap = 0.6F;
    static constexpr double desired_speed = 1.34;  ///< m/s

    explicit Corridor(const RunOptions& options) : PeriodicCorridor(options) { share_out_contacts(options); }

    /// Weidmann (1993), m/s at a density in people per m2.
    static double weidmann(double density)
    {
        return desired_speed * (1 - std::exp(-1.913 * (1 / density - 1 / 5.4)));
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        const double density = static_cast<double>(people.agents.size()) / (length * width);
        return {{"people per m2", density},
                {"speed (m/s)", speed_ / std::max(1.0, samples_)},
                {"Weidmann's speed (m/s)", weidmann(density)},
                {"overlap, deepest of all steps (% of radius)", 100 * deepest_ / 0.2}};
    }

  private:
    Neighbours neighbours_;
    double speed_ = 0, samples_ = 0;

    void aim(Executor& executor) override
    {
        neighbours_.find(people, time_gap * static_cast<float>(desired_speed), executor);
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            Agent& person = people.agents[i];
            person.goal = {people.positions[i].x, people.positions[i].y + 10};
            float gap = time_gap * static_cast<float>(desired_speed);
            for (const std::int32_t other : neighbours_.of(i)) {
                const auto j = static_cast<std::size_t>(other);
                const Vec2<double> d = people.offset(i, j);
                const float radii = person.radius + people.agents[j].radius;
                if (d.y <= 0 || std::abs(d.x) > static_cast<double>(radii)) continue;
                gap = std::min(gap, static_cast<float>(d.y) - radii);
            }
            person.desired_speed = std::max(0.0F, gap / time_gap);
        }
    }
    void measure() override
    {
        for (const Vec3<float>& v : people.velocities) speed_ += static_cast<double>(v.y);
        samples_ += static_cast<double>(people.velocities.size());
    }
};

}  // namespace motley::bench
