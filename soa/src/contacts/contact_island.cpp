// See contact_island.h.
#include "contacts/contact_island.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "contacts/friction_impulse.h"
#include "stores/array.h"

namespace motley {
namespace {

constexpr double rho = 1e5;
/// The residual that is good enough, m/s for each m/s of the contacts, which are taken to be 1 m/s fast at least.
constexpr double good_enough = 2e-6;
/// Residuals below so many times that are swept first, and how often.
constexpr double nearly = 5;
constexpr int most_sweeps = 3;
/// Another solve with the same matrix is worth while if the last one left at most this share of the residual, J.
constexpr double worth_while = 0.8;
/// Solves with one matrix, guesses between two sweeps, and sweeps.
constexpr int most_repeats = 8, most_guesses = 4, most_rounds = 12;

}  // namespace

template <int size>
auto ContactIsland<size>::rows_of(const Contact& contact) -> Row*
{
    return &rows_[as_index(contact.first_row)];
}
template <int size>
auto ContactIsland<size>::rows_of(const Contact& contact) const -> const Row*
{
    return &rows_[as_index(contact.first_row)];
}

/// j s of a row, for numbers s of the bodies.
template <int size>
double ContactIsland<size>::along(const Contact& contact, const Row& row, const Array<double>& s) const
{
    double sum = 0;
    if (contact.a >= 0) sum += product(row.a, s.data() + std::int64_t{contact.a} * size);
    if (contact.b >= 0) sum += product(row.b, s.data() + std::int64_t{contact.b} * size);
    return sum;
}

/// s += j^T times a number.
template <int size>
void ContactIsland<size>::add_across(const Contact& contact, const Row& row, double times,
                                     Array<double>& s) const
{
    const auto add = [&](std::int32_t body, const double* j) {
        double* x = s.data() + std::int64_t{body} * size;
        for (int i = 0; i < size; ++i) x[i] += j[i] * times;
    };
    if (contact.a >= 0) add(contact.a, row.a);
    if (contact.b >= 0) add(contact.b, row.b);
}

template <int size>
double ContactIsland<size>::speed(const Contact& contact, const Row& row) const
{
    return row.start + along(contact, row, s_);
}

template <int size>
void ContactIsland<size>::refresh_speeds()
{
    for (const Contact& contact : contacts_) {
        for (std::int32_t r = contact.first_row; r < contact.first_row + contact.rows; ++r)
            speeds_[as_index(r)] = speed(contact, rows_[as_index(r)]);
    }
}

template <int size>
void ContactIsland<size>::set(const Contact& contact, Row& row, double lambda)
{
    add_across(contact, row, lambda - row.lambda, s_);
    row.lambda = lambda;
}

/// One sweep over rigid contacts, friction first: see bounded_impulse.h.
template <int size>
void ContactIsland<size>::sweep()
{
    for (const Contact& contact : contacts_) {
        Row* rows = rows_of(contact);
        if (contact.rows > 1) {
            double most = 0;
            for (int k = 1; k < contact.rows; ++k) most = std::max(most, rows[k].response);
            const auto step = [&](int k, double response) {
                if (k >= contact.rows) return 0.0;
                const double slip = speed(contact, rows[k]) - rows[k].aim;
                return response > 0 ? rows[k].lambda - slip / response : rows[k].lambda;
            };
            const double bound = contact.friction * rows[0].lambda;
            const FrictionImpulse free{step(1, rows[1].response), step(2, rows[contact.rows - 1].response)};
            const FrictionImpulse next =
                free.length() > bound ? FrictionImpulse{step(1, most), step(2, most)}.within(bound) : free;
            set(contact, rows[1], next.x);
            if (contact.rows > 2) set(contact, rows[2], next.y);
        }
        if (rows[0].response <= 0) continue;
        const double wanted = rows[0].lambda - (speed(contact, rows[0]) - rows[0].aim) / rows[0].response;
        set(contact, rows[0], std::clamp(wanted, 0.0, contact.most));
    }
}

/// Refreshes the speeds, and returns what one more sweep would change, each contact by itself.
template <int size>
auto ContactIsland<size>::measure() -> Residual
{
    refresh_speeds();
    Residual all;
    const auto add = [&](double change, double response) {
        all.energy += change * change * response;
        all.speed = std::max(all.speed, std::abs(change) * response);
    };
    for (const Contact& contact : contacts_) {
        const Row* rows = rows_of(contact);
        const double* speeds = &speeds_[as_index(contact.first_row)];
        if (rows[0].response <= 0) continue;
        const double normal = rows[0].lambda - (speeds[0] - rows[0].aim) / rows[0].response;
        add(std::clamp(normal, 0.0, contact.most) - rows[0].lambda, rows[0].response);
        double most = 0;
        for (int k = 1; k < contact.rows; ++k) most = std::max(most, rows[k].response);
        if (most <= 0) continue;
        const auto step = [&](int k) {
            return k < contact.rows ? rows[k].lambda - (speeds[k] - rows[k].aim) / most : 0;
        };
        const FrictionImpulse next =
            FrictionImpulse{step(1), step(2)}.within(contact.friction * rows[0].lambda);
        add(next.x - rows[1].lambda, most);
        if (contact.rows > 2) add(next.y - rows[2].lambda, most);
    }
    return all;
}

/// Calls visit(contact, number of the row) for the rows that the guess makes equations of.
template <int size>
template <class Visit>
void ContactIsland<size>::for_each_active(const Visit& visit)
{
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (guess_[i] < State::slides) continue;
        const Contact& contact = contacts_[i];
        const int active = guess_[i] == State::sticks ? contact.rows : 1;
        for (std::int32_t r = contact.first_row; r < contact.first_row + active; ++r) {
            if (rows_[as_index(r)].response > 0) visit(contact, as_index(r));
        }
    }
}

