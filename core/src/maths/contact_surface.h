// What the surface of a contact does beyond being that of its body.
#pragma once

#include <cmath>

#include "motley/core/vector.h"

namespace motley {

/// Of body a. By default it rests on the body and pushes as hard as it must.
template <class Real>
struct ContactSurface {
    Vec3<Real> velocity{Real(0), Real(0), Real(0)};  ///< m/s, world, relative to the body: of a belt
    Real most_force = Real(INFINITY);                ///< N, along the normal
};

}  // namespace motley
