// Matches contacts with those of the last step: in a crowd most people touch the same neighbours as before.
#include "stores/contact_cache.h"

#include <algorithm>

#include "stores/growth.h"

namespace motley {
namespace {

constexpr std::size_t contacts_per_part = 2048;
/// How many contacts to either side a walk searches after it has lost its place.
constexpr std::uint32_t sight = 1024;

}  // namespace

void ContactCache::begin(std::size_t count)
{
    ContactList& list = staged();
    // With room to grow, so that a crowd that becomes denser does not allocate at every new contact. Each list is
    // judged by its own length, because memory may have run out between two of them in an earlier step.
    const auto grow = [](auto& values, std::size_t size) {
        if (values.size() < size) values.resize(size);
    };
    if (list.entries.size() < count) list.entries.resize(std::max<std::size_t>(64, with_room_to_grow(count)));
    const std::size_t room = list.entries.size();
    grow(list.colours, room);
    grow(list.impulses, room + 1);
    grow(list.step_impulses, room);
    grow(list.sleepers, room);
    list.has_sleepers = false;
    const std::size_t most = std::max(lists_[0].entries.size(), lists_[1].entries.size());
    parts_.reserve(most / contacts_per_part + 1);
    grow(claimed_, most);
    grow(missed_, most);
    grow(lost_, most);
    table_.reserve(2 * most, most);  // in case all contacts are gone and as many are new
    list.count = count;
    parts_.resize(std::max(count, current().count) / contacts_per_part + 1);
    std::fill_n(claimed_.begin(), current().count, std::uint8_t{0});
    looks_up_ = repeated_ = false;
}

ContactCache::Walk::Walk(ContactCache& cache, std::int64_t part)
    : cache_(cache), list_(cache.current()), part_(part), index_(cache.part(part).begin), missed_(index_)
{
    // Begin at the shift where the part before ended: in this step or, if it has not been read yet, in the last one.
    std::int32_t shift = 0;
    if (part > 0) shift = AtomicRef(cache.parts_[static_cast<std::size_t>(part - 1)].shift).load();
    cursor_ = static_cast<std::uint32_t>(
        std::clamp(std::int64_t{index_} + shift, std::int64_t{0}, static_cast<std::int64_t>(list_.count)));
}

ContactCache::Walk::~Walk()
{
    Part& part = cache_.parts_[static_cast<std::size_t>(part_)];
    part.missed = {cache_.part(part_).begin, missed_};
    part.claims = claims_;
    AtomicRef(part.shift).store(static_cast<std::int32_t>(cursor_) - static_cast<std::int32_t>(index_));
}

/// Searches the nearest contacts first: most often only a few have come or gone since the part before.
std::uint32_t ContactCache::Walk::look_around(std::uint64_t key) const
{
    const std::uint32_t ahead = std::min(static_cast<std::uint32_t>(list_.count) - cursor_, sight);
    const std::uint32_t behind = std::min(cursor_, sight);
    for (std::uint32_t i = 0; i < sight; ++i) {
        if (i < ahead && list_.entries[cursor_ + i].key == key) return cursor_ + i;
        if (i < behind && list_.entries[cursor_ - 1 - i].key == key) return cursor_ - 1 - i;
    }
    return none;
}

void ContactCache::find_lost(std::int64_t part)
{
    const Range range = share(current().count, part);
    std::uint32_t end = range.begin;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
        // Always written, and counted only if lost: a branch on it could not be predicted.
        lost_[end] = i;
        end += claimed_[i] == 0 ? 1 : 0;
    }
    parts_[static_cast<std::size_t>(part)].lost = {range.begin, end};
}

void ContactCache::open_table()
{
    std::size_t claims = 0, missed = 0, lost = 0;
    for (const Part& part : parts_) {
        claims += part.claims;
        missed += part.missed.end - part.missed.begin;
        lost += part.lost.end - part.lost.begin;
    }
    repeated_ = claims != current().count - lost;
    looks_up_ = missed > 0;
    if (looks_up_) table_.clear(lost + missed, missed);
}

void ContactCache::enter_lost(std::int64_t part)
{
    if (!looks_up_) return;
    const Range lost = parts_[static_cast<std::size_t>(part)].lost;
    for (std::uint32_t k = lost.begin; k < lost.end; ++k) {
        table_.enter(current().entries[lost_[k]].key, KeyTable::List::lost, lost_[k], keys());
    }
}

std::uint32_t ContactCache::trace(std::int64_t part, std::uint32_t index)
{
    const auto [which, found] =
        table_.enter(staged().entries[index].key, KeyTable::List::fresh, index, keys());
    if (found == KeyTable::Found::none) return none;
    if (which == KeyTable::List::fresh || AtomicRef(claimed_[found]).exchange(1) != 0) mark_repeated();
    AtomicRef(parts_[static_cast<std::size_t>(part)].shift)
        .store(static_cast<std::int32_t>(found) - static_cast<std::int32_t>(index));
    return which == KeyTable::List::lost ? found : none;
}

/// The only repeated keys not found yet: those of a new contact and of one that a walk has matched.
void ContactCache::verify(std::int64_t part)
{
    if (!looks_up_) return;
    const std::span<const std::uint32_t> others = missed(part);
    auto next = others.begin();
    const Range range = this->part(part);
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
        if (next != others.end() && *next == i) {
            ++next;
        } else if (table_.is_fresh(staged().entries[i].key, keys())) {
            mark_repeated();
        }
    }
}

bool ContactCache::restore(std::span<const ContactList::Entry> entries, std::span<const std::uint8_t> colours,
                           std::span<const ContactImpulse> impulses,
                           std::span<const ContactImpulse> step_impulses,
                           std::span<const std::uint32_t> sleepers)
{
    begin(entries.size());
    ContactList& list = staged();
    std::copy(entries.begin(), entries.end(), list.entries.begin());
    std::copy(colours.begin(), colours.end(), list.colours.begin());
    std::copy(impulses.begin(), impulses.end(), list.impulses.begin() + 1);
    std::copy(step_impulses.begin(), step_impulses.end(), list.step_impulses.begin());
    std::copy(sleepers.begin(), sleepers.end(), list.sleepers.begin());
    list.has_sleepers = !sleepers.empty();
    for (std::int64_t p = 0; p < part_count(); ++p) {
        Walk walk(*this, p);
        for (std::uint32_t i = part(p).begin; i < part(p).end; ++i) walk.find(i, list.entries[i].key);
    }
    for (std::int64_t p = 0; p < part_count(); ++p) find_lost(p);
    open_table();
    for (std::int64_t p = 0; p < part_count(); ++p) {
        for (const std::uint32_t i : missed(p)) trace(p, i);
    }
    if (has_repeated_key()) return false;
    accept_staged();
    return true;
}

}  // namespace motley
