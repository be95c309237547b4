// A run as a file, for `motley view`: people from above with what presses on them, and walls, a frame at a time.
//
// The file begins with "motleyrn", the version, the seconds from frame to frame and the name of the scene. Each frame is its length,
// a checksum and its bytes, and is written as a whole, so that of a run that is killed all frames but the last are there. Lengths
// are in millimetres, pressures in N/m, both whole: positions are off by half a millimetre at most. Numbers are varints
// (varints.h) and differ from those of the frame before, except in key frames, from which a reader may begin: the first, every
// 32nd, and those in which others are there than before.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "worlds/view.h"

namespace motley::bench {

inline constexpr std::uint32_t recording_version = 1;

/// A point in millimetres.
struct Millimetres {
    std::int64_t x = 0, y = 0;
    friend bool operator==(const Millimetres&, const Millimetres&) = default;
};

/// A silhouette as it was recorded.
struct RecordedShape {
    std::uint64_t person = 0;    ///< the person's number, the same in every frame
    std::uint64_t radius = 0;    ///< mm
    bool is_long = false;        ///< a capsule; else a disc, and both ends are the same
    Millimetres from{}, to{};    ///< the ends of its axis
    std::uint64_t pressure = 0;  ///< N per metre of circumference
};

struct RecordedFrame {
    std::int64_t step = 0;
    bool is_key = false;
    std::vector<RecordedShape> shapes;
    std::vector<std::pair<Millimetres, Millimetres>> walls;
    std::vector<std::vector<std::uint64_t>> wall_pressures;  ///< N/m, of each metre of each wall
};

/// Writes a recording, frame by frame.
class RecordingWriter {
  public:
    /// `seconds_a_frame`: above 0. Throws std::runtime_error when the file cannot be made.
    RecordingWriter(std::string path, const std::string& scene, double seconds_a_frame);
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;
    ~RecordingWriter();
    /// Throws std::runtime_error when the disk is full.
    void write(const View& view, std::int64_t step);

  private:
    std::string path_;
    std::FILE* file_;
    std::int64_t frames_ = 0;
    RecordedFrame last_;
    std::string bytes_;

    void put(const std::string& bytes);
};

struct Recording {
    std::string scene;
    double seconds_a_frame = 0;
    std::int64_t frames = 0;
    bool is_cut = false;         ///< the file ends within a frame, which is left out
    std::size_t whole_size = 0;  ///< bytes up to the end of the last whole frame
};
/// Calls visit(frame) for every frame. Throws std::runtime_error naming the file, the frame and what is wrong: no recording,
/// another version, a wrong checksum, a frame that claims more than it has.
Recording read_recording(const std::string& path, const std::function<void(const RecordedFrame&)>& visit);

/// The frame of a view, as it is recorded.
RecordedFrame recorded(const View& view, std::int64_t step);
/// FNV-1a of 32 bits.
std::uint32_t checksum_of(const std::string& bytes);

}  // namespace motley::bench
