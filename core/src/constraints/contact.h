// Contact: penetration as an inequality, friction in a circular cone, restitution.
//
//   C   = n . (p_b - p_a) >= 0,  lambda_n >= 0
//   J   = [-n, -(r_a x n), n, r_b x n];  friction: the same rows with the tangents, |lambda_t| <= mu lambda_n
//
// n: normal; p: surface points; r: arms to the contact point; mu: friction coefficient. The normal and the arms stay as
// they were when the step began, so J is constant and the separation follows from the displacement delta since then,
// C = C_0 + J delta: exact for discs and balls, with an error of second order in the rotation for other shapes. The
// surface of a may run along the tangents and bound lambda_n: see contact_surface.h.
//
// M turns with the bodies. K = J M^-1 J^T is that of the step's beginning until one of them has turned so far that a
// response may have changed by half (turned_inertia.h); then K is found anew before each sweep. A thin body that turns
// fast would otherwise get impulses that are many times too large for it, and gain energy.
#pragma once

#include <type_traits>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/bounded_impulse.h"
#include "maths/lever.h"
#include "maths/limit.h"
#include "maths/restitution.h"
#include "maths/turned_inertia.h"
#include "motley/core/constraints/contact_definition.h"

namespace motley {

/// A contact's numbers as quads, in the order of Contact's members after the key.
template <class Real>
struct ContactParameters {
    Vec3<Real> normal;
    Real separation;
    Vec3<Real> arm_a;
    Real friction;
    Vec3<Real> arm_b;
    Real restitution;
};

template <class Real>
struct ContactMemory {
    Real normal;
    Vec3<Real> friction;
};

/// What a contact does in addition to keeping bodies apart; each kind does what the one before does. Smooth contacts
/// have no friction rows, and only bouncing ones store the speed of the impact and what their surface does, as few
/// contacts have either.
enum class Touch { smooth, rough, bouncing };

template <Touch touch>
struct ContactKind : ConstraintTraits {
    static constexpr bool is_contact = true;
    static constexpr bool smooth = touch == Touch::smooth;
    static constexpr bool has_restitution = touch == Touch::bouncing;
    static constexpr const char* name = smooth            ? "smooth contact"
                                        : has_restitution ? "bouncing contact"
                                                          : "contact";
    template <class Real>
    using Parameters = ContactParameters<Real>;
    template <class Real>
    using Memory = ContactMemory<Real>;
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
    };

    template <class Real, BodyKind a, BodyKind b>
    struct SmoothRow {
        PairVector<Real, a, b> normal;
        Real separation;
        Real normal_effective_mass;
        [[no_unique_address]] Lever<Real, a, is_planar_pair(a, b)> lever_a;
        [[no_unique_address]] Lever<Real, b, is_planar_pair(a, b)> lever_b;
    };
    /// Without the two effective masses, which each sweep computes from arms and bodies: where rows come from memory
    /// this costs no more than loading them would, where they are in cache it adds a tenth to a sweep.
    template <class Real>
    struct PlanarSweep {
        Vec2<Real> normal, arm_a, arm_b;
        Real separation;
        Real friction;
    };
    template <class Real>
    struct SpatialSweep {
        Vec3<Real> normal, arm_a, arm_b;
        Real separation;
        Real normal_effective_mass;
        Vec3<Real>
            tangent;  ///< direction of the largest response; the second, normal x tangent, has the smallest
        Vec2<Real>
            tangent_effective_mass;  ///< along the two tangents, which are decoupled; the first is the smaller
        Real friction;
    };
    template <class Real, BodyKind a, BodyKind b>
    using RoughRow = std::conditional_t<is_planar_pair(a, b), PlanarSweep<Real>, SpatialSweep<Real>>;
    template <class Real, BodyKind a, BodyKind b>
    using Tangent = std::conditional_t<is_planar_pair(a, b), Real, Vec2<Real>>;
    template <class Real, BodyKind a, BodyKind b>
    struct BouncingSweep : RoughRow<Real, a, b> {
        Tangent<Real, a, b> surface_speed;  ///< of a's surface along the tangents, m/s
        Real most_force;                    ///< N, along the normal
    };
    template <class Real, BodyKind a, BodyKind b>
    struct BouncingRow {
        BouncingSweep<Real, a, b> in_sweep;
        Real restitution, approach, acceleration;  ///< see opening_speed
    };
    template <class Real, BodyKind a, BodyKind b>
    using Row = std::conditional_t<
        smooth, SmoothRow<Real, a, b>,
        std::conditional_t<has_restitution, BouncingRow<Real, a, b>, RoughRow<Real, a, b>>>;

