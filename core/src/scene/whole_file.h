// Files that are written whole or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace motley {

/// Throws std::runtime_error with `what` and the system's word for errno.
[[noreturn]] void fail_with_errno(const std::string& what);

/// Writes another file, `file`.part, and renames it to `file` when it is on the disk, so that a reader sees either the old
/// file or the new one. Throws std::runtime_error where that cannot be done, and leaves the old file as it was.
void write_whole(const std::string& file, std::span<const std::byte> bytes);

}  // namespace motley
