// Extremes: many bodies, many joints, denormals, and caches that no longer fit.
#pragma once

#include <algorithm>
#include <cmath>

#include "commands/extremes/trial.h"

namespace motley::bench {

/// The contact of `body`, a ball of radius 0.5 m, with the floor.
inline Contact floor_contact(const Trial& trial, BodyId body, std::uint64_t key)
{
    const Vec3<double> at = trial.scene.state(body).position;
    Contact contact;
    contact.body_a = trial.scene.ground();
    contact.body_b = body;
    contact.key = key;
    contact.normal = {0, 1, 0};
    contact.separation = static_cast<float>(at.y - 0.5);
    contact.arm_a = {static_cast<float>(at.x), 0, static_cast<float>(at.z)};
    contact.arm_b = {0, static_cast<float>(-at.y), 0};
    return contact;
}

/// Two hundred balls of 1 kg on top of each other, 2 kN on the lowest: how far the top one sinks in 5 s, in radii.
inline double tower(const ExtremeRun& run)
{
    constexpr int stories = 200;
    Trial trial(run);
    for (int i = 0; i < stories; ++i) trial.box({0, 0.5 + i, 0});
    std::vector<Contact> contacts;
    for (int step = 0; step < 300; ++step) {
        contacts.clear();
        contacts.push_back(floor_contact(trial, trial.bodies()[0], 0));
        for (std::size_t i = 1; i < stories; ++i) {
            const BodyId below = trial.bodies()[i - 1], above = trial.bodies()[i];
            Contact contact;
            contact.body_a = below;
            contact.body_b = above;
            contact.key = i;
            contact.normal = {0, 1, 0};
            contact.separation = static_cast<float>(trial.scene.state(above).position.y -
                                                    trial.scene.state(below).position.y - 1);
            contact.arm_a = {0, 0.5F, 0};
            contact.arm_b = {0, -0.5F, 0};
            contacts.push_back(contact);
        }
        trial.step(frame, contacts);
    }
    return trial.figure((stories - 0.5 - trial.scene.state(trial.bodies().back()).position.y) / 0.5);
}

/// A ball that bounces with restitution 1 from 0.1 m, ten thousand times: the largest deviation of its energy at the
/// top of a bounce from the energy that it began with, %.
inline double bounces(const ExtremeRun& run)
{
    const int last = run.way == ExtremeWay::direct ? 1000 : 10000;
    Trial trial(run);
    const BodyId ball = trial.box({0, 0.6, 0});
    // Energy above that of a ball that rests on the floor, whose centre is 0.5 m high.
    const auto height = [&] { return trial.energy() - 0.5 * 9.81; };
    const double start = height();
    double most = 0;
    bool fell = true;
    for (int bounce = 0, step = 0; bounce < last; ++step) {
        if (step > 100 * last) return no_claim;
        Contact contact = floor_contact(trial, ball, 1);
        contact.restitution = 1;
        trial.step(1.0F / 240, {&contact, contact.separation < 0.05F ? 1U : 0U});
        const bool falls = trial.scene.state(ball).linear_velocity.y < 0;
        if (!fell && falls) {
            most = std::max(most, std::abs(trial.figure(height() / start) - 1));
            ++bounce;
        }
        fell = falls;
    }
    return 100 * most;
}

/// One body with a hundred thousand joints to free bodies, pushed: the share of its momentum that is lost.
inline double hub(const ExtremeRun& run)
{
    const int spokes = run.way == ExtremeWay::direct ? 200 : 100000;
    Trial trial(run, {});
    BodyDefinition body;
    body.mass = 1000;
    body.linear_velocity = {1, 0, 0};
    const BodyId middle = trial.scene.add_body(body);
    body.mass = 1;
    body.linear_velocity = {};
    for (int i = 0; i < spokes; ++i)
        trial.scene.add_joint(BallSocketDefinition{middle, trial.scene.add_body(body), {}, {}});
    for (int step = 0; step < 3; ++step) trial.step();
    return trial.figure(std::abs(trial.scene.errors().momentum[0] / 1000 - 1));
}

/// Denormals in velocities, forces, gravity and impulses: the energy that results, J.
inline double denormals(const ExtremeRun& run)
{
    Trial trial(run, {1e-40F, -1e-40F, 1e-42F});
    trial.chain(8, {1, 0, 0}, 1e-3F);
    for (const BodyId body : trial.bodies()) {
        trial.scene.set_velocity(body, {1e-40F, 1e-41F, -1e-39F}, {1e-40F, 0, 1e-42F});
        trial.scene.set_force(body, {1e-41F, 1e-40F, 0}, {0, 1e-40F, 1e-44F});
    }
    for (int step = 0; step < 120; ++step) trial.step();
    return trial.figure(trial.scene.errors().kinetic_energy);
}

/// Ten thousand joints and bodies removed and added again in each step: joints that were lost, and how far the other
/// joints part.
inline double churn(const ExtremeRun& run)
{
    const int changing = run.way == ExtremeWay::direct ? 20 : 10000;
    Trial trial(run);
    trial.chain(6, {0, -1, 0}, 1);
    std::vector<BodyId> guests;
    double worst = 0;
    for (int step = 0; step < 30; ++step) {
        for (const BodyId guest : guests) trial.scene.remove_body(guest);
        guests.clear();
        for (int i = 0; i < changing; ++i) {
            BodyDefinition body;
            body.position = {5.0 + i, -0.5, 0};
            guests.push_back(trial.scene.add_body(body));
            trial.scene.add_joint(BallSocketDefinition{
                trial.scene.ground(), guests.back(), {5.0F + static_cast<float>(i), 0, 0}, {0, 0.5F, 0}});
        }
        trial.step();
        worst = std::max(worst, trial.scene.errors().joint_separation_max);
        if (trial.scene.joint_count() != static_cast<std::size_t>(6 + changing)) return no_claim;
    }
    return trial.figure(worst);
}

/// A ball pressed to the floor with 1 kN is teleported to the ceiling, and its contact keeps the key: the impulse of
/// the warm start now pushes along the opposite normal. The difference of its speed from that of a ball without a
/// warm start, m/s.
inline double reversed_cache(const ExtremeRun& run)
{
    double speed[2] = {};
    for (const bool cold : {false, true}) {
        Trial trial(run, {0, -1000, 0});
        const BodyId ball = trial.box({0, 0.5, 0});
        for (int step = 0; step < 60; ++step) {
            const Contact contact = floor_contact(trial, ball, 1);
            trial.step(frame, {&contact, 1});
        }
        trial.scene.set_pose(ball, {0, 9.5, 0}, {0, 0, 0, 1}, 0);
        trial.scene.set_velocity(ball, {}, {});
        Contact ceiling = floor_contact(trial, ball, cold ? 2 : 1);
        ceiling.normal = {0, -1, 0};
        ceiling.separation = 0;
        ceiling.arm_a = {0, 10, 0};
        ceiling.arm_b = {0, 0.5F, 0};
        trial.step(frame, {&ceiling, 1});
        speed[cold ? 1 : 0] =
            trial.figure(std::abs(static_cast<double>(trial.scene.state(ball).linear_velocity.y)));
    }
    return std::abs(speed[0] - speed[1]);
}

/// A hinge driven round ten thousand times at 200 rad/s: how far its axes part, rad.
inline double many_turns(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId wheel = trial.box({0, 0, 0});
    trial.scene.add_joint(HingeDefinition{trial.scene.ground(), wheel});
    trial.scene.set_velocity(wheel, {}, {200, 0, 0});
    const int steps = run.way == ExtremeWay::direct ? 600 : 18850;  // 10,000 turns of 2 pi at 200 rad/s
    double worst = 0;
    for (int step = 0; step < steps; ++step) {
        trial.step();
        worst = std::max(worst, trial.scene.errors().joint_angle_max);
    }
    return trial.figure(worst);
}

}  // namespace motley::bench
