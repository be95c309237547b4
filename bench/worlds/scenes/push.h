// A packed slab of people, each leaning on the one in front with 50 N: the stress on the wall is exactly density x
// length x force, 4.5 kN/m with 90 people behind every metre of it. Without friction, so that no side wall carries a
// share.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "worlds/bench_scene.h"

namespace motley::bench {

class Push final : public CrowdScene {
  public:
    static constexpr double radius = 0.2;
    static constexpr double force = 50;      ///< N each, towards -x
    static constexpr int people_a_row = 50;  ///< along the wall
    static constexpr double width = 2 * radius * people_a_row;

    explicit Push(const RunOptions& options)
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        // Touching discs in hexagonal packing: in a disordered packing force chains would make the true stress differ
        // between bands. The ends of the strip touch each other, as on an infinite wall: a side wall would take half
        // of what the disc at the end of a row passes on, and the law of the slab would not hold near it.
        const double row_pitch = std::sqrt(3.0) * radius;
        const auto rows = static_cast<int>(options.agents / people_a_row);
        for (int row = 0; row < rows; ++row) {
            for (int i = 0; i < people_a_row; ++i) {
                Agent agent;
                agent.radius = static_cast<float>(radius);
                people.add(scene, agent, {radius + row_pitch * row, radius * (1 + row % 2) + 2 * radius * i});
            }
        }
        people.walls = {{{0, -1}, {0, width + 1}}};
        people.period_y = width;
        expected_ = force * static_cast<double>(people.agents.size()) / width;
        std::vector<Vec3<float>> forces(people.agents.size(), {-static_cast<float>(force), 0, 0});
        scene.set_forces(people.bodies(), forces);
    }

    void steer(double, Executor& executor) override { people.observe(scene, executor); }

    void observe(double time, const Solver&) override
    {
        if (time < settle) return;
        const auto impulses = scene.contact_impulses();
        const auto contacts = people.contacts();
        const auto pairs = people.pairs();
        const double per_second = 1 / static_cast<double>(scene.last_step());
        std::vector<double> bands(static_cast<std::size_t>(width), 0.0);
        double total = 0;  // N
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (pairs[i].b >= 0 || contacts[i].normal.x < 0.9F) continue;  // only the front wall
            const double push = static_cast<double>(impulses[i].normal) * per_second;
            total += push;
            spread(people.positions[static_cast<std::size_t>(pairs[i].a)].y, push, bands);
        }
        for (std::size_t b = 0; b < bands.size(); ++b) {
            if (sums_.size() <= b) sums_.push_back(0);
            sums_[b] += bands[b];
            const double wrong = bands[b] / expected_ - 1;
            squares_ += wrong * wrong / static_cast<double>(bands.size());
        }
        const double wall = total / width / expected_ - 1;
        wall_squares_ += wall * wall;
        ++samples_;
    }

    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"wall stress of 1 m bands off its law, rms per step (share)",
                          samples_ > 0 ? std::sqrt(squares_ / samples_) : 0};
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        if (samples_ == 0) return {};  // the run was shorter than the settling time
        std::vector<Figure> figures{{"wall stress, expected (N/m)", expected_}};
        double worst = 0;
        for (std::size_t band = 0; band < sums_.size(); ++band) {
            const double wrong = 100 * (sums_[band] / samples_ / expected_ - 1);
            figures.emplace_back(fmt::format("wall stress off, 1 m band {} (%)", band + 1), wrong);
            worst = std::max(worst, std::abs(wrong));
        }
        figures.emplace_back("wall stress off, worst 1 m band (%)", worst);
        figures.emplace_back("wall force off, rms per step (%)", 100 * std::sqrt(wall_squares_ / samples_));
        figures.emplace_back("band stress off, rms per step (%)", 100 * std::sqrt(squares_ / samples_));
        return figures;
    }

  private:
    static constexpr double settle = 2;  ///< s before sampling
    double expected_ = 0;                ///< N/m
    std::vector<double> sums_;
    double squares_ = 0, wall_squares_ = 0;
    int samples_ = 0;

    /// A person leans on the wall over the width of the shoulders, not at a point: the force is spread over the
    /// diameter.
    static void spread(double y, double push, std::vector<double>& bands)
    {
        // The last band ends where the first begins.
        if (y > width - radius) bands[0] += push * (y + radius - width) / (2 * radius);
        for (std::size_t b = 0; b < bands.size(); ++b) {
            const double from = std::max(y - radius, static_cast<double>(b)),
                         to = std::min(y + radius, static_cast<double>(b) + 1);
            if (to > from) bands[b] += push * (to - from) / (2 * radius);
        }
    }
};

}  // namespace motley::bench
