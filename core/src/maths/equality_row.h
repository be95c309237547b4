// The rows that the solver of exact joints (SolverSettings::exact_joints) holds: of locks, and of limits, motors and springs
// that act.
//
// A sweep knows the response of the two bodies of a limit alone. Where these are links that bear tons, the response is a
// hundred or a million times as large as that of the figure, and sweeps would take as many rounds to hold the load. So sweeps
// only find out that a limit, a motor or a spring acts; from then on its row is one more row of the lock, until it would pull
// where it can only push, or push harder than it may: an active set, changed whenever the figure is factored (J. Nocedal, S.
// Wright, Numerical Optimization, 2006, section 16.5). The row of a spring gives way: J v + give lambda = speed.
//
// A rotor of inertia I_r on such a row always acts, for it is part of the figure's inertia. Its speed is that of the row, so it
// gives the bodies lambda = -I_r (J v - its speed before): a row with give 1 / I_r and that speed. On the row of a spring both
// add up, and on that of a limit or motor, which does not give way, the rotor takes the part of lambda that it needs.
#pragma once

#include <cstdint>

#include "maths/scalar.h"
#include "maths/step_constants.h"
#include "maths/torque.h"
#include "motley/core/vector.h"

namespace motley {

/// J = [-linear, -lever_a, linear, lever_b] over the velocities (v_a, omega_a, v_b, omega_b), and C, both in the
/// present poses of the bodies. The row is solved when J v + rate C = speed.
template <class Real>
struct EqualityRow {
    Vec3<Real> linear;
    Vec3<Real> lever_a, lever_b;
    Real error;            ///< C, m or rad
    Real speed = Real(0);  ///< m/s or rad/s; other than 0 for motors and springs only
};

/// The row of a limit, motor or spring.
enum class ActiveRow : std::uint8_t {
    none,
    linear,  ///< it also pushes the bodies along a line
    angular  ///< it only turns them, about opposite axes
};

/// What acts on such a row: one of these, as a Real. A rotor may be there beside the last three.
struct ActsBy {
    static constexpr float nothing = 0, rotor = 1, limit = 2, motor = 3, spring = 4;
};
/// Whether nothing but a rotor acts.
template <class Real>
auto is_rotor_alone(const Real& by)
{
    return (by > Real(ActsBy::nothing)) & (Real(ActsBy::limit) > by);
}

/// Where the Impulse of a type with a motor has a rotor, after the impulses of limit, motor and spring: what the substep has added
/// to its speed, and that speed.
struct RotorImpulse {
    static constexpr int change = 3, speed = 4;
};

template <class Real>
struct ActingRow {
    EqualityRow<Real> row;  ///< with the error of a limit that acts, or the speed of a motor or spring
    Real by;                ///< ActsBy
    Real taken_back;  ///< N s or N m s, to be added along the row: what has pulled or pushed too hard lets go
    Real effective_mass;  ///< K^-1 of the two bodies alone, as in SubstepRow
    /// N s or N m s, of what acts beside a rotor: beyond these it lets go at once, and the figure is solved again without it. The
    /// limit and the motor of a row count together.
    Real least, most;
    Real give = Real(0);  ///< of a spring: see SoftRow; else 0
    /// m/s or rad/s, of a spring whose substep has begun: by how much `speed` is too high for what is left of it, because the
    /// spring has pushed already, and because its law is that of C when the substep began.
    Real given = Real(0);
    Real rotor = Real(0);  ///< kg or kg m2: I_r, or 0
    /// How far the row gives way when the spring and the rotor hold it together.
    [[nodiscard]] Real give_of_all() const
    {
        const auto alone = is_rotor_alone(by);
        const Real beside_spring = give / (Real(1) + give * rotor);
        return select(alone, Real(1) / select(alone, rotor, Real(1)), beside_spring);
    }
};

/// How hard a limit may pull, N m s, until the figure is factored next. There it lets go and its pull T is taken back, but bodies
/// have moved on: its axis has turned by an angle of h w, with the substep h and the angular velocity w. What is missed changes
/// the lighter body's w by up to h T tr I^-1 of itself (see torque.h), here at most a quarter. A limit that pulls harder lets go
/// at once.
template <class Real, class A, class B>
Real bearable_pull(const StepConstants& step, const A& a, const B& b)
{
    const Real response = maximum(largest_response(a), largest_response(b));
    return Real(0.25F * step.inverse_substep) / maximum(response, Real(1e-20F));
}
/// In place of a bound that there is not.
inline constexpr float no_bound = 1e30F;

/// C of a limit that acts, without a correction faster than push_out_speed.
template <class Real>
Real error_of_limit(const StepConstants& step, const Real& c)
{
    return maximum(c, Real(step.exact_rate > 0 ? -step.push_out_speed / step.exact_rate : 0.0F));
}

}  // namespace motley
