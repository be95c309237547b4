// See whole_file.h. What POSIX and Windows call otherwise is here.
#include "scene/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#ifdef _WIN32
#include <io.h>
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <unistd.h>
#endif

namespace motley {
namespace {

/// Waits until the disk has what was written.
bool reach_the_disk(std::FILE* file)
{
    if (std::fflush(file) != 0) return false;
#ifdef _WIN32
    return _commit(_fileno(file)) == 0;
#else
    return fsync(fileno(file)) == 0;
#endif
}

/// Renames a file and replaces what had the name: std::rename() does not replace on Windows.
bool replace(const std::string& from, const std::string& to)
{
#ifdef _WIN32
    if (MoveFileExA(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING) != 0) return true;
    errno = EACCES;
    return false;
#else
    return std::rename(from.c_str(), to.c_str()) == 0;
#endif
}

}  // namespace

void fail_with_errno(const std::string& what)
{
    throw std::runtime_error(what + ": " + std::strerror(errno));
}

void write_whole(const std::string& file, std::span<const std::byte> bytes)
{
    const std::string part = file + ".part";
    std::FILE* out = std::fopen(part.c_str(), "wb");
    if (out == nullptr) fail_with_errno(part + ": cannot be written");
    const bool written =
        std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size() && reach_the_disk(out);
    const int error = errno;
    if (std::fclose(out) != 0 || !written || !replace(part, file)) {
        const int why = written ? errno : error;
        std::remove(part.c_str());
        errno = why;
        fail_with_errno(file + ": cannot be written");
    }
}

}  // namespace motley
