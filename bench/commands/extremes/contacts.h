// Extremes: contacts under loads, with friction of any size, and in duplicate.
#pragma once

#include <algorithm>
#include <cmath>

#include "commands/extremes/trial.h"

namespace motley::bench {

/// A ball of 10^exponent kg on one of 1 kg on the floor, for 10 s: how far the upper one sinks, in radii.
template <int exponent>
double heavy_on_light(const ExtremeRun& run)
{
    Trial trial(run);
    const BodyId light = trial.box({0, 0.5, 0}),
                 heavy = trial.box({0, 1.5, 0}, static_cast<float>(std::pow(10.0, exponent)));
    double lowest = 1.5;
    for (int step = 0; step < 600; ++step) {
        const double y[] = {0, trial.scene.state(light).position.y, trial.scene.state(heavy).position.y};
        Contact contacts[2];
        for (int i = 0; i < 2; ++i) {
            contacts[i].body_a = i == 0 ? trial.scene.ground() : light;
            contacts[i].body_b = i == 0 ? light : heavy;
            contacts[i].key = static_cast<std::uint64_t>(i);
            contacts[i].normal = {0, 1, 0};
            contacts[i].separation = static_cast<float>(y[i + 1] - y[i] - (i == 0 ? 0.5 : 1));
            contacts[i].arm_a = {0, i == 0 ? 0.0F : 0.5F, 0};
            contacts[i].arm_b = {0, -0.5F, 0};
        }
        trial.step(frame, contacts);
        lowest = std::min(lowest, trial.scene.state(heavy).position.y);
    }
    return trial.figure((1.5 - lowest) / 0.5);
}

/// A cube of 1 m on the floor y = 0 that touches it with its four lower corners, or twice with each corner, `twins` m
/// apart.
class Cube {
  public:
    Cube(const ExtremeRun& run, Vec3<float> pull, float friction, double twins = 0)
        : trial(run, pull), body(trial.box({0, 0.5, 0})), friction_(friction), twins_(twins)
    {
    }
    Trial trial;
    BodyId body;
    void step()
    {
        Contact contacts[8];
        const unsigned count = twins_ > 0 ? 8 : 4;
        const BodyState s = trial.scene.state(body);
        for (unsigned i = 0; i < count; ++i) {
            Contact& contact = contacts[i];
            contact.body_a = trial.scene.ground();
            contact.body_b = body;
            contact.key = i;
            contact.normal = {0, 1, 0};
            const Vec3<double> local{(i % 2 == 0 ? -0.5 : 0.5) + (i < 4 ? 0 : twins_), -0.5,
                                     i % 4 < 2 ? -0.5 : 0.5};
            const Vec3<double> arm = rotate(s.orientation, local);
            contact.separation = static_cast<float>(s.position.y + arm.y);
            contact.arm_b = convert<float>(arm);
            contact.arm_a = convert<float>(s.position + arm);
            contact.friction = friction_;
        }
        trial.step(frame, {contacts, count});
    }

  private:
    float friction_;
    double twins_;
};

/// Friction 1e6 under a sideways pull: the mean speed of creep over 10 s, m/s.
inline double huge_friction(const ExtremeRun& run)
{
    Cube cube(run, {3, -9.81F, 0}, 1e6F);
    for (int step = 0; step < 600; ++step) cube.step();
    return cube.trial.figure(std::abs(cube.trial.scene.state(cube.body).position.x) / 10);
}
/// No friction at all: the error of the speed under a sideways pull after 2 s against that of free fall, %.
inline double no_friction(const ExtremeRun& run)
{
    Cube cube(run, {3, -9.81F, 0}, 0);
    for (int step = 0; step < 120; ++step) cube.step();
    const auto speed = static_cast<double>(cube.trial.scene.state(cube.body).linear_velocity.x);
    return cube.trial.figure(100 * std::abs(speed / 6 - 1));
}
/// A cube that touches twice at each corner, a micrometre apart: its spin after 10 s, rad/s.
inline double twin_points(const ExtremeRun& run)
{
    Cube cube(run, gravity, 0.5F, 1e-6);
    for (int step = 0; step < 600; ++step) cube.step();
    return cube.trial.figure(length(convert<double>(cube.trial.scene.state(cube.body).angular_velocity)));
}

}  // namespace motley::bench
