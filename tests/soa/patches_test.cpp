// Patches of a large crowd: the properties that make it safe to sweep each on a thread of its own, counted over the
// blocks.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "lattice_crowd.h"
#include "lay_out.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::LatticeCrowd;

/// A moving body as blocks refer to it: kind and offset.
using Mover = std::pair<BodyKind, std::int32_t>;

template <class Visit>
void for_each_mover(const SweepChunk& chunk, std::int32_t block, int lane, const Visit& visit)
{
    const BlockBodies& bodies = chunk.streams.bodies[block];
    if (chunk.kind_a != BodyKind::fixed) visit(Mover{chunk.kind_a, bodies.a[lane]});
    if (chunk.kind_b != BodyKind::fixed) visit(Mover{chunk.kind_b, bodies.b[lane]});
}

/// Calls visit(block, lane) for every lane of a chunk with a constraint; all others must refer to the null rows.
template <class Visit>
void for_each_lane(const SweepChunk& chunk, const Visit& visit)
{
    for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
        ASSERT_GT(chunk.streams.counts[block], 0);
        for (int lane = 0; lane < block_lanes; ++lane) {
            if (lane < chunk.streams.counts[block]) {
                visit(block, lane);
            } else {
                ASSERT_EQ(chunk.streams.bodies[block].a[lane], 0);
                ASSERT_EQ(chunk.streams.bodies[block].b[lane], 0);
            }
        }
    }
}

struct Counts {
    std::size_t inside = 0, across = 0, overflow = 0;
    std::size_t patches = 0;  ///< with contacts
};

/// Exactly one patch lists each body that can move and that a contact touches: the patch with the contacts inside it.
void check_bodies(const Layout& layout, const Scene& scene, const std::map<Mover, std::size_t>& patch_of)
{
    const Patches& patches = layout.intake.patches;
    std::map<Mover, std::size_t> listed;
    for (std::size_t patch = 0; patch < layout.sweeps().patches.size(); ++patch) {
        for (const BodyKind kind : {BodyKind::particle, BodyKind::planar, BodyKind::rigid}) {
            for (const BodyRow body : patches.bodies_of(patch, kind)) {
                EXPECT_EQ(body.kind(), kind);
                EXPECT_TRUE(patches.lists(body));
                EXPECT_TRUE(listed.try_emplace(Mover{kind, offset_of(body)}, patch).second);
            }
        }
    }
    for (const auto& [mover, patch] : patch_of) EXPECT_EQ(listed.at(mover), patch);
    std::set<Mover> touched;
    for (const Placement& placement : layout.contact_placements()) {
        for (const BodyRow body : {placement.a, placement.b}) {
            if (body.kind() != BodyKind::fixed) touched.insert(Mover{body.kind(), offset_of(body)});
        }
    }
    EXPECT_EQ(touched.size(), listed.size());
    for (const BodyKind kind : {BodyKind::planar, BodyKind::rigid}) {
        for (std::uint32_t row = 1; row < core_of(scene).bodies.rows(kind).size(); ++row)
            EXPECT_EQ(patches.lists(BodyRow(kind, row)),
                      touched.contains(Mover{kind, offset_of(BodyRow(kind, row))}));
    }
}

/// Every contact is in one lane. No moving body is in a chunk of a colour twice, and none is in two patches.
Counts check(const Layout& layout, const Scene& scene, std::size_t contacts)
{
    Counts counts;
    std::set<std::int32_t> seen;
    const auto check_chunk = [&](const SweepChunk& chunk, std::size_t& count, const auto& visit) {
        std::set<Mover> movers;
        for_each_lane(chunk, [&](std::int32_t block, int lane) {
            EXPECT_TRUE(seen.insert(chunk.streams.constraints[block].lane[lane]).second);
            ++count;
            for_each_mover(chunk, block, lane, [&](const Mover& mover) {
                EXPECT_TRUE(movers.insert(mover).second);
                visit(mover);
            });
        });
    };
    const SweepLists& sweeps = layout.sweeps();
    for (int colour = 0; colour < parallel_colours; ++colour) {
        for (const SweepChunk& chunk : sweeps.of_colour(colour))
            check_chunk(chunk, counts.across, [](const Mover&) {});
    }
    // The overflow is swept block after block: there a body may be in several blocks, but in each only once.
    for (SweepChunk chunk : sweeps.of_colour(overflow_colour)) {
        const std::int32_t end = chunk.end;
        for (; chunk.begin < end; ++chunk.begin) {
            chunk.end = chunk.begin + 1;
            check_chunk(chunk, counts.overflow, [](const Mover&) {});
        }
    }
    std::map<Mover, std::size_t> patch_of;
    for (std::size_t patch = 0; patch < sweeps.patches.size(); ++patch) {
        counts.patches += sweeps.of_patch(static_cast<std::int64_t>(patch)).empty() ? 0 : 1;
        for (const SweepChunk& chunk : sweeps.of_patch(static_cast<std::int64_t>(patch))) {
            check_chunk(chunk, counts.inside, [&](const Mover& mover) {
                EXPECT_EQ(patch_of.try_emplace(mover, patch).first->second, patch);
            });
        }
    }
    EXPECT_EQ(seen.size(), contacts);
    if (!sweeps.patches.empty()) check_bodies(layout, scene, patch_of);
    std::size_t transferred = 0;
    for (const TransferTile::Part& part : layout.transfers().parts) {
        for (std::int32_t block = part.begin; block < part.end; ++block)
            transferred += part.streams.counts[block];
    }
    EXPECT_EQ(transferred, contacts);
    return counts;
}

