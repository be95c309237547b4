// What add_polygon() refuses.
#pragma once

#include "motley/core/polygon.h"

namespace motley {

/// Refuses a polygon that is not as add_polygon() wants it.
void check_polygon(const Polygon& polygon);

}  // namespace motley
