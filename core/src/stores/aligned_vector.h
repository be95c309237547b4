// A vector whose storage starts on a cache line, so that rows and blocks do not straddle two needlessly, and on huge
// pages when it is long, so that scattered reads of it seldom miss the translation lookaside buffers.
#pragma once

#include <cstddef>
#include <vector>

#include "stores/array.h"

namespace motley {

/// Asks the operating system for huge pages for memory that was not written to yet; a hint, without effect where there
/// are none.
void advise_huge_pages(void* memory, std::size_t bytes);

template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::size_t huge_page = std::size_t{2} << 20;

    CacheLineAllocator() = default;
    template <class U>
    // NOLINTNEXTLINE(google-explicit-constructor): allocators rebind
    CacheLineAllocator(const CacheLineAllocator<U>&)
    {
    }
    T* allocate(std::size_t count)
    {
        const std::size_t bytes = count * sizeof(T);
        void* memory = allocate_memory(bytes, alignment_of(count));
        if (bytes >= huge_page) advise_huge_pages(memory, bytes);
        return static_cast<T*>(memory);
    }
    void deallocate(T* elements, std::size_t count)
    {
        release_memory(elements, count * sizeof(T), alignment_of(count));
    }
    friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }

  private:
    static std::size_t alignment_of(std::size_t count)
    {
        return count * sizeof(T) >= huge_page ? huge_page : 64;
    }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace motley
