// The solver: advances a scene by one step.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/scene.h"
#include "motley/core/settings.h"
#include "motley/core/step_report.h"
#include "motley/parallel/executor.h"
#include "motley/soa/isa.h"

#pragma GCC visibility push(default)
namespace motley {

/// What a solver runs on. None of it changes a bit of the result.
struct SolverOptions {
    /// >= 1; 1 starts no thread at all. Ignored when `executor` is set, and taken for 1 where the library is built without
    /// threads of its own (MOTLEY_TBB=OFF): Solver::threads() tells.
    int threads = 1;
    /// Steps of fewer contacts (a joint counts as four, two bodies as one) run on the calling thread alone: they are
    /// done before another thread could begin.
    std::size_t alone_below = 8192;
    /// Default: what the environment variable MOTLEY_ISA names, else the widest this machine has.
    std::optional<Isa> isa{};
    Executor* executor = nullptr;  ///< the host's own threads; not owned, must outlive the solver
};

/// Steps scenes. Holds buffers and threads but no state that decides a result: two solvers step copies of a scene to
/// the same bits. One solver steps one scene at a time: step() is refused while the solver or the scene is in another
/// step. A solver that has been moved from steps nothing: step() is refused, everything else throws InvalidInput.
///
/// Threads. The rules for one scene are at Scene; with solvers:
/// - different solvers are independent: they may step different scenes at the same time, also with one list of
///   contacts, which a step only reads;
/// - during a step nothing may access its scene, not even by const calls, and only settings(), isa(), threads() and
///   executor() may be called of its solver. A second step is refused; no other violation is detected;
/// - one executor may serve any number of solvers and loops of parallel_for in turn. It may serve them at the same time
///   if its run() may be called by several threads at once, as that of a solver's own executor may, even by a thread
///   that it has lent: a loop over scenes may step each of them on the executor that runs the loop;
/// - a step runs on the thread that called it and, unless it is small (SolverOptions::alone_below) or of
///   Method::direct, on those that the executor lends. A lent thread stays until the step is over: it computes, or
///   waits by spinning and, after some thousand spins, by yielding its core, never by sleeping. So an executor should
///   lend no more threads than there are cores to spare. A thread that comes late helps with what is left, one that
///   comes after the step leaves at once, and one that never comes is not missed;
/// - a lent thread calls nothing of the host and throws nothing. While it is lent it rounds to nearest and takes
///   denormals for zero; then it has the floating-point environment that it came with.
class Solver {
  public:
    /// Throws InvalidInput for settings or options out of range, for an executor whose concurrency is out of range,
    /// and for an instruction set that is not available here, whether `options` asks for it or, where they leave it
    /// open, MOTLEY_ISA does: with a silent fallback, a host that forces one would measure another without noticing.
    explicit Solver(const SolverSettings& settings = {}, const SolverOptions& options = {});
    ~Solver();
    Solver(Solver&&) noexcept;
    Solver& operator=(Solver&&) noexcept;

    /// Advances the scene by `dt` seconds (0 to 1; 0 changes nothing), with the contacts of this step. The list is
    /// read during the call only. A step is fastest if the list is in about the order of the step before and, if
    /// long, has neighbours in space near each other. Never throws: bad input, a lack of memory and an executor that
    /// fails give StepStatus::refused, a message, and an untouched scene. Allocates nothing once the scene has
    /// stopped growing.
    StepReport step(Scene& scene, float dt, std::span<const Contact> contacts = {}) noexcept;

    [[nodiscard]] const SolverSettings& settings() const;
    /// Throws InvalidInput and keeps the old settings when one is out of range.
    void set_settings(const SolverSettings& settings);
    [[nodiscard]] Isa isa() const;
    [[nodiscard]] int threads() const;
    /// The threads that the solver runs on; a host may share them (a neighbour search, say).
    [[nodiscard]] Executor& executor();

  private:
    friend struct SolverAccess;
    struct [[gnu::visibility("hidden")]] Impl;
    std::unique_ptr<Impl> impl_;

    [[nodiscard]] Impl& impl() const;  ///< refuses when it has been moved from
};

}  // namespace motley
#pragma GCC visibility pop
