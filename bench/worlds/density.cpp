// See density.h.
#include "worlds/density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace motley::bench {
namespace {

using Area = std::vector<Vec2<double>>;

/// Cuts off what of a convex polygon is beyond the line n . p = limit.
void cut(Area& area, const Vec2<double>& n, double limit, Area& spare)
{
    spare.clear();
    for (std::size_t i = 0; i < area.size(); ++i) {
        const Vec2<double>&p = area[i], &q = area[(i + 1) % area.size()];
        const double of_p = dot(n, p) - limit, of_q = dot(n, q) - limit;
        if (of_p <= 0) spare.push_back(p);
        if ((of_p < 0 && of_q > 0) || (of_p > 0 && of_q < 0))
            spare.push_back(p + of_p / (of_p - of_q) * (q - p));
    }
    area.swap(spare);
}

/// Whether some of the line from p to q is in a convex polygon, whose corners are counter-clockwise.
bool reaches_into(const Area& area, const Vec2<double>& p, const Vec2<double>& q)
{
    double first = 0, last = 1;
    for (std::size_t i = 0; i < area.size(); ++i) {
        const Vec2<double> edge = area[(i + 1) % area.size()] - area[i];
        const double of_p = cross(edge, p - area[i]), of_q = cross(edge, q - area[i]);
        if (of_p <= 0 && of_q <= 0) return false;
        if (of_p < 0) first = std::max(first, of_p / (of_p - of_q));
        if (of_q < 0) last = std::min(last, of_p / (of_p - of_q));
    }
    return first < last;
}

double size_of(const Area& area)
{
    double twice = 0;
    for (std::size_t i = 0; i < area.size(); ++i) twice += cross(area[i], area[(i + 1) % area.size()]);
    return twice / 2;
}

/// Points in square cells.
class Buckets {
  public:
    Buckets(std::span<const Vec2<double>> points, double cell) : points_(points), cell_(cell)
    {
        Vec2<double> high{-1e300, -1e300};
        for (const Vec2<double>& p : points) {
            low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
        // A crowd that is spread out has larger cells, so that there are never many more cells than points.
        const Vec2<double> wide = high - low_;
        const double most_cells = 4 * static_cast<double>(points.size()) + 64;
        cell_ = std::max(cell, std::sqrt(std::max(wide.x, cell) * std::max(wide.y, cell) / most_cells));
        columns_ = column_of(high.x) + 1;
        rows_ = row_of(high.y) + 1;
        first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
        for (const Vec2<double>& p : points) ++first_[bucket_of(column_of(p.x), row_of(p.y)) + 1];
        for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        sorted_.resize(points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            sorted_[next[bucket_of(column_of(points[i].x), row_of(points[i].y))]++] = i;
    }
    template <class Work>
    void for_each_near(const Vec2<double>& low, const Vec2<double>& high, const Work& work) const
    {
        for (std::int64_t row = std::max<std::int64_t>(0, row_of(low.y));
             row <= std::min(rows_ - 1, row_of(high.y)); ++row) {
            for (std::int64_t column = std::max<std::int64_t>(0, column_of(low.x));
                 column <= std::min(columns_ - 1, column_of(high.x)); ++column) {
                const std::size_t bucket = bucket_of(column, row);
                for (std::size_t k = first_[bucket]; k < first_[bucket + 1]; ++k) work(sorted_[k]);
            }
        }
    }

  private:
    std::span<const Vec2<double>> points_;
    double cell_;
    Vec2<double> low_{1e300, 1e300};
    std::int64_t columns_ = 0, rows_ = 0;
    std::vector<std::size_t> first_, sorted_;

    [[nodiscard]] std::int64_t column_of(double x) const
    {
        return static_cast<std::int64_t>(std::floor((x - low_.x) / cell_));
    }
    [[nodiscard]] std::int64_t row_of(double y) const
    {
        return static_cast<std::int64_t>(std::floor((y - low_.y) / cell_));
    }
    [[nodiscard]] std::size_t bucket_of(std::int64_t column, std::int64_t row) const
    {
        return static_cast<std::size_t>(row * columns_ + column);
    }
};

/// The walls near each person, by the persons' numbers.
std::vector<std::vector<std::size_t>> walls_near(const View& view, const Buckets& people, double reach)
{
    std::vector<std::vector<std::size_t>> near(view.people.size());
    for (std::size_t w = 0; w < view.walls.size(); ++w) {
        const Vec2<double> from = view.walls[w].from, along = view.walls[w].to - from;
        const Vec2<double> low{std::min(from.x, view.walls[w].to.x) - reach,
                               std::min(from.y, view.walls[w].to.y) - reach},
            high{std::max(from.x, view.walls[w].to.x) + reach, std::max(from.y, view.walls[w].to.y) + reach};
        people.for_each_near(low, high, [&](std::size_t i) {
            if (i >= view.people.size()) return;
            const Vec2<double> off = view.people[i] - from;
            const double place = std::clamp(dot(along, off) / std::max(dot(along, along), 1e-12), 0.0, 1.0);
            const Vec2<double> apart = off - place * along;
            if (dot(apart, apart) < reach * reach) near[i].push_back(w);
        });
    }
    return near;
}

}  // namespace

DensityField density_field(std::span<const Vec2<double>> people)
{
    DensityField field;
    if (people.empty()) return field;
    Vec2<double> low{1e300, 1e300}, high{-1e300, -1e300};
    for (const Vec2<double>& p : people) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    field.low = {std::floor(low.x), std::floor(low.y)};
    field.columns = static_cast<std::int32_t>(std::floor(high.x) - field.low.x) + 1;
    field.rows = static_cast<std::int32_t>(std::floor(high.y) - field.low.y) + 1;
    field.people.assign(static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows), 0);
    for (const Vec2<double>& p : people)
        field.people[static_cast<std::size_t>(p.y - field.low.y) * static_cast<std::size_t>(field.columns) +
                     static_cast<std::size_t>(p.x - field.low.x)] += 1;
    return field;
}

std::vector<double> voronoi_densities(const View& view, double reach, Executor& executor)
{
    // Across the seam of a period everybody is there once more.
    std::vector<Vec2<double>> all = view.people;
    if (view.period_y > 0) {
        for (const double shift : {view.period_y, -view.period_y}) {
            for (const Vec2<double>& p : view.people) all.push_back({p.x, p.y + shift});
        }
    }
    const Buckets buckets(all, reach);
    const std::vector<std::vector<std::size_t>> walls = walls_near(view, buckets, reach);
    std::vector<double> densities(view.people.size());
    parallel_for(executor, static_cast<std::int64_t>(view.people.size()), 256,
                 [&](std::int64_t begin, std::int64_t end) {
                     Area area, spare;
                     for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         const Vec2<double> me = all[i];
                         area.clear();
                         constexpr int corners = 32;
                         for (int k = 0; k < corners; ++k) {
                             const double angle = 6.283185307179586 / corners * k;
                             area.push_back({reach * std::cos(angle), reach * std::sin(angle)});
                         }
                         const Vec2<double> wide{2 * reach, 2 * reach};
                         buckets.for_each_near(me - wide, me + wide, [&](std::size_t other) {
                             const Vec2<double> apart = all[other] - me;
                             const double length2 = dot(apart, apart);
                             // People on one spot have no cells of their own and share one.
                             if (other == i || length2 == 0 || length2 >= 4 * reach * reach) return;
                             cut(area, apart, length2 / 2, spare);
                         });
                         for (const std::size_t w : walls[i]) {
                             const Vec2<double> along = view.walls[w].to - view.walls[w].from,
                                                off = view.walls[w].from - me;
                             if (!reaches_into(area, off, off + along)) continue;
                             const Vec2<double> across{-along.y, along.x};
                             const double side = dot(across, off) < 0 ? -1 : 1;
                             cut(area, side * across, side * dot(across, off), spare);
                         }
                         const double size = size_of(area);
                         densities[i] = size > 0 ? 1 / size : std::numeric_limits<double>::infinity();
                     }
                 });
    return densities;
}

std::vector<Figure> density_figures(const View& view, Executor& executor)
{
    std::vector<Figure> figures;
    const auto add = [&](const char* of, std::vector<double> values) {
        std::erase(values, 0.0);
        if (values.empty()) return;
        std::ranges::sort(values);
        double sum = 0;
        for (const double value : values) sum += value;
        figures.emplace_back(fmt::format("density of {}, mean (1/m2)", of),
                             sum / static_cast<double>(values.size()));
        figures.emplace_back(fmt::format("density of {}, 95th percentile (1/m2)", of),
                             values[values.size() * 95 / 100]);
        figures.emplace_back(fmt::format("density of {}, highest (1/m2)", of), values.back());
    };
    add("square metres with people", density_field(view.people).people);
    add("Voronoi cells", voronoi_densities(view, density_reach, executor));
    return figures;
}

}  // namespace motley::bench
