// The library's vectors and frames as Eigen's, in double, and numbers as the library keeps them.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "motley/reference/joint_models.h"

namespace motley::reference {

inline Eigen::Vector3d eigen(const Vec3<float>& v)
{
    return {v.x, v.y, v.z};
}
inline Eigen::Vector3d eigen(const Vec3<double>& v)
{
    return {v.x, v.y, v.z};
}
/// An impulse as the library keeps it; 0 if it is not finite.
inline float narrow(double impulse)
{
    return std::isfinite(impulse) ? static_cast<float>(impulse) : 0.0F;
}
inline Frame eigen(const JointFrame& f)
{
    return {eigen(f.position),
            Eigen::Quaterniond(f.rotation.w, f.rotation.x, f.rotation.y, f.rotation.z).normalized()};
}

}  // namespace motley::reference
