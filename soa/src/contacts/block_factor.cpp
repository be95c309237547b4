// See block_factor.h.
#include "contacts/block_factor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

namespace motley {

bool Elimination::find(std::int32_t bodies, std::span<const BodyEdge> edges, std::int64_t most_products)
{
    const std::size_t count = as_index(bodies);
    body_at_.clear();
    begin_.assign(1, 0);
    rows_.clear();
    place_of_.assign(count, -1);
    if (neighbours_.size() < count) neighbours_.resize(count);
    for (std::size_t i = 0; i < count; ++i) neighbours_[i].clear();
    for (const BodyEdge& edge : edges) {
        neighbours_[as_index(edge.a)].push_back(edge.b);
        neighbours_[as_index(edge.b)].push_back(edge.a);
    }
    waiting_.clear();
    for (std::int32_t body = 0; body < bodies; ++body) {
        Array<std::int32_t>& near = neighbours_[as_index(body)];
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        waiting_.emplace_back(static_cast<std::int32_t>(near.size()), body);
    }
    std::make_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    std::int64_t products = 0;
    while (!waiting_.empty()) {
        const auto [degree, body] = waiting_.front();
        std::pop_heap(waiting_.begin(), waiting_.end(), std::greater<>());
        waiting_.pop_back();
        const bool is_current = place_of_[as_index(body)] < 0 &&
                                degree == static_cast<std::int32_t>(neighbours_[as_index(body)].size());
        if (!is_current) continue;
        products += std::int64_t{degree} * (degree + 3) / 2 + 1;
        if (products > most_products) {
            body_at_.clear();
            return false;
        }
        eliminate(body);
    }
    list_targets();
    return true;
}

/// Takes a body out; those that touched it touch each other from now on.
void Elimination::eliminate(std::int32_t body)
{
    place_of_[as_index(body)] = static_cast<std::int32_t>(body_at_.size());
    body_at_.push_back(body);
    const Array<std::int32_t>& column = neighbours_[as_index(body)];
    rows_.insert(rows_.end(), column.begin(), column.end());
    begin_.push_back(static_cast<std::int32_t>(rows_.size()));
    for (const std::int32_t other : column) {
        Array<std::int32_t>& near = neighbours_[as_index(other)];
        merged_.clear();
        std::set_union(near.begin(), near.end(), column.begin(), column.end(), std::back_inserter(merged_));
        std::erase_if(merged_, [&](std::int32_t i) { return i == body || i == other; });
        near.assign(merged_.begin(), merged_.end());
        waiting_.emplace_back(static_cast<std::int32_t>(near.size()), other);
        std::push_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    }
}

/// Renames the rows from bodies to places, in order, and finds the targets.
void Elimination::list_targets()
{
    targets_.clear();
    for (std::int32_t place = 0; place < bodies(); ++place) {
        const auto begin = rows_.begin() + begin_of(place), end = rows_.begin() + begin_of(place + 1);
        std::transform(begin, end, begin, [&](std::int32_t body) { return place_of_[as_index(body)]; });
        std::sort(begin, end);
    }
    for (std::int32_t place = 0; place < bodies(); ++place) {
        for (std::int32_t i = begin_of(place); i < begin_of(place + 1); ++i) {
            targets_.push_back(~row_of(i));
            for (std::int32_t j = i + 1; j < begin_of(place + 1); ++j)
                targets_.push_back(find_block(row_of(i), row_of(j)));
        }
    }
}

std::int32_t Elimination::find_block(std::int32_t column, std::int32_t row) const
{
    const auto begin = rows_.begin() + begin_of(column), end = rows_.begin() + begin_of(column + 1);
    return static_cast<std::int32_t>(std::lower_bound(begin, end, row) - rows_.begin());
}

namespace {

template <int size>
struct Block {
    /// L of a = L L^T in the lower triangle, in place, with the inverses of its diagonal. The matrix is the identity
    /// plus what is not negative, so that no pivot is below 1 but for rounding.
    static void factor(double* a)
    {
        for (int j = 0; j < size; ++j) {
            double pivot = a[j * size + j];
            for (int k = 0; k < j; ++k) pivot -= a[j * size + k] * a[j * size + k];
            const double inverse = 1 / std::sqrt(std::max(pivot, 1.0));
            a[j * size + j] = inverse;
            for (int i = j + 1; i < size; ++i) {
                double sum = a[i * size + j];
                for (int k = 0; k < j; ++k) sum -= a[i * size + k] * a[j * size + k];
                a[i * size + j] = sum * inverse;
            }
        }
    }
    /// b L^-T, in place.
    static void divide(double* b, const double* l)
    {
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
                double sum = b[i * size + j];
                for (int k = 0; k < j; ++k) sum -= b[i * size + k] * l[j * size + k];
                b[i * size + j] = sum * l[j * size + j];
            }
        }
    }
    /// c -= a b^T
    static void subtract_product(double* c, const double* a, const double* b)
    {
        double transposed[size * size];
        for (int i = 0; i < size; ++i) {
            for (int k = 0; k < size; ++k) transposed[k * size + i] = b[i * size + k];
        }
        for (int i = 0; i < size; ++i) {
            double row[size];
            for (int j = 0; j < size; ++j) row[j] = c[i * size + j];
            for (int k = 0; k < size; ++k) {
                for (int j = 0; j < size; ++j) row[j] -= a[i * size + k] * transposed[k * size + j];
            }
            for (int j = 0; j < size; ++j) c[i * size + j] = row[j];
        }
    }
    /// x L^-T ... of a vector: L^-1 x
    static void forward(double* x, const double* l)
    {
        for (int i = 0; i < size; ++i) {
            double sum = x[i];
            for (int k = 0; k < i; ++k) sum -= l[i * size + k] * x[k];
            x[i] = sum * l[i * size + i];
        }
    }
    /// L^-T x
    static void backward(double* x, const double* l)
    {
        for (int i = size; i-- > 0;) {
            double sum = x[i];
            for (int k = i + 1; k < size; ++k) sum -= l[k * size + i] * x[k];
            x[i] = sum * l[i * size + i];
        }
    }
    /// y -= a x
    static void subtract(double* y, const double* a, const double* x)
    {
        for (int i = 0; i < size; ++i) {
            double sum = 0;
            for (int k = 0; k < size; ++k) sum += a[i * size + k] * x[k];
            y[i] -= sum;
        }
    }
    /// y -= a^T x
    static void subtract_transposed(double* y, const double* a, const double* x)
    {
        for (int k = 0; k < size; ++k) {
            for (int i = 0; i < size; ++i) y[i] -= a[k * size + i] * x[k];
        }
    }
};

}  // namespace

