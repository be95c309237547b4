// Sorts rows along a space-filling curve, so that the bodies of neighbouring constraints lie in few cache lines.
#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "stores/array.h"
#include "stores/body_store.h"

namespace motley {
namespace {

/// Spreads the low 21 bits of x to every third bit.
std::uint64_t every_third(std::uint64_t x)
{
    x = (x | x << 32) & 0x001F00000000FFFFULL;
    x = (x | x << 16) & 0x001F0000FF0000FFULL;
    x = (x | x << 8) & 0x100F00F00F00F00FULL;
    x = (x | x << 4) & 0x10C30C30C30C30C3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

/// The place of positions along the Z-order curve (G. M. Morton, 1966) of the cube that holds them all.
class ZOrder {
  public:
    void include(const Vec3<PoseReal>& at)
    {
        low_ = {std::min(low_.x, at.x), std::min(low_.y, at.y), std::min(low_.z, at.z)};
        high_ = {std::max(high_.x, at.x), std::max(high_.y, at.y), std::max(high_.z, at.z)};
    }
    [[nodiscard]] std::uint64_t of(const Vec3<PoseReal>& at) const
    {
        const PoseReal size =
            std::max({high_.x - low_.x, high_.y - low_.y, high_.z - low_.z, PoseReal(1e-9)});
        const auto cell = [&](PoseReal offset) {
            return every_third(static_cast<std::uint64_t>(offset / size * PoseReal(0x1FFFFF)));
        };
        return cell(at.x - low_.x) | cell(at.y - low_.y) << 1 | cell(at.z - low_.z) << 2;
    }

  private:
    Vec3<PoseReal> low_{1e30F, 1e30F, 1e30F}, high_{-1e30F, -1e30F, -1e30F};
};

/// Copies entries of `size` values each in a new order: entry i is the old entry order[i].
template <class T, class Allocator>
std::vector<T, Allocator> reordered(const std::vector<T, Allocator>& values,
                                    std::span<const std::uint32_t> order, std::size_t size)
{
    if (values.empty()) return {};
    std::vector<T, Allocator> moved(order.size() * size);
    for (std::size_t i = 0; i < order.size(); ++i)
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(order[i] * size), size,
                    moved.begin() + static_cast<std::ptrdiff_t>(i * size));
    return moved;
}

/// The null row, then the rows of bodies in the order of the curve.
Array<std::uint32_t> order_of(const BodyRows& rows)
{
    ZOrder curve;
    Array<std::uint32_t> order{0};
    for (std::uint32_t row = 1; row < rows.size(); ++row) {
        if (rows.slot[row] == 0) continue;
        order.push_back(row);
        curve.include(rows.pose[row].position);
    }
    Array<std::uint64_t> place(rows.size());
    for (std::size_t i = 1; i < order.size(); ++i) place[order[i]] = curve.of(rows.pose[order[i]].position);
    std::stable_sort(order.begin() + 1, order.end(),
                     [&](std::uint32_t x, std::uint32_t y) { return place[x] < place[y]; });
    return order;
}

}  // namespace

void BodyStore::renumber()
{
    // Into new arrays: the old ones stay valid until memory for all of them has been found.
    std::array<BodyRows, body_kind_count> renumbered;
    for (int k = 0; k < body_kind_count; ++k) {
        const auto kind = static_cast<BodyKind>(k);
        const BodyRows& r = rows(kind);
        BodyRows& to = renumbered[static_cast<std::size_t>(k)];
        const Array<std::uint32_t> order = order_of(r);
        const std::size_t floats = std::size_t{4} * static_cast<std::size_t>(quads_of(kind));
        to.velocity = reordered(r.velocity, order, floats);
        to.delta = reordered(r.delta, order, floats);
        to.acceleration = reordered(r.acceleration, order, floats);
        to.unpushed = reordered(r.unpushed, order, floats);
        to.world_inverse_inertia = reordered(r.world_inverse_inertia, order, 8);
        to.start_inverse_inertia = reordered(r.start_inverse_inertia, order, 8);
        to.pose = reordered(r.pose, order, 1);
        to.orientation = reordered(r.orientation, order, 1);
        to.inertia = reordered(r.inertia, order, 1);
        to.inverse_inertia = reordered(r.inverse_inertia, order, 1);
        to.slot = reordered(r.slot, order, 1);
        to.awake.reserve(r.awake.size());  // noted when all memory has been found
    }
    rows_ = std::move(renumbered);
    for (int k = 0; k < body_kind_count; ++k) enter_rows(static_cast<BodyKind>(k));
}

void BodyStore::enter_rows(BodyKind kind)
{
    const Array<std::uint32_t>& slot = rows(kind).slot;
    for (std::uint32_t row = 1; row < slot.size(); ++row) {
        if (slot[row] != 0) slots_[slot[row]].row = BodyRow(kind, row);
    }
    note_awake(kind);
}

void BodyStore::swap_planar(std::uint32_t i, std::uint32_t j)
{
    BodyRows& r = rows(BodyKind::planar);
    for (AlignedVector<float>* quads : {&r.velocity, &r.delta, &r.acceleration, &r.unpushed}) {
        float* const first = quads->data();
        std::swap_ranges(first + std::size_t{4} * i, first + std::size_t{4} * i + 4,
                         first + std::size_t{4} * j);
    }
    std::swap(r.pose[i], r.pose[j]);
    std::swap(r.slot[i], r.slot[j]);
}

}  // namespace motley
