// libFuzzer on every reader of files: scenes and problems behind a good header and checksum, and trajectories.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

#include "forged_file.h"
#include "motley/motley.h"
#include "worlds/trajectories.h"

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer looks for
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    static const std::string path = "/tmp/motley-files-fuzz-" + std::to_string(getpid());
    if (size == 0) return 0;
    const std::string rest(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const std::uint8_t what = bytes[0] % 3;
    std::ofstream(path, std::ios::binary)
        << (what < 2 ? motley::testing::forged(path, rest, what == 1) : rest);
    try {
        if (what == 2) {
            motley::bench::read_trajectories(path);
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
