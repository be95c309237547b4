// How the plane is dealt out to the ranks, and how people move between them, at a search for all contacts.
#include <algorithm>
#include <numeric>

#include "region.h"
#include "shared_file.h"
#include "stopwatch.h"

namespace motley {
namespace {

/// The strip of a body, of all bodies the same way: from its place, rounded as that of an anchor is.
std::int32_t strip_of(const SceneCore& scene, const DiscStrips& strips, std::uint32_t row)
{
    const Vec3<PoseReal>& at = scene.bodies.rows(BodyKind::planar).pose[row].position;
    const DiscAnchor anchor{static_cast<float>(static_cast<double>(at.x) - scene.discs.frame.origin.x),
                            static_cast<float>(static_cast<double>(at.y) - scene.discs.frame.origin.y)};
    return strips.strip_at(strips.to_strips(anchor).y);
}

}  // namespace

int Region::rank_of(std::size_t band) const
{
    // The last rank that begins at or below the band: those before it that begin there too have no bands.
    return static_cast<int>(std::upper_bound(starts_.begin(), starts_.end() - 1, band) - starts_.begin()) - 1;
}

/// Cuts the bands into ranges of about as many people each.
void Region::deal_out(const DiscStrips& strips)
{
    const auto bands = static_cast<std::size_t>(strips.band_count());
    const std::span<const std::uint32_t> in_strip = strips.discs_by_strip();
    const auto all = std::accumulate(in_strip.begin(), in_strip.end(), std::int64_t{0});
    std::vector<std::int64_t> before(bands + 1, 0);  // people before each band
    for (std::size_t band = 0; band < bands; ++band) {
        before[band + 1] = before[band];
        for (std::int32_t s = strips.first_strip(static_cast<std::int32_t>(band));
             s < strips.first_strip(static_cast<std::int32_t>(band) + 1); ++s)
            before[band + 1] += in_strip[static_cast<std::size_t>(s)];
    }
    std::size_t band = 0;
    for (int rank = 0; rank < ranks_; ++rank) {
        const std::int64_t wanted = all * rank / ranks_;
        // The cut nearest to what is wanted.
        while (band < bands && before[band + 1] - wanted <= wanted - before[band]) ++band;
        starts_[static_cast<std::size_t>(rank)] = band + 1;
    }
    starts_[0] = 1;
    starts_.back() = bands + 1;
    first_ = starts_[static_cast<std::size_t>(rank_)];
    last_ = starts_[static_cast<std::size_t>(rank_) + 1];
    const bool has_any = first_ < last_;
    below_.rank = has_any && first_ > 1 ? rank_of(first_ - 1) : nobody;
    above_.rank = has_any && last_ <= bands ? rank_of(last_) : nobody;
    is_dealt_anew_ = true;
    // Of each strip.
    owners_.resize(in_strip.size());
    copiers_.assign(in_strip.size(), nobody);
    for (std::size_t b = 1; b <= bands; ++b) {
        for (std::int32_t s = strips.first_strip(static_cast<std::int32_t>(b) - 1);
             s < strips.first_strip(static_cast<std::int32_t>(b)); ++s) {
            owners_[static_cast<std::size_t>(s)] = rank_of(b);
            if (b > 1 && rank_of(b - 1) != rank_of(b)) copiers_[static_cast<std::size_t>(s)] = rank_of(b - 1);
        }
    }
}

/// Sends each rank its records, and returns those from all ranks, in the order of the ranks.
template <class Record>
std::vector<Record> Region::exchange(const std::vector<std::vector<Record>>& outgoing)
{
    const auto ranks = static_cast<std::size_t>(ranks_);
    std::vector<int> sent(ranks), sent_at(ranks), taken(ranks), taken_at(ranks);
    std::vector<Record> all;
    for (std::size_t rank = 0; rank < ranks; ++rank) {
        sent_at[rank] = static_cast<int>(all.size());
        sent[rank] = static_cast<int>(outgoing[rank].size());
        all.insert(all.end(), outgoing[rank].begin(), outgoing[rank].end());
        if (static_cast<int>(rank) != rank_)
            figures.moved_bytes += static_cast<std::int64_t>(sizeof(Record) * outgoing[rank].size());
    }
    MPI_Alltoall(sent.data(), 1, MPI_INT, taken.data(), 1, MPI_INT, comm_);
    std::exclusive_scan(taken.begin(), taken.end(), taken_at.begin(), 0);
    std::vector<Record> coming(static_cast<std::size_t>(taken_at.back() + taken.back()));
    const RecordType<Record> type;
    MPI_Alltoallv(all.data(), sent.data(), sent_at.data(), type.get(), coming.data(), taken.data(),
                  taken_at.data(), type.get(), comm_);
    return coming;
}

/// Copies are forgotten like those whom they are copies of: hosts teleport and remove people of their own rank only.
void Region::leave_copies_out(SceneCore& scene)
{
    const Stopwatch watch(figures.seconds_agreeing);
    std::vector<std::uint8_t> outgoing, incoming(above_.people.size());
    for (const BodyId body : below_.people) {
        const bool is_here =
            scene.bodies.is_alive(body) && !scene.discs.is_forgotten_row(scene.bodies.row_of(body).row());
        outgoing.push_back(is_here ? 0 : 1);
    }
    pass(below_, outgoing, above_, incoming, forgotten_tag);
    is_forgotten_.assign(scene.bodies.rows(BodyKind::planar).size(), 0);
    for (std::size_t i = 0; i < incoming.size(); ++i)
        is_forgotten_[scene.bodies.row_of(above_.people[i]).row()] = incoming[i];
    for (const BodyId body : above_.people) scene.discs.set_shape(body.slot, {});
}

void Region::move_people(SceneCore& scene, const DiscStrips& strips, CarriedImpulses& carried)
{
    const Stopwatch watch(figures.seconds_agreeing);
    deal_out(strips);
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    strip_of_.assign(rows.size(), 0);
    for (std::uint32_t row = 1; row < rows.size(); ++row) {
        if (rows.slot[row] != 0) strip_of_[row] = static_cast<std::size_t>(strip_of(scene, strips, row));
    }
    std::vector<std::vector<ImpulseRecord>> impulses = take_out_impulses(scene, carried);
    send_waiting_impulses(scene, impulses);
    std::vector<std::vector<PersonRecord>> going(static_cast<std::size_t>(ranks_));
    for (const OwnPerson& person : people) {
        const std::uint32_t slot = person.body.slot;
        if (scene.bodies.contained[slot] != 0) continue;
        const std::size_t strip = strip_of_[scene.bodies.row_of(person.body).row()];
        const int owner = owners_[strip], copier = copiers_[strip];
        if (owner == rank_ && copier == nobody) continue;
        PersonRecord record = read(scene, slot);
        if (owner != rank_) going[static_cast<std::size_t>(owner)].push_back(record);
        record.is_copy = 1;
        if (copier != nobody) going[static_cast<std::size_t>(copier)].push_back(record);
    }
    remove_those_who_go(scene);
    take_in_people(scene, exchange(going));
    const std::vector<ImpulseRecord> coming = exchange(impulses);
    carried.make_room(scene.bodies.rows(BodyKind::planar).size(), coming.size());
    for (const BodyId body : above_.people) carried.forget_row(scene.bodies.row_of(body).row());
    take_in_impulses(scene, coming, carried);
    ++figures.searches;
    figures.people = static_cast<std::int64_t>(people.size());
}

ImpulseRecord Region::record_of(const SceneCore& scene, std::uint32_t row, std::uint32_t other, bool is_wall,
                                const CarriedImpulses::Impulse& impulse)
{
    const auto number_of = [&](std::uint32_t of) {
        return scene.discs.numbers[scene.bodies.rows(BodyKind::planar).slot[of]];
    };
    return {number_of(row),       is_wall ? std::uint64_t{other} : number_of(other),
            impulse.normal,       impulse.tangent,
            impulse.side,         impulse.step_normal,
            impulse.step_tangent, is_wall ? 1U : 0U};
}

/// Takes out the impulses of contacts that another rank will find, and of people whose rows change, as the records that
/// go to each rank.
std::vector<std::vector<ImpulseRecord>> Region::take_out_impulses(const SceneCore& scene,
                                                                  CarriedImpulses& carried) const
{
    std::vector<std::vector<ImpulseRecord>> records(static_cast<std::size_t>(ranks_));
    const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
    const auto stays = [&](std::uint32_t row) {
        return !is_copy(slots[row]) && owners_[strip_of_[row]] == rank_;
    };
    carried.take_out([&](std::uint32_t row, std::uint32_t other, bool is_wall,
                         const CarriedImpulses::Impulse& impulse) {
        if (is_forgotten_[row] != 0 || (!is_wall && is_forgotten_[other] != 0)) return true;
        const int finder = owners_[is_wall ? strip_of_[row] : std::min(strip_of_[row], strip_of_[other])];
        if (finder == rank_ && stays(row) && (is_wall || stays(other))) return false;
        records[static_cast<std::size_t>(finder)].push_back(record_of(scene, row, other, is_wall, impulse));
        return true;
    });
    return records;
}

/// Removes the copies, and the people of other ranks.
void Region::remove_those_who_go(SceneCore& scene)
{
    std::vector<BodyId> removed = std::move(above_.people);
    above_.people.clear();
    for (std::size_t i = 0; i < people.size();) {
        const OwnPerson person = people[i];
        if (scene.bodies.contained[person.body.slot] != 0 ||
            owners_[strip_of_[scene.bodies.row_of(person.body).row()]] == rank_) {
            ++i;
            continue;
        }
        removed.push_back(person.body);
        forget_person(person.number);
    }
    // Their islands go on sleeping elsewhere: nobody is told that who is removed here has woken.
    for (const BodyId body : removed) is_copy_[body.slot] = was_asleep_[body.slot] = 0;
    scene_.remove_bodies(removed);
}

void Region::forget_person(std::uint64_t number)
{
    const auto place = index_of.find(number);
    people[place->second] = people.back();
    index_of[people.back().number] = place->second;
    people.pop_back();
    index_of.erase(number);
}

void Region::take_in_people(SceneCore& scene, std::span<const PersonRecord> coming)
{
    const std::vector<BodyDefinition> definitions(
        coming.size(), BodyDefinition{.model = BodyModel::planar, .motion = BodyMotion::dynamic_body});
    std::vector<BodyId> bodies(coming.size());
    scene_.add_bodies(definitions, bodies);
    grow_with_slots();
    for (std::size_t i = 0; i < coming.size(); ++i) {
        const BodyId body = bodies[i];
        write_person(scene, body.slot, coming[i]);
        if (coming[i].user_data != 0) scene_.set_user_data(body, coming[i].user_data);
        is_copy_[body.slot] = coming[i].is_copy != 0 ? 1 : 0;
        was_asleep_[body.slot] = coming[i].sleep != 0 ? 1 : 0;
        island_of_[body.slot] = coming[i].island;
        if (coming[i].is_copy != 0) {
            above_.people.push_back(body);  // in their order once they are sorted
        } else {
            index_of[coming[i].number] = static_cast<std::uint32_t>(people.size());
            people.push_back({coming[i].number, body});
            ++figures.crossings;
        }
    }
    sleepers_ = scene.bodies.sleepers;
}

void Region::take_in_impulses(const SceneCore& scene, std::span<const ImpulseRecord> impulses,
                              CarriedImpulses& carried) const
{
    std::unordered_map<std::uint64_t, BodyId> copies;
    for (const BodyId body : above_.people) copies[scene.discs.numbers[body.slot]] = body;
    constexpr std::uint32_t none = UINT32_MAX;
    const auto row_of = [&](std::uint64_t number) {
        const auto own = index_of.find(number);
        if (own != index_of.end()) return scene.bodies.row_of(people[own->second].body).row();
        const auto copy = copies.find(number);
        return copy == copies.end() ? none : scene.bodies.row_of(copy->second).row();
    };
    for (const ImpulseRecord& record : impulses) {
        const bool is_wall = record.is_wall != 0;
        const std::uint32_t row = row_of(record.a),
                            other = is_wall ? static_cast<std::uint32_t>(record.b) : row_of(record.b);
        // Two who are in no band of this region together any more do not touch.
        if (row == none || other == none) continue;
        carried.put_in(row, other, is_wall,
                       {record.normal, record.tangent, record.side, record.step_normal, record.step_tangent});
    }
}

}  // namespace motley
