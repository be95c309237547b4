// See distributed_view.h.
#include "commands/distributed_view.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

#include "shared_file.h"
#include "worlds/slot_index.h"

namespace motley::bench {
namespace {

/// The records of all ranks, on rank `root`.
template <class Record>
std::vector<Record> gather(const std::vector<Record>& own, int root, int ranks)
{
    const auto size = static_cast<int>(own.size());
    std::vector<int> sizes(static_cast<std::size_t>(ranks)), firsts(sizes);
    MPI_Gather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, root, MPI_COMM_WORLD);
    std::exclusive_scan(sizes.begin(), sizes.end(), firsts.begin(), 0);
    std::vector<Record> all(static_cast<std::size_t>(firsts.back() + sizes.back()));
    const RecordType<Record> type;
    MPI_Gatherv(own.data(), size, type.get(), all.data(), sizes.data(), firsts.data(), type.get(), root,
                MPI_COMM_WORLD);
    return all;
}

constexpr auto by_number = [](const auto& p, const auto& q) { return p.number < q.number; };

}  // namespace

DistributedView::DistributedView(const OpenCrowdPeople& people, std::span<const WallId> walls)
    : people_(people), walls_(walls.begin(), walls.end())
{
}

void DistributedView::note_places(const DistributedCrowd& crowd)
{
    std::vector<BodyId> bodies;
    for (const OwnPerson& person : crowd.people()) bodies.push_back(person.body);
    std::vector<Vec3<double>> positions(bodies.size());
    crowd.scene().read_positions(bodies, std::span<Vec3<double>>(positions));
    places_.clear();
    for (std::size_t i = 0; i < positions.size(); ++i)
        places_.push_back({crowd.people()[i].number, {positions[i].x, positions[i].y}});
}

std::optional<View> DistributedView::gather(const DistributedCrowd& crowd, int root) const
{
    const std::span<const OwnPerson> own = crowd.people();
    const std::vector<BodyLoad> loads = crowd.read_loads();
    std::vector<BodyId> bodies;
    std::vector<Pressed> pressed;
    for (std::size_t i = 0; i < own.size(); ++i) {
        bodies.push_back(own[i].body);
        pressed.push_back({own[i].number, static_cast<double>(loads[i].pressure)});
    }
    SlotIndex index;
    index.build(bodies);
    std::vector<Leaning> leaning;
    for (const DiscContact& contact : crowd.scene().disc_contacts()) {
        const auto wall = std::find(walls_.begin(), walls_.end(), contact.wall);
        const std::int32_t person = index.of(contact.b);
        if (wall == walls_.end() || person < 0) continue;
        leaning.push_back({own[static_cast<std::size_t>(person)].number, wall - walls_.begin(),
                           static_cast<double>(contact.normal_force)});
    }
    int rank = 0, ranks = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    std::vector<Place> all_places = bench::gather(places_, root, ranks);
    std::vector<Pressed> all_pressed = bench::gather(pressed, root, ranks);
    const std::vector<Leaning> all_leaning = bench::gather(leaning, root, ranks);
    if (rank != root) return std::nullopt;
    return view_of(std::move(all_places), std::move(all_pressed), all_leaning);
}

View DistributedView::view_of(std::vector<Place> places, std::vector<Pressed> pressed,
                              const std::vector<Leaning>& leaning) const
{
    std::sort(places.begin(), places.end(), by_number);
    std::sort(pressed.begin(), pressed.end(), by_number);
    View view;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto [number, at] = places[i];
        view.people.push_back(at);
        view.numbers.push_back(static_cast<std::uint32_t>(number));
        view.shapes.push_back(
            {at, at, static_cast<double>(people_.person(number).radius), pressed[i].pressure, i});
    }
    std::vector<std::vector<PressOnWall>> presses(walls_.size());
    for (const auto& [number, wall, force] : leaning) {
        const auto place = std::lower_bound(places.begin(), places.end(), Place{number, {}}, by_number);
        presses[static_cast<std::size_t>(wall)].push_back(
            {place->at, static_cast<double>(people_.person(number).radius), force});
    }
    const auto walls = people_.walls();
    view.walls.assign(walls.begin(), walls.end());
    for (std::size_t wall = 0; wall < view.walls.size(); ++wall)
        view.wall_pressures.push_back(wall_pressures(view.walls[wall], presses[wall]));
    return view;
}

void try_on_all(const std::function<void()>& work)
{
    int rank = 0, ranks = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    std::string failure;
    try {
        work();
    } catch (const std::exception& error) {
        failure = error.what();
    }
    const int failed = failure.empty() ? ranks : rank;
    int first = ranks;
    MPI_Allreduce(&failed, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (first == ranks) return;
    // Every rank throws the message of the first one that has failed.
    auto size = static_cast<int>(failure.size());
    MPI_Bcast(&size, 1, MPI_INT, first, MPI_COMM_WORLD);
    failure.resize(static_cast<std::size_t>(size));
    MPI_Bcast(failure.data(), size, MPI_CHAR, first, MPI_COMM_WORLD);
    throw std::runtime_error(failure);
}

}  // namespace motley::bench
