// Trajectory files in and out.
#include "worlds/trajectories.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace motley::bench {
namespace {

/// Takes the next number off the front of a line.
template <class Number>
bool take(std::string_view& line, Number& number)
{
    const std::size_t start = line.find_first_not_of(" \t\r");
    if (start == std::string_view::npos) return false;
    line.remove_prefix(start);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc()) return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    return true;
}

}  // namespace

Trajectories read_trajectories(const std::string& path)
{
    std::ifstream file(path);
    if (!file) throw std::runtime_error(fmt::format("{}: cannot be opened", path));
    Trajectories result;
    std::string text;
    for (std::int64_t number = 1; std::getline(file, text); ++number) {
        std::string_view line(text);
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        if (line.front() == '#') {
            const std::size_t key = line.find("framerate:");
            if (key == std::string_view::npos) continue;
            line.remove_prefix(key + 10);
            if (!take(line, result.frames_a_second) || !(result.frames_a_second > 0)) {
                throw std::runtime_error(
                    fmt::format("{}:{}: the frame rate must be a number above 0", path, number));
            }
            continue;
        }
        TrajectoryPoint point;
        if (!take(line, point.id) || !take(line, point.frame) || !take(line, point.x) ||
            !take(line, point.y) || !std::isfinite(point.x) || !std::isfinite(point.y)) {
            throw std::runtime_error(fmt::format("{}:{}: expected 'id frame x y [z]', found '{}'", path,
                                                 number, text.substr(0, 60)));
        }
        result.points.push_back(point);
    }
    if (result.points.empty()) throw std::runtime_error(fmt::format("{}: holds no trajectory", path));
    return result;
}

std::string trajectory_head(double frames_a_second)
{
    return fmt::format("# written by motley\n# framerate: {:.6g}\n# id frame x/m y/m z/m\n", frames_a_second);
}

void append_trajectory_point(std::string& text, const TrajectoryPoint& point)
{
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{:.4f}\t{:.4f}\t{:.2f}\n", point.id, point.frame,
                   point.x, point.y, 0.0);
}

TrajectoryWriter::TrajectoryWriter(const std::string& path, double frames_a_second)
    : path_(path), part_(path + ".part"), file_(std::fopen(part_.c_str(), "w"))
{
    if (file_ == nullptr) throw std::runtime_error(fmt::format("{}: cannot be written", path));
    fmt::print(file_, "{}", trajectory_head(frames_a_second));
}

TrajectoryWriter::~TrajectoryWriter()
{
    if (file_ == nullptr) return;
    std::fclose(file_);
    std::remove(part_.c_str());
}

void TrajectoryWriter::write(const Crowd& crowd, std::int64_t frame)
{
    std::string line;
    for (std::size_t i = 0; i < crowd.positions.size(); ++i) {
        line.clear();
        append_trajectory_point(
            line, {std::int64_t{crowd.number_of(i)} + 1, frame, crowd.positions[i].x, crowd.positions[i].y});
        fmt::print(file_, "{}", line);
    }
}

void TrajectoryWriter::close()
{
    const bool failed = std::ferror(file_) != 0 || std::fclose(file_) != 0;
    file_ = nullptr;
    if (failed || std::rename(part_.c_str(), path_.c_str()) != 0)
        throw std::runtime_error(fmt::format("{}: cannot be written", path_));
}

}  // namespace motley::bench
