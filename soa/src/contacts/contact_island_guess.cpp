// Which contacts of an island push and which of them stick: the first guess, and how a solve mends it. See contact_island.h.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "contacts/contact_island.h"
#include "contacts/friction_impulse.h"

namespace motley {

/// From impulses and refreshed speeds. What begins to touch sticks, until its slip is known.
template <int size>
auto ContactIsland<size>::guess_of(const Contact& contact) const -> State
{
    const Row* rows = rows_of(contact);
    const double* speeds = &speeds_[as_index(contact.first_row)];
    if (rows[0].response <= 0) return State::apart;
    const double normal = rows[0].lambda + (rows[0].aim - speeds[0]) / rows[0].response;
    if (normal < -rounding_speed / rows[0].response) return State::apart;
    if (normal > contact.most) return State::gives_way;
    if (contact.rows < 2 || contact.friction <= 0) return State::slides;
    if (rows[0].lambda <= 0) return State::sticks;
    const auto step = [&](int k) {
        if (k >= contact.rows) return 0.0;
        return rows[k].response > 0 ? rows[k].lambda - (speeds[k] - rows[k].aim) / rows[k].response : 0;
    };
    const double bound = contact.friction * std::max(normal, rows[0].lambda);
    return FrictionImpulse{step(1), step(2)}.length() <= bound ? State::sticks : State::slides;
}

/// What the impulses and speeds that a step leads to say of a contact.
template <int size>
auto ContactIsland<size>::mended(std::size_t i) const -> State
{
    const Contact& contact = contacts_[i];
    const Row* rows = rows_of(contact);
    const std::size_t first = as_index(contact.first_row);
    if (rows[0].response <= 0) return State::apart;
    const double opening = predicted_[first] - rows[0].aim;
    const State touching = contact.rows > 1 && contact.friction > 0 ? State::sticks : State::slides;
    if (guess_[i] == State::apart) return opening < -rounding_speed ? touching : State::apart;
    if (guess_[i] == State::gives_way) return opening > rounding_speed ? touching : State::gives_way;
    const double rounding = rounding_speed / rows[0].response;
    const double normal = rows[0].lambda + change_[first];
    if (normal < -rounding) return State::apart;
    if (normal > contact.most + rounding) return State::gives_way;
    if (touching == State::slides) return State::slides;
    if (guess_[i] == State::slides) {
        // Friction that pushes along the slip must have stopped it.
        double along_slip = 0, squares = 0;
        for (int k = 1; k < contact.rows; ++k) {
            along_slip += rows[k].lambda * (predicted_[first + as_index(k)] - rows[k].aim);
            squares += rows[k].lambda * rows[k].lambda;
        }
        return along_slip > rounding_speed * std::sqrt(squares) ? State::sticks : State::slides;
    }
    const FrictionImpulse pull{rows[1].lambda + change_[first + 1],
                               contact.rows > 2 ? rows[2].lambda + change_[first + 2] : 0};
    return pull.length() > contact.friction * std::max(normal, 0.0) + rounding ? State::slides
                                                                               : State::sticks;
}

/// Friction that had to be more than it can be is at its bound from now on, in its direction.
template <int size>
void ContactIsland<size>::begin_to_slide(const Contact& contact)
{
    Row* rows = rows_of(contact);
    double* change = &change_[as_index(contact.first_row)];
    const FrictionImpulse pull{rows[1].lambda + change[1], contact.rows > 2 ? rows[2].lambda + change[2] : 0};
    const FrictionImpulse held = pull.within(contact.friction * std::max(rows[0].lambda + change[0], 0.0));
    set(contact, rows[1], held.x);
    change[1] = 0;
    if (contact.rows < 3) return;
    set(contact, rows[2], held.y);
    change[2] = 0;
}

/// Returns whether anything in the guess had to be mended.
template <int size>
bool ContactIsland<size>::mend_guess()
{
    bool any = false;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const State state = mended(i);
        if (guess_[i] == State::sticks && state == State::slides) begin_to_slide(contacts_[i]);
        any = any || state != guess_[i];
        guess_[i] = state;
    }
    return any;
}

template class ContactIsland<3>;
template class ContactIsland<6>;

}  // namespace motley
