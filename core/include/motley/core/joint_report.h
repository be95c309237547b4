// Reports on joints, and break limits.
#pragma once

#include <cstdint>
#include <limits>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// The linear and the angular impulse of a joint on its body b over some time, world frame.
template <class Real>
struct Wrench {
    Vec3<Real> push;  ///< N s, at the joint's anchor on b
    Vec3<Real> turn;  ///< N m s, about that anchor
};

/// What a joint did in the last substep.
enum class JointState : std::uint8_t {
    inactive,  ///< nothing: a limit or rope that is not reached
    active,    ///< it holds or drives, or its spring acts
    lower,     ///< it is at its lower limit
    upper      ///< it is at its upper limit; of a rope: taut
};

/// The mean force of a joint over the last step, and its position error now.
struct JointReport {
    Vec3<float>
        force{};  ///< N, world, on body b at its anchor: the impulse of the whole step divided by its duration
    Vec3<float> torque{};   ///< N m, world, on body b about its anchor, likewise
    float error = 0;        ///< m: norm of the linear part of C; of a limit how far it is exceeded
    float angle_error = 0;  ///< rad, likewise of the angular part
    JointState state = JointState::inactive;
};

/// The load on a joint above which Scene::break_events() reports it.
struct BreakLimit {
    float force = std::numeric_limits<float>::infinity();   ///< N, > 0; infinite: no limit
    float torque = std::numeric_limits<float>::infinity();  ///< N m, > 0; infinite: no limit
};

/// A joint whose mean force or torque over the last step was above its BreakLimit.
struct BreakEvent {
    ConstraintId joint{};
    float force = 0;   ///< N, norm of JointReport::force
    float torque = 0;  ///< N m, norm of JointReport::torque
};

}  // namespace motley
#pragma GCC visibility pop
