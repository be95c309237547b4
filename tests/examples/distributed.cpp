// A crowd on several processes: mpirun -n 3 motley_example_distributed. Every rank adds people of its own, reads its own, and
// the whole crowd is pressed against a wall.
#include <motley/mpi/distributed_crowd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

int main(int argc, char** argv)
{
    int threads_allowed = 0, rank = 0, ranks = 1;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &threads_allowed);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    float most = 0;
    {
        motley::DistributedCrowd crowd(MPI_COMM_WORLD);

        // The walls are the same on all ranks.
        const std::vector<motley::Vec2<double>> hall{{0, 0}, {60, 0}, {60, 30}, {0, 30}};
        crowd.scene().add_wall({.points = hall, .closed = true});

        // Each rank adds every third person, say; the first step takes people to the rank of their place.
        std::vector<std::uint64_t> numbers;
        std::vector<motley::BodyDefinition> bodies;
        for (int i = rank; i < 4000; i += ranks) {
            numbers.push_back(static_cast<std::uint64_t>(i));
            bodies.push_back({.model = motley::BodyModel::planar,
                              .position = {0.3 + 0.5 * (i % 100), 0.3 + 0.5 * (i / 100), 0},
                              .mass = 75,
                              .inertia = {1, 0, 0, 1, 0, 1.5F}});
        }
        crowd.add_people(numbers, bodies, std::vector<motley::DiscDefinition>(numbers.size()));

        for (int step = 0; step < 300; ++step) {
            // People of this rank, whoever they are by now, lean towards x = 0 with 40 N.
            for (const motley::OwnPerson& person : crowd.people())
                crowd.scene().set_force(person.body, {-40, 0, 0}, {});
            const motley::StepReport report = crowd.step(1.0F / 60);
            if (report.status != motley::StepStatus::done)
                return std::fprintf(stderr, "%s\n", report.error.c_str()), MPI_Abort(MPI_COMM_WORLD, 1);
        }
        for (const motley::BodyLoad& load : crowd.read_loads()) most = std::max(most, load.pressure);
        MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_FLOAT, MPI_MAX, MPI_COMM_WORLD);
        const std::uint64_t hash = crowd.hash();
        if (rank == 0)
            std::printf("most pressed: %.0f N/m; hash %016llx\n", static_cast<double>(most),
                        static_cast<unsigned long long>(hash));
    }
    MPI_Finalize();
    return most > 1000 ? 0 : 1;
}
