// Where the anchors of a joint are when a step begins, in lanes.
#pragma once

#include "maths/lane_body.h"

namespace motley {

/// The orientation of a body at the start of a step; a particle has none.
template <class Real, BodyKind kind>
struct Orientation {
    Quat<Real> rotation;
};
template <class Real>
struct Orientation<Real, BodyKind::particle> {
};
template <class Real>
struct Orientation<Real, BodyKind::planar> {
    Real yaw;  ///< wrapped to +-pi
};

/// Takes a vector from the body frame to the world frame.
template <class Real>
Vec3<Real> to_world(const Orientation<Real, BodyKind::particle>&, const Vec3<Real>& local)
{
    return local;
}
template <class Real>
Vec3<Real> to_world(const Orientation<Real, BodyKind::planar>& o, const Vec3<Real>& local)
{
    const SineCosine<Real> t = sine_cosine(o.yaw);
    return {t.cosine * local.x - t.sine * local.y, t.sine * local.x + t.cosine * local.y, local.z};
}
template <class Real, BodyKind kind>
requires(kind == BodyKind::rigid ||
         kind == BodyKind::fixed) Vec3<Real> to_world(const Orientation<Real, kind>& o,
                                                      const Vec3<Real>& local)
{
    return rotate(o.rotation, local);
}

/// The poses of a joint's bodies when a step begins. `between` is x_b - x_a, the difference of their centres of mass,
/// computed in double.
template <class Real, BodyKind a, BodyKind b>
struct JointPose {
    Vec3<Real> between;
    Orientation<Real, a> orientation_a;
    Orientation<Real, b> orientation_b;
};

/// For joints that are defined by points of the world: x_a - point_a and x_b - point_b, computed in double.
template <class Real>
struct FromWorldPoints {
    Vec3<Real> a, b;
};

/// The two points of the world, m, that such a joint is defined by.
struct WorldPoints {
    Vec3<double> a, b;
};

}  // namespace motley
