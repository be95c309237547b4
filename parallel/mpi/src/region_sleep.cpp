// See region.h: sleep. An island is named by the smallest number of its people. Every rank knows the islands of those who
// sleep there, copies included, so that what wakes on one rank wakes on all by its name.
#include <algorithm>
#include <array>
#include <numeric>

#include "region.h"
#include "stopwatch.h"

namespace motley {

PersonRecord Region::read(const SceneCore& scene, std::uint32_t slot) const
{
    PersonRecord record = read_person(scene, slot);
    if (scene.bodies.is_asleep(slot)) record.island = island_of_[slot];
    return record;
}

std::int64_t Region::people_asleep(const SceneCore& scene) const
{
    if (scene.bodies.sleepers == 0) return 0;
    return static_cast<std::int64_t>(scene.bodies.sleepers) -
           std::count_if(above_.people.begin(), above_.people.end(),
                         [&](const BodyId copy) { return scene.bodies.is_asleep(copy.slot); });
}

std::uint32_t Region::known_slots(const SceneCore& scene) const
{
    return std::min(static_cast<std::uint32_t>(was_asleep_.size()), scene.bodies.slot_count());
}

/// Lists the islands of those who slept and do so no more, and of those who were removed.
void Region::list_woken(const SceneCore& scene)
{
    woken_.clear();
    if (scene.bodies.sleepers == sleepers_) return;
    sleepers_ = scene.bodies.sleepers;
    for (std::uint32_t slot = 1; slot < known_slots(scene); ++slot) {
        if (was_asleep_[slot] == 0 || scene.bodies.is_asleep(slot)) continue;
        was_asleep_[slot] = 0;
        woken_.push_back(island_of_[slot]);
    }
    std::sort(woken_.begin(), woken_.end());
    woken_.erase(std::unique(woken_.begin(), woken_.end()), woken_.end());
}

void Region::spread_waking(SceneCore& scene)
{
    if (!anybody_sleeps_) return;
    const Stopwatch watch(figures.seconds_agreeing);
    list_woken(scene);
    // Of each rank: how many islands woke, and whether anybody sleeps.
    const std::array<int, 2> own{static_cast<int>(woken_.size()), scene.bodies.sleepers > 0 ? 1 : 0};
    const auto ranks = static_cast<std::size_t>(ranks_);
    std::vector<std::array<int, 2>> of_ranks(ranks);
    MPI_Allgather(own.data(), 2, MPI_INT, of_ranks.data(), 2, MPI_INT, comm_);
    anybody_sleeps_ =
        std::any_of(of_ranks.begin(), of_ranks.end(), [](const std::array<int, 2>& of) { return of[1] > 0; });
    std::vector<int> counts(ranks), places(ranks);
    std::transform(of_ranks.begin(), of_ranks.end(), counts.begin(),
                   [](const std::array<int, 2>& of) { return of[0]; });
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0);
    woken_everywhere_.resize(static_cast<std::size_t>(places.back() + counts.back()));
    if (woken_everywhere_.empty()) return;
    MPI_Allgatherv(woken_.data(), own[0], MPI_UINT64_T, woken_everywhere_.data(), counts.data(),
                   places.data(), MPI_UINT64_T, comm_);
    std::sort(woken_everywhere_.begin(), woken_everywhere_.end());
    for (std::uint32_t slot = 1; slot < known_slots(scene); ++slot) {
        if (was_asleep_[slot] == 0 ||
            !std::binary_search(woken_everywhere_.begin(), woken_everywhere_.end(), island_of_[slot]))
            continue;
        was_asleep_[slot] = 0;
        scene.wake_island(slot);
    }
    sleepers_ = scene.bodies.sleepers;
}

void Region::renew_slowness(SceneCore& scene)
{
    const Stopwatch watch(figures.seconds_agreeing);
    std::vector<float> outgoing, incoming(above_.people.size());
    for (const BodyId body : below_.people)
        outgoing.push_back(scene.bodies.is_alive(body) ? scene.bodies.slow_for[body.slot] : 0);
    pass(below_, outgoing, above_, incoming, slowness_tag);
    for (std::size_t i = 0; i < above_.people.size(); ++i)
        scene.bodies.slow_for[above_.people[i].slot] = incoming[i];
}

/// Tells one neighbour, and hears from the other one, of which islands the people at the borders are, and joins the parts.
/// Returns whether something was new.
bool Region::exchange_parts(const SceneCore& scene, const Border& to, const Border& from,
                            const BodySets& islands, std::vector<Part>& parts) const
{
    const auto part_of = [&](BodyId body) -> Part& {
        return parts[static_cast<std::size_t>(islands.root(scene.bodies.row_of(body)))];
    };
    std::vector<Part> outgoing, incoming(from.people.size());
    for (const BodyId body : to.people)
        outgoing.push_back(scene.bodies.is_alive(body) ? part_of(body) : Part{});
    pass(to, outgoing, from, incoming, islands_tag);
    bool is_new = false;
    for (std::size_t i = 0; i < incoming.size(); ++i) {
        if (!scene.bodies.is_alive(from.people[i])) continue;
        Part& own = part_of(from.people[i]);
        const Part joined{std::min(own.island, incoming[i].island),
                          own.is_restless | incoming[i].is_restless};
        is_new = is_new || joined.island != own.island || joined.is_restless != own.is_restless;
        own = joined;
    }
    return is_new;
}

void Region::join_islands(const SceneCore& scene, const BodySets& islands, std::span<std::uint8_t> restless)
{
    const Stopwatch watch(figures.seconds_agreeing);
    std::vector<Part> parts(islands.size());
    const auto root_of = [&](BodyId body) {
        return static_cast<std::size_t>(islands.root(scene.bodies.row_of(body)));
    };
    const auto for_each_here = [&](const auto& work) {
        for (const OwnPerson& person : people) work(person.body);
        for (const BodyId copy : above_.people) work(copy);
    };
    for_each_here([&](BodyId body) {
        Part& part = parts[root_of(body)];
        part.island = std::min(part.island, scene.discs.numbers[body.slot]);
        part.is_restless = restless[root_of(body)];
    });
    // An island may cross borders several times: until no rank hears anything new.
    for (bool is_new = true; is_new;) {
        const bool from_above = exchange_parts(scene, below_, above_, islands, parts);
        const bool from_below = exchange_parts(scene, above_, below_, islands, parts);
        is_new = is_so_anywhere(from_above || from_below);
    }
    for_each_here([&](BodyId body) {
        restless[root_of(body)] = parts[root_of(body)].is_restless != 0 ? 1 : 0;
        if (!scene.bodies.is_asleep(body.slot)) island_of_[body.slot] = parts[root_of(body)].island;
    });
}

void Region::note_sleepers(const SceneCore& scene)
{
    for (std::uint32_t slot = 1; slot < known_slots(scene); ++slot)
        was_asleep_[slot] = scene.bodies.is_asleep(slot) ? 1 : 0;
    sleepers_ = scene.bodies.sleepers;
    anybody_sleeps_ = is_so_anywhere(sleepers_ > 0);
}

}  // namespace motley
