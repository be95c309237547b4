// See recording.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "recording/recording.h"
#include "recording/varints.h"

namespace motley::bench {
namespace {

constexpr std::int64_t key_every = 32;  // frames

Millimetres in_millimetres(const Vec2<double>& v)
{
    // Beyond that a crowd is not to be seen on a page, and what is not finite has no place.
    constexpr double most = 1e12;
    const auto whole = [most](double x) {
        return std::isfinite(x) ? std::llround(std::clamp(1000 * x, -most, most)) : std::int64_t{0};
    };
    return {whole(v.x), whole(v.y)};
}
std::uint64_t whole(double value)
{
    constexpr double most = 1e15;
    return std::isfinite(value) ? static_cast<std::uint64_t>(std::llround(std::clamp(value, 0.0, most))) : 0;
}

template <class T>
void append(std::string& bytes, const T& value)
{
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

bool are_alike(const RecordedFrame& a, const RecordedFrame& b)
{
    return std::ranges::equal(a.shapes, b.shapes, [](const RecordedShape& x, const RecordedShape& y) {
        return x.person == y.person && x.radius == y.radius && x.is_long == y.is_long;
    });
}

void put_walls(std::string& bytes, const RecordedFrame& frame)
{
    put_unsigned(bytes, frame.walls.size());
    for (const auto& [from, to] : frame.walls) {
        for (const std::int64_t x : {from.x, from.y, to.x, to.y}) put_signed(bytes, x);
    }
}

}  // namespace

RecordedFrame recorded(const View& view, std::int64_t step)
{
    RecordedFrame frame;
    frame.step = step;
    for (const Silhouette& shape : view.shapes) {
        RecordedShape& recorded = frame.shapes.emplace_back();
        recorded.person = view.numbers[shape.person];
        recorded.radius = whole(1000 * shape.radius);
        recorded.from = in_millimetres(shape.from);
        recorded.to = in_millimetres(shape.to);
        recorded.is_long = !(recorded.from == recorded.to);
        recorded.pressure = whole(shape.pressure);
    }
    for (const Wall& wall : view.walls)
        frame.walls.emplace_back(in_millimetres(wall.from), in_millimetres(wall.to));
    for (const std::vector<double>& bands : view.wall_pressures) {
        frame.wall_pressures.emplace_back();
        for (const double band : bands) frame.wall_pressures.back().push_back(whole(band));
    }
    return frame;
}

std::uint32_t checksum_of(const std::string& bytes)
{
    std::uint32_t hash = 2166136261U;
    for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 16777619U;
    return hash;
}

RecordingWriter::RecordingWriter(std::string path, const std::string& scene, double seconds_a_frame)
    : path_(std::move(path)), file_(std::fopen(path_.c_str(), "wb"))
{
    if (file_ == nullptr) throw std::runtime_error(fmt::format("{}: cannot be written", path_));
    std::string head = "motleyrn";
    append(head, recording_version);
    append(head, seconds_a_frame);
    append(head, static_cast<std::uint32_t>(scene.size()));
    put(head + scene);
}
RecordingWriter::~RecordingWriter()
{
    std::fclose(file_);
}

void RecordingWriter::put(const std::string& bytes)
{
    const bool is_written = std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size();
    if (!is_written || std::fflush(file_) != 0)
        throw std::runtime_error(fmt::format("{}: cannot be written", path_));
}

void RecordingWriter::write(const View& view, std::int64_t step)
{
    RecordedFrame frame = recorded(view, step);
    frame.is_key = frames_ % key_every == 0 || !are_alike(frame, last_);
    const bool has_walls = frame.is_key || frame.walls != last_.walls;
    ++frames_;
    bytes_.clear();
    put_unsigned(bytes_, static_cast<std::uint64_t>(step));
    put_unsigned(bytes_, (frame.is_key ? 1U : 0U) | (has_walls ? 2U : 0U));
    if (has_walls) put_walls(bytes_, frame);
    put_unsigned(bytes_, frame.wall_pressures.size());
    for (const std::vector<std::uint64_t>& bands : frame.wall_pressures) {
        put_unsigned(bytes_, bands.size());
        for (const std::uint64_t band : bands) put_unsigned(bytes_, band);
    }
    put_unsigned(bytes_, frame.shapes.size());
    for (std::size_t i = 0; i < frame.shapes.size(); ++i) {
        const RecordedShape& now = frame.shapes[i];
        const RecordedShape before = frame.is_key ? RecordedShape{} : last_.shapes[i];
        if (frame.is_key) {
            put_unsigned(bytes_, now.person);
            put_unsigned(bytes_, now.radius << 1 | (now.is_long ? 1U : 0U));
        }
        put_signed(bytes_, now.from.x - before.from.x);
        put_signed(bytes_, now.from.y - before.from.y);
        if (now.is_long) {
            put_signed(bytes_, now.to.x - now.from.x);
            put_signed(bytes_, now.to.y - now.from.y);
        }
        put_signed(bytes_,
                   static_cast<std::int64_t>(now.pressure) - static_cast<std::int64_t>(before.pressure));
    }
    std::string whole_frame;
    append(whole_frame, static_cast<std::uint32_t>(bytes_.size()));
    append(whole_frame, checksum_of(bytes_));
    put(whole_frame + bytes_);
    last_ = std::move(frame);
}

}  // namespace motley::bench
