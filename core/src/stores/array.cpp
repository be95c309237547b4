// See array.h and motley/core/memory.h.
#include "stores/array.h"

#include <atomic>
#include <new>

#include "motley/core/invalid_input.h"
#include "motley/core/memory.h"

namespace motley {
namespace {

constexpr std::size_t plain_alignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

constinit MemoryHooks hooks;
constinit std::atomic<std::size_t> held{0};

}  // namespace

void* allocate_memory(std::size_t bytes, std::size_t alignment)
{
    void* memory = nullptr;
    if (hooks.allocate != nullptr) {
        memory = hooks.allocate(bytes, alignment, hooks.user);
        if (memory == nullptr) throw std::bad_alloc();
    } else if (alignment <= plain_alignment) {
        memory = ::operator new(bytes);
    } else {
        memory = ::operator new (bytes, std::align_val_t{alignment});
    }
    held.fetch_add(bytes, std::memory_order_relaxed);
    return memory;
}

void release_memory(void* memory, std::size_t bytes, std::size_t alignment) noexcept
{
    // Nothing, as for operator delete: g++ 12 at -Os calls this for an empty vector.
    if (memory == nullptr) return;
    held.fetch_sub(bytes, std::memory_order_relaxed);
    if (hooks.release != nullptr) {
        hooks.release(memory, bytes, alignment, hooks.user);
    } else if (alignment <= plain_alignment) {
        ::operator delete(memory);
    } else {
        ::operator delete (memory, std::align_val_t{alignment});
    }
}

void set_memory_hooks(const MemoryHooks& wanted)
{
    if ((wanted.allocate == nullptr) != (wanted.release == nullptr)) {
        refuse(wanted.allocate == nullptr ? "MemoryHooks.allocate" : "MemoryHooks.release", "null",
               "a function, as the other one is");
    }
    if (bytes_held() > 0) {
        refuse("set_memory_hooks", static_cast<double>(bytes_held()),
               "0 bytes held by the library: hooks are set before the first scene");
    }
    hooks = wanted;
}

std::size_t bytes_held()
{
    return held.load(std::memory_order_relaxed);
}

}  // namespace motley
