// All contacts of an island, solved at once: bodies that contacts connect, such as a tower or a queue.
//
// Sweeps hand an impulse on from body to body, and a queue of n people wants about n^2 of them. Here a guess is made of
// which contacts push and which of them stick (the active set), these are solved as equations, and the guess is mended
// until the impulses agree with it: a primal-dual active set method (M. Hintermueller, K. Ito, K. Kunisch 2002), begun
// with the impulses of the last sweep, as subspace minimisation begins (M. Silcowitz, S. Niebe, K. Erleben 2010).
//
//   minimise 1/2 dv^T M dv + sum over active rows of rho / (2 K) (J (v + dv) - aim)^2
//   lambda += -rho / K (J (v + dv) - aim)
//
// M: mass matrix; J: a row; K = J M^-1 J^T its response; aim: the speed that the row wants. Four contacts between two
// faces are more than six equations, so J M^-1 J^T is singular; this form is not. rho = 1e8 leaves 1e-8 of a row's
// error even where a tower of fifty boxes leans, whose softest mode responds 1e-6 as much as one contact does.
//
// Unknowns are scaled: dv = W s with W W^T = M^-1, so that masses of any ratio are alike and a body that cannot turn
// needs no special case. The matrix is I + sum rho / K j j^T, with j = W^T J^T, in blocks of two bodies; its factor is
// as sparse as the contacts are (block_factor.h).
//
// Friction that slides is not an equation: it keeps its direction and follows the normal impulse. Between guesses one
// sweep lets it turn. Coulomb's law has no energy to be minimised, so whether a guess is better is judged by the
// residual: what one more sweep would change.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contacts/block_factor.h"
#include "contacts/contact_directions.h"
#include "layout/batches.h"

namespace motley {

/// Where a contact lies in its block, and which bodies of the island it touches; -1: a body that does not move.
struct IslandContact {
    const SweepChunk* chunk;  ///< valid for the step
    std::int32_t rows, block, lane;
    std::int32_t a, b;
};

/// What a solve of islands achieved.
struct IslandResult {
    double residual = 0;  ///< m/s: the most that one more sweep would change the speed of a row
    int factors = 0;      ///< matrices factored
};

/// `size`: degrees of freedom of a body, 3 for planar bodies or particles alone, else 6.
template <int size>
class ContactIsland {
  public:
    /// Makes all space for these bodies and contacts. Returns false if their matrix would take more products of two
    /// blocks than `most_products`: then the island is left alone.
    bool lay_out(std::span<const BodyRow> bodies, std::span<const IslandContact> contacts,
                 std::int64_t most_products);
    /// Reads the contacts' rows and impulses.
    void begin();
    /// Solves all rows for the present velocities and displacements of the bodies, and changes velocities and impulses.
    /// With `relaxes` penetration asks for no speed.
    IslandResult solve(const KernelContext& context, bool relaxes);

  private:
    enum class State : std::uint8_t { apart, slides, sticks };
    struct Row {
        double a[size], b[size];    ///< W^T J^T of each body
        double response;            ///< K
        double lambda, aim, start;  ///< start: J v before this solve
    };
    struct Contact {
        std::int32_t a, b, first_row, rows;
        std::int32_t block;  ///< of the pair in the factor; -1 if one of them does not move
        bool a_is_later;
        double friction;
    };
    struct Body {
        BodyRow row;
        double linear;      ///< square root of 1/m
        double angular[6];  ///< lower triangle of the root of I^-1: xx, yx, yy, zx, zy, zz
    };
    std::vector<Body> bodies_;
    std::vector<IslandContact> places_;
    std::vector<Contact> contacts_;
    std::vector<Row> rows_;
    std::vector<double> s_, step_;  ///< `size` numbers a body: dv = W s; and the next change of s
    std::vector<ContactDirections> directions_;
    std::vector<double> impulses_;  ///< as they were stored last
    std::vector<double> kept_;      ///< before a step
    std::vector<double> best_;      ///< of those that were tried
    std::vector<double> change_;    ///< of impulses
    std::vector<State> guess_, factored_;
    bool is_sparse_ = false;
    bool has_rows_ = false;
    bool has_guess_ = false;  ///< guess_ solved these contacts
    bool has_factor_ = false;
    Elimination order_;
    BlockFactor<size> factor_;
    std::vector<BodyEdge> edges_;

    bool load_bodies(const KernelContext& context);
    void load_rows();
    void load_speeds(const KernelContext& context, bool relaxes);
    void store(const KernelContext& context);
    void sweep();
    [[nodiscard]] double speed(const Contact& contact, const Row& row) const;
    void push(const Contact& contact, const Row& row, double impulse);
    [[nodiscard]] State guess_of(const Contact& contact) const;
    void factor(IslandResult& result);
    void find_step();
    bool mend_guess();
    void apply(double share);
    struct Residual {
        double energy = 0, speed = 0;  ///< J, and m/s
    };
    [[nodiscard]] Residual residual() const;
    void improve(double tolerance, IslandResult& result);
};

}  // namespace motley
