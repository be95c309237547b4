// The coordinate C of a drive, and its row J, from two frames:
//
//   slide   C = x_a . d, d = p_b - p_a        row [-x_a, -(r_a + d) x x_a, x_a, r_b x x_a]
//   twist   C = 2 atan2(v . x, w), q = q_a* q_b, w >= 0    row [0, -t, 0, t], t = (x_a + x_b) / (1 + x_a . x_b)
//   euler   n = z_b x x_a:   x: C = atan2(-y_a . z_b, z_a . z_b),  t = n x z_b / n^2
//                            y: C = atan2(x_a . z_b, |n|),         t = n / |n|
//                            z: C = atan2(-x_a . y_b, x_a . x_b),  t = x_a x n / n^2
//
// Symbols: p, r: anchors and their arms; x, y, z: axes of the frames of a and b; q = (v, w): rotation of frame b in
// frame a from those of the frames, q_a and q_b; t: axis of the angular row.
#pragma once

#include <cmath>

#include "contract/constraint_type.h"
#include "maths/wrench.h"
#include "motley/core/constraints/drive_definition.h"
#include "stores/if_needed.h"

namespace motley {

template <DriveAxis drive_axis>
struct DriveCoordinate {
    static constexpr bool slides = drive_axis == DriveAxis::slide;
    static constexpr bool is_euler = drive_axis == DriveAxis::euler;

    /// Only slides have positions of frames, arms and levers. Rotations act about their axis wherever that is.
    template <class Real>
    struct Anchors {
        Vec3<Real> position_a, position_b;
    };
    template <class Real>
    struct Arms {
        Vec3<Real> a, b, separation;
    };
    template <class Real>
    struct Levers {
        Vec3<Real> a, b;
    };
    /// Which Euler angle the drive acts on: 1 for it, 0 for the others.
    template <class Real>
    struct Which {
        Real x, y, z;
    };

    /// The frames on the bodies.
    template <class Real>
    struct Frames {
        Quat<Real> rotation_a, rotation_b;
        [[no_unique_address]] IfNeeded<slides, Anchors<Real>> anchors;
        [[no_unique_address]] IfNeeded<is_euler, Which<Real>, 1> which;
    };
    /// The frames when the step began, in the world.
    template <class Real>
    struct Start {
        [[no_unique_address]] IfNeeded<slides, Arms<Real>> arms;
        Quat<Real> frame_a, frame_b;
        [[no_unique_address]] IfNeeded<is_euler, Which<Real>, 1> which;
    };
    /// C and J where the bodies are now.
    template <class Real>
    struct Here {
        Vec3<Real> axis;  ///< x_a or t
        [[no_unique_address]] IfNeeded<slides, Levers<Real>> levers;
        Real value;  ///< C
    };

    static Frames<float> frames_of(const DriveDefinition<drive_axis>& drive)
    {
        Frames<float> frames{unit(drive.frame_a.rotation), unit(drive.frame_b.rotation), {}, {}};
        if constexpr (slides) frames.anchors = {drive.frame_a.position, drive.frame_b.position};
        if constexpr (is_euler) {
            const auto share = [&](EulerAngle angle) { return drive.angle == angle ? 1.0F : 0.0F; };
            frames.which = {share(EulerAngle::x), share(EulerAngle::y), share(EulerAngle::z)};
        }
        return frames;
    }

    template <class Real, BodyKind a, BodyKind b>
    static Start<Real> start_of(const Frames<Real>& frames, const JointPose<Real, a, b>& pose)
    {
        Start<Real> start;
        if constexpr (slides) {
            start.arms.a = to_world(pose.orientation_a, frames.anchors.position_a);
            start.arms.b = to_world(pose.orientation_b, frames.anchors.position_b);
            start.arms.separation = pose.between + start.arms.b - start.arms.a;
        }
        start.frame_a = to_world(pose.orientation_a, frames.rotation_a);
        start.frame_b = to_world(pose.orientation_b, frames.rotation_b);
        if constexpr (is_euler) start.which = frames.which;
        return start;
    }

    template <class Real, class A, class B>
    static void locate(const Start<Real>& start, Here<Real>& here, const A& a, const B& b)
    {
        const Quat<Real> frame_a = turn_of(a) * start.frame_a;
        if constexpr (slides) {
            const Vec3<Real> arm_a = rotate(turn_of(a), start.arms.a),
                             arm_b = rotate(turn_of(b), start.arms.b);
            const Vec3<Real> d =
                anchor_error(start.arms.separation, start.arms.a, start.arms.b, arm_a, arm_b, a, b);
            here.axis = axis_x(frame_a);
            here.levers.a = cross(arm_a + d, here.axis);
            here.levers.b = cross(arm_b, here.axis);
            here.value = dot(here.axis, d);
        } else if constexpr (is_euler) {
            locate_euler(start.which, frame_a, turn_of(b) * start.frame_b, here);
        } else {
            const Quat<Real> frame_b = turn_of(b) * start.frame_b;
            const Quat<Real> q = relative_rotation(frame_a, frame_b);
            const Vec3<Real> x_a = axis_x(frame_a), x_b = axis_x(frame_b);
            // In a hinge the axes are nearly parallel. Without one they may be opposite, where there is no twist.
            const Real scale = Real(1) / maximum(Real(1) + dot(x_a, x_b), Real(0.01F));
            here.axis = scale * (x_a + x_b);
            here.value = Real(2) * arc_tangent2(q.x, q.w);
        }
    }