    template <class Real>
    struct SmoothImpulse {
        Real normal;
    };
    template <class Tangent, class Real>
    struct RoughImpulse {
        Real normal;
        Tangent tangent;
    };
    template <class Tangent, class Real>
    struct BouncingImpulse {
        Real normal;
        Tangent tangent;
        Real peak;  ///< the largest normal impulse of the step, decides restitution
    };
    template <class Real, BodyKind a, BodyKind b>
    using Impulse =
        std::conditional_t<smooth, SmoothImpulse<Real>,
                           std::conditional_t<has_restitution, BouncingImpulse<Tangent<Real, a, b>, Real>,
                                              RoughImpulse<Tangent<Real, a, b>, Real>>>;

    /// A unit vector perpendicular to n: along n x e_x, or n x e_z where n is close to the x axis.
    template <class Real>
    static Vec3<Real> tangent_of(const Vec3<Real>& n)
    {
        const auto leans_from_x = absolute(n.x) < Real(0.57735F);
        const Vec3<Real> across{select(leans_from_x, Real(0), n.y), select(leans_from_x, n.z, -n.x),
                                select(leans_from_x, -n.y, Real(0))};
        const Real scale = Real(1) / square_root(dot(across, across));
        return scale * across;
    }
    template <class Real>
    static Vec2<Real> tangent_of(const Vec2<Real>& n)
    {
        return {-n.y, n.x};
    }

    /// What the host says of a contact, with bodies a and b exchanged where `order` is -1 and not 1.
    template <class Real>
    static void put_in_order(const Real& order, ContactParameters<Real>& contact)
    {
        const auto stays = order > Real(0);
        const Vec3<Real> arm_a = contact.arm_a;
        contact.normal = order * contact.normal;
        contact.arm_a = select(stays, arm_a, contact.arm_b);
        contact.arm_b = select(stays, contact.arm_b, arm_a);
    }
    /// Likewise what is kept from step to step: the normal impulse is the same.
    template <class Real>
    static void put_in_order(const Real& order, ContactMemory<Real>& memory)
    {
        memory.friction = order * memory.friction;
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const ContactParameters<Real>& contact,
                        const ContactMemory<Real>& memory, const A& a, const B& b,
                        Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        using Vector = PairVector<Real, A::kind, B::kind>;
        Row<Real, A::kind, B::kind> whole;
        auto& row = in_sweep(whole);
        row.normal = to_space<Vector>(contact.normal);
        row.separation = contact.separation;
        const Vector arm_a = to_space<Vector>(contact.arm_a), arm_b = to_space<Vector>(contact.arm_b);
        const auto k = point_response(a, arm_a, b, arm_b);
        if constexpr (requires { row.normal_effective_mass; })
            row.normal_effective_mass = effective_mass_along(row.normal, k);
        const Real warm(step.warm_start_scale);
        impulse.normal = warm * memory.normal;
        if constexpr (smooth) {
            row.lever_a = lever_of<decltype(row.lever_a)>(arm_a, row.normal);
            row.lever_b = lever_of<decltype(row.lever_b)>(arm_b, row.normal);
        } else {
            row.arm_a = arm_a;
            row.arm_b = arm_b;
            row.friction = contact.friction;
            if constexpr (has_restitution) {
                whole.restitution = contact.restitution;
                whole.approach = speed<Real>(row, a, b);
                whole.acceleration = dot(contact.normal, start.acceleration(a, b));
                impulse.peak = Real(0);
            }
            if constexpr (is_planar_pair(A::kind, B::kind)) {
                impulse.tangent = warm * dot(tangent_of(row.normal), to_space<Vector>(memory.friction));
            } else {
                const Vector s1 = tangent_of(row.normal), s2 = cross(row.normal, s1);
                const Principal<Real> most = principal(across(s1, s2, k));
                row.tangent = most.direction.x * s1 + most.direction.y * s2;
                row.tangent_effective_mass = {inverse_or_zero(most.largest), inverse_or_zero(most.smallest)};
                const Vector t2 = cross(row.normal, row.tangent);
                impulse.tangent = {warm * dot(row.tangent, memory.friction), warm * dot(t2, memory.friction)};
            }
            if constexpr (has_restitution) {
                const ContactSurface<Real> surface = start.surface();
                row.surface_speed = along_tangents<Real>(row, to_space<Vector>(surface.velocity));
                row.most_force = surface.most_force;
            }
        }
        return whole;
    }

