// What every call of the C interface does: no exception leaves it, and what it is given is checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "motley/c/types.h"
#include "motley/core/invalid_input.h"
#include "motley/core/strided_span.h"

namespace motley::c {

/// Keeps the text of the exception that is being handled for motley_last_error(), behind the name of the call, and returns
/// its status.
motley_status keep_error(const char* call) noexcept;

/// Runs the work of a call. `name` is that of the call, for the text of an error.
template <class Work>
motley_status call(const char* name, const Work& work) noexcept
{
    try {
        work();
        return MOTLEY_DONE;
    } catch (...) {
        return keep_error(name);
    }
}

/// Thrown for files and saved bytes that cannot be read or written.
class FileError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The same for work on files or saved bytes, which says by a std::runtime_error what is wrong with them.
template <class Work>
motley_status call_on_file(const char* name, const Work& work) noexcept
{
    return call(name, [&] {
        try {
            work();
        } catch (const std::runtime_error& error) {
            throw FileError(error.what());
        }
    });
}

/// What a pointer points to; refuses null.
template <class T>
T& need(T* pointer, const char* name)
{
    if (pointer == nullptr) refuse(name, "null", "a pointer that is not null");
    return *pointer;
}

/// Refuses an array of `count` elements, `stride` bytes apart, that cannot be. Elements have `size` bytes.
void check_array(const void* first, std::size_t count, std::size_t stride, std::size_t size,
                 std::size_t alignment, const char* name);

/// An array of the host as one of Cpp, which has the same layout as C: see same_layout() in mirror.h.
template <class Cpp, class C>
std::span<Cpp> array(C* first, std::size_t count, const char* name)
{
    static_assert(sizeof(C) == sizeof(Cpp) && alignof(C) == alignof(Cpp));
    check_array(first, count, sizeof(C), sizeof(C), alignof(C), name);
    return {reinterpret_cast<Cpp*>(first), count};
}

template <class Cpp, class C>
StridedSpan<Cpp> strided(C* first, std::size_t count, std::size_t stride, const char* name)
{
    static_assert(sizeof(C) == sizeof(Cpp) && alignof(C) == alignof(Cpp));
    check_array(first, count, stride, sizeof(C), alignof(C), name);
    return {reinterpret_cast<Cpp*>(first), count, stride};
}

/// The same, where null stands for no array.
template <class Cpp, class C>
StridedSpan<Cpp> strided_or_none(C* first, std::size_t count, std::size_t stride, const char* name)
{
    return first == nullptr ? StridedSpan<Cpp>{} : strided<Cpp>(first, count, stride, name);
}

}  // namespace motley::c
