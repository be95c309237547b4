// Checkpoints: all people of all ranks, and the impulses of their contacts, in one file by MPI-IO.
//
// The file: a CheckpointHead; a SavedPerson for each person; an ImpulseRecord for each impulse, those of one person after
// another. It is written beside its place and moved there when it is whole.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_set>

#include "maths/bit_cast.h"
#include "motley/core/invalid_input.h"
#include "region.h"
#include "stopwatch.h"

namespace motley {
namespace {

struct SavedPerson {
    PersonRecord person;
    std::uint64_t first_impulse = 0;  ///< of all impulses in the file
};
struct CheckpointHead {
    std::array<char, 8> magic{'m', 'o', 't', 'l', 'e', 'y', 'M', 'P'};
    std::uint64_t version = 1;
    std::uint64_t person_bytes = sizeof(SavedPerson);  ///< fewer where positions are floats
    std::uint64_t people = 0, impulses = 0;
    std::uint64_t steps = 0;
    std::uint64_t walls = 0;  ///< a hash of them
    std::uint64_t check = 0;  ///< the sum of the hashes of all records
    float last_step = 0, last_substep = 0;
    std::uint64_t is_turned = 0;  ///< StripFrame::is_turned
};
// Files have no undefined bytes.
static_assert(sizeof(CheckpointHead) == 80 && sizeof(ImpulseRecord) == 32);
static_assert(sizeof(SavedPerson) == 4 * sizeof(PoseReal) + 88);

std::uint64_t mix(std::uint64_t hash, std::uint64_t value)
{
    hash = (hash ^ value) * 0xBF58476D1CE4E5B9ULL;
    return hash ^ (hash >> 29);
}
template <class Record>
std::uint64_t check_of(const std::vector<Record>& records)
{
    std::uint64_t sum = 0;
    for (const Record& record : records) {
        std::array<std::uint64_t, sizeof(Record) / 8> words;
        std::memcpy(words.data(), &record, sizeof record);
        std::uint64_t hash = 0x9E3779B97F4A7C15ULL;
        for (const std::uint64_t word : words) hash = mix(hash, word);
        sum += hash;
    }
    return sum;
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
    const auto is_within = [](double value, double low, double high) {
        return value >= low && value <= high;
    };
    const PersonState& state = person.state;
    const auto real = [](auto value) { return static_cast<double>(value); };
    bool good =
        is_within(real(state.pose.position.x), -1e12, 1e12) &&
        is_within(real(state.pose.position.y), -1e12, 1e12) &&
        is_within(real(state.pose.position.z), -1e12, 1e12) && is_within(real(state.pose.yaw), -1e15, 1e15) &&
        is_within(real(person.inverse_mass), 1e-10, 1e10) &&
        is_within(real(person.inverse_inertia), 1e-20, 1e20) &&
        is_within(real(person.shape.radius), 1e-6, 1e6) && is_within(real(person.shape.friction), 0, 1e9) &&
        is_within(real(state.damping.linear), 0, 1e6) && is_within(real(state.damping.angular), 0, 1e6) &&
        person.is_copy == 0;
    for (const float value : state.velocity) good = good && is_within(real(value), -1e30, 1e30);
    for (const float value : state.acceleration) good = good && is_within(real(value), -1e38, 1e38);
    return good;
}

/// A file that all ranks have open. Errors of one rank are errors of all.
class SharedFile {
  public:
    SharedFile(MPI_Comm comm, const std::string& path, int mode) : comm_(comm), path_(path)
    {
        require(MPI_File_open(comm, path.c_str(), mode, MPI_INFO_NULL, &file_), "cannot be opened");
    }
    ~SharedFile()
    {
        if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
    }
    SharedFile(const SharedFile&) = delete;
    SharedFile& operator=(const SharedFile&) = delete;

