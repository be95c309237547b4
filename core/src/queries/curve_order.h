// Orders points along the curve of D. Hilbert (1891), on which neighbours are near each other in the plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "motley/core/strided_span.h"
#include "motley/core/vector.h"
#include "stores/array.h"

namespace motley {

class CurveOrder {
  public:
    /// Makes room, so that find() of as many points allocates nothing.
    void make_room(std::size_t count);
    /// Finds the order of finite points, m. The curve is refined until only a few points share a place on it, so that a
    /// few points far away do no harm.
    void find(StridedSpan<const Vec2<double>> points);
    /// The index of the point that comes i-th.
    [[nodiscard]] std::uint32_t operator[](std::size_t i) const { return placed_[i].index; }

  private:
    struct Placed {
        std::uint32_t place, index;
    };
    Array<Placed> placed_, spare_;
    void sort(StridedSpan<const Vec2<double>> points, std::span<Placed> part);
};

}  // namespace motley
