// Contact of a disc with a disc or with a wall, which the library found itself. The laws are those of
// constraints/contact.h:
//
//   C   = |x_b - x_a| - r_a - r_b >= 0 of two discs,  n . (x_b - q) - r_b >= 0 of a disc and the point q of a wall
//   J   = [-n, 0, n, 0], 0 <= lambda <= h f_max
//   friction along t = n turned by +90 degrees: |lambda_t| <= mu lambda
//
// x: centres; r: radii; n: normal; mu: friction coefficient; h: substep; f_max: of a wall, else infinite. The normal
// stays as it was when the step began, and C follows from the displacement since then. C is measured once a substep, by
// `relax`, because bodies have just moved there; `solve` then reads no displacements, which is half of what it would read
// of each body. A disc's normal passes through its centre, so that only friction turns it, at an arm whose direction is
// known: a row is a third of a contact's from a host's list.
#pragma once

#include <type_traits>

#include "contract/constraint_type.h"
#include "maths/limit.h"

namespace motley {

/// Pairs of two planar bodies, and walls (a: the wall's body, fixed) with a planar body.
template <bool is_rough>
struct DiscContactKind : ConstraintTraits {
    static constexpr bool is_contact = true;
    static constexpr bool rough = is_rough;

    template <class Real>
    struct Parameters {
    };
    template <class Real>
    struct Memory {
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
    };

    template <class Real>
    struct SmoothPair {
        Vec2<Real> normal;
        Real separation, effective_mass;
    };
    template <class Real>
    struct RoughPair {
        Vec2<Real> normal;
        Real separation, effective_mass;
        Real arm_a, arm_b;  ///< from the centres to the contact point, along n and against it
        Real friction;
    };
    template <class Real>
    struct SmoothWall {
        Vec2<Real> normal;
        Real separation, effective_mass;
        Vec2<Real> arm_a;  ///< from the wall's body to the contact point
        Real most_force;   ///< N, along the normal
    };
    template <class Real>
    struct RoughWall {
        Vec2<Real> normal;
        Real separation, effective_mass;
        Vec2<Real> arm_a;
        Real most_force;
        Real arm_b;
        Real friction;
        Real surface_speed;  ///< of the wall's surface along t, m/s
    };
    template <class Real, BodyKind a>
    using Sweep =
        std::conditional_t<a == BodyKind::fixed, std::conditional_t<rough, RoughWall<Real>, SmoothWall<Real>>,
                           std::conditional_t<rough, RoughPair<Real>, SmoothPair<Real>>>;
    template <class Real, BodyKind a>
    struct SmoothRow {
        Sweep<Real, a> in_sweep;  ///< its separation is that of now
        Real start_separation;    ///< C when the step began
        Real reach;               ///< r_a + r_b
    };
    template <class Real, BodyKind a>
    struct RoughRow {
        Sweep<Real, a> in_sweep;
        Real start_separation;
        Real radius_a, radius_b;  ///< r_a of a wall: 0
    };
    /// Effective mass, friction and radii are set when the contact is found, the rest when a step begins.
    template <class Real, BodyKind a, BodyKind b>
    using Row = std::conditional_t<rough, RoughRow<Real, a>, SmoothRow<Real, a>>;

    template <class Real>
    struct SmoothImpulse {
        Real normal;
    };
    template <class Real>
    struct RoughImpulse {
        Real normal, tangent;
    };
    template <class Real, BodyKind a, BodyKind b>
    using Impulse = std::conditional_t<rough, RoughImpulse<Real>, SmoothImpulse<Real>>;

    /// When a step begins: the row of two discs from `between` = x_b - x_a. Discs at one point are parted along x.
    template <class Real>
    static void place_pair(const Vec2<Real>& between, Row<Real, BodyKind::planar, BodyKind::planar>& row)
    {
        const Real distance = square_root(dot(between, between));
        const auto apart = distance > Real(1e-9F);
        const Real scale = Real(1) / select(apart, distance, Real(1));
        auto& sweep = row.in_sweep;
        sweep.normal = {select(apart, scale * between.x, Real(1)), select(apart, scale * between.y, Real(0))};
        if constexpr (rough) {
            sweep.separation = distance - (row.radius_a + row.radius_b);
            // Both arms lead to the middle of the gap or overlap, so that angular momentum is kept.
            sweep.arm_a = row.radius_a + Real(0.5F) * sweep.separation;
            sweep.arm_b = row.radius_b + Real(0.5F) * sweep.separation;
        } else {
            sweep.separation = distance - row.reach;
        }
        row.start_separation = sweep.separation;
    }

