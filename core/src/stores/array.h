// Vectors whose memory comes from the host's hooks, if there are any: all that the library keeps in vectors is in these.
#pragma once

#include <cstddef>
#include <vector>

namespace motley {

/// Memory of the hooks of set_memory_hooks(), else of operator new. Throws std::bad_alloc where there is none.
[[nodiscard]] void* allocate_memory(std::size_t bytes, std::size_t alignment);
/// Does nothing for null.
void release_memory(void* memory, std::size_t bytes, std::size_t alignment) noexcept;

template <class T>
struct HookedAllocator {
    using value_type = T;

    HookedAllocator() = default;
    template <class U>
    // NOLINTNEXTLINE(google-explicit-constructor): allocators rebind
    HookedAllocator(const HookedAllocator<U>&)
    {
    }
    // NOLINTBEGIN(bugprone-sizeof-expression): elements may be pointers
    T* allocate(std::size_t count) { return static_cast<T*>(allocate_memory(count * sizeof(T), alignof(T))); }
    void deallocate(T* elements, std::size_t count)
    {
        release_memory(elements, count * sizeof(T), alignof(T));
    }
    // NOLINTEND(bugprone-sizeof-expression)
    friend bool operator==(const HookedAllocator&, const HookedAllocator&) { return true; }
};

template <class T>
using Array = std::vector<T, HookedAllocator<T>>;

}  // namespace motley
