// All contacts of an island, solved at once. An island is what contacts connect, such as a tower or a queue.
//
// Sweeps hand an impulse on from body to body, and a queue of n people wants about n^2 of them. Here a guess is made of
// which contacts push and which of them stick (the active set), these are solved as equations, and the guess is mended
// until the impulses agree with it: a primal-dual active set method (M. Hintermueller, K. Ito, K. Kunisch 2002) that
// begins with what impulses and speeds say, as subspace minimisation begins with what sweeps found (M. Silcowitz,
// S. Niebe, K. Erleben 2010). One guess is enough while contacts stay as they were.
//
//   minimise 1/2 dv^T M dv + sum over active rows of rho / (2 K) (J (v + dv) - aim)^2
//   lambda -= rho / K (J (v + dv) - aim)
//
// M: mass matrix; J: a row; K = J M^-1 J^T its response; aim: the speed that the row wants. Four contacts between two
// faces are more than six equations, so J M^-1 J^T is singular; this matrix is not. A solve leaves about 1 / (rho s) of
// an error in a mode that responds s times as much as a single contact, and is repeated while that is worth while. A
// tower of fifty boxes leans with s = 1e-6. Where rows contradict each other, an impulse grows by rho times what they
// contradict each other by: a larger rho would make that of rounding. Separations do contradict each other, by rounding: a
// wall would press against itself, more and more with each step, until friction gives way. So separations that are next to
// nothing ask for nothing.
//
// Unknowns are scaled: dv = W s with W W^T = M^-1, so that masses of any ratio are alike and a body that cannot turn
// needs no special case. The matrix is I + sum rho / K j j^T, with j = W^T J^T, in blocks of two bodies; its factor is
// as sparse as the contacts are (block_factor.h).
//
// Friction that slides is no equation: it keeps its direction and follows the normal impulse. Between guesses one sweep
// lets it turn. Coulomb's law minimises no energy, so whether a guess is better is judged by the residual: what one more
// sweep would change.
#pragma once

#include <cstdint>
#include <span>

#include "contacts/block_factor.h"
#include "contacts/contact_directions.h"
#include "layout/batches.h"
#include "stores/array.h"

namespace motley {

/// Where a contact lies in its block, how many rows it has, and which bodies it touches.
struct IslandContact {
    const SweepChunk* chunk;  ///< valid for the step
    ReadDirections read;
    float* peak;  ///< largest normal impulse of the step, where restitution asks for it; else null
    std::int32_t rows, block, lane;
    BodyRow body_a, body_b;
    std::int32_t a = -1, b = -1;  ///< their numbers in the island; -1: a body that does not move

    /// Of its first row; those of the other rows follow at a distance of block_lanes.
    [[nodiscard]] float* impulses() const
    {
        const std::int64_t floats = std::int64_t{chunk->kernels->impulse_floats} * block_lanes;
        return chunk->streams.impulses + floats * block + lane;
    }
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
    /// What sweeps have done to the impulses since the last solve is taken back. With `relaxes` penetration asks for no
    /// speed. Returns the residual that is left, m/s.
    double solve(const KernelContext& context, bool relaxes);

  private:
    /// m/s: smaller speeds and residuals are rounding.
    static constexpr double rounding_speed = 1e-6;
    /// m: so much of a gap or of a penetration asks for no speed. Separations are rounded in float, and bodies wander by
    /// what solves leave over.
    static constexpr double rounding_separation = 2e-6;

    enum class State : std::uint8_t {
        apart,
        gives_way,  ///< pushes as hard as its surface may (contact_surface.h)
        slides,     ///< pushes; friction is at its bound, or there is none
        sticks
    };
    struct Row {
        double of_a[size], of_b[size];  ///< J of each body
        double a[size], b[size];        ///< W^T J^T of each body
        double response;                ///< K
        double lambda, aim;
        double start;  ///< J v before this solve
    };
    struct Contact {
        std::int32_t a, b, first_row, rows;
        std::int32_t block;  ///< of the pair in the factor; -1 if one of them does not move
        bool a_is_later;     ///< in the order of elimination
        double separation;   ///< m, when the step began
        double friction;
        double most_force, most;  ///< N and N s, along the normal
        double surface_speed[2];  ///< of a's surface along the tangents, m/s
    };
    struct Body {
        BodyRow row;
        float inverse_mass = 0, inverse_inertia[6] = {};  ///< as the rows were made of them
        double linear = 0;                                ///< square root of 1/m
        double angular[6] = {};  ///< lower triangle of the root of I^-1: xx, yx, yy, zx, zy, zz
        double velocity[size] = {}, moved[size] = {};  ///< moved: since the step began, to first order
    };
    /// A body that no impulse moves, such as a closing door, and what it adds to the speeds of a contact.
    struct Carrier {
        std::int32_t contact;
        BodyRow body;
        bool is_a;
        ContactDirections directions;
    };
    struct Residual {
        double energy = 0, speed = 0;  ///< J, and m/s
    };
    Array<Body> bodies_;
    Array<IslandContact> places_;
    Array<Contact> contacts_;
    Array<Carrier> carriers_;
    Array<Row> rows_;
    Array<double> impulses_;            ///< by row, as they were stored last
    Array<double> speeds_;              ///< by row: J v
    Array<double> predicted_, change_;  ///< by row: J v and the change of lambda by a step
    Array<double> best_;                ///< by row: the best lambda that was tried
    Array<double> s_, step_;            ///< `size` numbers a body: dv = W s; and the next change of s
    Array<State> guess_, factored_;     ///< the present guess, and that of the matrix
    bool is_sparse_ = false;
    bool has_rows_ = false;
    bool has_guess_ = false;  ///< guess_ solved these contacts
    bool has_factor_ = false;
    Array<BodyEdge> edges_;
    Elimination order_;
    BlockFactor<size> factor_;

    static std::size_t as_index(std::int32_t i) { return static_cast<std::size_t>(i); }
    static double product(const double* a, const double* b)
    {
        double sum = 0;
        for (int i = 0; i < size; ++i) sum += a[i] * b[i];
        return sum;
    }

    // contact_island_rows.cpp: from bodies and blocks, and back.
    bool load_bodies(const KernelContext& context);
    void load_rows();
    double load_speeds(const KernelContext& context, bool relaxes);
    void take_back(std::size_t contact);
    void store(const KernelContext& context);

    [[nodiscard]] Row* rows_of(const Contact& contact);
    [[nodiscard]] const Row* rows_of(const Contact& contact) const;
    [[nodiscard]] double along(const Contact& contact, const Row& row, const Array<double>& s) const;
    void add_across(const Contact& contact, const Row& row, double times, Array<double>& s) const;
    [[nodiscard]] double speed(const Contact& contact, const Row& row) const;
    void refresh_speeds();
    /// Gives a row another impulse, and the bodies what follows.
    void set(const Contact& contact, Row& row, double lambda);
    void sweep();
    [[nodiscard]] Residual measure();
    [[nodiscard]] State guess_of(const Contact& contact) const;
    template <class Visit>
    void for_each_active(const Visit& visit);
    bool release();
    bool hold_in_cone(const Contact& contact);
    void factor();
    void find_step();
    bool mend_guess();
    void begin_to_slide(const Contact& contact);
    [[nodiscard]] State mended(std::size_t contact) const;
    void apply_step();
    Residual improve(Residual left, double tolerance);
};

}  // namespace motley
