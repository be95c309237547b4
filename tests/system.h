// What tests ask of the system and what POSIX and Windows call otherwise.
#pragma once

#include <cstddef>
#include <cstdlib>

#ifdef _WIN32
#include <malloc.h>
#include <process.h>
#else
#include <unistd.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace motley::testing {

/// For names of files that no other run of the tests has.
inline int process_id()
{
#ifdef _WIN32
    return _getpid();
#else
    return getpid();
#endif
}

/// Sets a variable of the environment, or removes it where `value` is empty.
inline void set_environment(const char* name, const char* value)
{
#ifdef _WIN32
    _putenv_s(name, value);
#else
    if (*value == '\0') {
        unsetenv(name);
    } else {
        setenv(name, value, 1);
    }
#endif
}

/// As std::aligned_alloc() and std::free(), of which Windows has no pair.
inline void* allocate_aligned(std::size_t alignment, std::size_t size)
{
#ifdef _WIN32
    return _aligned_malloc(size, alignment);
#else
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
#endif
}
inline void free_aligned(void* memory)
{
#ifdef _WIN32
    _aligned_free(memory);
#else
    std::free(memory);
#endif
}

/// New memory has this byte from now on, where the C library is able to do that: glibc's is.
inline void fill_new_memory([[maybe_unused]] int byte)
{
#ifdef __GLIBC__
    mallopt(M_PERTURB, byte);
#endif
}

}  // namespace motley::testing
