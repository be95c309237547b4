// Cholesky factors of a sparse symmetric positive definite matrix of small dense blocks, a block row for each body of
// an island: H = L L^T.
//
// The order of elimination is that of least degree, so that chains and trees get no fill at all: their factors cost a
// fixed time a body (T. Davis, Direct Methods for Sparse Linear Systems, 2006). What is eliminated when, and which
// block is subtracted from which, depends only on who touches whom, and is kept while that stays.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "stores/array.h"

namespace motley {

/// Two bodies that touch each other, by their numbers in the island.
struct BodyEdge {
    std::int32_t a, b;
};

/// The order of elimination of an island's bodies, and where the factor has blocks.
class Elimination {
  public:
    /// Finds both for `bodies` bodies and these edges, in which a pair may occur several times. Returns false, and has no
    /// order, if the factor would take more than `most_products` products of two blocks.
    bool find(std::int32_t bodies, std::span<const BodyEdge> edges, std::int64_t most_products);

    [[nodiscard]] std::int32_t bodies() const { return static_cast<std::int32_t>(body_at_.size()); }
    /// The body that is eliminated at a place in the order, and the place of a body.
    [[nodiscard]] std::int32_t body_at(std::int32_t place) const { return body_at_[as_index(place)]; }
    [[nodiscard]] std::int32_t place_of(std::int32_t body) const { return place_of_[as_index(body)]; }
    /// The blocks below the diagonal, column after column; block k of column p is of row rows()[k].
    [[nodiscard]] std::int32_t begin_of(std::int32_t place) const { return begin_[as_index(place)]; }
    [[nodiscard]] std::int32_t blocks() const { return static_cast<std::int32_t>(rows_.size()); }
    [[nodiscard]] std::int32_t row_of(std::int32_t block) const { return rows_[as_index(block)]; }
    /// The block in column `column` and row `row`, both places, column before row.
    [[nodiscard]] std::int32_t find_block(std::int32_t column, std::int32_t row) const;
    /// For each column, for each pair of its blocks (first, second >= first), the block from which their product is
    /// subtracted; ~row where that is on the diagonal.
    [[nodiscard]] std::span<const std::int32_t> targets() const { return targets_; }

  private:
    Array<std::int32_t> body_at_, place_of_, begin_, rows_, targets_;
    Array<Array<std::int32_t>> neighbours_;                 ///< of bodies that are not eliminated yet, sorted
    Array<std::pair<std::int32_t, std::int32_t>> waiting_;  ///< (degree, body), a heap; may be out of date
    Array<std::int32_t> merged_;

    static std::size_t as_index(std::int32_t i) { return static_cast<std::size_t>(i); }
    void eliminate(std::int32_t body);
    void list_targets();
};

/// The numbers of the factor; `size` rows and columns a block.
template <int size>
class BlockFactor {
  public:
    static constexpr int numbers = size * size;

    /// Makes space for a matrix of this order.
    void make_room(const Elimination& order);
    /// Starts with the identity.
    void begin();
    /// Adds weight * a a^T to the block on the diagonal of the body at a place.
    void add(std::int32_t place, const double* a, double weight);
    /// Adds weight * a b^T to block `block` of the bodies' pair, a of the one that is eliminated later.
    void add_between(std::int32_t block, const double* a, const double* b, double weight);
    void factor(const Elimination& order);
    /// Solves H x = x; x has `size` numbers a body.
    void solve(const Elimination& order, std::span<double> x) const;

  private:
    Array<double> diagonal_, below_;  ///< by place; by block
};

}  // namespace motley
