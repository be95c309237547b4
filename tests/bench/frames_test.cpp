// Pictures of a crowd. Independent evidence: the PNG is read back, and its size, places and colours are worked out here
// from the scene: five people in a row, one of them free and two pairs pressed together by known forces.
#include "page/frames.h"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace motley::bench {
namespace {

using Colour = std::array<int, 3>;

struct ReadPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> bytes;

    explicit ReadPicture(const std::string& path)
    {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return;
        image.format = PNG_FORMAT_RGB;
        bytes.resize(PNG_IMAGE_SIZE(image));
        if (png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr) == 0) return;
        width = static_cast<int>(image.width);
        height = static_cast<int>(image.height);
    }
    [[nodiscard]] Colour at(int x, int y) const
    {
        const auto first =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
        return {bytes.at(first), bytes.at(first + 1), bytes.at(first + 2)};
    }
};

/// A folder of a test, removed with it.
struct TemporaryFolder {
    std::filesystem::path path;
    TemporaryFolder()
    {
        const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
        path = std::filesystem::temp_directory_path() /
               (std::string("motley-frames-") + test->name() + "-" + std::to_string(getpid()));
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() { std::filesystem::remove_all(path); }
};

/// Five people of radius 0.2 m at y = 0, from x = 0 to 3, over a wall from (-1, -1) to (4, -1). Each of a pair is pushed
/// at the other: those in the middle so that they bear two thirds of the pressure at which the scale ends, those on the
/// right far beyond it.
struct PressedPeople {
    static constexpr double radius = 0.2, pi = 3.14159265358979323846;
    static constexpr double places[] = {0, 1, 1.4, 2.6, 3};
    Scene scene;
    Crowd crowd;
    Solver solver{stiff()};

    PressedPeople()
    {
        for (const double x : places) crowd.add(scene, {}, {x, 0});
        crowd.walls.push_back({{-1, -1}, {4, -1}});
        const auto force = static_cast<float>(FrameWriter::full_pressure * 2 / 3 * 2 * pi * radius);
        for (int step = 0; step < 60; ++step) {
            push(1, force);
            push(2, -force);
            push(3, 10 * force);
            push(4, -10 * force);
            crowd.observe(scene, solver.executor());
            const StepReport report =
                solver.step(scene, 1.0F / 60, crowd.find_contacts(scene, solver.executor()));
            EXPECT_EQ(report.status, StepStatus::done);
            EXPECT_EQ(report.contacts, 2);
        }
        crowd.observe(scene, solver.executor());
    }

