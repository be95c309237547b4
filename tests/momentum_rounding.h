// What rounding to float may change of momenta that the equations conserve.
#pragma once

#include <cmath>

namespace motley::testing {

/// Velocities are floats. Each time a body's velocity is stored, at least one rounding moves its momentum by up to half
/// a unit in the last place, 2^-24 of itself, with a standard deviation of 2^-24 / sqrt(3). What is added each time is
/// rounded too, but is smaller than the velocity. Rounding to nearest has no direction, so that `stores` of them for
/// each body add up as a random walk does. Returns six standard deviations of the sum over bodies, of whose momenta,
/// or |m x v| and |I w|, `squares` is the sum of squares.
inline double rounding_of_momenta(double stores, double squares)
{
    return 6 * std::ldexp(std::sqrt(stores / 3 * squares), -24);
}

/// How often a step of soft_step or sequential_impulse stores the velocity of a body with so many joints: with gravity
/// and gyration, and for each joint once for the warm start and once a sweep.
inline double stores_of(int joints, int sweeps)
{
    return 1.0 + joints * (1.0 + sweeps);
}

}  // namespace motley::testing
