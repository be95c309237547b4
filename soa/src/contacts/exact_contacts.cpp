// See exact_contacts.h.
#include "contacts/exact_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "contacts/contact_island.h"
#include "stores/array.h"

namespace motley {

struct ExactContacts::Island {
    bool is_flat = false;  ///< all bodies have three degrees of freedom
    bool is_left_out = false;
    double residual = 0;  ///< m/s
    Array<BodyRow> bodies;
    Array<IslandContact> contacts;
    ContactIsland<3> flat;
    ContactIsland<6> spatial;
};

ExactContacts::ExactContacts() = default;
ExactContacts::~ExactContacts() = default;

namespace {

constexpr std::int32_t none = -1;

IslandContact placed(const SweepChunk& chunk, std::int32_t block, std::int32_t lane)
{
    const BlockBodies& bodies = chunk.streams.bodies[block];
    IslandContact contact{};
    contact.chunk = &chunk;
    contact.block = block;
    contact.lane = lane;
    contact.body_a = row_at(chunk.kind_a, bodies.a[lane]);
    contact.body_b = row_at(chunk.kind_b, bodies.b[lane]);
    contact.rows = chunk.kernels->impulse_floats;
    return contact;
}

/// A contact of the list, or of a capsule.
IslandContact listed(const SweepChunk& chunk, std::int32_t block, std::int32_t lane)
{
    IslandContact contact = placed(chunk, block, lane);
    contact.read = reader_of_contacts(chunk.type, chunk.kind_a, chunk.kind_b);
    if (static_cast<Touch>(chunk.type) == Touch::bouncing) {
        --contact.rows;  // the last float is the peak
        contact.peak = contact.impulses() + std::int64_t{contact.rows} * block_lanes;
    }
    return contact;
}
IslandContact of_discs(const SweepChunk& chunk, std::int32_t block, std::int32_t lane)
{
    IslandContact contact = placed(chunk, block, lane);
    contact.read = reader_of_discs(contact.rows > 1, chunk.kind_a == BodyKind::fixed);
    return contact;
}

/// m: the sum of the radii of two discs.
double reach_of(const IslandContact& contact)
{
    const float* rows = contact.chunk->streams.rows;
    const auto block = static_cast<std::size_t>(contact.block), lane = static_cast<std::size_t>(contact.lane);
    if (contact.rows == 1) {
        const auto row = load_lane<DiscFieldsOf<DiscClass::smooth_pair>::Row>(rows, block, lane);
        return static_cast<double>(row.reach);
    }
    const auto row = load_lane<DiscFieldsOf<DiscClass::rough_pair>::Row>(rows, block, lane);
    return static_cast<double>(row.radius_a) + static_cast<double>(row.radius_b);
}

/// m: discs that are farther apart are taken to touch within a step only as far as their speeds bring them.
constexpr double near_disc = 0.01;

/// Whether two discs may touch within dt seconds, or pushed each other in the last step. Bands list many that do neither.
bool may_touch(const BodyStore& bodies, const IslandContact& contact, double dt)
{
    if (*contact.impulses() > 0) return true;
    const BodyRows& rows = bodies.rows(BodyKind::planar);
    const std::uint32_t a = contact.body_a.row(), b = contact.body_b.row();
    const Vec3<PoseReal> between = rows.pose[b].position - rows.pose[a].position;
    const auto speed = [&](std::uint32_t row) {
        const float* v = rows.velocity.data() + std::int64_t{4} * row;
        return std::hypot(static_cast<double>(v[0]), static_cast<double>(v[1]));
    };
    const double distance = std::hypot(static_cast<double>(between.x), static_cast<double>(between.y));
    return distance - reach_of(contact) < near_disc + (speed(a) + speed(b)) * dt;
}

/// Calls visit(block, lane) for each contact of a chunk.
template <class Visit>
void for_each_lane(const SweepChunk& chunk, const Visit& visit)
{
    for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
        for (std::int32_t lane = 0; lane < chunk.streams.counts[block]; ++lane) visit(block, lane);
    }
}

/// Whether two steps list the same contact at the same place.
bool are_same(const IslandContact& x, const IslandContact& y)
{
    return x.chunk == y.chunk && x.block == y.block && x.lane == y.lane && x.read == y.read &&
           x.rows == y.rows && x.peak == y.peak && x.body_a.bits == y.body_a.bits &&
           x.body_b.bits == y.body_b.bits;
}

}  // namespace

