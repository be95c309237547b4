// Where the library gets its memory from.
#pragma once

#include <cstddef>

#pragma GCC visibility push(default)
namespace motley {

/// Functions of the host that the library calls for memory instead of operator new and operator delete. Threads may call them at
/// the same time. Neither may throw.
struct MemoryHooks {
    /// Returns `bytes` (above 0) aligned to `alignment` (a power of two), or null where there are none: then the call of the
    /// library fails as it does without hooks when memory runs out.
    void* (*allocate)(std::size_t bytes, std::size_t alignment, void* user) = nullptr;
    /// Takes back what `allocate` returned for the same `bytes` and `alignment`.
    void (*release)(void* memory, std::size_t bytes, std::size_t alignment, void* user) = nullptr;
    void* user = nullptr;  ///< passed on to both
};

/// From now on scenes, solvers, indices and whatever else the library makes take memory from these hooks for all that grows with
/// what is in them; both functions null: from operator new again. Not asked for here is the memory of what a host holds itself,
/// such as the vectors that calls return and the text of errors, of a fixed number of objects a scene and a solver, of
/// Method::direct, and of threads by oneTBB. Refuses one function without the other, and any change while the library holds
/// memory: set hooks before the first scene. One thread at a time.
void set_memory_hooks(const MemoryHooks& hooks);

/// Bytes that the library holds now of the memory that hooks would serve, whether there are any or not.
[[nodiscard]] std::size_t bytes_held();

}  // namespace motley
#pragma GCC visibility pop
