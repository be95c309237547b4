// libFuzzer on every reader of files: scenes, problems and the frames of recordings behind a good header and checksum, and trajectories.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

#include "forged_file.h"
#include "motley/motley.h"
#include "recording/recording.h"
#include "worlds/trajectories.h"

namespace {

template <class T>
void append(std::string& bytes, const T& value)
{
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// A recording of one frame.
std::string recording_with(const std::string& frame)
{
    std::string file = "motleyrn";
    append(file, motley::bench::recording_version);
    append(file, 0.1);
    append(file, std::uint32_t{0});
    append(file, static_cast<std::uint32_t>(frame.size()));
    append(file, motley::bench::checksum_of(frame));
    return file + frame;
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer looks for
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    static const std::string path = "/tmp/motley-files-fuzz-" + std::to_string(getpid());
    if (size == 0) return 0;
    const std::string rest(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const std::uint8_t what = bytes[0] % 4;
    std::ofstream(path, std::ios::binary) << (what < 2    ? motley::testing::forged(path, rest, what == 1)
                                              : what == 2 ? rest
                                                          : recording_with(rest));
    try {
        if (what == 2) {
            motley::bench::read_trajectories(path);
        } else if (what == 3) {
            motley::bench::read_recording(path, [](const motley::bench::RecordedFrame&) {});
        } else {
            motley::Scene scene = what == 0 ? motley::load_scene(path) : motley::load_problem(path).scene;
            motley::testing::live_on(scene);
        }
    } catch (const std::runtime_error&) {
        // Refused.
    }
    std::remove(path.c_str());
    return 0;
}
