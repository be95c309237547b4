// Contacts found again from step to step, against a std::map that is updated in the same way. RapidCheck generates
// the lists: short ones, which it can shrink, and long ones of several parts. Parts run on threads of their own.
#include "stores/contact_cache.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "large_property.h"
#include "motley/parallel/parallel_for.h"
#include "thread_executor.h"

namespace motley {
namespace {

using Keys = std::vector<std::uint64_t>;

/// Takes in a list of keys as a step does. Returns the index of each contact in the list before, or nothing if keys
/// are refused.
std::optional<std::vector<std::uint32_t>> take(ContactCache& cache, const Keys& keys, Executor& executor)
{
    std::vector<std::uint32_t> before(keys.size());
    cache.begin(keys.size());
    const auto for_parts = [&](const auto& work) {
        parallel_for(executor, cache.part_count(), 1, [&](std::int64_t part, std::int64_t) { work(part); });
    };
    for_parts([&](std::int64_t part) {
        ContactCache::Walk walk(cache, part);
        for (std::uint32_t i = cache.part(part).begin; i < cache.part(part).end; ++i) {
            cache.staged().entries[i].key = keys[i];
            before[i] = walk.find(i, keys[i]);
        }
    });
    for_parts([&](std::int64_t part) { cache.find_lost(part); });
    cache.open_table();
    for_parts([&](std::int64_t part) { cache.enter_lost(part); });
    for_parts([&](std::int64_t part) {
        for (const std::uint32_t i : cache.missed(part)) before[i] = cache.trace(part, i);
    });
    for_parts([&](std::int64_t part) { cache.verify(part); });
    if (cache.has_repeated_key()) return {};
    cache.accept_staged();
    return before;
}

/// Takes lists in and checks that every contact finds itself in the list before, and only itself.
struct Checked {
    ContactCache cache;
    std::map<std::uint64_t, std::uint32_t> last;
    testing::ThreadExecutor threads{3, 2};

    /// Returns false if anything is wrong.
    bool take_in(const Keys& keys)
    {
        const bool unique = std::set<std::uint64_t>(keys.begin(), keys.end()).size() == keys.size();
        const auto before = take(cache, keys, threads);
        if (before.has_value() != unique) return false;
        if (!before) return true;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const auto known = last.find(keys[i]);
            if ((*before)[i] != (known == last.end() ? ContactCache::none : known->second)) return false;
        }
        last.clear();
        for (std::uint32_t i = 0; i < keys.size(); ++i) last[keys[i]] = i;
        return true;
    }
};

RC_GTEST_PROP(ContactCache, FindsWhatTheLastAcceptedListHad,
              (const std::vector<std::vector<std::uint8_t>>& lists))
{
    Checked checked;
    for (const auto& list : lists) {
        Keys keys;
        // Few different keys, so that keys recur; some of them share their low half.
        for (const std::uint8_t key : list) keys.push_back(key % 64 + (std::uint64_t{key} >> 6 << 33));
        RC_ASSERT(checked.take_in(keys));
    }
}

/// The list of the next step: a host drops some contacts, adds others anywhere, and now and then lists in another order.
void change_as_a_host(Keys& keys, std::uint64_t& fresh, std::mt19937_64& random)
{
    // New keys of which many share their low or their high half.
    const auto next_key = [&] {
        const std::uint64_t key = fresh++;
        return key % 5'000 + (key / 5'000 << 33);
    };
    const std::uint64_t order = random() % 4;
    if (order == 1) std::shuffle(keys.begin(), keys.end(), random);
    if (order == 2)
        std::rotate(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(random() % keys.size()),
                    keys.end());
    Keys changed;
    const std::size_t size = testing::any_size(4'200, 14'000);
    for (const std::uint64_t key : keys) {
        if (random() % 10 != 0 && changed.size() < size) changed.push_back(key);
        if (random() % 10 == 0) changed.push_back(next_key());
    }
    while (changed.size() < size) changed.push_back(next_key());
    keys = changed;
}

TEST(ContactCache, FindsInSeveralPartsWhatTheLastAcceptedListHad)
{
    testing::check_large(20, [] {
        std::mt19937_64 random = testing::any_random();
        Checked checked;
        Keys keys(5'000);
        std::iota(keys.begin(), keys.end(), 0);
        std::uint64_t fresh = keys.size();
        RC_ASSERT(checked.take_in(keys));
        for (int step = 0; step < 6; ++step) {
            change_as_a_host(keys, fresh, random);
            if (step % 3 == 2) {
                // Refused: the next list is matched with the one before this.
                Keys twice = keys;
                twice[random() % twice.size()] = twice.front();
                twice.push_back(twice.back());
                RC_ASSERT(checked.take_in(twice));
            }
            RC_ASSERT(checked.take_in(keys));
            RC_ASSERT(checked.last.size() == keys.size());
            RC_ASSERT(checked.cache.part_count() >= 3);
        }
    });
}

/// Keys of two lists that fall into few buckets, against a std::map of the first entry with each key.
RC_GTEST_PROP(KeyTable, HasEachKeyOnce, (const std::vector<std::pair<bool, std::uint8_t>>& entries))
{
    using List = KeyTable::List;
    const auto key_at = [&](List, std::uint32_t i) {
        const std::uint64_t low = entries[i].second;
        return low << 58 | low;
    };
    const auto list_at = [&](std::size_t i) { return entries[i].first ? List::fresh : List::lost; };
    KeyTable table;
    table.clear(entries.size(), entries.size());
    std::map<std::uint64_t, std::uint32_t> first;
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
        const std::uint64_t key = key_at({}, i);
        const auto [known, is_new] = first.try_emplace(key, i);
        const KeyTable::Found found = table.enter(key, list_at(i), i, key_at);
        RC_ASSERT(found.index == (is_new ? KeyTable::Found::none : known->second));
        RC_ASSERT(found.list == list_at(known->second));
    }
    for (std::uint64_t low = 0; low < 256; ++low) {
        const auto known = first.find(low << 58 | low);
        const bool is_fresh = known != first.end() && list_at(known->second) == List::fresh;
        RC_ASSERT(table.is_fresh(low << 58 | low, key_at) == is_fresh);
    }
}