    template <class Record>
    void write(std::uint64_t at, const std::vector<Record>& records)
    {
        require(MPI_File_write_at_all(file_, static_cast<MPI_Offset>(at), records.data(), count_of(records),
                                      MPI_UINT64_T, MPI_STATUS_IGNORE),
                "cannot be written");
    }
    template <class Record>
    void read(std::uint64_t at, std::vector<Record>& records)
    {
        require(MPI_File_read_at_all(file_, static_cast<MPI_Offset>(at), records.data(), count_of(records),
                                     MPI_UINT64_T, MPI_STATUS_IGNORE),
                "cannot be read");
    }
    [[nodiscard]] std::uint64_t size()
    {
        MPI_Offset bytes = 0;
        require(MPI_File_get_size(file_, &bytes), "cannot be read");
        return static_cast<std::uint64_t>(bytes);
    }
    /// The bytes are on the disk when this returns.
    void finish()
    {
        require(MPI_File_sync(file_), "cannot be written");
        require(MPI_File_close(&file_), "cannot be written");
    }

  private:
    MPI_Comm comm_;
    std::string path_;
    MPI_File file_ = MPI_FILE_NULL;

    template <class Record>
    static int count_of(const std::vector<Record>& records)
    {
        return static_cast<int>(records.size() * (sizeof(Record) / 8));
    }
    void require(int result, const char* what)
    {
        int failed = result == MPI_SUCCESS ? 0 : 1;
        MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, comm_);
        if (failed != 0) throw std::runtime_error(path_ + ": " + what);
    }
};

}  // namespace

