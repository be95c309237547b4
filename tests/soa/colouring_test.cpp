// Properties of colourings and blocks of random graphs, which RapidCheck generates.
#include "layout/colouring.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "block_walk.h"
#include "layout/batches.h"

namespace motley {
namespace {

/// Bodies of every kind: 40 of each.
struct Bodies {
    BodyStore store;
    std::vector<BodyRow> rows;
    Bodies()
    {
        for (int kind = 0; kind < 4; ++kind) {
            for (int i = 0; i < 40; ++i) {
                BodyDefinition body;
                body.model = static_cast<BodyModel>(std::min(kind, 2));
                if (kind == 3) body.motion = BodyMotion::static_body;
                rows.push_back(store.row_of(store.add(body)));
            }
        }
    }
};

using Edges = std::vector<std::pair<int, int>>;

/// Keeps pairs of different bodies of which at least one can move.
Edges usable(const std::vector<std::pair<unsigned, unsigned>>& raw)
{
    Edges edges;
    for (const auto& [a, b] : raw) {
        const int x = static_cast<int>(a % 160), y = static_cast<int>(b % 160);
        if (x != y && (x < 120 || y < 120)) edges.push_back({x, y});
    }
    return edges;
}

RC_GTEST_PROP(Colouring, NeverSharesAMovingBodyWithinAColour,
              (const std::vector<std::pair<unsigned, unsigned>>& raw))
{
    Bodies bodies;
    ColourMasks masks;
    masks.reset(bodies.store);
    std::set<std::pair<int, int>> taken;  // (colour, body)
    for (const auto& [a, b] : usable(raw)) {
        const int colour = masks.take_first(bodies.rows[static_cast<std::size_t>(a)],
                                            bodies.rows[static_cast<std::size_t>(b)]);
        if (colour == overflow_colour) continue;
        for (const int body : {a, b}) {
            if (body < 120) RC_ASSERT(taken.insert({colour, body}).second);
        }
    }
}

RC_GTEST_PROP(Colouring, FirstFitStaysBelowTwiceTheLargestDegree,
              (const std::vector<std::pair<unsigned, unsigned>>& raw))
{
    Bodies bodies;
    ColourMasks masks;
    masks.reset(bodies.store);
    std::map<int, int> degree;
    int largest = 0, most = -1;
    for (const auto& [a, b] : usable(raw)) {
        for (const int body : {a, b}) {
            if (body < 120) largest = std::max(largest, ++degree[body]);
        }
        const int colour = masks.take_first(bodies.rows[static_cast<std::size_t>(a)],
                                            bodies.rows[static_cast<std::size_t>(b)]);
        if (colour != overflow_colour) most = std::max(most, colour);
    }
    RC_ASSERT(most + 1 <= std::max(1, 2 * largest - 1));
}

RC_GTEST_PROP(Blocks, HoldEveryConstraintInOneLaneAndNoMovingBodyTwice,
              (const std::vector<std::pair<unsigned, unsigned>>& raw))
{
    Bodies bodies;
    ColourMasks masks;
    masks.reset(bodies.store);
    BatchSet set(0, contact_type_count);
    std::vector<Placement> placements;
    const Edges edges = usable(raw);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const BodyRow a = bodies.rows[static_cast<std::size_t>(edges[i].first)],
                      b = bodies.rows[static_cast<std::size_t>(edges[i].second)];
        // Every third goes straight to the overflow, as constraints of a hub do.
        const std::uint8_t colour = i % 3 == 0 ? overflow_colour : masks.take_first(a, b);
        placements.push_back({a, b, static_cast<std::int32_t>(i), 0, colour});
    }
    const KernelTable& kernels = kernel_table(Isa::scalar);
    set.begin(placements, false);
    for (std::int64_t chunk = 0; chunk < set.chunk_count(); ++chunk) set.count(chunk);
    set.open(kernels, false);
    for (std::int64_t chunk = set.chunk_count(); chunk-- > 0;) set.fill(chunk);  // any order is allowed
    SweepLists sweeps;
    TransferList transfers;
    set.cut(kernels, false, sweeps, transfers);
    std::set<std::int32_t> seen;
    std::set<std::tuple<int, std::int32_t, int>> movers;  // class, block, body
    testing::for_each_lane(sweeps, [&](const SweepChunk& chunk, std::int32_t block, int lane) {
        const std::int32_t constraint = chunk.streams.constraints[block].lane[lane];
        RC_ASSERT(seen.insert(constraint).second);
        const auto [a, b] = edges[static_cast<std::size_t>(constraint)];
        for (const int body : {a, b}) {
            const int of_class = class_of(chunk.type, chunk.kind_a, chunk.kind_b);
            if (body < 120) RC_ASSERT(movers.insert({of_class, block, body}).second);
        }
    });
    RC_ASSERT(seen.size() == edges.size());
}

TEST(Colouring, AHubSendsItsRestToTheOverflowAndAStaticHubNeedsOneColour)
{
    Bodies bodies;
    ColourMasks masks;
    masks.reset(bodies.store);
    int overflow = 0;
    for (std::size_t i = 1; i < 120; ++i)
        overflow += masks.take_first(bodies.rows[0], bodies.rows[i]) == overflow_colour;
    EXPECT_EQ(overflow, 119 - parallel_colours);
    masks.reset(bodies.store);
    for (std::size_t i = 0; i < 120; ++i) EXPECT_EQ(masks.take_first(bodies.rows[130], bodies.rows[i]), 0);
}

}  // namespace
}  // namespace motley