TEST(KeyTable, HasEachKeyOnceWhenThreadsEnterItAtOnce)
{
    using List = KeyTable::List;
    testing::check_large(10, [] {
        std::mt19937_64 random = testing::any_random();
        // Each key comes about four times, most often on different threads.
        Keys keys(testing::any_size(8'000, 20'000));
        for (std::uint64_t& key : keys) key = random() % (keys.size() / 4) << 20;
        const auto key_at = [&](List, std::uint32_t i) { return keys[i]; };
        const auto list_at = [](std::uint32_t i) { return i % 3 == 0 ? List::fresh : List::lost; };
        KeyTable table;
        table.clear(keys.size(), keys.size());
        std::vector<KeyTable::Found> found(keys.size());
        testing::ThreadExecutor threads(3, 2);
        parallel_for(
            threads, static_cast<std::int64_t>(keys.size()), 64, [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::uint32_t>(begin); i < static_cast<std::uint32_t>(end); ++i)
                    found[i] = table.enter(keys[i], list_at(i), i, key_at);
            });
        std::map<std::uint64_t, std::uint32_t> entered;  // who came first with a key
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            if (found[i].index == KeyTable::Found::none) RC_ASSERT(entered.try_emplace(keys[i], i).second);
        }
        RC_ASSERT(entered.size() < keys.size() / 2);
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            const std::uint32_t first = entered.at(keys[i]);
            RC_ASSERT(found[i].index == (first == i ? KeyTable::Found::none : first));
            RC_ASSERT(found[i].list == list_at(first));
            RC_ASSERT(table.is_fresh(keys[i], key_at) == (list_at(first) == List::fresh));
        }
    });
}

TEST(ContactCache, ListsMayShrinkAndGrowByAnyAmount)
{
    Checked checked;
    std::uint64_t next = 0;
    for (const std::size_t count : {10'000, 3, 0, 7'000, 20'000, 1, 19'999, 40'000, 12}) {
        Keys keys(count);
        std::iota(keys.begin(), keys.end(), next);
        ASSERT_TRUE(checked.take_in(keys));
        next += count / 2;  // half of the keys recur
    }
}

/// Lists large enough for several parts. Each is the list before, changed in a way in which a host may change it.
TEST(ContactCache, OrderIsAHintOnly)
{
    Checked checked;
    std::mt19937 random(12345);
    Keys keys(30'000);
    std::iota(keys.begin(), keys.end(), 0);
    ASSERT_TRUE(checked.take_in(keys));
    const auto with = [&](const auto& change) {
        change();
        return checked.take_in(keys);
    };
    std::uint64_t fresh = 1'000'000;
    const auto come_and_go = [&] {
        Keys changed;
        for (const std::uint64_t key : keys) {
            if (random() % 10 != 0) changed.push_back(key);
            if (random() % 9 == 0) changed.push_back(fresh++);
        }
        keys = changed;
    };
    for (int step = 0; step < 5; ++step) EXPECT_TRUE(with(come_and_go));
    EXPECT_TRUE(with([&] { std::shuffle(keys.begin(), keys.end(), random); }));
    EXPECT_TRUE(with([&] { std::reverse(keys.begin(), keys.end()); }));
    EXPECT_TRUE(with([&] { std::rotate(keys.begin(), keys.begin() + 11'000, keys.end()); }));
    EXPECT_TRUE(with([&] { keys.erase(keys.begin() + 100, keys.begin() + 9'000); }));
    EXPECT_TRUE(with([&] {
        Keys crowd(9'000);
        std::iota(crowd.begin(), crowd.end(), fresh);
        fresh += crowd.size();
        keys.insert(keys.begin() + 200, crowd.begin(), crowd.end());
    }));
    EXPECT_TRUE(with(come_and_go));
    EXPECT_TRUE(with([] {}));
}

/// A repeated key is detected whether the last list had it or it is new, and in one part of the list or in two.
TEST(ContactCache, AKeyThatComesTwiceIsFoundOut)
{
    std::mt19937 random(12345);
    for (int round = 0; round < 300; ++round) {
        Checked checked;
        Keys keys(9'000);
        std::iota(keys.begin(), keys.end(), 0);
        ASSERT_TRUE(checked.take_in(keys));
        for (std::uint64_t& key : keys) {
            if (random() % 20 == 0) key += 1'000'000;
        }
        const auto any = [&] { return static_cast<std::ptrdiff_t>(random() % keys.size()); };
        const std::uint64_t twice = keys[static_cast<std::size_t>(any())];
        switch (round % 3) {
            case 0:
                keys[static_cast<std::size_t>(any())] = twice;
                break;
            case 1:
                keys.insert(keys.begin() + any(), twice);
                break;
            default:
                keys.insert(std::find(keys.begin(), keys.end(), twice), twice);
                break;
        }
        EXPECT_TRUE(checked.take_in(keys)) << round;
    }
}

}  // namespace
}  // namespace motley
