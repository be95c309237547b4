// The people of the open crowd: who they are, where they begin and where they go next. Each follows from the person's number
// alone, so that several processes can share the crowd out among themselves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "worlds/bench_scene.h"

namespace motley::bench {

class OpenCrowdPeople {
  public:
    explicit OpenCrowdPeople(const RunOptions& options)
        : friction(options.friction < 0 ? 0.0F : options.friction), seed_(options.seed)
    {
        constexpr double default_density = 5;  // people per m2
        count = static_cast<std::size_t>(options.agents);
        const double density = options.density > 0 ? options.density : default_density;
        side = std::sqrt(static_cast<double>(count) / density);
        columns_ = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    }

    std::size_t count = 0;
    double side = 0;  ///< m, of the walled square
    float friction;   ///< of people and walls

    [[nodiscard]] std::array<Wall, 4> walls() const
    {
        return {
            {{{0, 0}, {side, 0}}, {{side, 0}, {side, side}}, {{side, side}, {0, side}}, {{0, side}, {0, 0}}}};
    }
    [[nodiscard]] Vec2<double> start_of(std::size_t number) const
    {
        const double pitch = side / static_cast<double>(columns_);
        return {pitch * (0.5 + static_cast<double>(number % columns_)) + 0.01 * symmetric(number, 1),
                pitch * (0.5 + static_cast<double>(number / columns_)) + 0.01 * symmetric(number, 2)};
    }
    /// Radius 0.20 m +- 8 %, as in a crowd of men and women, and with a first goal.
    [[nodiscard]] Agent person(std::size_t number) const
    {
        Agent agent;
        agent.radius = static_cast<float>(0.20 * (1 + 0.08 * symmetric(number, 3)));
        agent.goal = goal_near(start_of(number), number, 4);
        return agent;
    }
    /// In each step one person in so many looks whether the goal is reached, which is often enough for walks that take seconds:
    /// those of this number, and of every so many on.
    static constexpr std::size_t one_in = 60;
    [[nodiscard]] static std::size_t first_to_look(std::int64_t step)
    {
        return static_cast<std::size_t>(step) % one_in;
    }
    [[nodiscard]] static bool has_reached(const Vec2<double>& goal, const Vec3<double>& at)
    {
        const double x = goal.x - at.x, y = goal.y - at.y;
        return x * x + y * y < 1;
    }
    [[nodiscard]] Vec2<double> next_goal(std::size_t number, const Vec3<double>& at, std::int64_t step) const
    {
        return goal_near({at.x, at.y}, number, 6 + 2 * static_cast<std::uint64_t>(step));
    }

  private:
    std::uint64_t seed_;
    std::size_t columns_ = 1;

    /// -1 to 1, of a person and a purpose: splitmix64 of both.
    [[nodiscard]] double symmetric(std::size_t number, std::uint64_t purpose) const
    {
        std::uint64_t bits = seed_ + number * 0x9E3779B97F4A7C15ULL + purpose * 0xD1B54A32D192ED03ULL;
        bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9ULL;
        bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBULL;
        bits ^= bits >> 31;
        return static_cast<double>(bits >> 40) / 8388608.0 - 1;
    }
    /// On a grid of 1/1024 m, so that two floats hold it, which a rank sends to another as 64 bits.
    [[nodiscard]] Vec2<double> goal_near(const Vec2<double>& at, std::size_t number,
                                         std::uint64_t purpose) const
    {
        constexpr double walk = 20;  // m
        const auto within = [&](double x) {
            return std::round(1024 * std::clamp(x, 0.3, side - 0.3)) / 1024;
        };
        return {within(at.x + walk * symmetric(number, purpose)),
                within(at.y + walk * symmetric(number, purpose + 1))};
    }
};

}  // namespace motley::bench
