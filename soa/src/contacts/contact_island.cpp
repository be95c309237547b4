// See contact_island.h.
#include "contacts/contact_island.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace motley {
namespace {

constexpr double rho = 1e5;
/// m/s: speeds below it are rounding.
constexpr double touching_speed = 1e-6;
/// Repeated solves with one matrix, guesses between two sweeps, and sweeps of one solve.
constexpr int most_repeats = 4, most_guesses = 4, most_rounds = 4;
/// What a body may turn its inertia, relative, before rows are made anew.
constexpr double turned_inertia = 1e-5;

std::size_t as_index(std::int32_t i)
{
    return static_cast<std::size_t>(i);
}

template <int size>
double product(const double* a, const double* b)
{
    double sum = 0;
    for (int i = 0; i < size; ++i) sum += a[i] * b[i];
    return sum;
}

float* quad_of(float* rows, BodyRow body)
{
    return rows + std::int64_t{4} * quads_of(body.kind()) * body.row();
}

struct Motion {
    Vec3<double> linear, angular;
};
Vec3<double> vector_at(const float* quad)
{
    return {static_cast<double>(quad[0]), static_cast<double>(quad[1]), static_cast<double>(quad[2])};
}
/// The velocity of a body.
Motion velocity_of(const KernelContext& context, BodyRow body)
{
    const float* v = quad_of(context.bodies[static_cast<int>(body.kind())].velocity, body);
    switch (body.kind()) {
        case BodyKind::particle:
            return {vector_at(v), {0, 0, 0}};
        case BodyKind::planar:
            return {{static_cast<double>(v[0]), static_cast<double>(v[1]), 0},
                    {0, 0, static_cast<double>(v[2])}};
        default:
            return {vector_at(v), vector_at(v + 4)};
    }
}
/// How a body has moved since the step began, to first order in its rotation.
Motion displacement_of(const KernelContext& context, BodyRow body)
{
    const float* d = quad_of(context.bodies[static_cast<int>(body.kind())].delta, body);
    switch (body.kind()) {
        case BodyKind::particle:
            return {vector_at(d), {0, 0, 0}};
        case BodyKind::planar:
            return {{static_cast<double>(d[0]), static_cast<double>(d[1]), 0},
                    {0, 0, static_cast<double>(d[2])}};
        default:
            return {vector_at(d), 2.0 * vector_at(d + 4)};
    }
}
ContactDirections directions_of(const IslandContact& place)
{
    const SweepChunk& chunk = *place.chunk;
    const std::int64_t floats = std::int64_t{chunk.kernels->row_floats} * block_lanes;
    return reader_of_contacts(chunk.type, chunk.kind_a,
                              chunk.kind_b)(chunk.streams.rows + floats * place.block + place.lane);
}
float* impulses_of(const IslandContact& place)
{
    const std::int64_t floats = std::int64_t{place.chunk->kernels->impulse_floats} * block_lanes;
    return place.chunk->streams.impulses + floats * place.block + place.lane;
}
double along(const ContactDirection& d, const Motion& a, const Motion& b)
{
    return dot(d.n, b.linear - a.linear) + dot(d.lever_b, b.angular) - dot(d.lever_a, a.angular);
}

/// The lower triangle of L L^T = the inverse inertia; axes that cannot turn give columns of zeros.
void root_of(const float* inertia, double* l)
{
    const auto at = [&](int i) { return static_cast<double>(inertia[i]); };
    const double xx = at(0), xy = at(1), xz = at(2), yy = at(3), yz = at(4), zz = at(5);
    const auto root = [](double square) { return square > 0 ? std::sqrt(square) : 0.0; };
    const auto over = [](double x, double y) { return y > 0 ? x / y : 0.0; };
    l[0] = root(xx);
    l[1] = over(xy, l[0]);
    l[2] = root(yy - l[1] * l[1]);
    l[3] = over(xz, l[0]);
    l[4] = over(yz - l[3] * l[1], l[2]);
    l[5] = root(zz - l[3] * l[3] - l[4] * l[4]);
}

}  // namespace

