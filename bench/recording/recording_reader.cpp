// See recording.h.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "recording/recording.h"
#include "recording/varints.h"

namespace motley::bench {
namespace {

/// x + by, which a forged file may make any number.
std::int64_t moved(std::int64_t x, std::int64_t by)
{
    constexpr std::int64_t most = std::int64_t{1} << 60;
    if (x > most || x < -most || by > most || by < -most)
        throw std::runtime_error("has a number out of range");
    return x + by;
}

void read_walls(Bytes& bytes, RecordedFrame& frame)
{
    frame.walls.clear();
    const std::size_t walls = bytes.count(4);
    for (std::size_t i = 0; i < walls; ++i) {
        std::int64_t ends[4];
        for (std::int64_t& end : ends) end = bytes.signed_number();
        frame.walls.push_back({{ends[0], ends[1]}, {ends[2], ends[3]}});
    }
}

void read_wall_pressures(Bytes& bytes, RecordedFrame& frame)
{
    frame.wall_pressures.clear();
    const std::size_t walls = bytes.count(1);
    for (std::size_t i = 0; i < walls; ++i) {
        std::vector<std::uint64_t>& bands = frame.wall_pressures.emplace_back();
        const std::size_t count = bytes.count(1);
        for (std::size_t k = 0; k < count; ++k) bands.push_back(bytes.unsigned_number());
    }
}

/// The frame after `frame`, which is changed into it.
void read_frame(Bytes bytes, RecordedFrame& frame)
{
    constexpr std::uint64_t is_key = 1, has_walls = 2;
    const std::uint64_t step = bytes.unsigned_number();
    if (step > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        throw std::runtime_error("has a number out of range");
    frame.step = static_cast<std::int64_t>(step);
    const std::uint64_t flags = bytes.unsigned_number();
    if (flags > (is_key | has_walls)) throw std::runtime_error("has flags of a later version");
    frame.is_key = (flags & is_key) != 0;
    if ((flags & has_walls) != 0) read_walls(bytes, frame);
    read_wall_pressures(bytes, frame);
    const std::size_t shapes = bytes.count(frame.is_key ? 5 : 3);
    if (frame.is_key) {
        frame.shapes.assign(shapes, {});
    } else if (frame.shapes.size() != shapes) {
        throw std::runtime_error("has other people than the frame before, and is no key frame");
    }
    for (RecordedShape& shape : frame.shapes) {
        if (frame.is_key) {
            shape.person = bytes.unsigned_number();
            const std::uint64_t radius = bytes.unsigned_number();
            shape.radius = radius >> 1;
            shape.is_long = (radius & 1) != 0;
        }
        shape.from.x = moved(shape.from.x, bytes.signed_number());
        shape.from.y = moved(shape.from.y, bytes.signed_number());
        shape.to = shape.from;
        if (shape.is_long) {
            shape.to.x = moved(shape.from.x, bytes.signed_number());
            shape.to.y = moved(shape.from.y, bytes.signed_number());
        }
        const std::int64_t pressure = moved(static_cast<std::int64_t>(shape.pressure), bytes.signed_number());
        if (pressure < 0) throw std::runtime_error("has a pressure below 0");
        shape.pressure = static_cast<std::uint64_t>(pressure);
    }
    if (bytes.left() > 0) throw std::runtime_error("has more bytes than people");
}

template <class T>
T taken(const std::string& file, std::size_t& at)
{
    T value;
    if (file.size() - at < sizeof(T)) throw std::runtime_error("ends within its head");
    std::memcpy(&value, file.data() + at, sizeof(T));
    at += sizeof(T);
    return value;
}

void read_head(const std::string& file, std::size_t& at, Recording& recording)
{
    if (file.compare(0, 8, "motleyrn") != 0)
        throw std::runtime_error("is no recording of `motley run --record`");
    at = 8;
    const auto version = taken<std::uint32_t>(file, at);
    if (version != recording_version)
        throw std::runtime_error(
            fmt::format("is of version {}; this program reads {}", version, recording_version));
    recording.seconds_a_frame = taken<double>(file, at);
    if (!(recording.seconds_a_frame > 0) || !std::isfinite(recording.seconds_a_frame))
        throw std::runtime_error(
            fmt::format("has {} seconds a frame; expected above 0", recording.seconds_a_frame));
    const auto length = taken<std::uint32_t>(file, at);
    if (length > file.size() - at) throw std::runtime_error("ends within its head");
    recording.scene = file.substr(at, length);
    at += length;
}

}  // namespace

Recording read_recording(const std::string& path, const std::function<void(const RecordedFrame&)>& visit)
{
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", path));
    const std::string file{std::istreambuf_iterator<char>(in), {}};
    Recording recording;
    std::size_t at = 0;
    try {
        read_head(file, at, recording);
    } catch (const std::runtime_error& wrong) {
        throw std::runtime_error(fmt::format("{}: {}", path, wrong.what()));
    }
    recording.whole_size = at;
    RecordedFrame frame;
    constexpr std::size_t head = 8;
    while (at < file.size()) {
        const std::size_t begin = at;
        recording.is_cut = true;
        if (file.size() - at < head) break;
        const auto length = taken<std::uint32_t>(file, at);
        const auto checksum = taken<std::uint32_t>(file, at);
        if (length > file.size() - at) break;
        const std::string bytes = file.substr(at, length);
        at += length;
        const auto refuse = [&](const char* why) {
            throw std::runtime_error(
                fmt::format("{}: frame {} at byte {} {}", path, recording.frames, begin, why));
        };
        if (checksum_of(bytes) != checksum) refuse("has a wrong checksum");
        try {
            read_frame(Bytes({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}), frame);
            if (recording.frames == 0 && !frame.is_key)
                throw std::runtime_error("is the first and no key frame");
        } catch (const std::runtime_error& wrong) {
            refuse(wrong.what());
        }
        visit(frame);
        ++recording.frames;
        recording.whole_size = at;
        recording.is_cut = false;
    }
    return recording;
}

}  // namespace motley::bench
