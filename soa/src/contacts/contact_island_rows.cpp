// How an island reads the rows of contacts and the state of bodies, and writes them back: see contact_island.h.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "contacts/contact_island.h"
#include "stores/array.h"

namespace motley {
namespace {

/// What the inertia of a body may turn, relative, before rows are made anew.
constexpr float turned_inertia = 1e-5F;

float* quad_of(float* rows, BodyRow body)
{
    return rows + std::int64_t{4} * quads_of(body.kind()) * body.row();
}

/// The quads of a body as a motion: `size` numbers as the rows of an island have them. `turn`: what a number of a rotation
/// in space stands for, 1 for a velocity and 2 for a displacement, which is a quaternion.
template <int size>
void read_motion(BodyKind kind, const float* quads, double turn, double* motion)
{
    for (int i = 0; i < 3; ++i) motion[i] = static_cast<double>(quads[i]);
    if constexpr (size == 6) {
        for (int i = 3; i < 6; ++i)
            motion[i] = kind == BodyKind::rigid ? turn * static_cast<double>(quads[i + 1]) : 0;
        if (kind == BodyKind::planar) std::swap(motion[2], motion[5]);
    }
}
/// J of a body with this normal and lever, in the same numbers.
template <int size>
void read_direction(BodyKind kind, const Vec3<double>& n, const Vec3<double>& lever, double sign, double* j)
{
    j[0] = sign * n.x;
    j[1] = sign * n.y;
    j[2] = sign * n.z;
    if constexpr (size == 6) {
        const bool turns = kind == BodyKind::rigid;
        j[3] = turns ? sign * lever.x : 0;
        j[4] = turns ? sign * lever.y : 0;
        j[5] = turns ? sign * lever.z : 0;
    }
    if (kind == BodyKind::planar) {
        if constexpr (size == 6) j[2] = 0;
        j[size - 1] = sign * lever.z;
    }
}
/// How a body that no impulse moves carries the point of a contact along one of its directions: by its velocity or by
/// its displacement, whose rotation in space is the vector of a quaternion (turn = 2).
double carried(const Vec3<double>& n, const Vec3<double>& lever, const float* quads, double turn)
{
    const auto vector_at = [&](int i) {
        return Vec3<double>{static_cast<double>(quads[i]), static_cast<double>(quads[i + 1]),
                            static_cast<double>(quads[i + 2])};
    };
    return dot(n, vector_at(0)) + turn * dot(lever, vector_at(4));
}

ContactDirections directions_of(const IslandContact& place)
{
    return place.read(place.chunk->streams.rows, static_cast<std::size_t>(place.block),
                      static_cast<std::size_t>(place.lane));
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
    places_.clear();  // should memory run out, nothing is known in the next step
    bodies_.clear();
    for (const BodyRow row : bodies) {
        Body body{};
        body.row = row;
        bodies_.push_back(body);
    }
    if (!is_known) {
        edges_.clear();
        for (const IslandContact& contact : contacts) {
            if (contact.a >= 0 && contact.b >= 0) edges_.push_back({contact.a, contact.b});
        }
        is_sparse_ = order_.find(static_cast<std::int32_t>(bodies.size()), edges_, most_products);
        if (is_sparse_) factor_.make_room(order_);
    }
    if (!is_sparse_) {
        places_.assign(contacts.begin(), contacts.end());
        return false;
    }
    carriers_.clear();
    std::size_t rows = 0;
    for (const IslandContact& contact : contacts) rows += static_cast<std::size_t>(contact.rows);
    contacts_.resize(contacts.size());
    guess_.resize(contacts.size());
    factored_.resize(contacts.size());
    rows_.resize(rows);
    for (Array<double>* numbers : {&impulses_, &speeds_, &predicted_, &change_, &best_})
        numbers->resize(rows);
    s_.resize(bodies.size() * size);
    step_.resize(bodies.size() * size);
    places_.assign(contacts.begin(), contacts.end());
    std::int32_t first_row = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const IslandContact& place = contacts[i];
        Contact& contact = contacts_[i] = {};
        contact.a = place.a;
        contact.b = place.b;
        contact.first_row = first_row;
        contact.rows = place.rows;
        contact.block = -1;
        first_row += place.rows;
        if (place.a < 0 || place.b < 0) {
            carriers_.push_back(
                {static_cast<std::int32_t>(i), place.a < 0 ? place.body_a : place.body_b, place.a < 0, {}});
            continue;
        }
        const std::int32_t a = order_.place_of(place.a), b = order_.place_of(place.b);
        contact.a_is_later = a > b;
        contact.block = order_.find_block(std::min(a, b), std::max(a, b));
    }
    return true;
}

template <int size>
void ContactIsland<size>::begin()
{
    has_rows_ = has_factor_ = has_guess_ = false;
    auto carrier = carriers_.begin();
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const IslandContact& place = places_[i];
        Contact& contact = contacts_[i];
        const ContactDirections all = directions_of(place);
        contact.separation = all.separation;
        contact.friction = all.friction;
        contact.most_force = all.most_force;
        std::copy(std::begin(all.surface_speed), std::end(all.surface_speed), contact.surface_speed);
        for (int k = 0; k < contact.rows; ++k) {
            const ContactDirection& d = all.of[k];
            Row& row = rows_[as_index(contact.first_row + k)];
            if (contact.a >= 0) read_direction<size>(place.body_a.kind(), d.n, d.lever_a, -1, row.of_a);
            if (contact.b >= 0) read_direction<size>(place.body_b.kind(), d.n, d.lever_b, 1, row.of_b);
            impulses_[as_index(contact.first_row + k)] =
                static_cast<double>(place.impulses()[k * block_lanes]);
        }
        if (contact.a < 0 || contact.b < 0) (carrier++)->directions = all;
    }
}

