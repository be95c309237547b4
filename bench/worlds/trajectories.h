// Trajectories as pedestrian dynamics exchanges them: '#' comments, then `id frame x y [z]` by white space.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "worlds/crowd.h"

namespace motley::bench {

struct TrajectoryPoint {
    std::int64_t id = 0, frame = 0;
    double x = 0, y = 0;  ///< m
};

struct Trajectories {
    double frames_a_second = 25;
    std::vector<TrajectoryPoint> points;  ///< in the order of the file
};

/// Reads a file; throws std::runtime_error naming the file, the line and what is wrong with it.
Trajectories read_trajectories(const std::string& path);

/// The first lines of a file, and a line of it.
std::string trajectory_head(double frames_a_second);
void append_trajectory_point(std::string& text, const TrajectoryPoint& point);

/// Writes a file that PedPy reads, a frame at a time. Nothing is left behind at `path` unless close() succeeds.
class TrajectoryWriter {
  public:
    /// Throws std::runtime_error when the file cannot be made.
    TrajectoryWriter(const std::string& path, double frames_a_second);
    TrajectoryWriter(const TrajectoryWriter&) = delete;
    TrajectoryWriter& operator=(const TrajectoryWriter&) = delete;
    ~TrajectoryWriter();
    void write(const Crowd& crowd, std::int64_t frame);
    void close();

  private:
    std::string path_, part_;
    std::FILE* file_;
};

}  // namespace motley::bench
