// Patches of a large crowd: what makes it safe to sweep one on a thread of its own, counted over the blocks that were made.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "lattice_crowd.h"
#include "lay_out.h"

namespace motley {
namespace {

using testing::LatticeCrowd;

/// A moving body as blocks name it: kind and offset.
using Mover = std::pair<BodyKind, std::int32_t>;

template <class Visit>
void for_each_mover(const SweepChunk& chunk, std::int32_t block, int lane, const Visit& visit)
{
    const BlockBodies& bodies = chunk.streams.bodies[block];
    if (chunk.kind_a != BodyKind::fixed) visit(Mover{chunk.kind_a, bodies.a[lane]});
    if (chunk.kind_b != BodyKind::fixed) visit(Mover{chunk.kind_b, bodies.b[lane]});
}

/// Calls visit(block, lane) for every lane of a chunk; those without a constraint must be on the null rows.
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
    std::size_t inside = 0, across = 0;
};

/// Every contact in one lane; no moving body twice in a chunk, which is of one colour, nor in two patches.
Counts check(const Layout& layout, std::size_t contacts)
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
    std::map<Mover, std::size_t> patch_of;
    for (std::size_t patch = 0; patch < sweeps.patches.size(); ++patch) {
        for (const SweepChunk& chunk : sweeps.of_patch(static_cast<std::int64_t>(patch))) {
            check_chunk(chunk, counts.inside, [&](const Mover& mover) {
                EXPECT_EQ(patch_of.try_emplace(mover, patch).first->second, patch);
            });
        }
    }
    EXPECT_EQ(seen.size(), contacts);
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
    // Coloured anew, then with the colours of the step before.
    for (int step = 0; step < 2; ++step) {
        testing::lay_out(layout, crowd.scene, crowd.contacts());
        const Counts counts = check(layout, crowd.pairs.size());
        EXPECT_GT(counts.inside, crowd.pairs.size() * 3 / 4);
        EXPECT_GT(counts.across, 0U);
    }
}

TEST(Patches, OfAListInNoOrderAreStillApart)
{
    LatticeCrowd crowd;
    crowd.shuffle();
    Layout layout(kernel_table(Isa::scalar));
    testing::lay_out(layout, crowd.scene, crowd.contacts());
    EXPECT_GT(check(layout, crowd.pairs.size()).across, crowd.pairs.size() * 3 / 4);
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
    EXPECT_EQ(check(layout, crowd.pairs.size()).across, crowd.pairs.size());
}

/// Claims carry the number of their list, which begins again after some thousands.
TEST(Patches, StayTheSameWhenListsAreCountedAnew)
{
    LatticeCrowd crowd;
    const BodyStore& bodies = crowd.scene.bodies();
    Patches patches;
    const auto insides = [&] {
        std::size_t inside = 0;
        patches.begin(bodies, crowd.pairs.size());
        for (std::uint32_t pass = 0; pass < 2; ++pass) {
            for (std::uint32_t i = 0; i < crowd.pairs.size(); ++i) {
                const BodyRow a = bodies.row_of(crowd.bodies[static_cast<std::size_t>(crowd.pairs[i].first)]);
                const BodyRow b =
                    bodies.row_of(crowd.bodies[static_cast<std::size_t>(crowd.pairs[i].second)]);
                if (pass == 0) {
                    patches.claim(a, i);
                    patches.claim(b, i);
                } else {
                    inside += patches.holds(a, b, i) ? 1 : 0;
                }
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
