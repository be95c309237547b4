// See exact_contacts.h.
#include "contacts/exact_contacts.h"

#include <algorithm>
#include <cstddef>

#include "contacts/contact_island.h"

namespace motley {

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

/// The rows of a contact: its impulses, but for the peak of those that bounce.
std::int32_t rows_of(const SweepChunk& chunk)
{
    return chunk.kernels->impulse_floats - (static_cast<Touch>(chunk.type) == Touch::bouncing ? 1 : 0);
}

/// Calls visit(chunk, block, lane, body a, body b) for each contact of the lists, in the order of the blocks, which does
/// not depend on threads or lanes.
template <class Visit>
void for_each_contact(const SweepLists& sweeps, const Visit& visit)
{
    for (const auto& chunks : sweeps.lists) {
        for (const SweepChunk& chunk : chunks) {
            if (chunk.type >= contact_type_count) continue;
            for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
                const BlockBodies& bodies = chunk.streams.bodies[block];
                for (std::int32_t lane = 0; lane < chunk.streams.counts[block]; ++lane) {
                    visit(chunk, block, lane, body_at(chunk.kind_a, bodies.a[lane]),
                          body_at(chunk.kind_b, bodies.b[lane]));
                }
            }
        }
    }
}

}  // namespace

void ExactContacts::find_islands(const BodyStore& bodies, const SweepLists& sweeps)
{
    sets_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    for_each_contact(sweeps, [&](const SweepChunk&, std::int32_t, std::int32_t, BodyRow a, BodyRow b) {
        sets_.tie(a, b);
    });
    sets_.flatten();
    island_of_.assign(sets_.size(), none);
    local_.assign(sets_.size(), none);
    count_ = left_out_ = 0;
    for_each_contact(
        sweeps, [&](const SweepChunk& chunk, std::int32_t block, std::int32_t lane, BodyRow a, BodyRow b) {
            Island& island = island_of(sets_.root(a.kind() == BodyKind::fixed ? b : a));
            const std::int32_t first = number_in(island, a), second = number_in(island, b);
            island.contacts.push_back({&chunk, rows_of(chunk), block, lane, first, second});
        });
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
