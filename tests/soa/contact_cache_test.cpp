// Contacts found again from step to step, against a std::map that is told the same: RapidCheck makes the lists.
#include "motley/core/contact_cache.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>

namespace motley {
namespace {

/// What an intake does with a list of keys; false when refused.
bool take(ContactCache& cache, const std::vector<std::uint64_t>& keys)
{
    cache.begin(keys.size());
    std::uint32_t cursor = 0;
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
        cache.staged().entries[i].key = keys[i];
        std::uint32_t before = cache.find_near(keys[i], cursor);
        if (before == ContactCache::none) before = cache.find(keys[i]);
        cache.claim(i, before);
    }
    for (std::int64_t part = 0; part < cache.survey_parts(); ++part) cache.survey(part);
    if (!cache.admit()) return false;
    cache.accept_staged();
    return true;
}

RC_GTEST_PROP(ContactCache, FindsWhatTheLastAcceptedListHad,
              (const std::vector<std::vector<std::uint8_t>>& lists))
{
    ContactCache cache;
    std::map<std::uint64_t, std::uint32_t> truth;
    for (const auto& list : lists) {
        std::vector<std::uint64_t> keys;
        // Few different keys, so that they come back, and some that share the low half.
        for (const std::uint8_t key : list) keys.push_back(key % 64 + (std::uint64_t{key} >> 6 << 33));
        const bool unique = std::set<std::uint64_t>(keys.begin(), keys.end()).size() == keys.size();
        RC_ASSERT(take(cache, keys) == unique);
        if (unique) {
            truth.clear();
            for (std::uint32_t i = 0; i < keys.size(); ++i) truth[keys[i]] = i;
        }
        for (std::uint64_t key = 0; key < 256; ++key) {
            const std::uint64_t asked = key % 64 + (key >> 6 << 33);
            const auto known = truth.find(asked);
            RC_ASSERT(cache.find(asked) == (known == truth.end() ? ContactCache::none : known->second));
        }
    }
}

TEST(ContactCache, ListsMayShrinkAndGrowByAnyAmount)
{
    ContactCache cache;
    std::uint64_t next = 0;
    for (const std::size_t count : {10'000, 3, 0, 7'000, 20'000, 1, 19'999, 40'000, 12}) {
        std::vector<std::uint64_t> keys(count);
        for (std::size_t i = 0; i < count; ++i) keys[i] = next + i;
        ASSERT_TRUE(take(cache, keys));
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(cache.find(keys[i]), i);
        next += count / 2;  // half of them come back
    }
}

RC_GTEST_PROP(KeyTable, IsAMapFromKeysToTicketsOfTheirOwn,
              (const std::vector<std::pair<bool, std::uint8_t>>& changes))
{
    KeyTable table;
    std::map<std::uint64_t, std::uint32_t> truth;
    for (const auto& [insert, low] : changes) {
        // Multiples of 2^58 crowd into few buckets.
        const std::uint64_t key = std::uint64_t{low} << 58 | low;
        if (insert) {
            const std::uint32_t ticket = table.insert(key);
            RC_ASSERT((ticket == KeyTable::none) == truth.contains(key));
            if (ticket == KeyTable::none) continue;
            for (const auto& other : truth) RC_ASSERT(other.second != ticket);
            truth[key] = ticket;
        } else {
            table.remove(key);
            truth.erase(key);
        }
        RC_ASSERT(table.size() == truth.size());
        for (const auto& [known, ticket] : truth) RC_ASSERT(table.find(known) == ticket);
    }
}

TEST(KeyTable, SurvivesAThousandGenerationsWithoutGrowing)
{
    KeyTable table;
    for (std::uint64_t i = 0; i < 1000; ++i) table.insert(i);
    const std::size_t limit = table.ticket_limit();
    for (std::uint64_t i = 0; i < 1'000'000; ++i) {
        table.remove(i);
        ASSERT_NE(table.insert(i + 1000), KeyTable::none);
    }
    EXPECT_EQ(table.ticket_limit(), limit);
    EXPECT_EQ(table.size(), 1000U);
    for (std::uint64_t i = 0; i < 1000; ++i) EXPECT_NE(table.find(1'000'000 + i), KeyTable::none);
    EXPECT_EQ(table.find(999'999), KeyTable::none);
}

}  // namespace
}  // namespace motley
