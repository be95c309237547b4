// A packed slab of people, each leaning on the one in front with the same force: the stress on the wall is exactly
// density x length x force. With 50 N and 90 people behind every metre of the wall it is 4.5 kN/m. Without friction, so
// that no side wall carries a share.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/scenes/rows.h"

namespace motley::bench {

class Push final : public CrowdScene {
  public:
    static constexpr double radius = 0.2;
    static constexpr int rows = 36;  ///< behind each other

    /// Each leans with `force`, N, towards -x.
    Push(const RunOptions& options, double force)
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        // Whole metres of wall: five people stand on two.
        people_a_row_ = 5 * std::max(1, static_cast<int>(options.agents / (5 * rows)));
        width_ = 2 * radius * people_a_row_;
        // Touching discs in hexagonal packing: in a disordered packing force chains would make the true stress differ
        // between bands. The ends of the strip touch each other, as on an infinite wall: a side wall would take half
        // of what the disc at the end of a row passes on, and the law of the slab would not hold near it.
        const double row_pitch = std::sqrt(3.0) * radius;
        for (int row = 0; row < rows; ++row) {
            for (int i = 0; i < people_a_row_; ++i) {
                Agent agent;
                agent.radius = static_cast<float>(radius);
                people.add(scene, agent, {radius + row_pitch * row, radius * (1 + row % 2) + 2 * radius * i});
            }
        }
        people.walls = {{{0, -1}, {0, width_ + 1}}};
        people.period_y = width_;
        expected_ = force * static_cast<double>(people.agents.size()) / width_;
        std::vector<Vec3<float>> forces(people.agents.size(), {-static_cast<float>(force), 0, 0});
        scene.set_forces(people.bodies(), forces);
        share_out_contacts(options);
        sums_.resize(static_cast<std::size_t>(std::lround(width_)));
    }

    void steer(double, Executor& executor) override { people.observe(scene, executor); }

    void observe(double time, const Solver&) override
    {
        if (time < settle) return;
        std::vector<double> bands(sums_.size(), 0.0);
        double total = 0;  // N
        for (const Touch& touch : people.touches(scene)) {
            deepest_ = std::max(deepest_, -touch.separation);
            if (touch.a >= 0) continue;
            total += touch.force;
            spread(people.positions[static_cast<std::size_t>(touch.b)].y, touch.force, bands);
        }
        for (std::size_t b = 0; b < bands.size(); ++b) {
            sums_[b] += bands[b];
            band_off_.add(bands[b] / expected_ - 1);
        }
        wall_off_.add(total / width_ / expected_ - 1);
        ++samples_;
    }

    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"wall stress of 1 m bands off its law, rms per step (share)", band_off_.root()};
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        if (samples_ == 0) return {};  // the run was shorter than the settling time
        std::vector<Figure> figures{{"wall stress, expected (N/m)", expected_}};
        constexpr std::size_t most_bands = 20;
        for (std::size_t band = 0; band < std::min(sums_.size(), most_bands); ++band)
            figures.emplace_back(fmt::format("wall stress off, 1 m band {} (%)", band + 1), 100 * off(band));
        return figures;
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        if (samples_ == 0) return {};
        double worst = 0;
        for (std::size_t band = 0; band < sums_.size(); ++band) worst = std::max(worst, std::abs(off(band)));
        return {{"wall stress off, worst 1 m band (share)", worst, 0.02},
                {"band stress off, rms per step (share)", band_off_.root(), 0.02},
                {"wall force off, rms per step (share)", wall_off_.root(), 0.02},
                {"overlap, deepest of all steps (share of radius)", deepest_ / radius, 0.01}};
    }

  private:
    static constexpr double settle = 2;  ///< s before sampling
    int people_a_row_ = 0;
    double width_ = 0;     ///< m, along the wall
    double expected_ = 0;  ///< N/m
    std::vector<double> sums_;
    MeanSquare band_off_, wall_off_;
    double deepest_ = 0;  ///< m
    int samples_ = 0;

    /// How far the mean stress of a band is off its law, as a share.
    [[nodiscard]] double off(std::size_t band) const { return sums_[band] / samples_ / expected_ - 1; }

    /// A person leans on the wall over the width of the shoulders, not at a point: the force is spread over the
    /// diameter.
    void spread(double y, double push, std::vector<double>& bands) const
    {
        // The last band ends where the first begins.
        if (y > width_ - radius) bands[0] += push * (y + radius - width_) / (2 * radius);
        const auto first = static_cast<std::size_t>(std::max(0.0, y - radius));
        for (std::size_t b = first; b < std::min(first + 2, bands.size()); ++b) {
            const double from = std::max(y - radius, static_cast<double>(b)),
                         to = std::min(y + radius, static_cast<double>(b) + 1);
            if (to > from) bands[b] += push * (to - from) / (2 * radius);
        }
    }
};

}  // namespace motley::bench