    /// Finds K anew where the bodies have turned far. Tangents stay, because impulses are along them; K may couple them
    /// now, and so both have the effective mass of the largest response, with which no step is too long.
    template <class Real, class Row, class A, class B>
    static void renew_response(Row& whole, const A& a, const B& b)
    {
        auto& row = in_sweep(whole);
        const auto turned = maximum(change_at_most(a), change_at_most(b)) > Real(most_change);
        if constexpr (smooth) {
            const Real k =
                response_along(a, row.normal, row.lever_a) + response_along(b, row.normal, row.lever_b);
            row.normal_effective_mass = select(turned, inverse_or_zero(k), row.normal_effective_mass);
        } else {
            const Sym3<Real> k = point_response(a, row.arm_a, b, row.arm_b);
            const Vec3<Real> t2 = cross(row.normal, row.tangent);
            const Real largest = inverse_or_zero(principal(across(row.tangent, t2, k)).largest);
            Vec2<Real>& masses = row.tangent_effective_mass;
            row.normal_effective_mass =
                select(turned, effective_mass_along(row.normal, k), row.normal_effective_mass);
            masses = {select(turned, largest, masses.x), select(turned, largest, masses.y)};
        }
    }

    template <class Real, class Row, class Impulse>
    static auto total_impulse(const Row& row, const Impulse& impulse)
    {
        if constexpr (smooth) {
            return impulse.normal * row.normal;
        } else {
            return impulse.normal * row.normal + vector_of<Real>(row, impulse.tangent);
        }
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row& whole, const Substep&, const Impulse& impulse, A& a, B& b)
    {
        const auto& row = in_sweep(whole);
        if constexpr (smooth) {
            push<Real>(row, impulse.normal, a, b);
        } else {
            push_both<Real>(row, impulse.normal, impulse.tangent, a, b);
        }
    }

