// Files of scenes: a header, which says what they are and has a checksum of the fields, and the fields.
#include "motley/core/snapshot.h"
#include "stores/joint_store.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <type_traits>

#include "scene/scene_archive.h"

namespace motley {
namespace {

/// To be increased with every change of what is written.
constexpr std::uint32_t format_version = 4;
constexpr std::array<char, 8> scene_name{'m', 'o', 't', 'l', 'e', 'y', ' ', 's'};
constexpr std::array<char, 8> problem_name{'m', 'o', 't', 'l', 'e', 'y', ' ', 'p'};

struct Header {
    std::array<char, 8> name;
    std::uint32_t version;
    std::uint32_t layout;    ///< a hash of how numbers and definitions lie in memory
    std::uint64_t size;      ///< bytes after the header
    std::uint64_t checksum;  ///< of those
};

/// FNV-1a over words, then over the bytes that are left.
std::uint64_t checksum_of(std::span<const std::byte> bytes)
{
    std::uint64_t hash = 0xCBF29CE484222325ULL;
    const auto mix = [&](std::uint64_t word) {
        hash = (hash ^ word) * 0x100000001B3ULL;
        hash ^= hash >> 29;
    };
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
        std::uint64_t word;
        std::memcpy(&word, bytes.data(), sizeof word);
        mix(word);
    }
    for (const std::byte byte : bytes) mix(std::to_integer<std::uint64_t>(byte));
    return hash;
}

/// A hash of the byte order and of the size of everything that is written as it lies in memory.
std::uint32_t layout_of_numbers()
{
    std::uint64_t hash = 0;
    const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 0x9E3779B97F4A7C15ULL; };
    const std::uint32_t order = 0x01020304;
    unsigned char first;
    std::memcpy(&first, &order, 1);
    mix(first);
    mix(sizeof(BodyPose));
    mix(sizeof(ContactImpulse));
    mix(sizeof(Contact));
    mix(sizeof(SolverSettings));
    mix(sizeof(std::size_t));
    JointStores().for_each([&](const auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        mix(sizeof(store.definitions[0]));
        mix(quad_floats<typename Store::Parameters>);
        mix(quad_floats<typename Store::Memory>);
    });
    return static_cast<std::uint32_t>(hash >> 32);
}

[[noreturn]] void fail(const std::string& file, const std::string& what)
{
    throw std::runtime_error(file + ": " + what);
}
[[noreturn]] void fail_with_errno(const std::string& file, const std::string& what)
{
    fail(file, what + ": " + std::strerror(errno));
}

/// Writes another file and renames it to `file`, so that a reader sees either the old file or the new one.
void write_whole(const std::string& file, const Header& header, std::span<const std::byte> bytes)
{
    const std::string part = file + ".part";
    std::FILE* out = std::fopen(part.c_str(), "wb");
    if (out == nullptr) fail_with_errno(part, "cannot be written");
    const bool written = std::fwrite(&header, sizeof header, 1, out) == 1 &&
                         std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size() &&
                         std::fflush(out) == 0 && fsync(fileno(out)) == 0;
    const int error = errno;
    if (std::fclose(out) != 0 || !written || std::rename(part.c_str(), file.c_str()) != 0) {
        const int why = written ? errno : error;
        std::remove(part.c_str());
        errno = why;
        fail_with_errno(file, "cannot be written");
    }
}

std::vector<std::byte> read_whole(const std::string& file, const std::array<char, 8>& name)
{
    std::ifstream in(file, std::ios::binary);
    if (!in) fail_with_errno(file, "cannot be read");
    Header header{};
    in.read(reinterpret_cast<char*>(&header), sizeof header);
    if (in.gcount() != sizeof header || header.name != name)
        fail(file, name == scene_name ? "is not a scene of motley" : "is not a step's problem of motley");
    if (header.version != format_version) {
        fail(file, "has version " + std::to_string(header.version) +
                       " of the format; this motley reads version " + std::to_string(format_version));
    }
    if (header.layout != layout_of_numbers())
        fail(file, "was written by a machine or build whose numbers lie otherwise in memory");
    in.seekg(0, std::ios::end);
    const auto size = static_cast<std::uint64_t>(in.tellg()) - sizeof header;
    if (size != header.size) {
        fail(file, "is truncated or has grown: " + std::to_string(size) + " bytes where " +
                       std::to_string(header.size) + " were written");
    }
    in.seekg(sizeof header);
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (in.gcount() != static_cast<std::streamsize>(bytes.size())) fail_with_errno(file, "cannot be read");
    if (checksum_of(bytes) != header.checksum) fail(file, "is corrupted: its checksum differs");
    return bytes;
}

void write_archive(const std::string& file, const std::array<char, 8>& name, const ArchiveWriter& archive)
{
    write_whole(file,
                {name, format_version, layout_of_numbers(), archive.bytes.size(), checksum_of(archive.bytes)},
                archive.bytes);
}

/// Reads the fields of a file with `read`, and adds the file's name to any error.
template <class Read>
void read_archive(const std::string& file, const std::array<char, 8>& name, const Read& read)
{
    const std::vector<std::byte> bytes = read_whole(file, name);
    try {
        ArchiveReader archive(bytes);
        read(archive);
        if (!archive.is_done()) throw std::runtime_error("goes on behind its last field");
    } catch (const std::exception& error) {
        fail(file, error.what());
    }
}

/// Reads settings as they lie in memory. A byte other than 0 or 1 must not be read as a bool, so these are checked
/// first.
SolverSettings read_settings(ArchiveReader& archive)
{
    std::array<unsigned char, sizeof(SolverSettings)> bytes{};
    archive(bytes);
    for (const std::size_t at : {offsetof(SolverSettings, exact_joints), offsetof(SolverSettings, warm_start),
                                 offsetof(SolverSettings, measures)}) {
        if (bytes[at] > 1) throw std::runtime_error("holds settings that are neither true nor false");
    }
    SolverSettings settings;
    std::memcpy(&settings, bytes.data(), sizeof settings);
    settings.validate();
    return settings;
}

}  // namespace

void save_scene(const Scene& scene, const std::string& file)
{
    ArchiveWriter archive;
    SceneArchive::visit(archive, core_of(scene));
    write_archive(file, scene_name, archive);
}

Scene load_scene(const std::string& file)
{
    Scene scene;
    read_archive(file, scene_name,
                 [&](ArchiveReader& archive) { SceneArchive::visit(archive, core_of(scene)); });
    return scene;
}

void save_problem(const StepProblem& problem, const std::string& file)
{
    ArchiveWriter archive;
    SceneArchive::visit(archive, core_of(problem.scene));
    archive(problem.settings);
    archive(problem.dt);
    archive(problem.contacts);
    write_archive(file, problem_name, archive);
}

StepProblem load_problem(const std::string& file)
{
    StepProblem problem;
    read_archive(file, problem_name, [&](ArchiveReader& archive) {
        SceneArchive::visit(archive, core_of(problem.scene));
        problem.settings = read_settings(archive);
        archive(problem.dt);
        archive(problem.contacts);
    });
    return problem;
}

}  // namespace motley
