// Contacts found again from step to step. The table of keys changes only by the keys that come and go, which are
// few: most of a crowd touches the neighbours that it touched before.
#include "motley/core/contact_cache.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "motley/core/growth.h"

namespace motley {

void KeyTable::reserve(std::size_t count)
{
    const std::size_t tickets = std::bit_ceil(count);
    keys_.reserve(tickets);
    free_.reserve(tickets);
    const std::size_t wanted = std::bit_ceil(count + count / 4 + 1);
    if (buckets_.size() >= wanted) return;
    AlignedVector<std::uint64_t> wider(wanted);
    const int shift = 32 - std::countr_zero(wanted);
    for (const std::uint64_t held : buckets_) {
        if (held == 0) continue;
        std::size_t i = (held >> 32) >> shift;
        while (wider[i] != 0) i = (i + 1) & (wanted - 1);
        wider[i] = held;
    }
    buckets_ = std::move(wider);
    shift_ = shift;
}

/// The bucket that holds a key, or the empty one where it would go.
std::size_t KeyTable::bucket_of(std::uint64_t key) const
{
    const std::uint64_t hash = hash_of(key);
    for (std::size_t i = place_of(hash);; i = (i + 1) & (buckets_.size() - 1)) {
        const std::uint64_t held = buckets_[i];
        if (held == 0) return i;
        if (held >> 32 == hash && keys_[static_cast<std::uint32_t>(held) - 1] == key) return i;
    }
}

std::uint32_t KeyTable::find(std::uint64_t key) const
{
    return static_cast<std::uint32_t>(buckets_[bucket_of(key)]) - 1;  // an empty bucket's 0 becomes none
}

std::uint32_t KeyTable::insert(std::uint64_t key)
{
    reserve(size() + 1);
    const std::size_t bucket = bucket_of(key);
    if (buckets_[bucket] != 0) return none;
    std::uint32_t ticket;
    if (free_.empty()) {
        ticket = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
    } else {
        ticket = free_.back();
        free_.pop_back();
        keys_[ticket] = key;
    }
    buckets_[bucket] = hash_of(key) << 32 | (ticket + 1);
    return ticket;
}

void KeyTable::remove(std::uint64_t key)
{
    std::size_t hole = bucket_of(key);
    if (buckets_[hole] == 0) return;
    free_.push_back(static_cast<std::uint32_t>(buckets_[hole]) - 1);
    // Knuth, The Art of Computer Programming 3, algorithm 6.4R: whoever probed across the hole moves into it.
    const std::size_t mask = buckets_.size() - 1;
    for (std::size_t i = (hole + 1) & mask; buckets_[i] != 0; i = (i + 1) & mask) {
        const std::size_t home = place_of(buckets_[i] >> 32);
        if (((i - home) & mask) < ((i - hole) & mask)) continue;
        buckets_[hole] = buckets_[i];
        hole = i;
    }
    buckets_[hole] = 0;
}

void ContactCache::begin(std::size_t count)
{
    ContactList& list = staged();
    list.count = count;
    if (list.entries.size() < count) {
        // Room to grow into, so that a crowd that keeps pressing together does not allocate at each new contact.
        const std::size_t room = std::max<std::size_t>(64, with_room_to_grow(count));
        list.entries.resize(room);
        list.tickets.resize(room);
        list.colours.resize(room);
        list.impulses.resize(room + 1);
        newcomers_.resize(std::max(room, newcomers_.size()));
        leavers_.resize(std::max(room, leavers_.size()));
        // All gone and as many come, at most.
        const std::size_t tickets = lists_[0].entries.size() + lists_[1].entries.size();
        keys_.reserve(tickets);
        for (ContactList& either : lists_) either.positions.resize(tickets, none);
    }
    std::fill_n(list.positions.begin(), keys_.ticket_limit(), none);
    constexpr std::size_t contacts_per_part = 4096;
    surveys_.resize(std::max(count, current().count) / contacts_per_part + 1);
}

void ContactCache::survey(std::int64_t part)
{
    const ContactList& list = staged();
    const auto share = [&](std::size_t count, std::int64_t p) {
        return static_cast<std::uint32_t>(static_cast<std::int64_t>(count) * p / survey_parts());
    };
    Survey& found = surveys_[static_cast<std::size_t>(part)];
    found.has_repeated_key = false;
    found.first_newcomer = found.last_newcomer = share(list.count, part);
    for (std::uint32_t i = found.first_newcomer; i < share(list.count, part + 1); ++i) {
        const std::uint32_t ticket = list.tickets[i];
        if (ticket == none) {
            newcomers_[found.last_newcomer++] = i;
        } else {
            found.has_repeated_key = found.has_repeated_key || list.positions[ticket] != i;
        }
    }
    found.first_leaver = found.last_leaver = share(current().count, part);
    for (std::uint32_t i = found.first_leaver; i < share(current().count, part + 1); ++i) {
        if (list.positions[current().tickets[i]] == none) leavers_[found.last_leaver++] = i;
    }
}

bool ContactCache::admit()
{
    // Keys come and go in numbers that make a table's cache misses count; asked for this far ahead, they overlap.
    constexpr std::size_t ahead = 12;
    ContactList& list = staged();
    std::size_t new_count = 0, gone_count = 0;
    for (const Survey& survey : surveys_) {
        if (survey.has_repeated_key) return false;
        for (std::uint32_t k = survey.first_newcomer; k < survey.last_newcomer; ++k)
            newcomers_[new_count++] = newcomers_[k];
        for (std::uint32_t k = survey.first_leaver; k < survey.last_leaver; ++k)
            leavers_[gone_count++] = leavers_[k];
    }
    for (std::size_t k = 0; k < new_count; ++k) {
        if (k + ahead < new_count) keys_.prefetch(list.entries[newcomers_[k + ahead]].key);
        const std::uint32_t ticket = keys_.insert(list.entries[newcomers_[k]].key);
        if (ticket == none) {
            while (k-- > 0) keys_.remove(list.entries[newcomers_[k]].key);
            return false;
        }
        list.tickets[newcomers_[k]] = ticket;
        list.positions[ticket] = newcomers_[k];
    }
    for (std::size_t k = 0; k < gone_count; ++k) {
        if (k + ahead < gone_count) keys_.prefetch(current().entries[leavers_[k + ahead]].key);
        keys_.remove(current().entries[leavers_[k]].key);
    }
    return true;
}

bool ContactCache::restore(std::span<const ContactList::Entry> entries, std::span<const std::uint8_t> colours,
                           std::span<const ContactImpulse> impulses)
{
    begin(entries.size());
    ContactList& list = staged();
    std::copy(entries.begin(), entries.end(), list.entries.begin());
    std::copy(colours.begin(), colours.end(), list.colours.begin());
    std::copy(impulses.begin(), impulses.end(), list.impulses.begin() + 1);
    for (std::uint32_t i = 0; i < entries.size(); ++i) claim(i, none);
    for (std::int64_t part = 0; part < survey_parts(); ++part) survey(part);
    if (!admit()) return false;
    accept_staged();
    return true;
}

}  // namespace motley
