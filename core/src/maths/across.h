// A direction across another one.
#pragma once

#include <cmath>

#include "motley/core/vector.h"

namespace motley {

/// A vector perpendicular to `v`, which has a length: its cross product with the coordinate axis along which it extends
/// least. Its length is at least 0.8 of that of `v`.
inline Vec3<double> some_across(const Vec3<double>& v)
{
    const Vec3<double> size{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
    const Vec3<double> least = size.x <= size.y && size.x <= size.z ? Vec3<double>{1, 0, 0}
                               : size.y <= size.z                   ? Vec3<double>{0, 1, 0}
                                                                    : Vec3<double>{0, 0, 1};
    return cross(v, least);
}

}  // namespace motley