template <int size>
void BlockFactor<size>::make_room(const Elimination& order)
{
    const auto bodies = static_cast<std::size_t>(order.bodies());
    diagonal_.resize(bodies * numbers);
    below_.resize(static_cast<std::size_t>(order.blocks()) * numbers);
}

template <int size>
void BlockFactor<size>::begin()
{
    std::fill(diagonal_.begin(), diagonal_.end(), 0.0);
    std::fill(below_.begin(), below_.end(), 0.0);
    for (std::size_t block = 0; block < diagonal_.size(); block += numbers) {
        for (std::size_t i = 0; i < size; ++i) diagonal_[block + i * (size + 1)] = 1;
    }
}

template <int size>
void BlockFactor<size>::add(std::int32_t place, const double* a, double weight)
{
    double* block = diagonal_.data() + std::int64_t{place} * numbers;
    for (int i = 0; i < size; ++i) {
        const double scaled = weight * a[i];
        for (int j = 0; j <= i; ++j) block[i * size + j] += scaled * a[j];
    }
}

template <int size>
void BlockFactor<size>::add_between(std::int32_t block, const double* a, const double* b, double weight)
{
    double* numbers_of = below_.data() + std::int64_t{block} * numbers;
    for (int i = 0; i < size; ++i) {
        const double scaled = weight * a[i];
        for (int j = 0; j < size; ++j) numbers_of[i * size + j] += scaled * b[j];
    }
}

template <int size>
void BlockFactor<size>::factor(const Elimination& order)
{
    const std::int32_t* target = order.targets().data();
    const auto below = [&](std::int32_t block) { return below_.data() + std::int64_t{block} * numbers; };
    for (std::int32_t place = 0; place < order.bodies(); ++place) {
        double* pivot = diagonal_.data() + std::int64_t{place} * numbers;
        Block<size>::factor(pivot);
        const std::int32_t begin = order.begin_of(place), end = order.begin_of(place + 1);
        for (std::int32_t i = begin; i < end; ++i) Block<size>::divide(below(i), pivot);
        for (std::int32_t i = begin; i < end; ++i) {
            for (std::int32_t j = i; j < end; ++j, ++target) {
                double* const from =
                    *target < 0 ? diagonal_.data() + std::int64_t{~*target} * numbers : below(*target);
                Block<size>::subtract_product(from, below(j), below(i));
            }
        }
    }
}

template <int size>
void BlockFactor<size>::solve(const Elimination& order, std::span<double> x) const
{
    const auto at = [&](std::int32_t place) { return x.data() + std::int64_t{order.body_at(place)} * size; };
    for (std::int32_t place = 0; place < order.bodies(); ++place) {
        double* const own = at(place);
        Block<size>::forward(own, diagonal_.data() + std::int64_t{place} * numbers);
        for (std::int32_t i = order.begin_of(place); i < order.begin_of(place + 1); ++i)
            Block<size>::subtract(at(order.row_of(i)), below_.data() + std::int64_t{i} * numbers, own);
    }
    for (std::int32_t place = order.bodies(); place-- > 0;) {
        double* const own = at(place);
        for (std::int32_t i = order.begin_of(place); i < order.begin_of(place + 1); ++i)
            Block<size>::subtract_transposed(own, below_.data() + std::int64_t{i} * numbers,
                                             at(order.row_of(i)));
        Block<size>::backward(own, diagonal_.data() + std::int64_t{place} * numbers);
    }
}

template class BlockFactor<3>;
template class BlockFactor<6>;

}  // namespace motley
