// Mechanisms whose motion is known: their equations of motion in minimal coordinates, integrated in double by fourth
// order Runge-Kutta at 1/64 of a step. The error is how far the bodies are from where they should be.
#pragma once

#include <array>
#include <cmath>
#include <memory>

#include "worlds/rig.h"

namespace motley::bench {

inline constexpr double rig_dt = 1.0 / 60;  ///< s between two entries of a truth

/// Angles and their rates, at every step.
template <std::size_t angles>
class Motion {
  public:
    using Angles = std::array<double, angles>;
    struct State {
        Angles angle{}, rate{};
    };
    /// `acceleration(state)` gives the second derivatives.
    template <class Acceleration>
    Motion(const Angles& start, double seconds, const Acceleration& acceleration)
    {
        constexpr int parts = 64;
        const double h = rig_dt / parts;
        State state{start, {}};
        states_.push_back(state);
        const auto moved = [](State s, const Angles& rate, const Angles& change, double time) {
            for (std::size_t i = 0; i < angles; ++i) {
                s.angle[i] += time * rate[i];
                s.rate[i] += time * change[i];
            }
            return s;
        };
        for (int step = 0; step < static_cast<int>(std::ceil(seconds / rig_dt)) + 1; ++step) {
            for (int part = 0; part < parts; ++part) {
                const Angles c1 = acceleration(state);
                const State s2 = moved(state, state.rate, c1, h / 2);
                const Angles c2 = acceleration(s2);
                const State s3 = moved(state, s2.rate, c2, h / 2);
                const Angles c3 = acceleration(s3);
                const State s4 = moved(state, s3.rate, c3, h);
                const Angles c4 = acceleration(s4);
                for (std::size_t i = 0; i < angles; ++i) {
                    state.angle[i] += h / 6 * (state.rate[i] + 2 * s2.rate[i] + 2 * s3.rate[i] + s4.rate[i]);
                    state.rate[i] += h / 6 * (c1[i] + 2 * c2[i] + 2 * c3[i] + c4[i]);
                }
            }
            states_.push_back(state);
        }
    }
    [[nodiscard]] const Angles& at(double time) const
    {
        const auto step = static_cast<std::size_t>(std::lround(time / rig_dt));
        return states_[std::min(step, states_.size() - 1)].angle;
    }

