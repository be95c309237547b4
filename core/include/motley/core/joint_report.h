// What a joint tells of itself.
#pragma once

#include <cstdint>
#include <limits>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// What a joint did to its body b in some time: an impulse where it acts, and a turning impulse beside it; world.
template <class Real>
struct Wrench {
    Vec3<Real> push;  ///< N s, at the joint's anchor on b
    Vec3<Real> turn;  ///< N m s, about that anchor
};

/// Whether a joint had anything to say in the last substep.
enum class JointState : std::uint8_t {
    inactive,  ///< a limit or rope with room on every side
    active,    ///< holds, drives or springs
    lower,     ///< at its lower limit
    upper      ///< at its upper limit; of a rope: taut
};

/// What a joint did in the last step, all its substeps together, and how far off it is now.
struct JointReport {
    Vec3<float>
        force{};  ///< N, world, on body b at its anchor: its impulse over the step, divided by the step
    Vec3<float> torque{};   ///< N m, world, on body b about its anchor, likewise
    float error = 0;        ///< m: the length of the linear part of C, of a limit only what it is beyond it
    float angle_error = 0;  ///< rad, of the angular part
    JointState state = JointState::inactive;
};

/// What a joint bears before the host is told.
struct BreakLimit {
    float force = std::numeric_limits<float>::infinity();   ///< N, > 0
    float torque = std::numeric_limits<float>::infinity();  ///< N m, > 0
};

/// A joint that bore more than its BreakLimit, on average over the last step.
struct BreakEvent {
    ConstraintId joint{};
    float force = 0;   ///< N
    float torque = 0;  ///< N m
};

}  // namespace motley