template <int size>
bool ContactIsland<size>::lay_out(std::span<const BodyRow> bodies, std::span<const IslandContact> contacts,
                                  std::int64_t most_products)
{
    const bool is_known = std::equal(places_.begin(), places_.end(), contacts.begin(), contacts.end(),
                                     [](const IslandContact& x, const IslandContact& y) {
                                         return x.a == y.a && x.b == y.b && x.rows == y.rows;
                                     });
    has_guess_ = has_guess_ && is_known;
    bodies_.clear();
    for (const BodyRow body : bodies) bodies_.push_back({body, -1, {}});
    places_.assign(contacts.begin(), contacts.end());
    if (!is_known) {
        edges_.clear();
        for (const IslandContact& contact : contacts) {
            if (contact.a >= 0 && contact.b >= 0) edges_.push_back({contact.a, contact.b});
        }
        is_sparse_ = order_.find(static_cast<std::int32_t>(bodies.size()), edges_, most_products);
        if (is_sparse_) factor_.make_room(order_);
    }
    if (!is_sparse_) return false;
    std::size_t rows = 0;
    for (const IslandContact& contact : contacts) rows += static_cast<std::size_t>(contact.rows);
    contacts_.resize(contacts.size());
    directions_.resize(contacts.size());
    guess_.resize(contacts.size());
    factored_.resize(contacts.size());
    rows_.resize(rows);
    for (std::vector<double>* numbers : {&impulses_, &kept_, &best_, &change_}) numbers->resize(rows);
    s_.resize(bodies.size() * size);
    step_.resize(bodies.size() * size);
    std::int32_t first_row = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const IslandContact& place = contacts[i];
        Contact& contact = contacts_[i] = {place.a, place.b, first_row, place.rows, -1, false, 0};
        first_row += place.rows;
        if (place.a < 0 || place.b < 0) continue;
        const std::int32_t a = order_.place_of(place.a), b = order_.place_of(place.b);
        contact.a_is_later = a > b;
        contact.block = order_.find_block(std::min(a, b), std::max(a, b));
    }
    return true;
}

template <int size>
void ContactIsland<size>::begin()
{
    has_rows_ = has_factor_ = false;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        directions_[i] = directions_of(places_[i]);
        contacts_[i].friction = directions_[i].friction;
        for (int k = 0; k < contacts_[i].rows; ++k)
            impulses_[as_index(contacts_[i].first_row + k)] =
                static_cast<double>(impulses_of(places_[i])[k * block_lanes]);
    }
}

/// Reads masses. Returns whether an inertia has turned too far for the rows there are.
template <int size>
bool ContactIsland<size>::load_bodies(const KernelContext& context)
{
    bool turned = !has_rows_;
    for (Body& body : bodies_) {
        const BodyArrays& arrays = context.bodies[static_cast<int>(body.row.kind())];
        const float* v = quad_of(arrays.velocity, body.row);
        Body now{body.row, std::sqrt(static_cast<double>(v[3])), {}};
        if (body.row.kind() == BodyKind::planar) {
            now.angular[5] = std::sqrt(static_cast<double>(quad_of(arrays.delta, body.row)[3]));
        } else if (body.row.kind() == BodyKind::rigid) {
            root_of(arrays.world_inverse_inertia + std::int64_t{8} * body.row.row(), now.angular);
        }
        const double scale = now.angular[0] + now.angular[2] + now.angular[5];
        bool own = now.linear != body.linear;
        for (int i = 0; i < 6; ++i)
            own = own || std::abs(now.angular[i] - body.angular[i]) > turned_inertia * scale;
        if (own) {
            body = now;
            turned = true;
        }
    }
    return turned;
}

template <int size>
void ContactIsland<size>::load_rows()
{
    const auto scaled = [&](std::int32_t i, const ContactDirection& d, const Vec3<double>& lever, double sign,
                            double* j) {
        std::fill(j, j + size, 0.0);
        if (i < 0) return;
        const Body& body = bodies_[as_index(i)];
        const double push = sign * body.linear;
        const double* l = body.angular;
        const Vec3<double> turn{sign * (l[0] * lever.x + l[1] * lever.y + l[3] * lever.z),
                                sign * (l[2] * lever.y + l[4] * lever.z), sign * (l[5] * lever.z)};
        j[0] = push * d.n.x;
        j[1] = push * d.n.y;
        if constexpr (size == 3) {
            j[2] = body.row.kind() == BodyKind::planar ? turn.z : push * d.n.z;
        } else {
            if (body.row.kind() != BodyKind::planar) j[2] = push * d.n.z;
            j[3] = turn.x;
            j[4] = turn.y;
            j[5] = turn.z;
        }
    };
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& contact = contacts_[i];
        for (int k = 0; k < contact.rows; ++k) {
            const ContactDirection& d = directions_[i].of[k];
            Row& row = rows_[as_index(contact.first_row + k)];
            scaled(contact.a, d, d.lever_a, -1, row.a);
            scaled(contact.b, d, d.lever_b, 1, row.b);
            row.response = product<size>(row.a, row.a) + product<size>(row.b, row.b);
        }
    }
    has_rows_ = true;
    has_factor_ = false;
}