std::vector<std::vector<ImpulseRecord>> Region::impulses_by_person(const SceneCore& scene) const
{
    CarriedImpulses carried;
    carried.begin(scene);
    for (std::size_t band = 0; band < scene.discs.band_count; ++band) carried.count(scene.discs, band);
    carried.open();
    for (std::size_t band = 0; band < scene.discs.band_count; ++band) carried.keep(scene.discs, band);
    const std::vector<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
    std::vector<std::vector<ImpulseRecord>> records(people.size());
    carried.take_out([&](std::uint32_t row, std::uint32_t other, bool is_wall,
                         const CarriedImpulses::Impulse& impulse) {
        // The impulse is of a person of this rank; the second one may be of the region above.
        if (!is_wall && is_copy(slots[row])) std::swap(row, other);
        const std::uint64_t number = scene.discs.numbers[slots[row]];
        const auto own = index_of.find(number);
        if (own == index_of.end()) return false;  // removed since
        records[own->second].push_back({number,
                                        is_wall ? std::uint64_t{other} : scene.discs.numbers[slots[other]],
                                        impulse.normal, impulse.tangent, impulse.side, is_wall ? 1U : 0U});
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
    std::vector<SavedPerson> saved(people.size());
    std::vector<ImpulseRecord> impulses;
    const std::vector<std::vector<ImpulseRecord>> by_person = impulses_by_person(scene);
    std::array<std::uint64_t, 2> before{0, 0};  // people and impulses of the ranks before this one
    for (std::size_t i = 0; i < people.size(); ++i) {
        saved[i] = {read_person(scene, people[i].body.slot), impulses.size()};
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
    head.check = sums[2];
    head.steps = static_cast<std::uint64_t>(figures.steps);
    head.walls = hash_of_walls(scene);
    head.last_step = scene.last_step;
    head.last_substep = scene.last_substep;
    head.is_turned = scene.discs.frame.is_turned != 0 ? 1 : 0;

    const std::string part = path + ".part";
    SharedFile file(comm_, part, MPI_MODE_CREATE | MPI_MODE_WRONLY);
    file.write(0, rank_ == 0 ? std::vector<CheckpointHead>{head} : std::vector<CheckpointHead>{});
    file.write(sizeof head + before[0] * sizeof(SavedPerson), saved);
    file.write(sizeof head + head.people * sizeof(SavedPerson) + before[1] * sizeof(ImpulseRecord), impulses);
    file.finish();
    int failed = 0;
    if (rank_ == 0) {
        std::error_code error;
        // A longer file of an earlier run may have lain there.
        std::filesystem::resize_file(
            part, sizeof head + head.people * sizeof(SavedPerson) + head.impulses * sizeof(ImpulseRecord),
            error);
        if (!error) std::filesystem::rename(part, path, error);
        failed = error ? 1 : 0;
    }
    MPI_Bcast(&failed, 1, MPI_INT, 0, comm_);
    if (failed != 0) throw std::runtime_error(path + ": cannot be written");
    // Who goes on from the file searches for contacts, and so does who has written it.
    scene.discs.is_stale = true;
}

void Region::load(const std::string& path)
{
    SceneCore& scene = core_of(scene_);
    std::int64_t present = static_cast<std::int64_t>(people.size());
    MPI_Allreduce(MPI_IN_PLACE, &present, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (present > 0) refuse("people of a crowd that loads a checkpoint", static_cast<double>(present), "0");
    SharedFile file(comm_, path, MPI_MODE_RDONLY);
    const std::uint64_t bytes = file.size();
    const auto require = [&](bool is_good, const char* what) {
        if (!is_so_everywhere(is_good)) throw std::runtime_error(path + ": " + what);
    };
    require(bytes >= sizeof(CheckpointHead), "no checkpoint of motley, or cut short");
    std::vector<CheckpointHead> heads(1);
    file.read(0, heads);
    const CheckpointHead& head = heads[0];
    require(head.magic == CheckpointHead().magic, "no checkpoint of motley");
    require(head.version == CheckpointHead().version, "a checkpoint of another version");
    require(head.person_bytes == sizeof(SavedPerson), "of a build whose positions have other digits");
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    require(
        head.people <= most && head.impulses <= 64 * most &&
            bytes == sizeof head + head.people * sizeof(SavedPerson) + head.impulses * sizeof(ImpulseRecord),
        "cut short, or longer than it says");
    require(head.walls == hash_of_walls(scene), "of a crowd between other walls");

    const auto share = [&](int rank) {
        return head.people * static_cast<std::uint64_t>(rank) / static_cast<std::uint64_t>(ranks_);
    };
    const std::uint64_t first = share(rank_), last = share(rank_ + 1);
    // One more, if there is one, says where the impulses of the last one end.
    std::vector<SavedPerson> saved(static_cast<std::size_t>(std::min(last + 1, head.people) - first));
    file.read(sizeof head + first * sizeof(SavedPerson), saved);
    const bool has_next = last < head.people;
    const std::uint64_t first_impulse = saved.empty() ? head.impulses : saved.front().first_impulse;
    const std::uint64_t last_impulse = has_next ? saved.back().first_impulse : head.impulses;
    if (has_next) saved.pop_back();
    require(first_impulse <= last_impulse && last_impulse <= head.impulses, "damaged");
    std::vector<ImpulseRecord> impulses(static_cast<std::size_t>(last_impulse - first_impulse));
    file.read(sizeof head + head.people * sizeof(SavedPerson) + first_impulse * sizeof(ImpulseRecord),
              impulses);
    std::uint64_t check = check_of(saved) + check_of(impulses);
    MPI_Allreduce(MPI_IN_PLACE, &check, 1, MPI_UINT64_T, MPI_SUM, comm_);
    require(check == head.check, "damaged: its checksum is wrong");

    std::unordered_set<std::uint64_t> numbers;
    bool are_fit = true;
    for (const SavedPerson& person : saved)
        are_fit = are_fit && is_fit(person.person) && numbers.insert(person.person.number).second;
    for (const ImpulseRecord& impulse : impulses)
        are_fit = are_fit && std::isfinite(impulse.normal) && std::isfinite(impulse.tangent) &&
                  (impulse.is_wall == 0 || impulse.b < scene.discs.segments.size());
    require(are_fit, "holds a person or an impulse that no crowd has");

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