  private:
    /// Stiff contacts, so that nobody moves by as much as a pixel.
    static SolverSettings stiff()
    {
        SolverSettings settings;
        settings.contact_hertz = 1e6F;
        return settings;
    }
    void push(std::size_t i, float force) { scene.set_force(crowd.agents[i].body, {force, 0, 0}, {}); }
};

/// The view: half a metre around everything, 900 pixels along x; and around that 20 pixels, with 58 more on the right for
/// each scale.
struct Pixels {
    static constexpr double pixels_a_metre = 900 / (5 + 2 * 0.5);
    static constexpr int width = 900 + 2 * 20 + 2 * 58, height = 300 + 2 * 20;
    static int x(double world) { return static_cast<int>(20 + (world + 1.5) * pixels_a_metre); }
    static int y(double world) { return static_cast<int>(height - 20 - (world + 1.5) * pixels_a_metre); }
};

void expect_near(const Colour& colour, const Colour& expected, int by, const std::string& where)
{
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(colour[c], expected[c], by) << where << ", channel " << c;
}

TEST(Frames, HaveTheSizePlacesAndColoursOfTheScene)
{
    const TemporaryFolder folder;
    PressedPeople people;
    FrameWriter writer(folder.path.string());
    writer.write(view_of(people.crowd, people.scene), people.solver.executor());
    const ReadPicture picture((folder.path / "frame-00000.png").string());
    ASSERT_EQ(picture.width, Pixels::width);
    ASSERT_EQ(picture.height, Pixels::height);
    const auto person = [&](std::size_t i) {
        return picture.at(Pixels::x(PressedPeople::places[i]), Pixels::y(0));
    };
    expect_near(person(0), {70, 120, 180}, 0, "free: blue");
    // The force is known to a few percent, as two discs settle, and the colour runs 130 values in a third of the scale.
    for (const std::size_t i : {1U, 2U}) expect_near(person(i), {250, 210, 90}, 8, "two thirds: yellow");
    for (const std::size_t i : {3U, 4U}) expect_near(person(i), {205, 40, 45}, 0, "beyond the scale: red");
    // A disc ends at its radius, in a darker edge.
    const int edge = static_cast<int>(PressedPeople::radius * Pixels::pixels_a_metre);
    expect_near(picture.at(Pixels::x(0), Pixels::y(0) - edge + 3), {70, 120, 180}, 0, "inside");
    expect_near(picture.at(Pixels::x(0), Pixels::y(0) - edge - 2), {250, 250, 248}, 0, "outside");
    expect_near(picture.at(Pixels::x(-0.5), Pixels::y(-1)), {50, 50, 55}, 0, "the wall");
    expect_near(picture.at(2, 2), {250, 250, 248}, 0, "the background");
    // The scales at the right edge, of people and left of it of walls: red at the top, blue at the bottom.
    for (const int bar : {Pixels::width - 10 - 44 - 7, Pixels::width - 10 - 58 - 44 - 7}) {
        expect_near(picture.at(bar, 20 + 24 + 1), {205, 40, 45}, 4, "top of a scale");
        expect_near(picture.at(bar, Pixels::height - 20 - 2), {70, 120, 180}, 4, "bottom of a scale");
    }
}

/// Two people whom the library's contacts hold against a wall of four metres, one with a third of the pressure at which
/// the scale of walls ends and one with two thirds. Each metre of the wall has the colour of what is on it.
TEST(Frames, WallsHaveTheColourOfTheirPressureMetreByMetre)
{
    const TemporaryFolder folder;
    Scene scene;
    Crowd crowd;
    crowd.add(scene, {}, {0.5, 0.2});
    crowd.add(scene, {}, {2.5, 0.2});
    crowd.walls.push_back({{0, 0}, {4, 0}});
    crowd.hand_over(scene);
    SolverSettings settings;
    settings.contact_hertz = 1e6F;
    Solver solver(settings);
    for (int step = 0; step < 60; ++step) {
        for (std::size_t i = 0; i < 2; ++i) {
            const auto force = static_cast<float>(FrameWriter::full_wall_pressure / 3 * (i + 1.0));
            scene.set_force(crowd.agents[i].body, {0, -force, 0}, {});
        }
        ASSERT_EQ(solver.step(scene, 1.0F / 60).status, StepStatus::done);
    }
    crowd.observe(scene, solver.executor());
    FrameWriter writer(folder.path.string());
    writer.write(view_of(crowd, scene), solver.executor());
    const ReadPicture picture((folder.path / "frame-00000.png").string());
    // 900 pixels for the wall and half a metre on each side of it; the disc lies over the middle of its metre.
    const auto colour_at = [&](double x) {
        return picture.at(static_cast<int>(20 + (x + 0.5) * 900 / 5), picture.height - 20 - 900 / 10);
    };
    expect_near(colour_at(0.1), {120, 190, 170}, 3, "a third");
    expect_near(colour_at(1.5), {50, 50, 55}, 0, "nothing");
    expect_near(colour_at(2.1), {250, 210, 90}, 3, "two thirds");
}

TEST(Frames, AreNumberedAndKeepTheViewOfTheFirst)
{
    const TemporaryFolder folder;
    PressedPeople people;
    FrameWriter writer(folder.path.string());
    writer.write(view_of(people.crowd, people.scene), people.solver.executor());
    people.crowd.positions[0].y = 3;  // out of the view of the first frame
    writer.write(view_of(people.crowd, people.scene), people.solver.executor());
    const ReadPicture second((folder.path / "frame-00001.png").string());
    ASSERT_EQ(second.width, Pixels::width);
    ASSERT_EQ(second.height, Pixels::height);
    expect_near(second.at(Pixels::x(0), Pixels::y(0)), {250, 250, 248}, 0, "nobody is there any more");
    expect_near(second.at(Pixels::x(3), Pixels::y(0)), {205, 40, 45}, 0, "the others have not moved");
}

/// Three people on one square metre and one on another: cells have the colours of three and of one to the square metre.
TEST(Frames, SquareMetresHaveTheColourOfTheirDensity)
{
    const TemporaryFolder folder;
    bench::View view;
    view.people = {{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {2.9, 0.9}};
    for (std::size_t i = 0; i < view.people.size(); ++i)
        view.shapes.push_back({view.people[i], view.people[i], 0.05, 0, i});
    view.walls = {{{0, 0}, {3, 0}}, {{3, 0}, {3, 1}}};
    FrameWriter writer(folder.path.string(), FrameColour::density);
    Solver solver{SolverSettings{}};
    writer.write(view, solver.executor());
    const ReadPicture picture((folder.path / "frame-00000.png").string());
    const auto at = [&](double x, double y) {
        constexpr double scale = 900.0 / 4;
        return picture.at(static_cast<int>(20 + (x + 0.5) * scale),
                          static_cast<int>(picture.height - 20 - (y + 0.5) * scale));
    };
    // Three eighths of the scale: an eighth of the way from the second colour to the third.
    expect_near(at(0.5, 0.5), {136, 192, 160}, 2, "three on a square metre");
    expect_near(at(1.5, 0.5), {250, 250, 248}, 0, "nobody");
    expect_near(at(2.5, 0.5), {89, 146, 176}, 2, "one");
}

TEST(Frames, AFolderThatCannotBeMadeIsNamed)
{
    try {
        FrameWriter writer("/dev/null/frames");
        FAIL() << "expected a refusal";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()).find("/dev/null/frames: "), 0U) << error.what();
    }
}

}  // namespace
}  // namespace motley::bench