/// Reads velocities, and what speed each row wants.
template <int size>
void ContactIsland<size>::load_speeds(const KernelContext& context, bool relaxes)
{
    const StepConstants& step = context.step;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const IslandContact& place = places_[i];
        const SweepChunk& chunk = *place.chunk;
        const BlockBodies& bodies = chunk.streams.bodies[place.block];
        const auto row_of = [&](BodyKind kind, std::int32_t offset) {
            return BodyRow(kind, static_cast<std::uint32_t>(offset / offsets_a_row(kind)));
        };
        const BodyRow a = row_of(chunk.kind_a, bodies.a[place.lane]),
                      b = row_of(chunk.kind_b, bodies.b[place.lane]);
        const ContactDirections& all = directions_[i];
        const Motion va = velocity_of(context, a), vb = velocity_of(context, b);
        for (int k = 0; k < all.count; ++k) {
            Row& row = rows_[as_index(contacts_[i].first_row + k)];
            row.start = along(all.of[k], va, vb);
            row.aim = 0;
        }
        const double separation =
            all.separation + along(all.of[0], displacement_of(context, a), displacement_of(context, b));
        const bool on_fixed = place.a < 0 || place.b < 0;
        Row& normal = rows_[as_index(contacts_[i].first_row)];
        if (separation > 0) {
            normal.aim = -separation * static_cast<double>(step.inverse_substep);
        } else if (!relaxes) {
            const Softness& soft = on_fixed ? step.static_contact : step.contact;
            normal.aim = std::min(
                -static_cast<double>(soft.rate) * std::min(separation + static_cast<double>(step.slop), 0.0),
                static_cast<double>(step.push_out_speed));
        }
    }
    for (Row& row : rows_) {
        if (std::abs(row.aim) < touching_speed) row.aim = 0;
    }
    // A sweep may have changed impulses and velocities since. That is taken back.
    std::fill(s_.begin(), s_.end(), 0.0);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const float* impulses = impulses_of(places_[i]);
        for (int k = 0; k < contacts_[i].rows; ++k) {
            const auto r = as_index(contacts_[i].first_row + k);
            push(contacts_[i], rows_[r], impulses_[r] - static_cast<double>(impulses[k * block_lanes]));
            rows_[r].lambda = impulses_[r];
        }
    }
}

template <int size>
void ContactIsland<size>::store(const KernelContext& context)
{
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const IslandContact& place = places_[i];
        float* impulses = impulses_of(place);
        const Contact& contact = contacts_[i];
        for (int k = 0; k < contact.rows; ++k) {
            const auto r = as_index(contact.first_row + k);
            impulses[k * block_lanes] = static_cast<float>(rows_[r].lambda);
            impulses_[r] = static_cast<double>(impulses[k * block_lanes]);
        }
        if (static_cast<Touch>(place.chunk->type) == Touch::bouncing) {
            float& peak = impulses[contact.rows * block_lanes];
            peak = std::max(peak, impulses[0]);
        }
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Body& body = bodies_[i];
        const double* s = s_.data() + i * size;
        const double* l = body.angular;
        float* v = quad_of(context.bodies[static_cast<int>(body.row.kind())].velocity, body.row);
        const auto change = [](float& x, double by) { x = static_cast<float>(static_cast<double>(x) + by); };
        change(v[0], body.linear * s[0]);
        change(v[1], body.linear * s[1]);
        if (body.row.kind() == BodyKind::planar) {
            change(v[2], l[5] * s[size - 1]);
            continue;
        }
        change(v[2], body.linear * s[2]);
        if constexpr (size == 6) {
            if (body.row.kind() != BodyKind::rigid) continue;
            change(v[4], l[0] * s[3]);
            change(v[5], l[1] * s[3] + l[2] * s[4]);
            change(v[6], l[3] * s[3] + l[4] * s[4] + l[5] * s[5]);
        }
    }
}

