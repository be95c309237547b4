// Scenes as bytes, in files and in memory: a header, which says what they are and has a checksum of the fields, and the
// fields.
#include "motley/core/snapshot.h"
#include "stores/joint_store.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <new>
#include <type_traits>
#include <utility>

#include "scene/scene_archive.h"
#include "scene/whole_file.h"

namespace motley {
namespace {

/// To be increased with every change of what is written.
constexpr std::uint32_t format_version = 11;
using Name = std::array<char, 8>;
constexpr Name scene_name{'m', 'o', 't', 'l', 'e', 'y', ' ', 's'};
constexpr Name problem_name{'m', 'o', 't', 'l', 'e', 'y', ' ', 'p'};

struct Header {
    Name name;
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
    JointStores().for_each([&](const auto& store, int type) {
        using Store = std::remove_cvref_t<decltype(store)>;
        // Where joints were left out of the build, types are known by their place among all.
        constexpr int among_all = TypeOfDefinition<typename Store::Type::Definition, AllJointTypes>::index;
        if (among_all != type) mix(std::uint64_t{among_all});
        mix(sizeof(store.definitions[0]));
        mix(quad_floats<typename Store::Parameters>);
        mix(quad_floats<typename Store::Memory>);
    });
    return static_cast<std::uint32_t>(hash >> 32);
}

/// Runs `read`, and adds where it reads from to any error. A lack of memory is none of what is read.
template <class Read>
auto reading(const std::string& from, const Read& read)
{
    try {
        return read();
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw std::runtime_error(from + ": " + error.what());
    }
}

[[noreturn]] void fail(const std::string& what)
{
    throw std::runtime_error(what);
}

/// Throws unless this motley reads what has such a header and `size` bytes in all.
void check_header(const Header& header, const Name& name, std::uint64_t size)
{
    if (size < sizeof header || header.name != name)
        fail(name == scene_name ? "is not a scene of motley" : "is not a step's problem of motley");
    if (header.version != format_version) {
        fail("has version " + std::to_string(header.version) + " of the format; this motley reads version " +
             std::to_string(format_version));
    }
    if (header.layout != layout_of_numbers())
        fail("was written by a machine or build whose numbers lie otherwise in memory");
    if (size - sizeof header != header.size) {
        fail("is truncated or has grown: " + std::to_string(size - sizeof header) + " bytes where " +
             std::to_string(header.size) + " were written");
    }
}

/// Runs `write` on an archive and puts the header before what it has written.
template <class Write>
std::vector<std::byte> with_header(const Name& name, const Write& write)
{
    ArchiveWriter archive;
    Header header{name, format_version, layout_of_numbers(), 0, 0};
    archive(header);
    write(archive);
    const std::span<const std::byte> fields = std::span(archive.bytes).subspan(sizeof header);
    header.size = fields.size();
    header.checksum = checksum_of(fields);
    std::memcpy(archive.bytes.data(), &header, sizeof header);
    return std::move(archive.bytes);
}

/// An archive of the fields behind the header of `bytes`.
ArchiveReader behind_header(std::span<const std::byte> bytes, const Name& name)
{
    Header header{};
    if (!bytes.empty()) std::memcpy(&header, bytes.data(), std::min(bytes.size(), sizeof header));
    check_header(header, name, bytes.size());
    const std::span<const std::byte> fields = bytes.subspan(sizeof header);
    if (checksum_of(fields) != header.checksum) fail("is corrupted: its checksum differs");
    return ArchiveReader(fields);
}

void require_done(const ArchiveReader& archive)
{
    if (!archive.is_done()) fail("goes on behind its last field");
}

/// The bytes of a file whose header is good.
std::vector<std::byte> read_whole(const std::string& file, const Name& name)
{
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in) fail_with_errno("cannot be read");
    const auto size = static_cast<std::uint64_t>(in.tellg());
    in.seekg(0);
    Header header{};
    in.read(reinterpret_cast<char*>(&header), sizeof header);
    check_header(header, name, static_cast<std::uint64_t>(in.gcount()) < sizeof header ? 0 : size);
    in.seekg(0);
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (in.gcount() != static_cast<std::streamsize>(bytes.size())) fail_with_errno("cannot be read");
    return bytes;
}

/// Reads settings as they lie in memory. A byte other than 0 or 1 must not be read as a bool, so these are checked
/// first.
SolverSettings read_settings(ArchiveReader& archive)
{
    std::array<unsigned char, sizeof(SolverSettings)> bytes{};
    archive(bytes);
    for (const std::size_t at :
         {offsetof(SolverSettings, exact_joints), offsetof(SolverSettings, exact_limits),
          offsetof(SolverSettings, exact_contacts), offsetof(SolverSettings, warm_start),
          offsetof(SolverSettings, measures)}) {
        if (bytes[at] > 1) throw std::runtime_error("holds settings that are neither true nor false");
    }
    SolverSettings settings;
    std::memcpy(&settings, bytes.data(), sizeof settings);
    settings.validate();
    return settings;
}

Scene read_scene(std::span<const std::byte> bytes)
{
    ArchiveReader archive = behind_header(bytes, scene_name);
    Scene scene;
    SceneArchive::visit(archive, core_of(scene));
    require_done(archive);
    return scene;
}

StepProblem read_problem(std::span<const std::byte> bytes)
{
    ArchiveReader archive = behind_header(bytes, problem_name);
    StepProblem problem;
    SceneArchive::visit(archive, core_of(problem.scene));
    problem.settings = read_settings(archive);
    archive(problem.dt);
    archive(problem.contacts);
    require_done(archive);
    return problem;
}

}  // namespace

std::vector<std::byte> save_scene(const Scene& scene)
{
    return with_header(scene_name,
                       [&](ArchiveWriter& archive) { SceneArchive::visit(archive, core_of(scene)); });
}

std::vector<std::byte> save_problem(const StepProblem& problem)
{
    return with_header(problem_name, [&](ArchiveWriter& archive) {
        SceneArchive::visit(archive, core_of(problem.scene));
        archive(problem.settings);
        archive(problem.dt);
        archive(problem.contacts);
    });
}

Scene load_scene(std::span<const std::byte> bytes)
{
    return reading("load_scene.bytes", [&] { return read_scene(bytes); });
}

StepProblem load_problem(std::span<const std::byte> bytes)
{
    return reading("load_problem.bytes", [&] { return read_problem(bytes); });
}

void save_scene(const Scene& scene, const std::string& file)
{
    write_whole(file, save_scene(scene));
}

void save_problem(const StepProblem& problem, const std::string& file)
{
    write_whole(file, save_problem(problem));
}

Scene load_scene(const std::string& file)
{
    return reading(file, [&] { return read_scene(read_whole(file, scene_name)); });
}

StepProblem load_problem(const std::string& file)
{
    return reading(file, [&] { return read_problem(read_whole(file, problem_name)); });
}

}  // namespace motley