/// Reads masses and motions. Returns whether a mass has changed or an inertia has turned too far for the rows there are.
template <int size>
bool ContactIsland<size>::load_bodies(const KernelContext& context)
{
    bool any_changed = false;
    for (Body& body : bodies_) {
        const BodyKind kind = body.row.kind();
        const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
        const float* velocity = quad_of(arrays.velocity, body.row);
        const float* delta = quad_of(arrays.delta, body.row);
        read_motion<size>(kind, velocity, 1, body.velocity);
        read_motion<size>(kind, delta, 2, body.moved);
        bool changed = !has_rows_ || velocity[3] != body.inverse_mass;
        const float* inertia = nullptr;
        if (kind == BodyKind::planar) {
            changed = changed || delta[3] != body.inverse_inertia[5];
        } else if (kind == BodyKind::rigid) {
            inertia = arrays.world_inverse_inertia + std::int64_t{8} * body.row.row();
            const float scale = inertia[0] + inertia[3] + inertia[5];
            for (int i = 0; i < 6; ++i)
                changed = changed || std::abs(inertia[i] - body.inverse_inertia[i]) > turned_inertia * scale;
        }
        if (!changed) continue;
        any_changed = true;
        body.inverse_mass = velocity[3];
        body.linear = std::sqrt(static_cast<double>(body.inverse_mass));
        if (kind == BodyKind::planar) {
            body.inverse_inertia[5] = delta[3];
            body.angular[5] = std::sqrt(static_cast<double>(delta[3]));
        } else if (kind == BodyKind::rigid) {
            std::copy(inertia, inertia + 6, body.inverse_inertia);
            root_of(inertia, body.angular);
        }
    }
    return any_changed;
}

template <int size>
void ContactIsland<size>::load_rows()
{
    const auto scaled = [&](std::int32_t i, const double* of, double* j) {
        std::fill(j, j + size, 0.0);
        if (i < 0) return;
        const Body& body = bodies_[as_index(i)];
        const double* l = body.angular;
        for (int k = 0; k < 3; ++k) j[k] = body.linear * of[k];
        if constexpr (size == 6) {
            j[3] = l[0] * of[3] + l[1] * of[4] + l[3] * of[5];
            j[4] = l[2] * of[4] + l[4] * of[5];
        }
        if (size == 6 || body.row.kind() == BodyKind::planar) j[size - 1] = l[5] * of[size - 1];
    };
    for (const Contact& contact : contacts_) {
        for (std::int32_t r = contact.first_row; r < contact.first_row + contact.rows; ++r) {
            Row& row = rows_[as_index(r)];
            scaled(contact.a, row.of_a, row.a);
            scaled(contact.b, row.of_b, row.b);
            row.response = product(row.a, row.a) + product(row.b, row.b);
        }
    }
    has_rows_ = true;
    has_factor_ = false;
}

