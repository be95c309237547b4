// The text of the last error, and the checks of arrays.
#include "call.h"

#include <cstdio>
#include <cstdlib>
#include <new>

#include "motley/core/memory.h"

namespace motley::c {
namespace {

/// Plain bytes, so that an error can be told where there is no memory.
thread_local char last_error[1024];

motley_status keep(motley_status status, const char* call, const char* text) noexcept
{
    std::snprintf(last_error, sizeof last_error, "%s: %s", call, text);
    return status;
}

}  // namespace

motley_status keep_error(const char* call) noexcept
{
    try {
        throw;
    } catch (const InvalidInput& error) {
        return keep(MOTLEY_REFUSED, call, error.what());
    } catch (const FileError& error) {
        return keep(MOTLEY_FILE_ERROR, call, error.what());
    } catch (const std::bad_alloc&) {
        return keep(MOTLEY_OUT_OF_MEMORY, call, "out of memory");
    } catch (const std::length_error&) {  // more elements than memory has addresses for
        return keep(MOTLEY_OUT_OF_MEMORY, call, "out of memory");
    } catch (const std::exception& error) {
        return keep(MOTLEY_FAILED, call, error.what());
    } catch (...) {
        return keep(MOTLEY_FAILED, call, "an exception of unknown type");
    }
}

void check_array(const void* first, std::size_t count, std::size_t stride, std::size_t size,
                 std::size_t alignment, const char* name)
{
    if (count == 0) return;
    if (stride < size || stride % alignment != 0) {
        refuse(name + std::string(", its stride"), std::to_string(stride),
               std::to_string(size) + " or more, a multiple of " + std::to_string(alignment) + " (bytes)");
    }
    // A negative number of the host has become one near the largest.
    if (count > static_cast<std::size_t>(PTRDIFF_MAX) / stride) {
        refuse(name + std::string(", its count"), std::to_string(static_cast<std::ptrdiff_t>(count)),
               "0 to " + std::to_string(static_cast<std::size_t>(PTRDIFF_MAX) / stride));
    }
    if (first == nullptr) refuse(name, "null", "an array of " + std::to_string(count));
    if (reinterpret_cast<std::uintptr_t>(first) % alignment != 0)
        refuse(name, "not aligned", "an address that is a multiple of " + std::to_string(alignment));
}

}  // namespace motley::c

int32_t motley_c_version()
{
    return MOTLEY_C_VERSION;
}

const char* motley_last_error()
{
    return motley::c::last_error;
}

motley_status motley_set_memory_hooks(const motley_memory_hooks* hooks)
{
    return motley::c::call("motley_set_memory_hooks", [&] {
        motley::set_memory_hooks(hooks == nullptr
                                     ? motley::MemoryHooks{}
                                     : motley::MemoryHooks{hooks->allocate, hooks->release, hooks->user});
    });
}

size_t motley_bytes_held()
{
    return motley::bytes_held();
}

void motley_free(void* memory)
{
    std::free(memory);
}
