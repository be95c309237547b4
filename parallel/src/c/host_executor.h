// The threads of a host in C.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "mirror.h"
#include "motley/c/solver.h"
#include "motley/parallel/executor.h"

/// A job, and which of its workers have been run: a host that runs one twice would have two threads do one share.
struct motley_job {
    motley::Job work;
    std::int32_t workers;
    std::array<std::atomic<std::uint64_t>, 16> begun{};  ///< a bit each, of 1,024
};

namespace motley::c {

/// What motley_executor says, with its defaults.
struct HostThreads {
    void* user = nullptr;
    std::int32_t concurrency = 1;
    std::int32_t (*run)(void* user, std::int32_t workers, motley_job* job) = nullptr;
};

template <>
struct Mirror<motley_executor, HostThreads> : Pair<motley_executor, HostThreads> {
    static constexpr const char* name = "motley_executor";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(user), MOTLEY_FIELD(concurrency), MOTLEY_FIELD(run));
};

class HostExecutor final : public Executor {
  public:
    explicit HostExecutor(const HostThreads& host) : host_(host)
    {
        if (host.run == nullptr) refuse("motley_executor.run", "null", "a function");
    }
    [[nodiscard]] int concurrency() const override { return host_.concurrency; }
    void run(int workers, Job work) override
    {
        motley_job job{work, workers};
        const std::int32_t failure = host_.run(host_.user, workers, &job);
        if (failure != 0) throw std::runtime_error("motley_executor.run returned " + std::to_string(failure));
    }

  private:
    HostThreads host_;
};

}  // namespace motley::c