  private:
    std::vector<State> states_;
};

inline double distance(const Vec3<double>& u, const Vec3<double>& v)
{
    const Vec3<double> d = u - v;
    return std::sqrt(dot(d, d));
}
/// A unit vector `angle` from straight down, in the x-y plane.
inline Vec3<double> down_turned(double angle)
{
    return {std::sin(angle), -std::cos(angle), 0};
}

inline constexpr double rig_g = 9.81;
inline constexpr double mechanism_seconds = 11;  ///< s: how long the reference motions last

/// A body of 1 kg, its centre 1 m from a ball-socket, starting level.
inline Rig make_pendulum(std::int64_t bodies, std::uint64_t)
{
    static constexpr double inertia = 0.1;
    Rig rig;
    const int bob = rig.add({.position = {1, 0, 0}, .mass = 1, .inertia = {0.1F, 0.1F, 0.1F}});
    rig.joints.push_back({.a = rig_world, .b = bob, .anchor = {0, 0, 0}});
    const auto motion = std::make_shared<Motion<1>>(
        std::array<double, 1>{1.5707963267948966}, mechanism_seconds, [](const Motion<1>::State& s) {
            return std::array<double, 1>{-rig_g * std::sin(s.angle[0]) / (1 + inertia)};
        });
    rig.truth = [motion](std::span<const RigPose> poses, double time) {
        return distance(poses[0].position, down_turned(motion->at(time)[0]));
    };
    return repeat(rig, bodies);
}

/// Lagrange's equations of two hinged rods of 1 kg and 1 m: M (angle1'', angle2'') = f.
inline std::array<double, 2> double_pendulum_acceleration(const Motion<2>::State& s)
{
    constexpr double l = 0.5, length = 1, inertia = 1.0 / 12;
    const double between = s.angle[0] - s.angle[1], c = length * l * std::cos(between),
                 r = length * l * std::sin(between);
    const double m11 = inertia + l * l + length * length, m22 = inertia + l * l;
    const double f1 = -r * s.rate[1] * s.rate[1] - (l + length) * rig_g * std::sin(s.angle[0]);
    const double f2 = r * s.rate[0] * s.rate[0] - l * rig_g * std::sin(s.angle[1]);
    const double d = m11 * m22 - c * c;
    return {(m22 * f1 - c * f2) / d, (m11 * f2 - c * f1) / d};
}

/// Two rods of 1 kg and 1 m, hinged, starting level. The motion is chaotic: only its first two seconds can be
/// predicted.
inline Rig make_double_pendulum(std::int64_t bodies, std::uint64_t)
{
    static constexpr double l = 0.5, length = 1, inertia = 1.0 / 12;
    const auto tensor = static_cast<float>(inertia);
    Rig rig;
    const int upper = rig.add({.position = {l, 0, 0}, .mass = 1, .inertia = {0.01F, tensor, tensor}});
    const int lower =
        rig.add({.position = {length + l, 0, 0}, .mass = 1, .inertia = {0.01F, tensor, tensor}});
    rig.joints.push_back(
        {.a = rig_world, .b = upper, .anchor = {0, 0, 0}, .tie = RigTie::hinge, .axis = {0, 0, 1}});
    rig.joints.push_back(
        {.a = upper, .b = lower, .anchor = {length, 0, 0}, .tie = RigTie::hinge, .axis = {0, 0, 1}});
    const auto motion =
        std::make_shared<Motion<2>>(std::array<double, 2>{1.5707963267948966, 1.5707963267948966},
                                    mechanism_seconds, double_pendulum_acceleration);
    rig.truth = [motion](std::span<const RigPose> poses, double time) {
        const auto& angle = motion->at(time);
        const Vec3<double> elbow = length * down_turned(angle[0]);
        return std::hypot(distance(poses[0].position, l * down_turned(angle[0])),
                          distance(poses[1].position, elbow + l * down_turned(angle[1])));
    };
    return repeat(rig, bodies / 2);
}

/// A parallelogram on four hinges, the classical redundant loop: two cranks of 1 m and 1 kg carry a bar of 2 m and 3
/// kg.
inline Rig make_four_bar(std::int64_t bodies, std::uint64_t)
{
    static constexpr double crank = 1, bar = 2, start = 1, inertia = 1.0 / 12;
    static constexpr double crank_mass = 1, bar_mass = 3;
    const auto tensor = static_cast<float>(inertia);
    const Vec3<double> way = down_turned(start);
    Rig rig;
    const int left = rig.add({.position = 0.5 * way, .mass = 1, .inertia = {tensor, tensor, tensor}});
    const int right = rig.add(
        {.position = Vec3<double>{bar, 0, 0} + 0.5 * way, .mass = 1, .inertia = {tensor, tensor, tensor}});
    const int coupler =
        rig.add({.position = Vec3<double>{bar / 2, 0, 0} + way, .mass = 3, .inertia = {0.01F, 1, 1}});
    const auto hinge = [&](int a, int b, Vec3<double> at) {
        rig.joints.push_back({.a = a, .b = b, .anchor = at, .tie = RigTie::hinge, .axis = {0, 0, 1}});
    };
    hinge(rig_world, left, {0, 0, 0});
    hinge(rig_world, right, {bar, 0, 0});
    hinge(left, coupler, way);
    hinge(right, coupler, Vec3<double>{bar, 0, 0} + way);
    const auto motion = std::make_shared<Motion<1>>(
        std::array<double, 1>{start}, mechanism_seconds, [](const Motion<1>::State& s) {
            const double moved = 2 * (inertia + crank_mass * crank * crank / 4) + bar_mass * crank * crank;
            return std::array<double, 1>{-(crank_mass + bar_mass) * crank * rig_g * std::sin(s.angle[0]) /
                                         moved};
        });
    rig.truth = [motion](std::span<const RigPose> poses, double time) {
        return distance(poses[2].position,
                        Vec3<double>{bar / 2, 0, 0} + crank * down_turned(motion->at(time)[0]));
    };
    return repeat(rig, bodies / 3);
}

}  // namespace motley::bench
