#include "worlds/steering/half_planes.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace motley::bench {
namespace {

/// The problem with all planes but the hard ones moved back by `slack`.
struct Problem {
    std::span<const HalfPlane> planes;
    std::size_t hard;
    float greatest_speed, slack;

    [[nodiscard]] Vec2<float> point(std::size_t i) const
    {
        return i < hard ? planes[i].point : planes[i].point - slack * planes[i].normal;
    }
    [[nodiscard]] bool allows(std::size_t i, Vec2<float> velocity) const
    {
        return dot(planes[i].normal, velocity - point(i)) >= -1e-6F;
    }
    /// The velocity on the border of plane i nearest to the wish that the planes before it allow.
    [[nodiscard]] std::optional<Vec2<float>> on_border(std::size_t i, Vec2<float> wish) const
    {
        const Vec2<float> from = point(i), along{-planes[i].normal.y, planes[i].normal.x};
        const float middle = -dot(along, from);
        const float distance = dot(planes[i].normal, from);
        const float half2 = greatest_speed * greatest_speed - distance * distance;
        if (half2 < 0) return {};
        float low = middle - std::sqrt(half2), high = middle + std::sqrt(half2);
        for (std::size_t j = 0; j < i; ++j) {
            const float rises = dot(planes[j].normal, along);
            const float here = dot(planes[j].normal, from - point(j));
            if (std::abs(rises) < 1e-6F) {
                if (here < 0) return {};
                continue;
            }
            const float at = -here / rises;
            if (rises > 0)
                low = std::max(low, at);
            else
                high = std::min(high, at);
            if (low > high) return {};
        }
        return from + std::clamp(dot(along, wish - from), low, high) * along;
    }
    [[nodiscard]] std::optional<Vec2<float>> solve(Vec2<float> wish) const
    {
        const float speed = std::sqrt(dot(wish, wish));
        Vec2<float> best = speed > greatest_speed ? greatest_speed / speed * wish : wish;
        // The planes are added one by one. If one excludes the best velocity so far, the new best is on its border.
        for (std::size_t i = 0; i < planes.size(); ++i) {
            if (allows(i, best)) continue;
            const std::optional<Vec2<float>> moved = on_border(i, wish);
            if (!moved) return {};
            best = *moved;
        }
        return best;
    }
};

}  // namespace

Vec2<float> nearest_allowed(std::span<const HalfPlane> planes, std::size_t hard, float greatest_speed,
                            Vec2<float> wish)
{
    Problem problem{planes, hard, greatest_speed, 0};
    if (const auto velocity = problem.solve(wish)) return *velocity;
    // The smallest slack by bisection: enough of it allows everything that the hard planes allow.
    float too_little = 0, enough = 4 * greatest_speed + 4;
    problem.slack = enough;
    std::optional<Vec2<float>> best = problem.solve(wish);
    if (!best) return Problem{planes.first(hard), hard, greatest_speed, 0}.solve({}).value_or(Vec2<float>{});
    for (int halving = 0; halving < 16; ++halving) {
        problem.slack = (too_little + enough) / 2;
        if (const auto velocity = problem.solve(wish)) {
            best = velocity;
            enough = problem.slack;
        } else {
            too_little = problem.slack;
        }
    }
    return *best;
}

}  // namespace motley::bench
