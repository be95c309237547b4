// A crowd that several processes step together, by MPI. Link motley::mpi, which MOTLEY_MPI=ON builds.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "motley/core/scene.h"
#include "motley/parallel/solver.h"

#pragma GCC visibility push(default)
namespace motley {

/// A person whom this rank steps.
struct OwnPerson {
    std::uint64_t number = 0;  ///< the same on every rank, for as long as the person is there
    BodyId body{};             ///< in the scene of this rank, until the next step
};

/// What this rank has, and what it has exchanged with others since the crowd was made.
struct DistributedFigures {
    std::int64_t people = 0;  ///< of this rank
    std::int64_t copies = 0;  ///< of people of the region above, in the scene of this rank
    std::int64_t pushed = 0;  ///< of the copies those whom a contact of this rank may push
    std::int64_t steps = 0;
    std::int64_t searches = 0;     ///< steps that dealt out the plane anew
    std::int64_t crossings = 0;    ///< people who came to this rank from another one
    std::int64_t messages = 0;     ///< sent to neighbours
    std::int64_t bytes = 0;        ///< sent to neighbours
    std::int64_t moved_bytes = 0;  ///< sent when people moved, to any rank
    double seconds_sweeping = 0;   ///< spent in messages of sweeps: packing, and waiting for neighbours
    double seconds_agreeing = 0;   ///< spent in all other messages
};

/// A crowd of discs and walls in the plane, cut into regions, one for each rank of a communicator. Each rank has its own
/// scene and solver: the scene holds the walls, which every rank must add in the same order, the people of its region, and
/// copies of those next to it, who belong to another rank. At a search for contacts the plane is cut anew, so that each
/// rank has about the same number of people; people move to the rank of their place with their state, their impulses
/// and their Scene::user_data.
///
/// After any number of steps every person has the same bits as in one process, by one Solver on one Scene, whatever the
/// number of ranks, threads and the instruction set. There people must be added in the order of their numbers, so that
/// two on exactly one spot are told apart alike.
///
/// People sleep as they do in one process, in islands that may reach over several ranks. What the host does to a sleeper of
/// its rank (Scene::wake and whatever else wakes: see SolverSettings::sleep_speed) wakes the others of the island when the next
/// step begins; StepReport::bodies_asleep counts people of this rank.
///
/// Kinematic bodies with walls, such as doors, are on every rank, which all must add and move alike, as they do walls. Their
/// contacts are on the ranks of the people who touch them.
///
/// What a region cannot have: joints, capsules, half-spaces, tolerances, budgets, the direct method, exact contacts, islands that ask
/// for more iterations (Scene::set_island_iterations), and discs that reach much further than most others, by size or by speed. Such a
/// step is refused on all ranks. StepReport::measures are of the contacts that this rank solves.
///
/// Calls that are marked collective must be made by all ranks, in the same order. Between steps each rank may change the
/// forces, velocities and poses of its own people, as of any scene. MPI must be initialised with MPI_THREAD_SERIALIZED, or
/// with MPI_THREAD_FUNNELED where SolverOptions::threads is 1.
class DistributedCrowd {
  public:
    /// Collective. Duplicates the communicator. Throws InvalidInput as Solver does, and for settings that a region cannot have.
    explicit DistributedCrowd(MPI_Comm comm, const SolverSettings& settings = {},
                              const SolverOptions& options = {});
    ~DistributedCrowd();  ///< collective
    DistributedCrowd(const DistributedCrowd&) = delete;
    DistributedCrowd& operator=(const DistributedCrowd&) = delete;

    /// The scene of this rank. Its bodies may be copies: people() lists those that are not.
    [[nodiscard]] Scene& scene();
    [[nodiscard]] const Scene& scene() const;

    /// The threads of this rank's solver.
    [[nodiscard]] Executor& executor();

    /// Adds people to this rank, wherever they are: planar, dynamic bodies with these discs. Numbers are the host's, and each may
    /// be on one rank only, which is not checked on others. Throws InvalidInput for different lengths, for a number that this
    /// rank has, and as Scene::add_bodies and Scene::set_discs do, and then changes nothing.
    void add_people(std::span<const std::uint64_t> numbers, std::span<const BodyDefinition> bodies,
                    std::span<const DiscDefinition> discs);
    /// Throws InvalidInput for a number that this rank does not have, and then changes nothing.
    void remove_people(std::span<const std::uint64_t> numbers);
    /// The people of this rank, in no particular order. Valid until people are added or removed, or the next step.
    [[nodiscard]] std::span<const OwnPerson> people() const;
    /// The body of a person of this rank; the null handle for all others.
    [[nodiscard]] BodyId find(std::uint64_t number) const;

    /// Collective. Steps all regions by the same `dt`, s. The report is of this rank. Refused on all ranks for what
    /// a region cannot have. When memory runs out on one rank in the middle of a step, the others cannot go on: then all end,
    /// by MPI_Abort, with a line that says so.
    StepReport step(float dt);

    /// Collective: writes all people and their impulses to one file, which replaces an older one only when it is whole. Afterwards
    /// this crowd goes on with the bits of one that loads the file: both search for contacts in the next step. So a run
    /// that saves has other bits than one that does not. Throws std::runtime_error on all ranks when the file cannot be
    /// written, and InvalidInput while people are contained.
    void save(const std::string& path);
    /// Collective: reads such a file, written by any number of ranks, into a crowd without people, whose walls are those of the
    /// crowd that was saved; kinematic bodies are where the host puts them. Throws std::runtime_error on all ranks for a file
    /// that cannot be read, is of other walls, is cut short or damaged, and InvalidInput for a crowd with people; then nothing
    /// is changed.
    void load(const std::string& path);

    /// Collective: what contacts put on the people of this rank in the last step, in the order of people(); also those with people
    /// of other ranks, which Scene::read_loads and Scene::disc_contacts of one rank lack. `pressure` is of a disc's circumference.
    [[nodiscard]] std::vector<BodyLoad> read_loads() const;
    /// Collective: a hash of the bits of all people, which does not depend on who has them; compare it with people_hash().
    [[nodiscard]] std::uint64_t hash() const;
    [[nodiscard]] DistributedFigures figures() const;

  private:
    struct [[gnu::visibility("hidden")]] Impl;
    std::unique_ptr<Impl> impl_;
};

/// The same hash of the people of one scene; `numbers` are those of `bodies`. Throws InvalidInput for different lengths and dead
/// bodies.
std::uint64_t people_hash(const Scene& scene, std::span<const std::uint64_t> numbers,
                          std::span<const BodyId> bodies);

}  // namespace motley
#pragma GCC visibility pop
