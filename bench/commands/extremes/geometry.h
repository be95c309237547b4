// Extremes: degenerate geometry and redundant joints.
#pragma once

#include <algorithm>
#include <cmath>

#include "commands/extremes/trial.h"

namespace motley::bench {

inline double no_distance(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId a = trial.box({}), b = trial.box({});
    DistanceDefinition rod{a, b};
    rod.min_length = rod.max_length = 1;
    trial.scene.add_joint(rod);
    for (int i = 0; i < 600; ++i) trial.step();
    return trial.figure(std::abs(length(trial.scene.state(b).position - trial.scene.state(a).position) - 1));
}
inline double coincident_contact(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId a = trial.box({}), b = trial.box({});
    double fastest = 0;
    for (int i = 0; i < 240; ++i) {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.normal = {1, 0, 0};
        contact.separation =
            static_cast<float>(trial.scene.state(b).position.x - trial.scene.state(a).position.x) - 2;
        trial.step(frame, {&contact, 1});
        fastest = std::max(fastest, static_cast<double>(trial.scene.state(b).linear_velocity.x -
                                                        trial.scene.state(a).linear_velocity.x));
    }
    return trial.figure(fastest / static_cast<double>(trial.settings.push_out_speed));
}
inline double half_a_turn_off(const ExtremeRun& run)
{
    double worst = 0;
    for (int axis = 0; axis < 3; ++axis) {
        Trial trial(run, {});
        const BodyId body = trial.box({});
        const double half = (3.14159265358979 - 1e-3) / 2;
        Quat<double> q{0, 0, 0, std::cos(half)};
        (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = std::sin(half);
        trial.scene.set_pose(body, {}, q, 0);
        trial.scene.add_joint(RotationLockDefinition{trial.scene.ground(), body});
        for (int i = 0; i < 120; ++i) trial.step();
        worst = std::max(worst, trial.figure(trial.scene.errors().joint_angle_max));
    }
    return worst;
}
inline double same_joint_ten_times(const ExtremeRun& run)
{
    const auto end = [&](int times) {
        Trial trial(run);
        trial.settings.substeps = 1;
        const BodyId body = trial.box({0.5, 0, 0});
        for (int i = 0; i < times; ++i)
            trial.scene.add_joint(BallSocketDefinition{trial.scene.ground(), body, {}, {-0.5F, 0, 0}});
        trial.step();
        return convert<double>(trial.scene.state(body).linear_velocity);
    };
    return length(end(10) - end(1));
}
inline double contradictory_welds(const ExtremeRun& run)
{
    Trial trial(run);
    const BodyId body = trial.box({});
    trial.scene.add_joint(FixedDefinition{trial.scene.ground(), body, {{0.5F, 0, 0}}});
    trial.scene.add_joint(FixedDefinition{trial.scene.ground(), body, {{-0.5F, 0, 0}}});
    double farthest = 0;
    for (int i = 0; i < 2000; ++i) {
        trial.step();
        farthest = std::max(farthest, length(trial.scene.state(body).position));
    }
    return trial.figure(farthest);
}
/// Two rods and a third of 10^exponent kg between them, on four parallel hinges.
template <int exponent>
double loop_of_four(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    const BodyId left = trial.box({0, -0.5, 0}), right = trial.box({1, -0.5, 0}),
                 rod = trial.box({0.5, -1, 0}, static_cast<float>(std::pow(10.0, exponent)));
    const auto hinge = [&](BodyId a, BodyId b, Vec3<double> at) {
        const Quat<float> z{0, -0.70710678F, 0, 0.70710678F};
        const auto arm = [&](BodyId body) { return convert<float>(at - trial.scene.state(body).position); };
        trial.scene.add_joint(HingeDefinition{a, b, {arm(a), z}, {arm(b), z}});
    };
    hinge(trial.scene.ground(), left, {});
    hinge(trial.scene.ground(), right, {1, 0, 0});
    hinge(left, rod, {0, -1, 0});
    hinge(right, rod, {1, -1, 0});
    trial.scene.set_velocity(rod, {2, 0, 0}, {});
    return trial.worst_separation(run.way == ExtremeWay::direct ? 300 : 3600);
}
/// A door on two hinges of one axis, which have five redundant rows: the separation of its joints.
inline double door(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    const BodyId leaf = trial.box({0.5, 0, 0});
    const Quat<float> y{0, 0, 0.70710678F, 0.70710678F};
    for (const float height : {-0.8F, 0.8F}) {
        trial.scene.add_joint(
            HingeDefinition{trial.scene.ground(), leaf, {{0, height, 0}, y}, {{-0.5F, height, 0}, y}});
    }
    trial.scene.set_velocity(leaf, {}, {0, 5, 0});
    return trial.worst_separation(600);
}
/// The same pose written as q and as -q while a chain of hinges swings: the distance between the two ends.
inline double other_hemisphere(const ExtremeRun& run)
{
    const auto end = [&](double sign) {
        Trial trial(run);
        const BodyId first = trial.box({0.5, 0, 0}), second = trial.box({1.5, 0, 0});
        trial.scene.add_joint(HingeDefinition{trial.scene.ground(), first, {}, {{-0.5F, 0, 0}}});
        trial.scene.add_joint(FixedDefinition{first, second, {{0.5F, 0, 0}}, {{-0.5F, 0, 0}}});
        trial.scene.set_velocity(second, {0, 1, 2}, {3, 0, 0});
        for (int i = 0; i < 120; ++i) {
            if (i % 30 == 15) {
                const BodyState s = trial.scene.state(second);
                const Quat<double>& q = s.orientation;
                trial.scene.set_pose(second, s.position, {sign * q.x, sign * q.y, sign * q.z, sign * q.w}, 0);
            }
            trial.step();
        }
        return trial.scene.state(second).position;
    };
    return length(end(-1) - end(1));
}
/// Perpendicular axes that start parallel, where no rotation reduces C to first order: the fastest spin, rad/s.
inline double parallel_axes(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({});
    // The x axis of a on the y axis of b.
    const JointFrame turned{{}, {0, 0, -0.70710678F, 0.70710678F}};
    trial.scene.add_joint(PerpendicularAxesDefinition{trial.scene.ground(), body, {}, turned});
    double fastest = 0;
    for (int i = 0; i < 600; ++i) {
        trial.step();
        fastest = std::max(fastest, length(convert<double>(trial.scene.state(body).angular_velocity)));
    }
    return trial.figure(fastest);
}
inline double closed_range(const ExtremeRun& run)
{
    const auto end = [&](bool limit) {
        Trial trial(run);
        trial.settings.joint_hertz = 1e6F;
        trial.settings.contact_hertz = 1e6F;
        trial.settings.substeps = 8;
        const BodyId body = trial.box({0.5, 0, 0});
        if (limit) {
            trial.scene.add_joint(SliderDefinition{trial.scene.ground(), body, {}, {{-0.5F, 0, 0}}});
            SlideDriveDefinition range{trial.scene.ground(), body, {}, {{-0.5F, 0, 0}}};
            range.lower = range.upper = 0;
            trial.scene.add_joint(range);
        } else {
            trial.scene.add_joint(FixedDefinition{trial.scene.ground(), body, {}, {{-0.5F, 0, 0}}});
        }
        for (int i = 0; i < 120; ++i) trial.step();
        return trial.scene.state(body).position;
    };
    return length(end(true) - end(false));
}
inline double limits_at_speed(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({});
    trial.scene.add_joint(SliderDefinition{trial.scene.ground(), body});
    SlideDriveDefinition range{trial.scene.ground(), body};
    range.lower = -1;
    range.upper = 1;
    trial.scene.add_joint(range);
    trial.scene.set_velocity(body, {200, 0, 0}, {});
    const double before = trial.energy();
    const double peak = trial.peak_energy(2000);
    return trial.figure(100 * (peak / before - 1));
}

}  // namespace motley::bench