/// Finds what speed each row has and which one it wants, from bodies that have been read. Returns the largest speed, m/s.
template <int size>
double ContactIsland<size>::load_speeds(const KernelContext& context, bool relaxes)
{
    const StepConstants& step = context.step;
    std::fill(s_.begin(), s_.end(), 0.0);
    double largest = 0;
    auto carrier = carriers_.begin();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        Contact& contact = contacts_[i];
        Row* rows = rows_of(contact);
        const Body* a = contact.a < 0 ? nullptr : &bodies_[as_index(contact.a)];
        const Body* b = contact.b < 0 ? nullptr : &bodies_[as_index(contact.b)];
        double separation = contact.separation;
        if (a != nullptr) separation += product(rows[0].of_a, a->moved);
        if (b != nullptr) separation += product(rows[0].of_b, b->moved);
        for (int k = 0; k < contact.rows; ++k) {
            rows[k].start = 0;
            if (a != nullptr) rows[k].start += product(rows[k].of_a, a->velocity);
            if (b != nullptr) rows[k].start += product(rows[k].of_b, b->velocity);
            rows[k].aim = k == 0 ? 0 : contact.surface_speed[k - 1];
        }
        if (a == nullptr || b == nullptr) {
            const Carrier& by = *carrier++;
            const BodyArrays& arrays = context.bodies[static_cast<int>(BodyKind::fixed)];
            const double sign = by.is_a ? -1 : 1;
            const auto along = [&](int k, const float* quads, double turn) {
                const ContactDirection& d = by.directions.of[k];
                return sign * carried(d.n, by.is_a ? d.lever_a : d.lever_b, quads, turn);
            };
            separation += along(0, quad_of(arrays.delta, by.body), 2);
            for (int k = 0; k < contact.rows; ++k)
                rows[k].start += along(k, quad_of(arrays.velocity, by.body), 1);
        }
        for (int k = 0; k < contact.rows; ++k) largest = std::max(largest, std::abs(rows[k].start));
        contact.most = contact.most_force * static_cast<double>(step.substep);
        double aim = 0;
        if (separation > rounding_separation) {
            aim = (rounding_separation - separation) * static_cast<double>(step.inverse_substep);
        } else if (separation < -rounding_separation && !relaxes) {
            const Softness& soft = a == nullptr || b == nullptr ? step.static_contact : step.contact;
            const double slop = std::max(rounding_separation, static_cast<double>(step.slop));
            aim = std::min(-static_cast<double>(soft.rate) * std::min(separation + slop, 0.0),
                           static_cast<double>(step.push_out_speed));
        }
        rows[0].aim = std::abs(aim) < rounding_speed ? 0 : aim;
        take_back(i);
    }
    return largest;
}

/// Takes back what a sweep has changed of a contact's impulses, and of velocities by them, since they were stored.
template <int size>
void ContactIsland<size>::take_back(std::size_t i)
{
    const float* impulses = places_[i].impulses();
    Row* rows = rows_of(contacts_[i]);
    for (int k = 0; k < contacts_[i].rows; ++k) {
        rows[k].lambda = static_cast<double>(impulses[k * block_lanes]);
        set(contacts_[i], rows[k], impulses_[as_index(contacts_[i].first_row + k)]);
    }
}

template <int size>
void ContactIsland<size>::store(const KernelContext& context)
{
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const IslandContact& place = places_[i];
        float* impulses = place.impulses();
        const Contact& contact = contacts_[i];
        for (int k = 0; k < contact.rows; ++k) {
            const auto r = as_index(contact.first_row + k);
            impulses[k * block_lanes] = static_cast<float>(rows_[r].lambda);
            impulses_[r] = static_cast<double>(impulses[k * block_lanes]);
        }
        if (place.peak != nullptr) *place.peak = std::max(*place.peak, impulses[0]);
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

template class ContactIsland<3>;
template class ContactIsland<6>;

}  // namespace motley
