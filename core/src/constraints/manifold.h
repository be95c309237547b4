// Manifold: a contact at up to four points, with friction of the whole.
//
//   points    C_i = n . (p_b - p_a) >= 0, lambda_i >= 0     [-n, -(r_a x n), n, r_b x n], both r to the point on b
//   friction  t . (v_b - v_a - u) at the mean of the points, norm lambda_t <= mu sum lambda_i
//   torsion   n . (w_b - w_a)                                [0, -n, 0, n], |lambda| <= mu r_t sum lambda_i
//   rolling   t . (w_b - w_a)                                [0, -t, 0, t], norm lambda <= r_r sum lambda_i
//
// n: normal; t: tangents; p, r: points and their arms; v, w: velocities; u: surface velocity; mu: friction; r_t, r_r:
// torsional and rolling radius.
//
// A sweep solves friction, torsion and rolling within the bounds that the impulses of the points set so far, then the
// points one by one. Points that a manifold lacks have an effective mass of zero, so that nothing branches. Normal and
// arms stay as they were when the step began, as in a Contact: C = C_0 + J delta, delta being the displacement since
// then. This is exact for balls and has an error of second order in the rotation for other shapes. (Arms that turn with
// a ball would move its contact point along with it, and brake it.)
#pragma once

#include <cmath>
#include <string>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/bounded_impulse.h"
#include "maths/limit.h"
#include "maths/restitution.h"
#include "motley/core/constraints/manifold_definition.h"
#include "motley/core/invalid_input.h"

namespace motley {

struct Manifold : ConstraintTraits {
    using Definition = ManifoldDefinition;
    static constexpr bool has_restitution = true;
    static constexpr bool needs_bodies_that_turn = true;
    static constexpr int most_points = 4;
    static constexpr int restitution_rounds = 8;

    template <class Real>
    struct Point {
        Vec3<Real> anchor_a, anchor_b;
    };
    template <class Real>
    struct Parameters {
        Vec3<Real> normal;
        Real point_count;
        Point<Real> point[most_points];
        Real friction, restitution, torsional_radius, rolling_radius;
        Vec3<Real> surface_velocity;
    };
    template <class Real>
    struct Memory {
        Real normal[most_points];  ///< N s
        Vec2<Real> friction;       ///< N s along the tangents
        Real torsion;              ///< N m s
        Vec2<Real> rolling;        ///< N m s about the tangents
    };
    template <class Real>
    struct Sweep {
        Vec3<Real> normal, tangent;  ///< world; the second tangent is normal x tangent
        Vec3<Real> lever_a[most_points], lever_b[most_points];
        Real effective_mass[most_points], separation[most_points];
        Vec3<Real> arm_a, arm_b;                                     ///< to the mean of the points
        Sym2<Real> friction_effective_mass, rolling_effective_mass;  ///< K^-1 along the tangents
        Vec2<Real> friction_stride, rolling_stride;  ///< 1 / k_max; 0 along a tangent that cannot move
        Real torsion_effective_mass;
        Real friction, torsional_bound, rolling_radius;  ///< torsional_bound: friction times radius
        Vec2<Real> surface_speed;                        ///< along the tangents
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        Sweep<Real> in_sweep;
        Real restitution, acceleration, approach[most_points];  ///< see opening_speed
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real normal[most_points];
        Real peak[most_points];  ///< the largest normal impulse of the step, decides restitution
        Vec2<Real> friction, rolling;
        Real torsion;
    };

