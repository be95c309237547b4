// Extremes: loads, friction, springs.
#pragma once

#include <algorithm>
#include <cmath>

#include "commands/extremes/trial.h"

namespace motley::bench {

inline double a_blow(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    trial.chain(5, {0, -1, 0}, 1);
    const BodyId tip = trial.bodies().back();
    trial.scene.set_force(tip, {1e6F, 0, 0}, {});
    trial.step();
    trial.scene.set_force(tip, {}, {});
    for (int i = 0; i < 120; ++i) trial.step();
    return trial.figure(trial.scene.errors().joint_separation_rms / 0.5);
}
/// How far the end of a level arm of eight links of 1 kg sinks within a second, of a link's length: each hinge is at its limit,
/// and the end bears 10 t.
inline double limits_of_an_arm(const ExtremeRun& run)
{
    Trial trial(run);
    constexpr float half = 0.25F;
    const Quat<float> about_z{0, -0.70710678F, 0, 0.70710678F};
    BodyId before = trial.scene.ground();
    for (int i = 0; i < 8; ++i) {
        const BodyId body = trial.box({half * (2.0 * i + 1), 0, 0}, 1, {0.02F, 0.02F, 0.02F});
        const JointFrame inner{{i == 0 ? 0 : half, 0, 0}, about_z}, outer{{-half, 0, 0}, about_z};
        trial.scene.add_joint(HingeDefinition{before, body, inner, outer});
        TwistDriveDefinition limit;
        limit.body_a = before;
        limit.body_b = body;
        limit.frame_a = inner;
        limit.frame_b = outer;
        limit.lower = 0;
        limit.upper = 1;
        trial.scene.add_joint(limit);
        before = body;
    }
    const BodyId end = trial.box({16.0 * half, 0, 0}, 1e4F, {0.01F, 0.01F, 0.01F});
    trial.scene.add_joint(FixedDefinition{before, end, {{half, 0, 0}}, {}});
    for (int i = 0; i < 60; ++i) trial.step();
    return trial.figure(length(trial.scene.state(end).position - Vec3<double>{16.0 * half, 0, 0}) /
                        (2 * half));
}
inline double deep_overlap(const ExtremeRun& run)
{
    Trial trial(run, {});
    std::vector<BodyId> balls;
    for (int i = 0; i < 3; ++i) balls.push_back(trial.box({0.01 * i, 0, 0}));
    double fastest = 0;
    for (int step = 0; step < 240; ++step) {
        std::vector<Contact> contacts;
        for (std::size_t i = 0; i + 1 < balls.size(); ++i) {
            Contact contact;
            contact.body_a = balls[i];
            contact.body_b = balls[i + 1];
            contact.key = i;
            contact.normal = {1, 0, 0};
            contact.separation = static_cast<float>(trial.scene.state(balls[i + 1]).position.x -
                                                    trial.scene.state(balls[i]).position.x) -
                                 2;
            contacts.push_back(contact);
        }
        trial.step(frame, contacts);
        fastest = std::max(
            fastest, trial.figure(length(convert<double>(trial.scene.state(balls[2]).linear_velocity))));
    }
    // The two balls of each contact part at the push-out speed, so the outer balls leave the middle one at that
    // speed.
    return fastest / static_cast<double>(trial.settings.push_out_speed);
}
/// 1e-12 N on 1 kg for 10 s: the relative error of the speed against v = F t / m.
inline double whisper(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({});
    trial.scene.set_force(body, {1e-12F, 0, 0}, {});
    for (int i = 0; i < 600; ++i) trial.step();
    return trial.figure(std::abs(static_cast<double>(trial.scene.state(body).linear_velocity.x) / 1e-11 - 1));
}
inline double weightless_hour(const ExtremeRun& run)
{
    Trial trial(run, {});
    trial.settings.substeps = 1;
    trial.chain(3, {1, 0, 0}, 1);
    const double steps = run.way == ExtremeWay::direct ? 600 : 216000;
    for (int i = 0; i < static_cast<int>(steps); ++i) trial.step();
    return trial.figure(length(trial.scene.state(trial.bodies().back()).position - Vec3<double>{1.25, 0, 0}));
}
template <int exponent>
double spring_of(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({1.5, 0, 0});
    DistanceDefinition spring{trial.scene.ground(), body};
    spring.min_length = 0;
    spring.max_length = 100;
    spring.spring_hertz = static_cast<float>(std::pow(10.0, exponent));
    spring.spring_damping_ratio = 0.5F;
    spring.rest_length = 1;
    trial.scene.add_joint(spring);
    double farthest = 0;
    for (int i = 0; i < 600; ++i) {
        trial.step();
        farthest = std::max(farthest, std::abs(trial.scene.state(body).position.x - 1));
    }
    return trial.figure(farthest);
}
/// Scenes without bodies, with static bodies only, and with one body: how many of them could not be stepped.
inline double next_to_nothing(const ExtremeRun& run)
{
    int stuck = 0;
    for (int what = 0; what < 3; ++what) {
        Trial trial(run, {});
        BodyDefinition still;
        still.motion = BodyMotion::static_body;
        if (what == 1) trial.scene.add_body(still);
        if (what == 2) trial.box({});
        for (int i = 0; i < 10; ++i) trial.step();
        stuck += trial.figure(0) == 0 && trial.scene.errors().kinetic_energy == 0 ? 0 : 1;
    }
    return stuck;
}
inline double both_static(const ExtremeRun& run)
{
    Trial trial(run);
    BodyDefinition still;
    still.motion = BodyMotion::static_body;
    const BodyId a = trial.scene.add_body(still), b = trial.scene.add_body(still);
    int refused = 0;
    try {
        trial.scene.add_joint(BallSocketDefinition{a, b});
    } catch (const InvalidInput&) {
        ++refused;
    }
    try {
        trial.scene.add_joint(BallSocketDefinition{a, a});
    } catch (const InvalidInput&) {
        ++refused;
    }
    trial.step();
    return trial.figure(2 - refused);
}

}  // namespace motley::bench