void ExactContacts::find_islands(const BodyStore& bodies, const SweepLists& sweeps,
                                 std::span<const SweepChunk> discs, float dt)
{
    list_contacts(bodies, sweeps, discs, static_cast<double>(dt));
    if (has_islands_ && std::equal(now_.begin(), now_.end(), contacts_.begin(), contacts_.end(), are_same)) {
        for (std::int64_t i = 0; i < count_; ++i) islands_[static_cast<std::size_t>(i)]->residual = 0;
        return;
    }
    has_islands_ = false;  // should memory run out
    contacts_.swap(now_);
    make_islands(bodies);
    has_islands_ = true;
}

/// In the order of the blocks, which does not depend on threads or lanes.
void ExactContacts::list_contacts(const BodyStore& bodies, const SweepLists& sweeps,
                                  std::span<const SweepChunk> discs, double dt)
{
    now_.clear();
    for (const auto& chunks : sweeps.lists) {
        for (const SweepChunk& chunk : chunks) {
            if (chunk.type >= contact_type_count) continue;
            for_each_lane(chunk, [&](std::int32_t block, std::int32_t lane) {
                now_.push_back(listed(chunk, block, lane));
            });
        }
    }
    for (const SweepChunk& chunk : discs) {
        for_each_lane(chunk, [&](std::int32_t block, std::int32_t lane) {
            const IslandContact contact = of_discs(chunk, block, lane);
            if (chunk.kind_a == BodyKind::fixed || may_touch(bodies, contact, dt)) now_.push_back(contact);
        });
    }
}

void ExactContacts::make_islands(const BodyStore& bodies)
{
    sets_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    for (const IslandContact& contact : contacts_) sets_.tie(contact.body_a, contact.body_b);
    sets_.flatten();
    island_of_.assign(sets_.size(), none);
    local_.assign(sets_.size(), none);
    count_ = left_out_ = 0;
    for (IslandContact& contact : contacts_) {
        const bool on_fixed = contact.body_a.kind() == BodyKind::fixed;
        Island& island = island_of(sets_.root(on_fixed ? contact.body_b : contact.body_a));
        contact.a = number_in(island, contact.body_a);
        contact.b = number_in(island, contact.body_b);
        island.contacts.push_back(contact);
    }
    for (std::int64_t i = 0; i < count_; ++i) {
        Island& island = *islands_[static_cast<std::size_t>(i)];
        const auto all_are = [&](BodyKind kind) {
            return std::all_of(island.bodies.begin(), island.bodies.end(),
                               [&](BodyRow body) { return body.kind() == kind; });
        };
        island.is_flat = all_are(BodyKind::planar) || all_are(BodyKind::particle);
        const auto lay_out = [&](auto& contacts) {
            return contacts.lay_out(island.bodies, island.contacts, most_products);
        };
        island.is_left_out = !(island.is_flat ? lay_out(island.flat) : lay_out(island.spatial));
        left_out_ += island.is_left_out ? 1 : 0;
    }
}

ExactContacts::Island& ExactContacts::island_of(std::int32_t root)
{
    std::int32_t& number = island_of_[static_cast<std::size_t>(root)];
    if (number == none) {
        number = static_cast<std::int32_t>(count_++);
        if (islands_.size() < static_cast<std::size_t>(count_))
            islands_.push_back(std::make_unique<Island>());
        Island& island = *islands_[static_cast<std::size_t>(number)];
        island.bodies.clear();
        island.contacts.clear();
        island.residual = 0;
    }
    return *islands_[static_cast<std::size_t>(number)];
}

/// -1 for bodies that do not move.
std::int32_t ExactContacts::number_in(Island& island, BodyRow body)
{
    if (body.kind() == BodyKind::fixed) return none;
    std::int32_t& local = local_[sets_.number(body)];
    if (local == none) {
        local = static_cast<std::int32_t>(island.bodies.size());
        island.bodies.push_back(body);
    }
    return local;
}

void ExactContacts::begin(std::int64_t i)
{
    Island& island = *islands_[static_cast<std::size_t>(i)];
    if (island.is_left_out) return;
    if (island.is_flat) {
        island.flat.begin();
    } else {
        island.spatial.begin();
    }
}

void ExactContacts::solve(const KernelContext& context, std::int64_t i, bool relaxes)
{
    Island& island = *islands_[static_cast<std::size_t>(i)];
    if (island.is_left_out) return;
    const double left =
        island.is_flat ? island.flat.solve(context, relaxes) : island.spatial.solve(context, relaxes);
    island.residual = std::max(island.residual, left);
}

double ExactContacts::residual() const
{
    double largest = 0;
    for (std::int64_t i = 0; i < count_; ++i)
        largest = std::max(largest, islands_[static_cast<std::size_t>(i)]->residual);
    return largest;
}

}  // namespace motley