    /// K = J M^-1 J^T.
    template <class Real, class A, class B>
    static Real response(const Here<Real>& here, const A& a, const B& b)
    {
        if constexpr (slides) {
            return dot(here.axis, over_mass(a, here.axis) + over_mass(b, here.axis)) +
                   dot(here.levers.a, over_inertia(a, here.levers.a)) +
                   dot(here.levers.b, over_inertia(b, here.levers.b));
        } else {
            return dot(here.axis, over_inertia(a, here.axis) + over_inertia(b, here.axis));
        }
    }
    /// The magnitude of M^-1, of which a usable K is more than `rounding_share`.
    template <class Real, class A, class B>
    static Real size(const A& a, const B& b)
    {
        return slides ? linear_size(a) + linear_size(b) : angular_size(a) + angular_size(b);
    }

    /// J v.
    template <class Real, class A, class B>
    static Real speed(const Here<Real>& here, const A& a, const B& b)
    {
        if constexpr (slides) {
            return dot(here.axis, linear_of(b) - linear_of(a)) + dot(here.levers.b, angular_of(b)) -
                   dot(here.levers.a, angular_of(a));
        } else {
            return dot(here.axis, angular_of(b) - angular_of(a));
        }
    }
    /// v += M^-1 J^T lambda.
    template <class Real, class A, class B>
    static void push(const Here<Real>& here, const Real& lambda, A& a, B& b)
    {
        if constexpr (slides) {
            apply_wrench(a, -(lambda * here.axis), -(lambda * here.levers.a));
            apply_wrench(b, lambda * here.axis, lambda * here.levers.b);
        } else {
            apply_turn(a, -(lambda * here.axis));
            apply_turn(b, lambda * here.axis);
        }
    }
    /// The same for positions.
    template <class Real, class A, class B>
    static void move(const Here<Real>& here, const Real& lambda, A& a, B& b)
    {
        if constexpr (slides) {
            displace(a, -(lambda * here.axis), -(lambda * here.levers.a));
            displace(b, lambda * here.axis, lambda * here.levers.b);
        } else {
            const Vec3<Real> none{Real(0), Real(0), Real(0)};
            displace(a, none, -(lambda * here.axis));
            displace(b, none, lambda * here.axis);
        }
    }

    /// How far an angular row turns each body for its lambda: 1/2 for a twist.
    template <class Real>
    static Real length_of_axis(const Start<Real>& start)
    {
        Real length(0.5F);
        if constexpr (is_euler) {
            const Vec3<Real> n = cross(axis_z(start.frame_b), axis_x(start.frame_a));
            length = start.which.y + (start.which.x + start.which.z) * steepness(over_length(n));
        }
        return length;
    }

    /// C from the present poses, in double.
    static double value_of(const DriveDefinition<drive_axis>& drive, const BodyState& a, const BodyState& b)
    {
        const Quat<double> frame_a = a.orientation * unit(convert<double>(drive.frame_a.rotation));
        const Quat<double> frame_b = b.orientation * unit(convert<double>(drive.frame_b.rotation));
        const Vec3<double> d = anchor_separation(a, b, drive.frame_a.position, drive.frame_b.position);
        if (slides) return dot(axis_x(frame_a), d);
        return is_euler ? euler_angle(drive.angle, frame_a, frame_b) : twist_of(conjugate(frame_a) * frame_b);
    }

  private:
    static double twist_of(const Quat<double>& q)
    {
        return 2 * std::atan2(q.w < 0 ? -q.x : q.x, std::abs(q.w));
    }
    static double euler_angle(EulerAngle angle, const Quat<double>& frame_a, const Quat<double>& frame_b)
    {
        const Vec3<double> x_a = axis_x(frame_a), z_b = axis_z(frame_b), n = cross(z_b, x_a);
        if (angle == EulerAngle::x) return std::atan2(-dot(axis_y(frame_a), z_b), dot(axis_z(frame_a), z_b));
        if (angle == EulerAngle::y) return std::atan2(dot(x_a, z_b), std::sqrt(dot(n, n)));
        return std::atan2(-dot(x_a, axis_y(frame_b)), dot(x_a, axis_x(frame_b)));
    }
    template <class Real>
    static Real over_length(const Vec3<Real>& n)
    {
        return Real(1) / square_root(maximum(dot(n, n), Real(1e-30F)));
    }
    /// The length of t of the Euler angles x and z, from 1 / |n|. It must never be shorter than 1, or the impulse that
    /// reaches a given speed along t would grow without bound. Within 1.5 degrees of a right angle of y it is held at 38.
    template <class Real>
    static Real steepness(const Real& over_length)
    {
        return minimum(over_length, Real(38));
    }
    /// t and C of the Euler angle of each lane.
    template <class Real>
    static void locate_euler(const Which<Real>& which, const Quat<Real>& frame_a, const Quat<Real>& frame_b,
                             Here<Real>& here)
    {
        const Vec3<Real> x_a = axis_x(frame_a), z_b = axis_z(frame_b), n = cross(z_b, x_a);
        const Real over = over_length(n), steep = steepness(over);
        here.axis = (which.x * steep * over) * cross(n, z_b) + (which.y * over) * n +
                    (which.z * steep * over) * cross(x_a, n);
        const Real x = full_arc_tangent2(-dot(axis_y(frame_a), z_b), dot(axis_z(frame_a), z_b)),
                   y = arc_tangent2(dot(x_a, z_b), square_root(dot(n, n))),
                   z = full_arc_tangent2(-dot(x_a, axis_y(frame_b)), dot(x_a, axis_x(frame_b)));
        here.value = which.x * x + which.y * y + which.z * z;
    }
};

}  // namespace motley