    /// One sweep over this contact: friction within the bound of the normal impulse so far, then the normal. Where that
    /// becomes less, what friction is more than the new bound is taken back, so that a contact that opens keeps none.
    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& row, const Substep&, Impulse& impulse, A& a, B& b)
    {
        if constexpr (!smooth) solve_friction<Real>(row, impulse, a, b);

        constexpr bool on_fixed = A::kind == BodyKind::fixed || B::kind == BodyKind::fixed;
        Real wanted = contact_impulse(step, on_fixed ? step.static_contact : step.contact,
                                      row.separation + moved<Real>(row, a, b), speed<Real>(row, a, b),
                                      normal_effective_mass<Real>(row, a, b), impulse.normal);
        if constexpr (has_restitution) wanted = minimum(wanted, Real(step.substep) * row.most_force);
        change_normal(row, wanted, impulse, a, b);
    }

    /// After the substeps: contacts that were hit fast enough leave with restitution times the speed of the impact.
    template <class Real, class Row, class Impulse, class A, class B>
    static void restitute(const StepConstants& step, const Row& whole, Impulse& impulse, A& a, B& b)
    {
        const auto& row = in_sweep(whole);
        const Real opening = opening_speed(whole.restitution, whole.approach, whole.acceleration,
                                           row.separation, row.separation + moved<Real>(row, a, b));
        const Real free =
            impulse.normal - normal_effective_mass<Real>(row, a, b) * (speed<Real>(row, a, b) - opening);
        const Real wanted = minimum(maximum(free, Real(0)), Real(step.substep) * row.most_force);
        const auto bounces = (whole.restitution > Real(0)) & (impulse.peak > Real(0)) &
                             (whole.approach < Real(-step.restitution_threshold));
        change_normal(row, select(bounces, wanted, impulse.normal), impulse, a, b);
    }

    /// A position solve: moves the bodies along J^T until `projection_rate` of the penetration is gone.
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants& step, const Row& whole, A& a, B& b)
    {
        const auto& row = in_sweep(whole);
        const Real deep = minimum(row.separation + moved<Real>(row, a, b) + Real(step.slop), Real(0));
        const Real error = maximum(deep, Real(-0.2F));  // m a sweep: a deep overlap must not explode
        Real lambda = -(normal_effective_mass<Real>(row, a, b) * Real(step.projection_rate) * error);
        if constexpr (has_restitution) lambda = minimum(lambda, most_projection(step, row.most_force));
        if constexpr (smooth) {
            displace_along(a, row.normal, row.lever_a, -lambda);
            displace_along(b, row.normal, row.lever_b, lambda);
        } else {
            const auto both = lambda * row.normal;
            apply_displacement(a, row.arm_a, -both);
            apply_displacement(b, row.arm_b, both);
        }
    }

    template <class Real, class Row, class Impulse, class End>
    static ContactMemory<Real> remember(const Row& row, const Impulse& impulse, const End&)
    {
        ContactMemory<Real> memory{impulse.normal, {Real(0), Real(0), Real(0)}};
        if constexpr (!smooth) {
            const auto& swept = in_sweep(row);
            memory.friction = to_three(total_impulse<Real>(swept, impulse) - impulse.normal * swept.normal);
        }
        return memory;
    }

  private:
    template <class Row>
    static auto& in_sweep(Row& row)
    {
        if constexpr (has_restitution) {
            return row.in_sweep;
        } else {
            return row;
        }
    }
    /// K = J M^-1 J^T of the contact point, for all directions.
    template <class Vector, class A, class B>
    static auto point_response(const A& a, const Vector& arm_a, const B& b, const Vector& arm_b)
    {
        return inverse_point_mass(a, arm_a) + inverse_point_mass(b, arm_b);
    }
    /// K along two directions.
    template <class Real>
    static Sym2<Real> across(const Vec3<Real>& x, const Vec3<Real>& y, const Sym3<Real>& k)
    {
        const Vec3<Real> kx = k * x;
        return {dot(x, kx), dot(y, kx), dot(y, k * y)};
    }
    /// 1 / (J M^-1 J^T) along a direction, from K of the point.
    template <class Vector, class Symmetric>
    static auto effective_mass_along(const Vector& direction, const Symmetric& k)
    {
        return inverse_or_zero(dot(direction, k * direction));
    }
    template <class Real, class Row, class A, class B>
    static Real normal_effective_mass(const Row& row, const A& a, const B& b)
    {
        if constexpr (requires { row.normal_effective_mass; }) {
            return row.normal_effective_mass;
        } else {
            return effective_mass_along(row.normal, point_response(a, row.arm_a, b, row.arm_b));
        }
    }
    // With J the row of the normal: J v, J times the displacement since the step began, and v += M^-1 J^T lambda.
    template <class Real, class Row, class A, class B>
    static Real speed(const Row& row, const A& a, const B& b)
    {
        if constexpr (smooth) {
            return speed_along(b, row.normal, row.lever_b) - speed_along(a, row.normal, row.lever_a);
        } else {
            return dot(row.normal, velocity_at(b, row.arm_b) - velocity_at(a, row.arm_a));
        }
    }
    template <class Real, class Row, class A, class B>
    static Real moved(const Row& row, const A& a, const B& b)
    {
        if constexpr (smooth) {
            return moved_along(b, row.normal, row.lever_b) - moved_along(a, row.normal, row.lever_a);
        } else {
            return dot(row.normal, displacement_at(b, row.arm_b) - displacement_at(a, row.arm_a));
        }
    }
    template <class Real, class Row, class A, class B>
    static void push(const Row& row, const Real& lambda, A& a, B& b)
    {
        if constexpr (smooth) {
            push_along(a, row.normal, row.lever_a, -lambda);
            push_along(b, row.normal, row.lever_b, lambda);
        } else {
            const auto both = lambda * row.normal;
            apply_impulse(a, row.arm_a, -both);
            apply_impulse(b, row.arm_b, both);
        }
    }

    /// Makes the normal impulse `wanted`, and shortens the friction to what that can hold.
    template <class Real, class Row, class Impulse, class A, class B>
    static void change_normal(const Row& row, const Real& wanted, Impulse& impulse, A& a, B& b)
    {
        const Real change = wanted - impulse.normal;
        impulse.normal = wanted;
        if constexpr (has_restitution) impulse.peak = maximum(impulse.peak, wanted);
        if constexpr (smooth) {
            push<Real>(row, change, a, b);
        } else {
            const auto held = impulse.tangent;
            impulse.tangent = within(held, row.friction * wanted);
            push_both<Real>(row, change, impulse.tangent - held, a, b);
        }
    }
    /// Along the normal and the tangents.
    template <class Real, class Row, class Tangent, class A, class B>
    static void push_both(const Row& row, const Real& normal, const Tangent& tangent, A& a, B& b)
    {
        const auto both = normal * row.normal + vector_of<Real>(row, tangent);
        apply_impulse(a, row.arm_a, -both);
        apply_impulse(b, row.arm_b, both);
    }
    /// The vector of components along the tangents.
    template <class Real, class Row, class Tangent>
    static auto vector_of(const Row& row, const Tangent& tangent)
    {
        if constexpr (requires { row.tangent; }) {
            return tangent.x * row.tangent + tangent.y * cross(row.normal, row.tangent);
        } else {
            return tangent * tangent_of(row.normal);
        }
    }
    /// Shortened to the bound where it is longer.
    template <class Real>
    static Real within(const Real& tangent, const Real& bound)
    {
        return maximum(minimum(tangent, bound), -bound);
    }
    template <class Real>
    static Vec2<Real> within(const Vec2<Real>& tangent, const Real& bound)
    {
        return scale_within(tangent, bound) * tangent;
    }

    /// The components of a vector along the tangents.
    template <class Real, class Row, class Vector>
    static auto along_tangents(const Row& row, const Vector& v)
    {
        if constexpr (requires { row.tangent; }) {
            return Vec2<Real>{dot(row.tangent, v), dot(cross(row.normal, row.tangent), v)};
        } else {
            return dot(tangent_of(row.normal), v);
        }
    }
    template <class Real, class Row, class Impulse, class A, class B>
    static void solve_friction(const Row& row, Impulse& impulse, A& a, B& b)
    {
        const auto slip = velocity_at(b, row.arm_b) - velocity_at(a, row.arm_a);
        const Real bound = row.friction * impulse.normal;
        if constexpr (requires { row.tangent; }) {
            const Vec3<Real> t2 = cross(row.normal, row.tangent);
            const Vec2<Real> old = impulse.tangent;
            Real slip1 = dot(row.tangent, slip), slip2 = dot(t2, slip);
            if constexpr (has_restitution) {
                slip1 = slip1 - row.surface_speed.x;
                slip2 = slip2 - row.surface_speed.y;
            }
            const Vec2<Real>& effective_mass = row.tangent_effective_mass;
            const Real first = old.x - effective_mass.x * slip1;
            impulse.tangent = bounded_impulse(Vec2<Real>{first, old.y - effective_mass.y * slip2},
                                              Vec2<Real>{first, old.y - effective_mass.x * slip2}, bound);
            const Vec2<Real> change = impulse.tangent - old;
            const Vec3<Real> push = change.x * row.tangent + change.y * t2;
            apply_impulse(a, row.arm_a, -push);
            apply_impulse(b, row.arm_b, push);
        } else {
            const Vec2<Real> t = tangent_of(row.normal);
            const Real effective_mass = effective_mass_along(t, point_response(a, row.arm_a, b, row.arm_b));
            Real along = dot(t, slip);
            if constexpr (has_restitution) along = along - row.surface_speed;
            const Real free = impulse.tangent - effective_mass * along;
            const Real held = within(free, bound);
            const Vec2<Real> push = (held - impulse.tangent) * t;
            impulse.tangent = held;
            apply_impulse(a, row.arm_a, -push);
            apply_impulse(b, row.arm_b, push);
        }
    }
};

using SmoothContact = ContactKind<Touch::smooth>;
using RoughContact = ContactKind<Touch::rough>;
using BouncingContact = ContactKind<Touch::bouncing>;

/// The constraint types of this header, in the order of Touch.
using ContactTypes = TypeList<SmoothContact, RoughContact, BouncingContact>;

}  // namespace motley
