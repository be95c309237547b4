// See distributed_trajectories.h.
#include "commands/distributed_trajectories.h"

#include <algorithm>
#include <span>
#include <vector>

#include "worlds/trajectories.h"

namespace motley::bench {

DistributedTrajectories::DistributedTrajectories(const std::string& path, double frames_a_second)
    : file_(MPI_COMM_WORLD, path, SharedFile::Use::write)
{
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    write_all(rank == 0 ? trajectory_head(frames_a_second) : std::string());
}

void DistributedTrajectories::write(const DistributedCrowd& crowd, std::int64_t frame)
{
    std::vector<OwnPerson> people(crowd.people().begin(), crowd.people().end());
    std::sort(people.begin(), people.end(),
              [](const OwnPerson& p, const OwnPerson& q) { return p.number < q.number; });
    std::vector<BodyId> bodies;
    for (const OwnPerson& person : people) bodies.push_back(person.body);
    std::vector<Vec3<double>> positions(people.size());
    crowd.scene().read_positions(bodies, std::span<Vec3<double>>(positions));
    std::string text;
    for (std::size_t i = 0; i < people.size(); ++i)
        append_trajectory_point(
            text, {static_cast<std::int64_t>(people[i].number) + 1, frame, positions[i].x, positions[i].y});
    write_all(text);
}

void DistributedTrajectories::write_all(const std::string& text)
{
    const std::uint64_t own = text.size();
    std::uint64_t up_to_here = 0, all = 0;
    MPI_Scan(&own, &up_to_here, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(&own, &all, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    file_.write(end_ + up_to_here - own, std::span<const char>(text));
    end_ += all;
}

}  // namespace motley::bench
