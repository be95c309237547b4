// Recordings: what is read is what was written, to half a millimetre; files that were cut off end with their last whole frame; forged
// ones are refused by name and never crash.
#include "recording/recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "measuring/runner.h"
#include "page/viewer_page.h"

namespace motley::bench {
namespace {

/// A file of its own in the folder for temporary files, removed in the end.
class File {
  public:
    File()
        : path_((std::filesystem::temp_directory_path() / ("motley-recording-" + std::to_string(::getpid())))
                    .string())
    {
    }
    ~File() { std::filesystem::remove(path_); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::string read() const
    {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

  private:
    std::string path_;
};

/// People who walk, one of whom leaves in the middle, a capsule that turns, and a wall that moves.
View view_at(int step)
{
    View view;
    for (std::uint32_t i = 0; i < 20; ++i) {
        if (i == 5 && step > 50) continue;
        const Vec2<double> at{1.7 * i - 0.013 * step, -2.0 * i + 0.3 * std::sin(0.1 * step)};
        const Vec2<double> along = i == 3 ? Vec2<double>{0.2 * std::cos(0.2 * step), 0.2} : Vec2<double>{};
        view.shapes.push_back(
            {at - along, at + along, 0.2 + 0.001 * i, 37.0 * i * (step % 7), view.people.size()});
        view.people.push_back(at);
        view.numbers.push_back(100 + i);
    }
    view.walls = {{{0, 0}, {10, 0}}, {{0.01 * (step / 30), 0}, {0, -7}}};
    view.wall_pressures = {{1, 2.4, 3e3 + step}, {}};
    return view;
}

std::vector<RecordedFrame> frames_of(const std::string& path, Recording& recording)
{
    std::vector<RecordedFrame> frames;
    recording = read_recording(path, [&](const RecordedFrame& frame) { frames.push_back(frame); });
    return frames;
}

void write_frames(const std::string& path, int count)
{
    RecordingWriter writer(path, "a test", 0.1);
    for (int step = 0; step < count; ++step) writer.write(view_at(step), 6 * step);
}

TEST(Recording, HasWhatWasWritten)
{
    const File file;
    write_frames(file.path(), 100);
    Recording recording;
    const std::vector<RecordedFrame> frames = frames_of(file.path(), recording);
    EXPECT_EQ(recording.scene, "a test");
    EXPECT_EQ(recording.seconds_a_frame, 0.1);
    EXPECT_FALSE(recording.is_cut);
    ASSERT_EQ(frames.size(), 100U);
    for (int step = 0; step < 100; ++step) {
        const View view = view_at(step);
        const RecordedFrame& frame = frames[static_cast<std::size_t>(step)];
        EXPECT_EQ(frame.step, 6 * step);
        EXPECT_EQ(frame.is_key, step % 32 == 0 || step == 51) << step;
        ASSERT_EQ(frame.shapes.size(), view.shapes.size());
        for (std::size_t i = 0; i < view.shapes.size(); ++i) {
            const RecordedShape& shape = frame.shapes[i];
            EXPECT_EQ(shape.person, view.numbers[i]);
            EXPECT_NEAR(static_cast<double>(shape.from.x), 1000 * view.shapes[i].from.x, 0.51);
            EXPECT_NEAR(static_cast<double>(shape.to.x), 1000 * view.shapes[i].to.x, 0.51);
            EXPECT_NEAR(static_cast<double>(shape.to.y), 1000 * view.shapes[i].to.y, 0.51);
            EXPECT_NEAR(static_cast<double>(shape.radius), 1000 * view.shapes[i].radius, 0.51);
            EXPECT_NEAR(static_cast<double>(shape.pressure), view.shapes[i].pressure, 0.51);
        }
        ASSERT_EQ(frame.walls.size(), 2U);
        EXPECT_EQ(frame.walls[1].first.x, 10 * (step / 30));
        EXPECT_EQ(frame.wall_pressures[0],
                  (std::vector<std::uint64_t>{1, 2, 3000 + static_cast<std::uint64_t>(step)}));
    }
}

TEST(Recording, ThatWasCutOffEndsWithItsLastWholeFrame)
{
    const File file;
    write_frames(file.path(), 10);
    const std::string whole = file.read();
    std::int64_t most = 0;
    for (std::size_t length = 40; length < whole.size(); length += 13) {
        file.write(whole.substr(0, length));
        const Recording recording = read_recording(file.path(), [](const RecordedFrame&) {});
        EXPECT_GE(recording.frames, most);
        EXPECT_EQ(recording.is_cut, recording.whole_size != length);
        most = recording.frames;
    }
    EXPECT_EQ(most, 9);
}

TEST(Recording, ThatIsForgedIsRefusedByName)
{
    const File file;
    write_frames(file.path(), 3);
    const std::string good = file.read();
    const auto refusal = [&](const std::string& bytes) -> std::string {
        file.write(bytes);
        try {
            read_recording(file.path(), [](const RecordedFrame&) {});
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(refusal("hello").find("is no recording"), std::string::npos);
    EXPECT_NE(refusal(good.substr(0, 20)).find("ends within its head"), std::string::npos);
    std::string later = good;
    later[8] = 9;
    EXPECT_NE(refusal(later).find("version 9"), std::string::npos);
    std::string flipped = good;
    flipped[60] = static_cast<char>(flipped[60] ^ 1);
    EXPECT_NE(refusal(flipped).find("frame 0 at byte 30 has a wrong checksum"), std::string::npos)
        << refusal(flipped);
    // Any byte of the first frame, with a checksum that is right again.
    constexpr std::size_t frame = 30;
    std::uint32_t length = 0;
    std::memcpy(&length, good.data() + frame, 4);
    int refused = 0;
    for (std::size_t at = frame + 8; at < frame + 8 + length; ++at) {
        std::string forged = good;
        forged[at] = static_cast<char>(forged[at] ^ 0x91);
        const std::uint32_t checksum = checksum_of(forged.substr(frame + 8, length));
        std::memcpy(forged.data() + frame + 4, &checksum, 4);
        refused += refusal(forged).empty() ? 0 : 1;
    }
    EXPECT_GT(refused, 10);
    EXPECT_THROW(read_recording("/nowhere/at/all", [](const RecordedFrame&) {}), std::runtime_error);
    EXPECT_THROW(RecordingWriter("/nowhere/at/all", "x", 1), std::runtime_error);
}

TEST(Recording, OfAMinuteOfTenThousandPeopleIsBelowFiftyMegabytes)
{
    const File file;
    RunOptions options;
    options.agents = 1000;
    options.seconds = 6;
    RunOutputs outputs;
    outputs.progress = false;
    outputs.recording = file.path();
    run_scene(*find_scene("crowd"), options, outputs);
    Recording recording;
    const std::vector<RecordedFrame> frames = frames_of(file.path(), recording);
    EXPECT_EQ(frames.size(), 60U);
    EXPECT_EQ(frames.back().shapes.size(), 1000U);
    EXPECT_LT(static_cast<double>(recording.whole_size) * 10 * 10, 50e6);
}

TEST(Recording, HasAPageOnlyIfItHasAFrame)
{
    const File file;
    write_frames(file.path(), 0);
    EXPECT_THROW(write_viewer_page(file.path(), file.path() + ".html"), std::runtime_error);
    EXPECT_FALSE(std::filesystem::exists(file.path() + ".html"));
}

}  // namespace
}  // namespace motley::bench
