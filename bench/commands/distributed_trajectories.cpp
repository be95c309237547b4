// See distributed_trajectories.h.
#include "commands/distributed_trajectories.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "worlds/trajectories.h"

namespace motley::bench {

DistributedTrajectories::DistributedTrajectories(const std::string& path, double frames_a_second)
    : path_(path), part_(path + ".part")
{
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    // One of an earlier run may be longer.
    if (rank == 0) std::remove(part_.c_str());
    MPI_Barrier(MPI_COMM_WORLD);
    require(MPI_File_open(MPI_COMM_WORLD, part_.c_str(), MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL,
                          &file_) == MPI_SUCCESS);
    write_all(rank == 0 ? trajectory_head(frames_a_second) : std::string());
}

DistributedTrajectories::~DistributedTrajectories()
{
    if (file_ == MPI_FILE_NULL) return;
    MPI_File_close(&file_);
    std::remove(part_.c_str());
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

void DistributedTrajectories::close()
{
    bool is_good = MPI_File_sync(file_) == MPI_SUCCESS;
    is_good = MPI_File_close(&file_) == MPI_SUCCESS && is_good;
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    require(is_good);
    require(rank != 0 || std::rename(part_.c_str(), path_.c_str()) == 0);
}

void DistributedTrajectories::write_all(const std::string& text)
{
    const auto own = static_cast<std::int64_t>(text.size());
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    std::int64_t before = 0, all = 0;
    MPI_Exscan(&own, &before, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    if (rank == 0) before = 0;  // MPI_Exscan leaves it undefined
    MPI_Allreduce(&own, &all, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    require(MPI_File_write_at_all(file_, end_ + before, text.data(), static_cast<int>(text.size()), MPI_CHAR,
                                  MPI_STATUS_IGNORE) == MPI_SUCCESS);
    end_ += all;
}

void DistributedTrajectories::require(bool is_good) const
{
    int failed = is_good ? 0 : 1;
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    if (failed != 0) throw std::runtime_error(fmt::format("{}: cannot be written", path_));
}

}  // namespace motley::bench
