// Building blocks of scenes for tests against closed forms.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "motley/motley.h"

namespace motley::testing {

inline constexpr float frame_time = 1.0F / 60;

/// Whether a sanitizer runs, which makes a step many times slower.
#ifdef MOTLEY_SANITIZED
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

/// The number of steps of a long run, of which sanitizers get only `sanitized`: later steps access the same memory as earlier
/// ones.
constexpr int long_run(int steps, int sanitized)
{
    return is_sanitized ? sanitized : steps;
}
/// The same, where a tenth of the steps is enough for a sanitizer.
constexpr int long_run(int steps)
{
    return long_run(steps, steps / 10);
}
/// The number of repeats with other random numbers, loads or copies, of which sanitizers get one for the same reason.
constexpr int repeats(int count)
{
    return is_sanitized ? 1 : count;
}

/// Sweeps of rigid constraints in one substep, without gravity or correction of positions: velocities are those that the last
/// sweep leaves.
inline SolverSettings weightless_sweeps(int iterations)
{
    SolverSettings settings;
    settings.method = Method::sequential_impulse;
    settings.drift_correction = DriftCorrection::none;
    settings.substeps = 1;
    settings.iterations = iterations;
    return settings;
}

inline SolverSettings with_gravity(Vec3<float> gravity)
{
    SolverSettings settings;
    settings.gravity = gravity;
    return settings;
}

/// A body with inertia 0.1, 0.2 and 0.25 m2 times its mass about x, y and z.
inline BodyDefinition box(Vec3<double> position, float mass = 2)
{
    BodyDefinition body;
    body.position = position;
    body.mass = mass;
    body.inertia = {0.1F * mass, 0, 0, 0.2F * mass, 0, 0.25F * mass};
    return body;
}

inline double length(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// kg m2/s about a point: m (x - point) x v + R I R^T w, of a body with principal moments I.
inline Vec3<double> angular_momentum(const BodyState& state, double mass, const Vec3<double>& moments,
                                     const Vec3<double>& point = {})
{
    const Quat<double> q = state.orientation, back{-q.x, -q.y, -q.z, q.w};
    const Vec3<double> w = rotate(back, convert<double>(state.angular_velocity));
    return mass * cross(state.position - point, convert<double>(state.linear_velocity)) +
           rotate(q, Vec3<double>{moments.x * w.x, moments.y * w.y, moments.z * w.z});
}

/// The rotation of a frame whose x lies along `axis`: 0 x, 1 y, 2 z.
inline Quat<float> axis_along(int axis)
{
    const Quat<float> turns[3] = {
        {0, 0, 0, 1}, {0, 0, 0.70710678F, 0.70710678F}, {0, -0.70710678F, 0, 0.70710678F}};
    return turns[axis];
}

inline void run(Scene& scene, Solver& solver, double seconds)
{
    for (int step = 0; step < static_cast<int>(std::lround(seconds * 60)); ++step) {
        ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
    }
}

}  // namespace motley::testing
