// Checkpoints: all people of all ranks, and the impulses of their contacts, in one file by MPI-IO.
//
// The file: a CheckpointHead; a SavedPerson for each person; an ImpulseRecord for each impulse, those of one person after
// another.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <unordered_set>

#include "maths/bit_cast.h"
#include "maths/hash.h"
#include "motley/core/invalid_input.h"
#include "region.h"
#include "scene/body_checks.h"
#include "shared_file.h"

namespace motley {
namespace {

struct SavedPerson {
    PersonRecord person;
    std::uint64_t first_impulse = 0;  ///< of all impulses in the file
};
struct CheckpointHead {
    std::array<char, 8> magic{'m', 'o', 't', 'l', 'e', 'y', 'M', 'P'};
    std::uint64_t version = 2;
    std::uint64_t person_bytes = sizeof(SavedPerson);  ///< fewer where positions are floats
    std::uint64_t people = 0, impulses = 0;
    std::uint64_t steps = 0;
    std::uint64_t walls = 0;  ///< a hash of them
    std::uint64_t check = 0;  ///< the sum of the hashes of all records and of this head, but for its check
    float last_step = 0, last_substep = 0;
    std::uint64_t is_turned = 0;  ///< StripFrame::is_turned
    std::array<float, 3> gravity{};
    float sleep_speed = 0;
    std::uint64_t pause = 0;  ///< SleepStore::pause
};
// Files have no undefined bytes.
static_assert(sizeof(CheckpointHead) == 104 && sizeof(ImpulseRecord) == 40);
static_assert(sizeof(SavedPerson) == 4 * sizeof(PoseReal) + 112);

template <class Record>
std::uint64_t hash_of_record(const Record& record)
{
    std::array<std::uint64_t, sizeof(Record) / 8> words;
    std::memcpy(words.data(), &record, sizeof record);
    return hash_bytes(0, words.data(), words.size());
}
template <class Record>
std::uint64_t check_of(const std::vector<Record>& records)
{
    std::uint64_t sum = 0;
    for (const Record& record : records) sum += hash_of_record(record);
    return sum;
}
std::uint64_t check_of(CheckpointHead head)
{
    head.check = 0;
    return hash_of_record(head);
}
std::uint64_t hash_of_walls(const SceneCore& scene)
{
    std::uint64_t hash = scene.discs.segments.size();
    for (const WallSegment& segment : scene.discs.segments) {
        for (const double x : {segment.from.x, segment.from.y, segment.to.x, segment.to.y})
            hash = mix(hash, bit_cast<std::uint64_t>(x));
        hash = mix(hash, bit_cast<std::uint32_t>(segment.friction));
    }
    return hash;
}

/// Whether a person of a file is one whom a crowd could have had.
bool is_fit(const PersonRecord& person)
{
    const PersonState& state = person.state;
    const DiscShape& shape = person.shape;
    try {
        check_disc({shape.radius, shape.friction, shape.category, shape.mask});
        check_damping("PersonRecord", state.damping.linear, state.damping.angular);
    } catch (const InvalidInput&) {
        return false;
    }
    const auto is_within = [](auto value, double low, double high) {
        const auto number = static_cast<double>(value);
        return number >= low && number <= high;
    };
    const Vec3<double> at = convert<double>(state.pose.position);
    bool is_good = is_coordinate(at.x) && is_coordinate(at.y) && is_coordinate(at.z) &&
                   is_within(state.pose.yaw, -1e15, 1e15) && is_within(person.inverse_mass, 1e-10, 1e10) &&
                   is_within(person.inverse_inertia, 1e-20, 1e20) && is_within(person.slow_for, 0, 1e30) &&
                   person.sleep <= static_cast<std::uint32_t>(Sleep::roused) && person.is_copy == 0;
    for (const float value : state.velocity) is_good = is_good && is_within(value, -1e30, 1e30);
    for (const float value : state.acceleration) is_good = is_good && is_within(value, -1e38, 1e38);
    for (const float value : person.sleeper_acceleration) is_good = is_good && is_within(value, -1e38, 1e38);
    return is_good;
}

}  // namespace

std::vector<std::vector<ImpulseRecord>> Region::impulses_by_person(const SceneCore& scene) const
{
    CarriedImpulses carried;
    carried.begin(scene);
    for (std::size_t band = 0; band < scene.discs.band_count; ++band) carried.count(scene.discs, band);
    carried.open();
    for (std::size_t band = 0; band < scene.discs.band_count; ++band) carried.keep(scene.discs, band);
    const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
    std::vector<std::vector<ImpulseRecord>> records(people.size());
    carried.take_out(
        [&](std::uint32_t row, std::uint32_t other, bool is_wall, const CarriedImpulses::Impulse& impulse) {
            // The impulse is of a person of this rank; the second one may be of the region above.
            if (!is_wall && is_copy(slots[row])) std::swap(row, other);
            const std::uint64_t number = scene.discs.numbers[slots[row]];
            const auto own = index_of.find(number);
            if (own == index_of.end()) return false;  // removed since
            records[own->second].push_back(record_of(scene, row, other, is_wall, impulse));
            return false;
        });
    return records;
}

void Region::save(const std::string& path)
{
    SceneCore& scene = core_of(scene_);
    std::int64_t contained = static_cast<std::int64_t>(scene.bodies.contained_count);
    MPI_Allreduce(MPI_IN_PLACE, &contained, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (contained > 0)
        refuse("people contained when a checkpoint is written", static_cast<double>(contained),
               "0: revive or remove them first");
    spread_waking(scene);  // of those whom the host has woken since the last step
    std::vector<SavedPerson> saved(people.size());
    std::vector<ImpulseRecord> impulses;
    const std::vector<std::vector<ImpulseRecord>> by_person = impulses_by_person(scene);
    std::array<std::uint64_t, 2> before{0, 0};  // people and impulses of the ranks before this one
    for (std::size_t i = 0; i < people.size(); ++i) {
        saved[i] = {read(scene, people[i].body.slot), impulses.size()};
        impulses.insert(impulses.end(), by_person[i].begin(), by_person[i].end());
    }
    const std::array<std::uint64_t, 2> own{saved.size(), impulses.size()};
    MPI_Exscan(own.data(), before.data(), 2, MPI_UINT64_T, MPI_SUM, comm_);
    if (rank_ == 0) before = {0, 0};
    for (SavedPerson& person : saved) person.first_impulse += before[1];

    CheckpointHead head;
    std::array<std::uint64_t, 3> sums{own[0], own[1], check_of(saved) + check_of(impulses)};
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 3, MPI_UINT64_T, MPI_SUM, comm_);
    head.people = sums[0];
    head.impulses = sums[1];
    head.steps = static_cast<std::uint64_t>(figures.steps);
    head.walls = hash_of_walls(scene);
    head.last_step = scene.last_step;
    head.last_substep = scene.last_substep;
    head.is_turned = scene.discs.frame.is_turned != 0 ? 1 : 0;
    const Vec3<float>& gravity = scene.sleep.gravity;
    head.gravity = {gravity.x, gravity.y, gravity.z};
    head.sleep_speed = scene.sleep.speed;
    head.pause = static_cast<std::uint64_t>(scene.sleep.pause);
    head.check = check_of(head) + sums[2];

    SharedFile file(comm_, path, SharedFile::Use::write);
    file.write(0, std::span<const CheckpointHead>(&head, rank_ == 0 ? 1 : 0));
    file.write(sizeof head + before[0] * sizeof(SavedPerson), std::span<const SavedPerson>(saved));
    file.write(sizeof head + head.people * sizeof(SavedPerson) + before[1] * sizeof(ImpulseRecord),
               std::span<const ImpulseRecord>(impulses));
    file.finish();
    // Who goes on from the file searches for contacts, and so does who has written it. Before that neither knows who lies beside
    // whom, so that neither wakes anybody for it.
    scene.discs.is_stale = true;
    for (DiscBand& band : scene.discs.bands) band.half_awake = 0;
}

void Region::load(const std::string& path)
{
    SceneCore& scene = core_of(scene_);
    std::int64_t present = static_cast<std::int64_t>(people.size());
    MPI_Allreduce(MPI_IN_PLACE, &present, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (present > 0) refuse("people of a crowd that loads a checkpoint", static_cast<double>(present), "0");
    SharedFile file(comm_, path, SharedFile::Use::read);
    const std::uint64_t bytes = file.size();
    file.require(bytes >= sizeof(CheckpointHead), "no checkpoint of motley, or cut short");
    CheckpointHead head;
    file.read(0, std::span<CheckpointHead>(&head, 1));
    file.require(head.magic == CheckpointHead().magic, "no checkpoint of motley");
    file.require(head.version == CheckpointHead().version, "a checkpoint of another version");
    file.require(head.person_bytes == sizeof(SavedPerson), "of a build whose positions have other digits");
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    file.require(
        head.people <= most && head.impulses <= 64 * most &&
            bytes == sizeof head + head.people * sizeof(SavedPerson) + head.impulses * sizeof(ImpulseRecord),
        "cut short, or longer than it says");
    file.require(head.walls == hash_of_walls(scene), "of a crowd between other walls");

    const auto share = [&](int rank) {
        return head.people * static_cast<std::uint64_t>(rank) / static_cast<std::uint64_t>(ranks_);
    };
    const std::uint64_t first = share(rank_), last = share(rank_ + 1);
    // One more, if there is one, says where the impulses of the last one end.
    std::vector<SavedPerson> saved(static_cast<std::size_t>(std::min(last + 1, head.people) - first));
    file.read(sizeof head + first * sizeof(SavedPerson), std::span<SavedPerson>(saved));
    const bool has_next = last < head.people;
    const std::uint64_t first_impulse = saved.empty() ? head.impulses : saved.front().first_impulse;
    const std::uint64_t last_impulse = has_next ? saved.back().first_impulse : head.impulses;
    if (has_next) saved.pop_back();
    file.require(first_impulse <= last_impulse && last_impulse <= head.impulses, "damaged");
    std::vector<ImpulseRecord> impulses(static_cast<std::size_t>(last_impulse - first_impulse));
    file.read(sizeof head + head.people * sizeof(SavedPerson) + first_impulse * sizeof(ImpulseRecord),
              std::span<ImpulseRecord>(impulses));
    std::uint64_t check = check_of(saved) + check_of(impulses);
    MPI_Allreduce(MPI_IN_PLACE, &check, 1, MPI_UINT64_T, MPI_SUM, comm_);
    file.require(check + check_of(head) == head.check, "damaged: its checksum is wrong");

    std::unordered_set<std::uint64_t> numbers;
    bool are_fit = true;
    for (const SavedPerson& person : saved)
        are_fit = are_fit && is_fit(person.person) && numbers.insert(person.person.number).second;
    for (const ImpulseRecord& impulse : impulses)
        are_fit = are_fit && std::isfinite(impulse.normal) && std::isfinite(impulse.tangent) &&
                  (impulse.is_wall == 0 || impulse.b < scene.discs.segments.size());
    file.require(are_fit, "holds a person or an impulse that no crowd has");

    std::vector<PersonRecord> coming(saved.size());
    std::transform(saved.begin(), saved.end(), coming.begin(),
                   [](const SavedPerson& person) { return person.person; });
    take_in_people(scene, coming);
    waiting_impulses_ = std::move(impulses);
    figures = {};
    figures.steps = static_cast<std::int64_t>(head.steps);
    scene.last_step = head.last_step;
    scene.last_substep = head.last_substep;
    scene.discs.frame.is_turned = head.is_turned != 0 ? 1 : 0;
    scene.sleep.gravity = {head.gravity[0], head.gravity[1], head.gravity[2]};
    scene.sleep.speed = head.sleep_speed;
    scene.sleep.pause = static_cast<std::int32_t>(head.pause);
    anybody_sleeps_ = true;  // until the next step knows better
}

/// After load(): the impulses go to the ranks that may find their contacts. Those that find none forget them.
void Region::send_waiting_impulses(const SceneCore& scene, std::vector<std::vector<ImpulseRecord>>& records)
{
    for (const ImpulseRecord& record : waiting_impulses_) {
        const auto own = index_of.find(record.a);
        if (own == index_of.end()) continue;  // removed since
        const std::size_t strip = strip_of_[scene.bodies.row_of(people[own->second].body).row()];
        records[static_cast<std::size_t>(owners_[strip])].push_back(record);
        if (copiers_[strip] != nobody) records[static_cast<std::size_t>(copiers_[strip])].push_back(record);
    }
    waiting_impulses_.clear();
}

}  // namespace motley