template <int size>
double ContactIsland<size>::speed(const Contact& contact, const Row& row) const
{
    double sum = row.start;
    if (contact.a >= 0) sum += product<size>(row.a, s_.data() + std::int64_t{contact.a} * size);
    if (contact.b >= 0) sum += product<size>(row.b, s_.data() + std::int64_t{contact.b} * size);
    return sum;
}

template <int size>
void ContactIsland<size>::push(const Contact& contact, const Row& row, double impulse)
{
    const auto add = [&](std::int32_t body, const double* j) {
        double* s = s_.data() + std::int64_t{body} * size;
        for (int i = 0; i < size; ++i) s[i] += j[i] * impulse;
    };
    if (contact.a >= 0) add(contact.a, row.a);
    if (contact.b >= 0) add(contact.b, row.b);
}

namespace {

/// The impulses of friction after a sweep's step on a contact, shortened to `bound`. `stride` is 1 / K of the row that
/// responds most: see bounded_impulse.h.
struct Friction {
    double x = 0, y = 0;
    [[nodiscard]] double length() const { return std::sqrt(x * x + y * y); }
    [[nodiscard]] Friction within(double bound) const
    {
        const double l = length();
        return l > bound ? Friction{x * (bound / l), y * (bound / l)} : *this;
    }
};

}  // namespace

/// One sweep over rigid contacts, friction first.
template <int size>
void ContactIsland<size>::sweep()
{
    for (const Contact& contact : contacts_) {
        Row* rows = &rows_[as_index(contact.first_row)];
        if (contact.rows > 1) {
            const double bound = contact.friction * rows[0].lambda;
            const double most =
                contact.rows > 2 ? std::max(rows[1].response, rows[2].response) : rows[1].response;
            Friction free, cautious;
            const double slip[2] = {speed(contact, rows[1]), contact.rows > 2 ? speed(contact, rows[2]) : 0};
            const auto step = [&](int k, double response) {
                return response > 0 ? rows[k].lambda - slip[k - 1] / response : rows[k].lambda;
            };
            free.x = step(1, rows[1].response);
            cautious.x = step(1, most);
            if (contact.rows > 2) {
                free.y = step(2, rows[2].response);
                cautious.y = step(2, most);
            }
            const Friction next = free.length() > bound ? cautious.within(bound) : free;
            push(contact, rows[1], next.x - rows[1].lambda);
            rows[1].lambda = next.x;
            if (contact.rows > 2) {
                push(contact, rows[2], next.y - rows[2].lambda);
                rows[2].lambda = next.y;
            }
        }
        if (rows[0].response <= 0) continue;
        const double wanted =
            std::max(rows[0].lambda - (speed(contact, rows[0]) - rows[0].aim) / rows[0].response, 0.0);
        push(contact, rows[0], wanted - rows[0].lambda);
        rows[0].lambda = wanted;
    }
}

template <int size>
typename ContactIsland<size>::State ContactIsland<size>::guess_of(const Contact& contact) const
{
    const Row* rows = &rows_[as_index(contact.first_row)];
    if (rows[0].response <= 0) return State::apart;
    const double closing = rows[0].aim - speed(contact, rows[0]);
    const double normal = rows[0].lambda + closing / rows[0].response;
    if (normal < -touching_speed / rows[0].response) return State::apart;
    if (contact.rows < 2 || contact.friction <= 0) return State::slides;
    if (rows[0].lambda <= 0) return State::sticks;  // it begins to touch: nothing is known of its slip yet
    Friction free;
    free.x = rows[1].response > 0 ? rows[1].lambda - speed(contact, rows[1]) / rows[1].response : 0;
    if (contact.rows > 2 && rows[2].response > 0)
        free.y = rows[2].lambda - speed(contact, rows[2]) / rows[2].response;
    return free.length() <= contact.friction * std::max(normal, rows[0].lambda) ? State::sticks
                                                                                : State::slides;
}

template <int size>
void ContactIsland<size>::factor(IslandResult& result)
{
    if (has_factor_ && factored_ == guess_) return;
    factor_.begin();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (guess_[i] == State::apart) continue;
        const Contact& contact = contacts_[i];
        const int active = guess_[i] == State::sticks ? contact.rows : 1;
        for (int k = 0; k < active; ++k) {
            const Row& row = rows_[as_index(contact.first_row + k)];
            if (row.response <= 0) continue;
            const double weight = rho / row.response;
            if (contact.a >= 0) factor_.add(contact.a, row.a, weight);
            if (contact.b >= 0) factor_.add(contact.b, row.b, weight);
            if (contact.block >= 0) {
                if (contact.a_is_later) {
                    factor_.add_between(contact.block, row.a, row.b, weight);
                } else {
                    factor_.add_between(contact.block, row.b, row.a, weight);
                }
            }
        }
    }
    factor_.factor(order_);
    std::copy(guess_.begin(), guess_.end(), factored_.begin());
    has_factor_ = true;
    ++result.factors;
}

