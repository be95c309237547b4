// What an executor runs on each of its threads.
#pragma once

#include <type_traits>

#pragma GCC visibility push(default)
namespace motley {

/// Refers to a callable of the caller, and calls it with the number of a worker. Two words, trivially copyable: a
/// thread pool may keep a copy in a task. It owns nothing, so the callable must outlive every call.
class Job {
  public:
    /// Calls work(worker). `work` is a function object that may be called when const; it is not copied.
    template <class Work>
    requires(std::is_object_v<Work>&& std::is_invocable_v<const Work&, int> && !std::is_same_v<Work, Job>)
        // NOLINTNEXTLINE(google-explicit-constructor)
        Job(const Work& work)
        : work_(&work), call_([](const void* of, int worker) { (*static_cast<const Work*>(of))(worker); })
    {
    }

    void operator()(int worker) const { call_(work_, worker); }

  private:
    const void* work_;
    void (*call_)(const void* work, int worker);
};

}  // namespace motley
#pragma GCC visibility pop
