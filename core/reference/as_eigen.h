// The library's vectors and frames as Eigen's, in double.
#pragma once

#include <Eigen/Geometry>

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
inline Frame eigen(const JointFrame& f)
{
    return {eigen(f.position),
            Eigen::Quaterniond(f.rotation.w, f.rotation.x, f.rotation.y, f.rotation.z).normalized()};
}

}  // namespace motley::reference