/// The change of s and of the impulses that solves the rows of the guess.
template <int size>
void ContactIsland<size>::find_step()
{
    std::fill(step_.begin(), step_.end(), 0.0);
    std::fill(change_.begin(), change_.end(), 0.0);
    const auto for_each_active = [&](const auto& visit) {
        for (std::size_t i = 0; i < contacts_.size(); ++i) {
            if (guess_[i] == State::apart) continue;
            const Contact& contact = contacts_[i];
            const int active = guess_[i] == State::sticks ? contact.rows : 1;
            for (std::int32_t r = contact.first_row; r < contact.first_row + active; ++r) {
                if (rows_[as_index(r)].response > 0) visit(contact, r, rows_[as_index(r)]);
            }
        }
    };
    for_each_active([&](const Contact& contact, std::int32_t, const Row& row) {
        const double pull = -rho / row.response * (speed(contact, row) - row.aim);
        const auto add = [&](std::int32_t body, const double* j) {
            double* x = step_.data() + std::int64_t{body} * size;
            for (int i = 0; i < size; ++i) x[i] += j[i] * pull;
        };
        if (contact.a >= 0) add(contact.a, row.a);
        if (contact.b >= 0) add(contact.b, row.b);
    });
    factor_.solve(order_, step_);
    for_each_active([&](const Contact& contact, std::int32_t r, const Row& row) {
        double left = speed(contact, row) - row.aim;
        if (contact.a >= 0) left += product<size>(row.a, step_.data() + std::int64_t{contact.a} * size);
        if (contact.b >= 0) left += product<size>(row.b, step_.data() + std::int64_t{contact.b} * size);
        change_[as_index(r)] = -rho / row.response * left;
    });
}

/// Mends the guess by the impulses and speeds that the step predicts. Returns whether anything had to be mended.
template <int size>
bool ContactIsland<size>::mend_guess()
{
    bool mended = false;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& contact = contacts_[i];
        const Row* rows = &rows_[as_index(contact.first_row)];
        if (rows[0].response <= 0) continue;
        const auto predicted = [&](const Row& row) {
            double u = speed(contact, row);
            if (contact.a >= 0) u += product<size>(row.a, step_.data() + std::int64_t{contact.a} * size);
            if (contact.b >= 0) u += product<size>(row.b, step_.data() + std::int64_t{contact.b} * size);
            return u;
        };
        const auto after = [&](int k) { return rows[k].lambda + change_[as_index(contact.first_row + k)]; };
        State state = guess_[i];
        if (state == State::apart) {
            if (predicted(rows[0]) < rows[0].aim - touching_speed) state = State::sticks;
        } else if (after(0) < -touching_speed / rows[0].response) {
            state = State::apart;
        } else if (contact.rows > 1 && state == State::sticks) {
            const Friction pull{after(1), contact.rows > 2 ? after(2) : 0};
            const double rounding = touching_speed / rows[0].response;
            if (pull.length() > contact.friction * std::max(after(0), 0.0) + rounding) state = State::slides;
        }
        if (state == State::sticks && (contact.rows < 2 || contact.friction <= 0)) state = State::slides;
        mended = mended || state != guess_[i];
        guess_[i] = state;
    }
    return mended;
}

/// Gives the impulses `share` of their change from kept_, within their bounds, and the velocities what follows.
template <int size>
void ContactIsland<size>::apply(double share)
{
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& contact = contacts_[i];
        Row* rows = &rows_[as_index(contact.first_row)];
        const auto wanted = [&](int k) {
            const std::size_t r = as_index(contact.first_row + k);
            return kept_[r] + share * change_[r];
        };
        const double before = kept_[as_index(contact.first_row)];
        const double normal = std::max(wanted(0), 0.0);
        push(contact, rows[0], normal - rows[0].lambda);
        rows[0].lambda = normal;
        if (contact.rows < 2) continue;
        Friction pull{wanted(1), contact.rows > 2 ? wanted(2) : 0};
        const double bound = contact.friction * normal;
        // What slides follows the normal impulse.
        if (guess_[i] == State::slides && before > 0) {
            const double l = pull.length();
            const double most = contact.friction * before;
            if (l > 0.999 * most && l > 0) pull = {pull.x * (bound / l), pull.y * (bound / l)};
        }
        pull = pull.within(bound);
        push(contact, rows[1], pull.x - rows[1].lambda);
        rows[1].lambda = pull.x;
        if (contact.rows > 2) {
            push(contact, rows[2], pull.y - rows[2].lambda);
            rows[2].lambda = pull.y;
        }
    }
}

