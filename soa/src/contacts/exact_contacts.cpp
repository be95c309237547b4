// See exact_contacts.h.
#include "contacts/exact_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "contacts/contact_island.h"

namespace motley {

struct ExactContacts::Found {
    IslandContact contact;
    BodyRow a, b;
};
struct ExactContacts::Island {
    bool is_flat = false;  ///< all bodies have three degrees of freedom
    bool is_left_out = false;
    double residual = 0;  ///< m/s
    std::vector<BodyRow> bodies;
    std::vector<IslandContact> contacts;
    ContactIsland<3> flat;
    ContactIsland<6> spatial;
};

ExactContacts::ExactContacts() = default;
ExactContacts::~ExactContacts() = default;

namespace {

constexpr std::int32_t none = -1;

BodyRow body_at(BodyKind kind, std::int32_t offset)
{
    return {kind, static_cast<std::uint32_t>(offset / offsets_a_row(kind))};
}

/// A contact of the list, or of a capsule.
IslandContact listed(const SweepChunk& chunk, std::int32_t block, std::int32_t lane)
{
    const bool bounces = static_cast<Touch>(chunk.type) == Touch::bouncing;
    const std::int32_t floats = chunk.kernels->impulse_floats, rows = floats - (bounces ? 1 : 0);
    float* impulses = chunk.streams.impulses + std::int64_t{floats} * block_lanes * block + lane;
    return {&chunk,
            reader_of_contacts(chunk.type, chunk.kind_a, chunk.kind_b),
            bounces ? impulses + std::int64_t{rows} * block_lanes : nullptr,
            rows,
            block,
            lane,
            none,
            none};
}
IslandContact of_discs(const SweepChunk& chunk, std::int32_t block, std::int32_t lane)
{
    const std::int32_t rows = chunk.kernels->impulse_floats;
    return {
        &chunk, reader_of_discs(rows > 1, chunk.kind_a == BodyKind::fixed), nullptr, rows, block, lane, none,
        none};
}

/// m: discs that are farther apart are taken to touch within a step only as far as their speeds bring them.
constexpr double near = 0.01;

/// Whether two discs may touch within dt seconds, or pushed each other in the last step. Bands list many that do neither.
bool may_touch(const BodyStore& bodies, const IslandContact& contact, BodyRow a, BodyRow b, double dt)
{
    const SweepChunk& chunk = *contact.chunk;
    const std::int64_t floats = std::int64_t{chunk.kernels->impulse_floats} * block_lanes;
    if (chunk.streams.impulses[floats * contact.block + contact.lane] > 0) return true;
    const BodyRows& rows = bodies.rows(BodyKind::planar);
    const Vec3<PoseReal> between = rows.pose[b.row()].position - rows.pose[a.row()].position;
    const auto speed = [&](BodyRow body) {
        const float* v = rows.velocity.data() + std::int64_t{4} * body.row();
        return std::hypot(static_cast<double>(v[0]), static_cast<double>(v[1]));
    };
    // Radii are the last fields of a row.
    const float* last = chunk.streams.rows +
                        (std::int64_t{chunk.kernels->row_floats} * (contact.block + 1) - 1) * block_lanes +
                        contact.lane;
    double reach = static_cast<double>(*last);
    if (contact.rows > 1) reach += static_cast<double>(*(last - block_lanes));
    const double apart = std::hypot(static_cast<double>(between.x), static_cast<double>(between.y)) - reach;
    return apart < near + (speed(a) + speed(b)) * dt;
}

/// Calls visit(block, lane, body a, body b) for each contact of a chunk.
template <class Visit>
void for_each_lane(const SweepChunk& chunk, const Visit& visit)
{
    for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
        const BlockBodies& bodies = chunk.streams.bodies[block];
        for (std::int32_t lane = 0; lane < chunk.streams.counts[block]; ++lane)
            visit(block, lane, body_at(chunk.kind_a, bodies.a[lane]), body_at(chunk.kind_b, bodies.b[lane]));
    }
}

}  // namespace

void ExactContacts::find_islands(const BodyStore& bodies, const SweepLists& sweeps,
                                 std::span<const SweepChunk> discs, float dt)
{
    contacts_.clear();
    // In the order of the blocks, which does not depend on threads or lanes.
    for (const auto& chunks : sweeps.lists) {
        for (const SweepChunk& chunk : chunks) {
            if (chunk.type >= contact_type_count) continue;
            for_each_lane(chunk, [&](std::int32_t block, std::int32_t lane, BodyRow a, BodyRow b) {
                contacts_.push_back({listed(chunk, block, lane), a, b});
            });
        }
    }
    for (const SweepChunk& chunk : discs) {
        for_each_lane(chunk, [&](std::int32_t block, std::int32_t lane, BodyRow a, BodyRow b) {
            const IslandContact contact = of_discs(chunk, block, lane);
            if (a.kind() == BodyKind::fixed || may_touch(bodies, contact, a, b, static_cast<double>(dt)))
                contacts_.push_back({contact, a, b});
        });
    }
    sets_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    for (const Found& found : contacts_) sets_.tie(found.a, found.b);
    sets_.flatten();
    island_of_.assign(sets_.size(), none);
    local_.assign(sets_.size(), none);
    count_ = left_out_ = 0;
    for (const Found& found : contacts_) {
        Island& island = island_of(sets_.root(found.a.kind() == BodyKind::fixed ? found.b : found.a));
        IslandContact contact = found.contact;
        contact.a = number_in(island, found.a);
        contact.b = number_in(island, found.b);
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