/// Gives contacts that are no equations in the guess the impulses that it says. Returns whether any were others.
template <int size>
bool ContactIsland<size>::release()
{
    bool any = false;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& contact = contacts_[i];
        if (guess_[i] >= State::slides) continue;
        Row* rows = rows_of(contact);
        const double normal = guess_[i] == State::gives_way ? contact.most : 0;
        if (rows[0].lambda != normal) {
            set(contact, rows[0], normal);
            any = true;
        }
        any = hold_in_cone(contact) || any;
    }
    return any;
}

/// Shortens friction to what the normal impulse allows. Returns whether it was more.
template <int size>
bool ContactIsland<size>::hold_in_cone(const Contact& contact)
{
    if (contact.rows < 2) return false;
    Row* rows = rows_of(contact);
    const FrictionImpulse old{rows[1].lambda, contact.rows > 2 ? rows[2].lambda : 0};
    if (old.length() <= contact.friction * rows[0].lambda) return false;
    const FrictionImpulse pull = old.scaled_to(contact.friction * rows[0].lambda);
    set(contact, rows[1], pull.x);
    if (contact.rows > 2) set(contact, rows[2], pull.y);
    return true;
}

template <int size>
void ContactIsland<size>::factor()
{
    if (has_factor_ && factored_ == guess_) return;
    factor_.begin();
    for_each_active([&](const Contact& contact, std::size_t r) {
        const Row& row = rows_[r];
        const double weight = rho / row.response;
        if (contact.a >= 0) factor_.add(order_.place_of(contact.a), row.a, weight);
        if (contact.b >= 0) factor_.add(order_.place_of(contact.b), row.b, weight);
        if (contact.block < 0) return;
        if (contact.a_is_later) {
            factor_.add_between(contact.block, row.a, row.b, weight);
        } else {
            factor_.add_between(contact.block, row.b, row.a, weight);
        }
    });
    factor_.factor(order_);
    std::copy(guess_.begin(), guess_.end(), factored_.begin());
    has_factor_ = true;
}