    /// C from where the bodies are now.
    template <class Real, class Row, class A, class B>
    static void measure(Row& row, const A& a, const B& b)
    {
        row.in_sweep.separation = row.start_separation + moved<Real>(row.in_sweep, a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row& row, const Substep&, const Impulse& impulse, A& a, B& b)
    {
        push_normal<Real>(row.in_sweep, impulse.normal, a, b);
        if constexpr (rough) push_tangent<Real>(row.in_sweep, impulse.tangent, a, b);
    }

    /// One sweep: friction within the bound of the normal impulse so far, then the normal. Where that becomes less,
    /// friction is shortened with it, so that a contact that opens keeps none.
    template <class Real, class Sweep, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Sweep& row, const Substep&, Impulse& impulse, A& a,
                      B& b)
    {
        if constexpr (rough) {
            const Real free =
                impulse.tangent - tangent_effective_mass<Real>(row, a, b) * slip<Real>(row, a, b);
            set_tangent<Real>(row, free, impulse, a, b);
        }
        const Softness& soft = A::kind == BodyKind::fixed ? step.static_contact : step.contact;
        Real wanted =
            contact_impulse(step, soft, row.separation, dot(row.normal, relative_velocity<Real>(row, a, b)),
                            row.effective_mass, impulse.normal);
        if constexpr (A::kind == BodyKind::fixed)
            wanted = minimum(wanted, Real(step.substep) * row.most_force);
        push_normal<Real>(row, wanted - impulse.normal, a, b);
        impulse.normal = wanted;
        if constexpr (rough) set_tangent<Real>(row, impulse.tangent, impulse, a, b);
    }

    /// A position solve, as in contact.h.
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants& step, const Row& whole, A& a, B& b)
    {
        const auto& row = whole.in_sweep;
        const Real deep = minimum(whole.start_separation + moved<Real>(row, a, b) + Real(step.slop), Real(0));
        const Real error = maximum(deep, Real(-0.2F));  // m a sweep: a deep overlap must not explode
        Real lambda = -(row.effective_mass * Real(step.projection_rate) * error);
        if constexpr (A::kind == BodyKind::fixed)
            lambda = minimum(lambda, most_projection(step, row.most_force));
        const Vec2<Real> push = lambda * row.normal;
        if constexpr (A::kind == BodyKind::planar) a.delta = a.delta - a.inverse_mass * push;
        b.delta = b.delta + b.inverse_mass * push;
    }

  private:
    template <class Real, class Sweep, class A, class B>
    static Vec2<Real> relative_velocity(const Sweep& row, const A& a, const B& b)
    {
        if constexpr (A::kind == BodyKind::fixed) {
            return b.linear - velocity_at(a, row.arm_a);
        } else {
            return b.linear - a.linear;
        }
    }
    /// n . of the relative displacement since the step began.
    template <class Real, class Sweep, class A, class B>
    static Real moved(const Sweep& row, const A& a, const B& b)
    {
        if constexpr (A::kind == BodyKind::fixed) {
            return dot(row.normal, b.delta - displacement_at(a, row.arm_a));
        } else {
            return dot(row.normal, b.delta - a.delta);
        }
    }
    template <class Real, class Sweep, class A, class B>
    static void push_normal(const Sweep& row, const Real& lambda, A& a, B& b)
    {
        if constexpr (A::kind == BodyKind::planar)
            a.linear = a.linear - (a.inverse_mass * lambda) * row.normal;
        b.linear = b.linear + (b.inverse_mass * lambda) * row.normal;
    }

    template <class Real>
    static Vec2<Real> tangent_of(const Vec2<Real>& n)
    {
        return {-n.y, n.x};
    }
    template <class Real, class Sweep, class A, class B>
    static Real slip(const Sweep& row, const A& a, const B& b)
    {
        const Real of_centres = dot(tangent_of(row.normal), relative_velocity<Real>(row, a, b));
        if constexpr (A::kind == BodyKind::fixed) {
            return of_centres - row.arm_b * b.yaw_rate - row.surface_speed;
        } else {
            return of_centres - (row.arm_a * a.yaw_rate + row.arm_b * b.yaw_rate);
        }
    }
    template <class Real, class Sweep, class A, class B>
    static Real tangent_effective_mass(const Sweep& row, const A& a, const B& b)
    {
        Real k = b.inverse_mass + b.inverse_inertia * row.arm_b * row.arm_b;
        if constexpr (A::kind == BodyKind::planar)
            k = k + (a.inverse_mass + a.inverse_inertia * row.arm_a * row.arm_a);
        return inverse_or_zero(k);
    }
    /// Friction becomes `wanted`, within its bound.
    template <class Real, class Sweep, class Impulse, class A, class B>
    static void set_tangent(const Sweep& row, const Real& wanted, Impulse& impulse, A& a, B& b)
    {
        const Real bound = row.friction * impulse.normal;
        const Real held = maximum(minimum(wanted, bound), -bound);
        push_tangent<Real>(row, held - impulse.tangent, a, b);
        impulse.tangent = held;
    }
    template <class Real, class Sweep, class A, class B>
    static void push_tangent(const Sweep& row, const Real& lambda, A& a, B& b)
    {
        const Vec2<Real> t = tangent_of(row.normal);
        if constexpr (A::kind == BodyKind::planar) {
            a.linear = a.linear - (a.inverse_mass * lambda) * t;
            a.yaw_rate = a.yaw_rate - (a.inverse_inertia * lambda) * row.arm_a;
        }
        b.linear = b.linear + (b.inverse_mass * lambda) * t;
        b.yaw_rate = b.yaw_rate - (b.inverse_inertia * lambda) * row.arm_b;
    }
};

using SmoothDiscContact = DiscContactKind<false>;
using RoughDiscContact = DiscContactKind<true>;

}  // namespace motley