    static void validate(const Definition& contact, const JointBodies& bodies)
    {
        check_turns("body_a", bodies.model_a, bodies.fixed_a);
        check_turns("body_b", bodies.model_b, bodies.fixed_b);
        check_direction("normal", contact.normal);
        check_range("point_count", static_cast<float>(contact.point_count), 1, most_points, "1 to 4");
        for (int i = 0; i < contact.point_count; ++i) {
            constexpr const char* names[] = {"points[0]", "points[1]", "points[2]", "points[3]"};
            check_anchor({names[i], ".local_anchor_a"}, contact.points[i].local_anchor_a, bodies.model_a,
                         bodies.fixed_a);
            check_anchor({names[i], ".local_anchor_b"}, contact.points[i].local_anchor_b, bodies.model_b,
                         bodies.fixed_b);
        }
        check_range("friction", contact.friction, 0, 1e9F, "a finite value from 0 to 1e9");
        check_range("restitution", contact.restitution, 0, 1, "0 to 1");
        check_range("torsional_radius", contact.torsional_radius, 0, largest_length, "0 to 1e9 (m)");
        check_range("rolling_radius", contact.rolling_radius, 0, largest_length, "0 to 1e9 (m)");
        const Vec3<float>& u = contact.surface_velocity;
        check_range("surface_velocity.x", u.x, -1e9F, 1e9F, "a finite value from -1e9 to 1e9 (m/s)");
        check_range("surface_velocity.y", u.y, -1e9F, 1e9F, "a finite value from -1e9 to 1e9 (m/s)");
        check_range("surface_velocity.z", u.z, -1e9F, 1e9F, "a finite value from -1e9 to 1e9 (m/s)");
    }
    static Parameters<float> parameters(const Definition& contact)
    {
        Parameters<float> p{};
        p.normal = unit(contact.normal);
        p.point_count = static_cast<float>(contact.point_count);
        // Points beyond point_count are copies of the first one, so that their numbers are valid.
        for (int i = 0; i < most_points; ++i) {
            const ManifoldPoint& point = contact.points[i < contact.point_count ? i : 0];
            p.point[i] = {point.local_anchor_a, point.local_anchor_b};
        }
        p.friction = contact.friction;
        p.restitution = contact.restitution;
        p.torsional_radius = contact.torsional_radius;
        p.rolling_radius = contact.rolling_radius;
        p.surface_velocity = contact.surface_velocity;
        return p;
    }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& contact, const Memory<Real>& memory,
                        const A& a, const B& b, Impulse<Real, A::kind, B::kind>& impulse)
    {
        const StepConstants& step = start.step();
        const JointPose<Real, A::kind, B::kind> pose = start.pose();
        Row<Real, A::kind, B::kind> whole;
        Sweep<Real>& row = whole.in_sweep;
        const Vec3<Real> tangent = across(contact.normal);
        const Vec3<Real> n = row.normal = to_world(pose.orientation_a, contact.normal);
        const Vec3<Real> t = row.tangent = to_world(pose.orientation_a, tangent), t2 = cross(n, t);
        const Vec3<Real>& u = contact.surface_velocity;
        row.friction = contact.friction;
        row.torsional_bound = contact.friction * contact.torsional_radius;
        row.rolling_radius = contact.rolling_radius;
        whole.restitution = contact.restitution;
        whole.acceleration = dot(n, start.acceleration(a, b));
        row.surface_speed = {dot(tangent, u), dot(cross(contact.normal, tangent), u)};

        const Real warm(step.warm_start_scale);
        const Real linear_floor = Real(rounding_share) * (linear_size(a) + linear_size(b));
        const Real angular_floor = Real(rounding_share) * (angular_size(a) + angular_size(b));
        const Real along = dot(n, over_mass(a, n) + over_mass(b, n));
        Vec3<Real> mean{Real(0), Real(0), Real(0)};
        for (int i = 0; i < most_points; ++i) {
            const Vec3<Real> arm_b = to_world(pose.orientation_b, contact.point[i].anchor_b);
            const Vec3<Real> arm_a =
                pose.between + arm_b;  // to the same point, so that both impulses have no moment together
            row.separation[i] = dot(n, arm_a - to_world(pose.orientation_a, contact.point[i].anchor_a));
            row.lever_a[i] = cross(arm_a, n);
            row.lever_b[i] = cross(arm_b, n);
            const Real k = along + dot(row.lever_a[i], over_inertia(a, row.lever_a[i])) +
                           dot(row.lever_b[i], over_inertia(b, row.lever_b[i]));
            const auto is_there = contact.point_count > Real(static_cast<float>(i) + 0.5F);
            row.effective_mass[i] = select(is_there & (k > linear_floor), inverse_or_zero(k), Real(0));
            whole.approach[i] = speed_at<Real>(row, i, a, b);
            impulse.normal[i] = select(is_there, warm * memory.normal[i], Real(0));
            impulse.peak[i] = Real(0);
            mean = mean + select(is_there, Real(1), Real(0)) * arm_b;
        }
        row.arm_b = Real(1) / contact.point_count * mean;
        row.arm_a = pose.between + row.arm_b;
        const auto across_response = [&](const Vec3<Real>& x, const Vec3<Real>& y) {
            return dot(x, over_mass(a, y) + over_mass(b, y)) +
                   dot(cross(row.arm_a, x), over_inertia(a, cross(row.arm_a, y))) +
                   dot(cross(row.arm_b, x), over_inertia(b, cross(row.arm_b, y)));
        };
        const Sym2<Real> across_k{across_response(t, t), across_response(t, t2), across_response(t2, t2)};
        row.friction_effective_mass = inverse_of_what_moves(across_k, linear_floor);
        row.friction_stride = stride_of_what_moves(across_k, linear_floor);
        const auto turning = [&](const Vec3<Real>& x, const Vec3<Real>& y) {
            return dot(x, over_inertia(a, y) + over_inertia(b, y));
        };
        const Sym2<Real> turning_k{turning(t, t), turning(t, t2), turning(t2, t2)};
        row.rolling_effective_mass = inverse_of_what_moves(turning_k, angular_floor);
        row.rolling_stride = stride_of_what_moves(turning_k, angular_floor);
        const Real k = turning(n, n);
        row.torsion_effective_mass = select(k > angular_floor, inverse_or_zero(k), Real(0));
        impulse.friction = warm * memory.friction;
        impulse.torsion = warm * memory.torsion;
        impulse.rolling = warm * memory.rolling;
        return whole;
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row& whole, const Substep&, const Impulse& impulse, A& a, B& b)
    {
        const auto& row = whole.in_sweep;
        push_friction(row, impulse.friction, a, b);
        push_turn(row, impulse.torsion, impulse.rolling, a, b);
        for (int i = 0; i < most_points; ++i) push_point(row, i, impulse.normal[i], a, b);
    }

    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row& row, const Substep&, Impulse& impulse, A& a, B& b)
    {
        solve_friction<Real>(row, impulse, a, b);
        const bool on_fixed = is_fixed(a) || is_fixed(b);
        const Softness& soft = on_fixed ? step.static_contact : step.contact;
        for (int i = 0; i < most_points; ++i) {
            const Real wanted =
                contact_impulse(step, soft, separation_at<Real>(row, i, a, b), speed_at<Real>(row, i, a, b),
                                row.effective_mass[i], impulse.normal[i]);
            push_point(row, i, wanted - impulse.normal[i], a, b);
            impulse.normal[i] = wanted;
            impulse.peak[i] = maximum(impulse.peak[i], wanted);
        }
        shorten_friction<Real>(row, impulse, a, b);
    }

    /// After the substeps: points that were hit fast enough leave with restitution times the speed of the impact. A
    /// face that lands flat hits with all its points at once, which takes a few rounds over the points.
    template <class Real, class Row, class Impulse, class A, class B>
    static void restitute(const StepConstants& step, const Row& whole, Impulse& impulse, A& a, B& b)
    {
        const auto& row = whole.in_sweep;
        Real opening[most_points];
        for (int i = 0; i < most_points; ++i) {
            opening[i] = opening_speed(whole.restitution, whole.approach[i], whole.acceleration,
                                       row.separation[i], separation_at<Real>(row, i, a, b));
        }
        for (int i = 0; i < restitution_rounds * most_points; ++i) {
            const int point = i % most_points;
            const Real leaving = speed_at<Real>(row, point, a, b) - opening[point];
            const auto bounces = (whole.restitution > Real(0)) &
                                 (whole.approach[point] < Real(-step.restitution_threshold)) &
                                 (impulse.peak[point] > Real(0));
            const Real& held = impulse.normal[point];
            const Real wanted =
                select(bounces, maximum(held - row.effective_mass[point] * leaving, Real(0)), held);
            push_point(row, point, wanted - held, a, b);
            impulse.normal[point] = wanted;
        }
        shorten_friction<Real>(row, impulse, a, b);
    }

    /// Moves the bodies until `projection_rate` of every point's penetration is gone: the points one by one, each
    /// taking the displacements by those before it into account.
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants& step, const Row& whole, A& a, B& b)
    {
        const auto& row = whole.in_sweep;
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        Vec3<Real> linear = none, angular_a = none, angular_b = none;
        for (int i = 0; i < most_points; ++i) {
            const Real separation = separation_at<Real>(row, i, a, b);
            const Real deep = maximum(minimum(separation + Real(step.slop), Real(0)), Real(-0.2F));
            const Real so_far = dot(row.normal, over_mass(a, linear) + over_mass(b, linear)) +
                                dot(row.lever_a[i], over_inertia(a, angular_a)) +
                                dot(row.lever_b[i], over_inertia(b, angular_b));
            const Real lambda =
                maximum(-(row.effective_mass[i] * (Real(step.projection_rate) * deep + so_far)), Real(0));
            linear = linear + lambda * row.normal;
            angular_a = angular_a + lambda * row.lever_a[i];
            angular_b = angular_b + lambda * row.lever_b[i];
        }
        displace(a, -linear, -angular_a);
        displace(b, linear, angular_b);
    }

    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        Memory<Real> memory;
        for (int i = 0; i < most_points; ++i) memory.normal[i] = impulse.normal[i];
        memory.friction = impulse.friction;
        memory.torsion = impulse.torsion;
        memory.rolling = impulse.rolling;
        return memory;
    }

    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row& whole, const Substep&, const Impulse& impulse)
    {
        const auto& row = whole.in_sweep;
        Real normal(0);
        for (int i = 0; i < most_points; ++i) normal = normal + impulse.normal[i];
        const Vec3<Real> tangent2 = cross(row.normal, row.tangent);
        const auto along = [&](const Real& n, const Vec2<Real>& t) {
            return n * row.normal + t.x * row.tangent + t.y * tangent2;
        };
        return {along(normal, impulse.friction), along(impulse.torsion, impulse.rolling)};
    }

    /// Errors: the penetration of the deepest point, from the present poses, in double.
    static JointReport report(const Definition& contact, const Memory<float>& memory, const BodyState& a,
                              const BodyState& b)
    {
        const Vec3<double> n = rotate(a.orientation, convert<double>(unit(contact.normal)));
        double push = 0, deepest = 0;
        for (int i = 0; i < contact.point_count; ++i) {
            push += static_cast<double>(memory.normal[i]);
            const ManifoldPoint& point = contact.points[i];
            deepest = std::fmax(deepest,
                                -dot(n, anchor_separation(a, b, point.local_anchor_a, point.local_anchor_b)));
        }
        JointReport report;
        report.error = static_cast<float>(deepest);
        report.state = push > 0 ? JointState::active : JointState::inactive;
        return report;
    }

  private:
    /// A unit vector perpendicular to the unit vector n: along n x e_x, or n x e_z where n is close to the x axis.
    template <class Real>
    static Vec3<Real> across(const Vec3<Real>& n)
    {
        const auto leans_from_x = absolute(n.x) < Real(0.57735F);
        const Vec3<Real> v{select(leans_from_x, Real(0), n.y), select(leans_from_x, n.z, -n.x),
                           select(leans_from_x, -n.y, Real(0))};
        return Real(1) / square_root(dot(v, v)) * v;
    }
    /// The inverse of a block of two rows. Between planar bodies one of them may be unable to move; then only the other
    /// is inverted.
    template <class Real>
    static Sym2<Real> inverse_of_what_moves(const Sym2<Real>& k, const Real& floor)
    {
        const auto x_moves = k.xx > floor, y_moves = k.yy > floor;
        const Sym2<Real> both = inverse(k);
        const Real zero(0);
        return {select(x_moves, select(y_moves, both.xx, inverse_or_zero(k.xx)), zero),
                select(x_moves, select(y_moves, both.xy, zero), zero),
                select(y_moves, select(x_moves, both.yy, inverse_or_zero(k.yy)), zero)};
    }
    template <class Real>
    static Vec2<Real> stride_of_what_moves(const Sym2<Real>& k, const Real& floor)
    {
        const Real stride = inverse_or_zero(largest_response(k));
        return {select(k.xx > floor, stride, Real(0)), select(k.yy > floor, stride, Real(0))};
    }

    template <class Real, class Row, class A, class B>
    static Real separation_at(const Row& row, int i, const A& a, const B& b)
    {
        return row.separation[i] + dot(row.normal, to_three(b.delta) - to_three(a.delta)) +
               dot(row.lever_b[i], small_turn_of(b)) - dot(row.lever_a[i], small_turn_of(a));
    }
    template <class Real, class Row, class A, class B>
    static Real speed_at(const Row& row, int i, const A& a, const B& b)
    {
        return dot(row.normal, linear_of(b) - linear_of(a)) + dot(row.lever_b[i], angular_of(b)) -
               dot(row.lever_a[i], angular_of(a));
    }
    template <class Real, class Row, class A, class B>
    static void push_point(const Row& row, int i, const Real& lambda, A& a, B& b)
    {
        apply_wrench(a, -(lambda * row.normal), -(lambda * row.lever_a[i]));
        apply_wrench(b, lambda * row.normal, lambda * row.lever_b[i]);
    }
    template <class Real, class Row, class A, class B>
    static void push_friction(const Row& row, const Vec2<Real>& lambda, A& a, B& b)
    {
        const Vec3<Real> push = lambda.x * row.tangent + lambda.y * cross(row.normal, row.tangent);
        apply_wrench(a, -push, -cross(row.arm_a, push));
        apply_wrench(b, push, cross(row.arm_b, push));
    }
    template <class Real, class Row, class A, class B>
    static void push_turn(const Row& row, const Real& torsion, const Vec2<Real>& rolling, A& a, B& b)
    {
        const Vec3<Real> turn =
            torsion * row.normal + rolling.x * row.tangent + rolling.y * cross(row.normal, row.tangent);
        apply_turn(a, -turn);
        apply_turn(b, turn);
    }
    template <class Real>
    static Vec2<Real> brake(const Vec2<Real>& held, const Vec2<Real>& speed, const Sym2<Real>& effective_mass,
                            const Vec2<Real>& stride, const Real& bound)
    {
        return bounded_impulse(held - effective_mass * speed,
                               held - Vec2<Real>{stride.x * speed.x, stride.y * speed.y}, bound);
    }

    template <class Real, class Row, class Impulse, class A, class B>
    static void solve_friction(const Row& row, Impulse& impulse, A& a, B& b)
    {
        const Real push = push_of<Real>(impulse);
        const Vec3<Real>&n = row.normal, &t = row.tangent, t2 = cross(n, t);
        const Vec3<Real> slip = (linear_of(b) + cross(angular_of(b), row.arm_b)) -
                                (linear_of(a) + cross(angular_of(a), row.arm_a));
        const Vec2<Real> friction =
            brake(impulse.friction,
                  Vec2<Real>{dot(t, slip) - row.surface_speed.x, dot(t2, slip) - row.surface_speed.y},
                  row.friction_effective_mass, row.friction_stride, row.friction * push);
        push_friction(row, friction - impulse.friction, a, b);
        impulse.friction = friction;

        const Vec3<Real> spin = angular_of(b) - angular_of(a);
        const Real torsional_bound = row.torsional_bound * push;
        const Real free = impulse.torsion - row.torsion_effective_mass * dot(n, spin);
        const Real torsion = maximum(minimum(free, torsional_bound), -torsional_bound);
        push_turn(row, torsion - impulse.torsion, Vec2<Real>{Real(0), Real(0)}, a, b);
        impulse.torsion = torsion;

        const Vec3<Real> roll = angular_of(b) - angular_of(a);
        const Vec2<Real> rolling =
            brake(impulse.rolling, Vec2<Real>{dot(t, roll), dot(t2, roll)}, row.rolling_effective_mass,
                  row.rolling_stride, row.rolling_radius * push);
        push_turn(row, Real(0), rolling - impulse.rolling, a, b);
        impulse.rolling = rolling;
    }

    /// Takes back what friction, torsion and rolling are more than the points, pressing less now, can hold.
    template <class Real, class Row, class Impulse, class A, class B>
    static void shorten_friction(const Row& row, Impulse& impulse, A& a, B& b)
    {
        const Real push = push_of<Real>(impulse), torsional_bound = row.torsional_bound * push;
        const Vec2<Real> friction = scale_within(impulse.friction, row.friction * push) * impulse.friction,
                         rolling = scale_within(impulse.rolling, row.rolling_radius * push) * impulse.rolling;
        const Real torsion = maximum(minimum(impulse.torsion, torsional_bound), -torsional_bound);
        push_friction(row, friction - impulse.friction, a, b);
        push_turn(row, torsion - impulse.torsion, rolling - impulse.rolling, a, b);
        impulse.friction = friction;
        impulse.torsion = torsion;
        impulse.rolling = rolling;
    }

    /// The normal impulses of all points.
    template <class Real, class Impulse>
    static Real push_of(const Impulse& impulse)
    {
        return (impulse.normal[0] + impulse.normal[1]) + (impulse.normal[2] + impulse.normal[3]);
    }
};

/// The constraint types of this header.
using ManifoldTypes = TypeList<Manifold>;

}  // namespace motley
