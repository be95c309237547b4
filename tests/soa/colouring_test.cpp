// Properties of colourings and blocks of random graphs, which RapidCheck generates: small ones that it can shrink, and
// large ones that take several chunks and overflow.
#include "layout/colouring.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "block_walk.h"
#include "large_property.h"
#include "layout/batches.h"
#include "motley/parallel/parallel_for.h"
#include "thread_executor.h"

namespace motley {
namespace {

/// Bodies of every kind, `each` of each; the static ones are the last.
struct Bodies {
    int each;
    BodyStore store;
    std::vector<BodyRow> rows;
    explicit Bodies(int of_each_kind) : each(of_each_kind)
    {
        for (int kind = 0; kind < 4; ++kind) {
            for (int i = 0; i < each; ++i) {
                BodyDefinition body;
                body.model = static_cast<BodyModel>(std::min(kind, 2));
                if (kind == 3) body.motion = BodyMotion::static_body;
                rows.push_back(store.row_of(store.add(body)));
            }
        }
    }
    [[nodiscard]] bool moves(int body) const { return body < 3 * each; }
    [[nodiscard]] BodyRow row(int body) const { return rows[static_cast<std::size_t>(body)]; }
};

using Edges = std::vector<std::pair<int, int>>;
using RawEdges = std::vector<std::pair<unsigned, unsigned>>;

/// Keeps pairs of different bodies of which at least one can move.
Edges usable(const RawEdges& raw, const Bodies& bodies)
{
    Edges edges;
    const auto count = static_cast<unsigned>(bodies.rows.size());
    for (const auto& [a, b] : raw) {
        const int x = static_cast<int>(a % count), y = static_cast<int>(b % count);
        if (x != y && (bodies.moves(x) || bodies.moves(y))) edges.push_back({x, y});
    }
    return edges;
}

/// A graph large enough for several chunks. An eighth of its edges end at one of `hubs` bodies, and so do not all find a
/// colour.
Edges large_graph(const Bodies& bodies, std::size_t hubs)
{
    std::mt19937_64 random = testing::any_random();
    RawEdges raw(testing::any_size(6'000, 12'000));
    for (auto& [a, b] : raw) {
        a = static_cast<unsigned>(random());
        b = static_cast<unsigned>(random());
        // Hubs are one of each kind that moves, then again one of each.
        if (hubs > 0 && random() % 8 == 0)
            a = static_cast<unsigned>(random() % hubs) * static_cast<unsigned>(bodies.each) %
                static_cast<unsigned>(3 * bodies.each);
    }
    return usable(raw, bodies);
}

/// Returns the number of edges that found no colour.
std::size_t check_colours(const Bodies& bodies, const Edges& edges)
{
    ColourMasks masks;
    masks.reset(bodies.store);
    std::set<std::pair<int, int>> taken;  // (colour, body)
    std::size_t overflow = 0;
    for (const auto& [a, b] : edges) {
        const int colour = masks.take_first(bodies.row(a), bodies.row(b));
        if (colour == overflow_colour) {
            ++overflow;
            continue;
        }
        for (const int body : {a, b}) {
            if (bodies.moves(body)) RC_ASSERT(taken.insert({colour, body}).second);
        }
    }
    return overflow;
}

RC_GTEST_PROP(Colouring, NeverSharesAMovingBodyWithinAColour, (const RawEdges& raw))
{
    const Bodies bodies(40);
    check_colours(bodies, usable(raw, bodies));
}

TEST(Colouring, NeverSharesAMovingBodyWithinAColourWhenHubsOverflow)
{
    testing::check_large(20, [] {
        const Bodies bodies(300);
        const std::size_t overflow = check_colours(bodies, large_graph(bodies, 3));
        RC_ASSERT(overflow > 100U);
    });
}

/// Every colour below the one that an edge takes is taken by an earlier edge at one of its ends. Returns the most
/// colours.
int check_first_fit(const Bodies& bodies, const Edges& edges)
{
    ColourMasks masks;
    masks.reset(bodies.store);
    std::map<int, int> degree;
    int most = 0;
    for (const auto& [a, b] : edges) {
        int neighbours = 0;
        for (const int body : {a, b}) neighbours += bodies.moves(body) ? degree[body]++ : 0;
        const int colour = masks.take_first(bodies.row(a), bodies.row(b));
        RC_ASSERT(colour <= std::min(neighbours, static_cast<int>(overflow_colour)));
        most = std::max(most, colour + 1);
    }
    return most;
}

RC_GTEST_PROP(Colouring, FirstFitSkipsNoColourThatIsFree, (const RawEdges& raw))
{
    const Bodies bodies(40);
    check_first_fit(bodies, usable(raw, bodies));
}

TEST(Colouring, FirstFitSkipsNoColourThatIsFreeInALargeGraph)
{
    testing::check_large(20, [] {
        const Bodies bodies(300);
        const Edges edges = large_graph(bodies, 0);
        // The mean degree is 10 or more; else the bound would bind nowhere.
        RC_ASSERT(check_first_fit(bodies, edges) > 10);
    });
}

struct Laid {
    std::int64_t chunks;
    std::size_t overflow;  ///< constraints that found no colour
};

/// Checks that every constraint is in one lane, and that no block has a moving body twice. `for_chunks(count, work)`
/// must call work(chunk) for each chunk, in any order and on any threads.
template <class ForChunks>
Laid check_blocks(const Bodies& bodies, const Edges& edges, std::size_t sent_to_overflow,
                  const ForChunks& for_chunks)
{
    ColourMasks masks;
    masks.reset(bodies.store);
    BatchSet set(0, contact_type_count);
    std::vector<Placement> placements;
    Laid laid{};
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const BodyRow a = bodies.row(edges[i].first), b = bodies.row(edges[i].second);
        const bool overflows = sent_to_overflow > 0 && i % sent_to_overflow == 0;
        const std::uint8_t colour = overflows ? overflow_colour : masks.take_first(a, b);
        laid.overflow += colour == overflow_colour ? 1 : 0;
        const auto type = static_cast<std::uint8_t>(i % contact_type_count);
        placements.push_back({a, b, static_cast<std::int32_t>(i), type, colour});
    }
    const KernelTable& kernels = kernel_table(Isa::scalar);
    set.begin(placements, false);
    laid.chunks = set.chunk_count();
    for_chunks(laid.chunks, [&](std::int64_t chunk) { set.count(chunk); });
    set.open(kernels, false, false);
    for_chunks(laid.chunks, [&](std::int64_t chunk) { set.fill(chunk); });
    SweepLists sweeps;
    TransferList transfers;
    set.cut(kernels, false, sweeps, transfers);
    std::set<std::int32_t> seen;
    std::set<std::tuple<int, std::int32_t, int>> movers;  // class, block, body
    std::size_t overflow = 0;
    testing::for_each_lane(sweeps, [&](const SweepChunk& chunk, std::int32_t block, int lane) {
        const std::int32_t constraint = chunk.streams.constraints[block].lane[lane];
        RC_ASSERT(seen.insert(constraint).second);
        RC_ASSERT(chunk.type == constraint % contact_type_count);
        const auto [a, b] = edges[static_cast<std::size_t>(constraint)];
        overflow += placements[static_cast<std::size_t>(constraint)].colour == overflow_colour ? 1 : 0;
        for (const int body : {a, b}) {
            const int of_class = class_of(chunk.type, chunk.kind_a, chunk.kind_b);
            if (bodies.moves(body)) RC_ASSERT(movers.insert({of_class, block, body}).second);
        }
    });
    RC_ASSERT(seen.size() == edges.size());
    RC_ASSERT(overflow == laid.overflow);
    return laid;
}

RC_GTEST_PROP(Blocks, HoldEveryConstraintInOneLaneAndNoMovingBodyTwice, (const RawEdges& raw))
{
    const Bodies bodies(40);
    // Every third goes straight to the overflow, as constraints of a hub do.
    check_blocks(bodies, usable(raw, bodies), 3, [](std::int64_t chunks, const auto& work) {
        for (std::int64_t chunk = chunks; chunk-- > 0;) work(chunk);
    });
}

TEST(Blocks, OfSeveralChunksAreFilledBySeveralThreads)
{
    testing::check_large(20, [] {
        const Bodies bodies(300);
        testing::ThreadExecutor threads(3, 2);
        const Laid laid =
            check_blocks(bodies, large_graph(bodies, 3), 0, [&](std::int64_t chunks, const auto& work) {
                parallel_for(threads, chunks, 1, [&](std::int64_t chunk, std::int64_t) { work(chunk); });
            });
        RC_ASSERT(laid.chunks > 3);
        RC_ASSERT(laid.overflow > 100U);
    });
}

TEST(Colouring, AHubSendsItsRestToTheOverflowAndAStaticHubNeedsOneColour)
{
    const Bodies bodies(40);
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