/// The step that solves the equations of the guess, and the speeds that it leads to.
template <int size>
void ContactIsland<size>::find_step()
{
    std::fill(step_.begin(), step_.end(), 0.0);
    std::fill(change_.begin(), change_.end(), 0.0);
    for_each_active([&](const Contact& contact, std::size_t r) {
        const Row& row = rows_[r];
        add_across(contact, row, -rho / row.response * (speeds_[r] - row.aim), step_);
    });
    factor_.solve(order_, step_);
    for (const Contact& contact : contacts_) {
        for (std::int32_t r = contact.first_row; r < contact.first_row + contact.rows; ++r)
            predicted_[as_index(r)] = speeds_[as_index(r)] + along(contact, rows_[as_index(r)], step_);
    }
    for_each_active([&](const Contact&, std::size_t r) {
        change_[r] = -rho / rows_[r].response * (predicted_[r] - rows_[r].aim);
    });
}

/// Changes the impulses by the step, within their bounds.
template <int size>
void ContactIsland<size>::apply_step()
{
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& contact = contacts_[i];
        Row* rows = rows_of(contact);
        const std::size_t first = as_index(contact.first_row);
        const double before = rows[0].lambda;
        const double normal = std::clamp(before + change_[first], 0.0, contact.most);
        set(contact, rows[0], normal);
        if (contact.rows < 2) continue;
        FrictionImpulse pull{rows[1].lambda + change_[first + 1],
                             contact.rows > 2 ? rows[2].lambda + change_[first + 2] : 0};
        const double bound = contact.friction * normal;
        constexpr double at_bound = 0.999;  // it slid before
        const bool slides = guess_[i] == State::slides && before > 0;
        pull = slides && pull.length() > at_bound * contact.friction * before ? pull.scaled_to(bound)
                                                                              : pull.within(bound);
        set(contact, rows[1], pull.x);
        if (contact.rows > 2) set(contact, rows[2], pull.y);
    }
}

/// Solves for one guess after another, mending the guess, and keeps the best impulses. `left` is the residual now;
/// returns that of the best.
template <int size>
auto ContactIsland<size>::improve(Residual left, double tolerance) -> Residual
{
    double least = left.energy;
    const auto keep = [&] {
        for (std::size_t r = 0; r < rows_.size(); ++r) best_[r] = rows_[r].lambda;
    };
    keep();
    if (!has_guess_) {
        for (std::size_t i = 0; i < contacts_.size(); ++i) guess_[i] = guess_of(contacts_[i]);
    }
    has_guess_ = false;
    for (int guesses = 1; guesses <= most_guesses && !has_guess_; ++guesses) {
        const bool was_mended = guesses > 1;
        if (release() || was_mended) refresh_speeds();
        factor();
        bool is_wrong = false;
        double last = HUGE_VAL;
        for (int repeat = 0; repeat < most_repeats && !has_guess_; ++repeat) {
            find_step();
            is_wrong = mend_guess();
            if (is_wrong && guesses < most_guesses) break;
            apply_step();
            left = measure();
            has_guess_ = left.speed <= tolerance;
            if (left.energy < least) {
                least = left.energy;
                keep();
            }
            if (is_wrong || left.energy > worth_while * last) break;
            last = left.energy;
        }
        if (!is_wrong) break;
    }
    bool is_best = true;
    for (const Contact& contact : contacts_) {
        for (std::int32_t r = contact.first_row; r < contact.first_row + contact.rows; ++r) {
            if (rows_[as_index(r)].lambda == best_[as_index(r)]) continue;
            set(contact, rows_[as_index(r)], best_[as_index(r)]);
            is_best = false;
        }
    }
    return is_best ? left : measure();
}

template <int size>
double ContactIsland<size>::solve(const KernelContext& context, bool relaxes)
{
    if (load_bodies(context)) load_rows();
    const double tolerance = good_enough * std::max(1.0, load_speeds(context, relaxes));
    Residual left = measure();
    const auto sweep_once = [&] {
        sweep();
        left = measure();
    };
    // What is nearly solved needs no matrix.
    for (int sweeps = 0; sweeps < most_sweeps && left.speed > tolerance && left.speed < nearly * tolerance;
         ++sweeps)
        sweep_once();
    for (int round = 0; round < most_rounds && left.speed > tolerance; ++round) {
        if (round > 0) sweep_once();
        left = improve(left, tolerance);
    }
    for (const Contact& contact : contacts_) hold_in_cone(contact);
    store(context);
    return left.speed;
}

template class ContactIsland<3>;
template class ContactIsland<6>;

}  // namespace motley