TEST(Patches, HoldMostContactsOfAListInSpaceAndShareNoMovingBody)
{
    LatticeCrowd crowd;
    Layout layout(kernel_table(Isa::scalar));
    // The first step colours all contacts, the second keeps the colours of the first.
    for (int step = 0; step < 2; ++step) {
        testing::lay_out(layout, crowd.scene, crowd.contacts());
        const Counts counts = check(layout, crowd.scene, crowd.pairs.size());
        EXPECT_GT(counts.inside, crowd.pairs.size() * 3 / 4);
        EXPECT_GT(counts.across, 0U);
        EXPECT_EQ(counts.patches, crowd.pairs.size() / Patches::contacts_a_patch + 1);
        EXPECT_EQ(counts.overflow, 0U);
    }
}

/// People who touch more than thirty others, as somebody does whose contacts are listed at several points each.
TEST(Patches, HoldNoContactThatFoundNoColour)
{
    LatticeCrowd crowd;
    const std::size_t before = crowd.pairs.size();
    for (const int hub : {LatticeCrowd::side * 10 + 10, LatticeCrowd::side * 90 + 77}) {
        std::vector<std::pair<int, int>> more;
        for (int i = 2; i < 60; ++i) more.emplace_back(hub, hub + i);
        const auto at = static_cast<std::ptrdiff_t>(hub) * 3;
        crowd.pairs.insert(crowd.pairs.begin() + at, more.begin(), more.end());
    }
    Layout layout(kernel_table(Isa::scalar));
    for (int step = 0; step < 2; ++step) {
        testing::lay_out(layout, crowd.scene, crowd.contacts());
        const Counts counts = check(layout, crowd.scene, before + 2 * 58);
        EXPECT_GT(counts.patches, 10U);
        EXPECT_GE(counts.overflow, 2U * (58 - parallel_colours));
        EXPECT_LT(counts.overflow, 2U * (58 + 8));
    }
}

TEST(Patches, OfAListInNoOrderAreStillApart)
{
    LatticeCrowd crowd;
    crowd.shuffle();
    Layout layout(kernel_table(Isa::scalar));
    testing::lay_out(layout, crowd.scene, crowd.contacts());
    EXPECT_GT(check(layout, crowd.scene, crowd.pairs.size()).across, crowd.pairs.size() * 3 / 4);
}

TEST(Patches, LeaveAloneWhatNoContactTouches)
{
    LatticeCrowd crowd;
    Layout layout(kernel_table(Isa::scalar));
    testing::lay_out(layout, crowd.scene, crowd.contacts());
    // In the next list the last rows of people touch nobody.
    crowd.pairs.resize(Patches::from_contacts + 1000);
    testing::lay_out(layout, crowd.scene, crowd.contacts());
    check(layout, crowd.scene, crowd.pairs.size());
    std::size_t beside = 0;
    for (const BodyId body : crowd.bodies) {
        const BodyRow row = core_of(crowd.scene).bodies.row_of(body);
        beside += row.kind() != BodyKind::fixed && !layout.intake.patches.lists(row) ? 1 : 0;
    }
    EXPECT_GT(beside, 1000U);
}

TEST(Patches, AreNotMadeOfSmallListsNorLeftOverFromLargeOnes)
{
    LatticeCrowd crowd;
    Layout layout(kernel_table(Isa::scalar));
    testing::lay_out(layout, crowd.scene, crowd.contacts());
    ASSERT_FALSE(layout.sweeps().patches.empty());
    crowd.pairs.resize(Patches::from_contacts - 1);
    testing::lay_out(layout, crowd.scene, crowd.contacts());
    EXPECT_TRUE(layout.sweeps().patches.empty());
    EXPECT_EQ(check(layout, crowd.scene, crowd.pairs.size()).across, crowd.pairs.size());
}

/// Claims store the number of their list, which wraps around after some thousands of lists.
TEST(Patches, StayTheSameWhenListsAreCountedAnew)
{
    LatticeCrowd crowd;
    const BodyStore& bodies = core_of(crowd.scene).bodies;
    Patches patches;
    const auto insides = [&] {
        std::size_t inside = 0;
        patches.begin(bodies, crowd.pairs.size());
        const auto count = static_cast<std::uint32_t>(crowd.pairs.size());
        const auto row_of = [&](int body) {
            return bodies.row_of(crowd.bodies[static_cast<std::size_t>(body)]);
        };
        for (std::uint32_t i = 0; i < count; ++i) {
            patches.claim(row_of(crowd.pairs[i].first), i);
            patches.claim(row_of(crowd.pairs[i].second), i);
        }
        for (std::uint32_t i = 0; i < count;) {
            const std::size_t patch = i / Patches::contacts_a_patch;
            Patches::Roll roll(patches, patch);
            for (; i < count && i / Patches::contacts_a_patch == patch; ++i) {
                const bool holds_a = roll.holds(row_of(crowd.pairs[i].first));
                const bool holds_b = roll.holds(row_of(crowd.pairs[i].second));
                inside += holds_a && holds_b ? 1 : 0;
            }
        }
        return inside;
    };
    const std::size_t first = insides();
    for (int list = 1; list < (1 << 14) + 3; ++list) patches.begin(bodies, crowd.pairs.size());
    EXPECT_EQ(insides(), first);
}

}  // namespace
}  // namespace motley
