// A vector whose elements start on a cache line, so that rows and blocks never straddle one needlessly.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace motley {

template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t alignment{64};

    CacheLineAllocator() = default;
    template <class U>
    CacheLineAllocator(
        const CacheLineAllocator<U>&)  // NOLINT(google-explicit-constructor): allocators rebind
    {
    }
    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
    void deallocate(T* elements, std::size_t) { ::operator delete(elements, alignment); }
    friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace motley
