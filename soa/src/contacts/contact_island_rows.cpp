// How an island reads the rows of contacts and the state of bodies, and writes them back: see contact_island.h.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "contacts/contact_island.h"

namespace motley {
namespace {

/// What the inertia of a body may turn, relative, before rows are made anew.
constexpr double turned_inertia = 1e-5;

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
/// The quads of a body as a motion.
Motion motion_of(BodyKind kind, const float* quads)
{
    if (kind == BodyKind::particle) return {vector_at(quads), {0, 0, 0}};
    if (kind == BodyKind::planar) {
        return {{static_cast<double>(quads[0]), static_cast<double>(quads[1]), 0},
                {0, 0, static_cast<double>(quads[2])}};
    }
    return {vector_at(quads), vector_at(quads + 4)};
}
Motion velocity_of(const KernelContext& context, BodyRow body)
{
    return motion_of(body.kind(), quad_of(context.bodies[static_cast<int>(body.kind())].velocity, body));
}
/// How a body has moved since the step began, to first order in its rotation.
Motion displacement_of(const KernelContext& context, BodyRow body)
{
    Motion moved = motion_of(body.kind(), quad_of(context.bodies[static_cast<int>(body.kind())].delta, body));
    // The rotation of a body in space is a quaternion.
    if (quads_of(body.kind()) == 2) moved.angular = 2.0 * moved.angular;
    return moved;
}
ContactDirections directions_of(const IslandContact& place)
{
    return place.read(place.chunk->streams.rows, static_cast<std::size_t>(place.block),
                      static_cast<std::size_t>(place.lane));
}
float* impulses_of(const IslandContact& place)
{
    const std::int64_t floats = std::int64_t{place.chunk->kernels->impulse_floats} * block_lanes;
    return place.chunk->streams.impulses + floats * place.block + place.lane;
}
double component_along(const ContactDirection& d, const Motion& a, const Motion& b)
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
    places_.clear();  // should memory run out, nothing is known in the next step
    bodies_.clear();
    for (const BodyRow body : bodies) bodies_.push_back({body, -1, {}});
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
    std::size_t rows = 0;
    for (const IslandContact& contact : contacts) rows += static_cast<std::size_t>(contact.rows);
    contacts_.resize(contacts.size());
    directions_.resize(contacts.size());
    guess_.resize(contacts.size());
    factored_.resize(contacts.size());
    rows_.resize(rows);
    for (std::vector<double>* numbers : {&impulses_, &speeds_, &predicted_, &change_, &best_})
        numbers->resize(rows);
    s_.resize(bodies.size() * size);
    step_.resize(bodies.size() * size);
    places_.assign(contacts.begin(), contacts.end());
    std::int32_t first_row = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const IslandContact& place = contacts[i];
        Contact& contact = contacts_[i] = {place.a, place.b, first_row, place.rows, -1, false, 0, 0};
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
    has_rows_ = has_factor_ = has_guess_ = false;
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
        bool changed = now.linear != body.linear;
        for (int i = 0; i < 6; ++i)
            changed = changed || std::abs(now.angular[i] - body.angular[i]) > turned_inertia * scale;
        if (changed) {
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
            row.response = std::inner_product(row.a, row.a + size, row.a, 0.0) +
                           std::inner_product(row.b, row.b + size, row.b, 0.0);
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
        const ContactDirections& all = directions_[i];
        const Motion va = velocity_of(context, place.body_a), vb = velocity_of(context, place.body_b);
        Row* rows = rows_of(contacts_[i]);
        for (int k = 0; k < all.count; ++k) {
            rows[k].start = component_along(all.of[k], va, vb);
            rows[k].aim = k == 0 ? 0 : all.surface_speed[k - 1];
        }
        contacts_[i].most = all.most_force * static_cast<double>(step.substep);
        const double separation =
            all.separation + component_along(all.of[0], displacement_of(context, place.body_a),
                                             displacement_of(context, place.body_b));
        double aim = 0;
        if (separation > 0) {
            aim = -separation * static_cast<double>(step.inverse_substep);
        } else if (!relaxes) {
            const Softness& soft = place.a < 0 || place.b < 0 ? step.static_contact : step.contact;
            aim = std::min(
                -static_cast<double>(soft.rate) * std::min(separation + static_cast<double>(step.slop), 0.0),
                static_cast<double>(step.push_out_speed));
        }
        rows[0].aim = std::abs(aim) < rounding_speed ? 0 : aim;
    }
    // A sweep may have changed impulses and velocities since. That is taken back.
    std::fill(s_.begin(), s_.end(), 0.0);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const float* impulses = impulses_of(places_[i]);
        Row* rows = rows_of(contacts_[i]);
        for (int k = 0; k < contacts_[i].rows; ++k) {
            rows[k].lambda = static_cast<double>(impulses[k * block_lanes]);
            set(contacts_[i], rows[k], impulses_[as_index(contacts_[i].first_row + k)]);
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