/// What one more sweep would change, each contact by itself.
template <int size>
typename ContactIsland<size>::Residual ContactIsland<size>::residual() const
{
    Residual all;
    const auto add = [&](double change, double response) {
        all.energy += change * change * response;
        all.speed = std::max(all.speed, std::abs(change) * response);
    };
    for (const Contact& contact : contacts_) {
        const Row* rows = &rows_[as_index(contact.first_row)];
        if (rows[0].response <= 0) continue;
        const double normal =
            std::max(rows[0].lambda - (speed(contact, rows[0]) - rows[0].aim) / rows[0].response, 0.0);
        add(normal - rows[0].lambda, rows[0].response);
        if (contact.rows < 2) continue;
        const double most =
            contact.rows > 2 ? std::max(rows[1].response, rows[2].response) : rows[1].response;
        if (most <= 0) continue;
        Friction next{rows[1].lambda - speed(contact, rows[1]) / most,
                      contact.rows > 2 ? rows[2].lambda - speed(contact, rows[2]) / most : 0};
        next = next.within(contact.friction * rows[0].lambda);
        add(next.x - rows[1].lambda, most);
        if (contact.rows > 2) add(next.y - rows[2].lambda, most);
    }
    return all;
}

/// Solves for one guess after another, mending the guess, and keeps the best of them if it is better than what there
/// is. The first guess is the last one of the solve before, where that knew the same contacts.
template <int size>
void ContactIsland<size>::improve(double tolerance, IslandResult& result)
{
    for (std::size_t r = 0; r < rows_.size(); ++r) kept_[r] = rows_[r].lambda;
    std::copy(kept_.begin(), kept_.end(), best_.begin());
    double least = residual().energy;
    if (!has_guess_) {
        for (std::size_t i = 0; i < contacts_.size(); ++i) guess_[i] = guess_of(contacts_[i]);
    }
    has_guess_ = false;
    for (int guesses = 0; guesses < most_guesses; ++guesses) {
        factor(result);
        bool mended = false;
        double last = HUGE_VAL;
        for (int repeat = 0; repeat < most_repeats && !has_guess_ && !mended; ++repeat) {
            find_step();
            mended = mend_guess();
            if (mended && guesses + 1 < most_guesses) break;
            for (std::size_t r = 0; r < rows_.size(); ++r) kept_[r] = rows_[r].lambda;
            apply(1);
            const Residual left = residual();
            has_guess_ = left.speed <= tolerance;
            if (left.energy < least) {
                least = left.energy;
                for (std::size_t r = 0; r < rows_.size(); ++r) best_[r] = rows_[r].lambda;
            }
            if (left.energy > 0.5 * last) break;
            last = left.energy;
        }
        if (has_guess_ || !mended) break;
    }
    for (const Contact& contact : contacts_) {
        for (std::int32_t r = contact.first_row; r < contact.first_row + contact.rows; ++r) {
            Row& row = rows_[as_index(r)];
            push(contact, row, best_[as_index(r)] - row.lambda);
            row.lambda = best_[as_index(r)];
        }
    }
}

template <int size>
IslandResult ContactIsland<size>::solve(const KernelContext& context, bool relaxes)
{
    IslandResult result;
    if (load_bodies(context)) load_rows();
    load_speeds(context, relaxes);
    double scale = 1;
    for (const Row& row : rows_) scale = std::max(scale, std::abs(row.start));
    const double tolerance = touching_speed * scale;
    result.residual = residual().speed;
    for (int round = 0; round < most_rounds && result.residual > tolerance; ++round) {
        if (round > 0) sweep();
        improve(tolerance, result);
        result.residual = residual().speed;
    }
    store(context);
    return result;
}

template class ContactIsland<3>;
template class ContactIsland<6>;

}  // namespace motley
