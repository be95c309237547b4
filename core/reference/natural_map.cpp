// See natural_map.h.
#include "natural_map.h"

#include <algorithm>
#include <cmath>

#include "small_inverse.h"

namespace motley::reference {
namespace {

using Column = RowGroup::Rows<1>;
using Square = RowGroup::Square;

}  // namespace

double radius(const Cone& cone, const Column& lambda)
{
    if (cone.normal_count == 0) return cone.bound;
    return cone.bound * lambda.segment(cone.first_normal, cone.normal_count).cwiseMax(0).sum();
}

void find_map(MappedGroup& unit)
{
    const RowGroup& group = *unit.group;
    const Column& lambda = group.lambda;
    unit.map.resize(group.size());
    std::array<bool, RowGroup::most_rows> in_cone{};
    for (const Cone& cone : group.cones) {
        const double step = unit.scale.segment(cone.first, cone.count).maxCoeff();
        const Column z =
            lambda.segment(cone.first, cone.count) - step * unit.w.segment(cone.first, cone.count);
        const double r = radius(cone, group.lambda), length = z.norm();
        const bool sticks = length <= r && step > 0;
        for (int i = 0; i < cone.count; ++i) {
            const auto row = static_cast<std::size_t>(cone.first + i);
            in_cone[row] = true;
            unit.where[row] = sticks ? Where::inside : Where::slides;
            unit.map(cone.first + i) = sticks       ? step * unit.w(cone.first + i)
                                       : length > 0 ? lambda(cone.first + i) - r / length * z(i)
                                                    : lambda(cone.first + i);
        }
    }
    for (int i = 0; i < group.size(); ++i) {
        const auto row = static_cast<std::size_t>(i);
        if (in_cone[row]) continue;
        const double z = lambda(i) - unit.scale(i) * unit.w(i);
        const bool inside = z > group.low(i) && z < group.high(i) && unit.scale(i) > 0;
        unit.where[row] = inside ? Where::inside : z <= group.low(i) ? Where::low : Where::high;
        unit.map(i) = inside               ? unit.scale(i) * unit.w(i)
                      : unit.scale(i) == 0 ? lambda(i)
                                           : lambda(i) - std::clamp(z, group.low(i), group.high(i));
    }
}

void linearise(MappedGroup& unit, double epsilon)
{
    const RowGroup& group = *unit.group;
    const int n = group.size();
    Square &e = unit.e, &f = unit.f;
    e.setZero(n, n);
    f.setZero(n, n);
    for (int i = 0; i < n; ++i) {
        const bool inside = unit.where[static_cast<std::size_t>(i)] == Where::inside;
        e(i, i) = inside ? epsilon * unit.share(i) : 1;
        if (inside) f(i, i) = unit.scale(i);
    }
    for (const Cone& cone : group.cones) {
        const double step = unit.scale.segment(cone.first, cone.count).maxCoeff();
        auto ee = e.block(cone.first, cone.first, cone.count, cone.count);
        auto ff = f.block(cone.first, cone.first, cone.count, cone.count);
        if (unit.where[static_cast<std::size_t>(cone.first)] == Where::inside) {
            ff.diagonal().setConstant(step);
            continue;
        }
        // d(r z / |z|) = z/|z| dr + r / |z| (I - z z^T / |z|^2) dz, dz = dlambda - step dw.
        const Column z =
            group.lambda.segment(cone.first, cone.count) - step * unit.w.segment(cone.first, cone.count);
        const double length = z.norm();
        const Column along = length > 0 ? Column(z / length) : Column(Column::Zero(cone.count));
        const double share = length > 0 ? std::min(radius(cone, group.lambda) / length, 1.0) : 0;
        const Square across = share * (Square::Identity(cone.count, cone.count) - along * along.transpose());
        ee = (1 + epsilon) * Square::Identity(cone.count, cone.count) - across;
        ff = step * across;
        for (int normal = cone.first_normal; normal < cone.first_normal + cone.normal_count; ++normal) {
            if (group.lambda(normal) > 0) e.block(cone.first, normal, cone.count, 1) -= cone.bound * along;
        }
    }
    if (group.softness.size() > 0) e += f.lazyProduct(group.softness);
    if (unit.node >= 0) return;
    invert_small(e);
    unit.law = e.lazyProduct(f);
    unit.drive = -e.lazyProduct(unit.map);
}

void sweep_group(MappedGroup& unit, Eigen::VectorXd& change)
{
    const auto of_body = [&](int body) { return change.segment<6>(6 * static_cast<Eigen::Index>(body)); };
    RowGroup& group = *unit.group;
    const auto soft = [&](int i) {
        return group.softness.size() > 0 ? group.softness.row(i).dot(group.lambda) : 0.0;
    };
    const auto w_of = [&](int i) {
        double w = unit.offset(i) + soft(i);
        for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
            if (unit.bodies[side] >= 0) w += group.jacobian[side].row(i).dot(of_body(unit.bodies[side]));
        }
        return w;
    };
    const auto set = [&](int i, double lambda) {
        for (std::size_t side = 0; side < RowGroup::most_bodies; ++side) {
            if (unit.bodies[side] >= 0)
                of_body(unit.bodies[side]) +=
                    (lambda - group.lambda(i)) * group.jacobian[side].row(i).transpose();
        }
        group.lambda(i) = lambda;
    };
    std::array<bool, RowGroup::most_rows> in_cone{};
    for (const Cone& cone : group.cones) {
        for (int i = 0; i < cone.count; ++i) in_cone[static_cast<std::size_t>(cone.first + i)] = true;
    }
    for (int i = 0; i < group.size(); ++i) {
        if (!in_cone[static_cast<std::size_t>(i)])
            set(i, std::clamp(group.lambda(i) - unit.scale(i) * w_of(i), group.low(i), group.high(i)));
    }
    for (const Cone& cone : group.cones) {
        const double step = unit.scale.segment(cone.first, cone.count).minCoeff();
        Column z(cone.count);
        for (int i = 0; i < cone.count; ++i)
            z(i) = group.lambda(cone.first + i) - 0.7 * step * w_of(cone.first + i);
        const double r = radius(cone, group.lambda);
        if (z.norm() > r) z *= r / z.norm();
        for (int i = 0; i < cone.count; ++i) set(cone.first + i, z(i));
    }
}

}  // namespace motley::reference
