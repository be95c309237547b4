// Files of scenes that somebody has changed and made look whole.
#pragma once

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "motley/core/snapshot.h"

namespace motley::testing {

inline constexpr std::size_t snapshot_header = 32;  ///< bytes; the size is at 16, the checksum at 24

/// As the file says that it is checked.
inline std::uint64_t snapshot_checksum(const std::string& file)
{
    std::uint64_t hash = 0xCBF29CE484222325ULL;
    const auto mix = [&](std::uint64_t word) {
        hash = (hash ^ word) * 0x100000001B3ULL;
        hash ^= hash >> 29;
    };
    std::size_t at = snapshot_header;
    for (; at + 8 <= file.size(); at += 8) {
        std::uint64_t word;
        std::memcpy(&word, file.data() + at, sizeof word);
        mix(word);
    }
    for (; at < file.size(); ++at) mix(static_cast<unsigned char>(file[at]));
    return hash;
}

/// Makes size and checksum right again.
inline void make_whole(std::string& file)
{
    const std::uint64_t size = file.size() - snapshot_header, checksum = snapshot_checksum(file);
    std::memcpy(file.data() + 16, &size, sizeof size);
    std::memcpy(file.data() + 24, &checksum, sizeof checksum);
}

inline std::string bytes_of(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A small scene, or a problem, with these bytes xored over its fields, over and over; `path` is written to on the way.
inline std::string forged(const std::string& path, const std::string& changes, bool problem)
{
    StepProblem step;
    for (int i = 0; i < 3; ++i) {
        BodyDefinition body;
        body.model = static_cast<BodyModel>(i);
        body.position.x = i;
        step.scene.add_joint(BallSocketDefinition{step.scene.ground(), step.scene.add_body(body), {}, {}});
    }
    if (problem) {
        save_problem(step, path);
    } else {
        save_scene(step.scene, path);
    }
    std::string file = bytes_of(path);
    // Three bytes each: where, and what.
    for (std::size_t i = 0; i + 2 < changes.size(); i += 3) {
        const std::size_t where =
            static_cast<unsigned char>(changes[i]) * 256U + static_cast<unsigned char>(changes[i + 1]);
        char& at = file[snapshot_header + where % (file.size() - snapshot_header)];
        at = static_cast<char>(at ^ changes[i + 2]);
    }
    make_whole(file);
    return file;
}

}  // namespace motley::testing
