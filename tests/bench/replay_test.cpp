// `motley replay`: a problem that was written to a file gives, whoever solves it again, the bits of the step that it was
// recorded before. The program's exit codes and messages are those of a shell that runs it.
#include "commands/replay.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "mixed_scene.h"
#include "rig.h"

namespace motley::bench {
namespace {

/// A file of a test, removed with it.
struct TemporaryFile {
    std::string path;
    TemporaryFile()
    {
        const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
        path = (std::filesystem::temp_directory_path() / (std::string("motley-") + test->name())).string() +
               "-" + std::to_string(getpid());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() { std::filesystem::remove(path); }
};

SolverSettings with_method(Method method)
{
    SolverSettings settings;
    settings.method = method;
    settings.gravity = {0, -9.81F, 0};
    return settings;
}

/// Records the problem of the twentieth step of a mixed scene. Returns the hash of the state after that step and after
/// two more without contacts, as text.
std::string record(const std::string& file, const SolverSettings& settings)
{
    motley::testing::MixedScene mixed(6);
    Solver solver(settings);
    for (int step = 0; step < 20; ++step) solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
    save_problem({mixed.scene, settings, 1.0F / 60, mixed.contacts()}, file);
    EXPECT_FALSE(mixed.contacts().empty());
    std::ostringstream hashes;
    hashes << std::hex << std::setfill('0');
    for (int step = 0; step < 3; ++step) {
        const std::vector<Contact> contacts = step == 0 ? mixed.contacts() : std::vector<Contact>{};
        EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, contacts).status, StepStatus::done);
        hashes << std::setw(16) << mixed.scene.state_hash() << "\n";
    }
    return hashes.str();
}

/// The hashes after the steps in the text of a replay.
std::string hashes_in(const std::string& text)
{
    static const std::regex line("step \\d+ *hash ([0-9a-f]{16})");
    std::string hashes;
    for (std::sregex_iterator found(text.begin(), text.end(), line), end; found != end; ++found)
        hashes += (*found)[1].str() + "\n";
    return hashes;
}

TEST(Replay, GivesTheBitsOfTheRecordedStepOnEveryInstructionSetAndThreadCount)
{
    const TemporaryFile file;
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        const std::string recorded = record(file.path, with_method(method));
        for (const Isa isa : available_isas()) {
            for (const int threads : {1, 2, 3}) {
                if (motley::testing::is_sanitized && threads != 2) continue;
                const std::string text =
                    replay(load_problem(file.path), {.threads = threads, .alone_below = 0, .isa = isa}, 3);
                EXPECT_EQ(hashes_in(text), recorded) << isa_name(isa) << ", " << threads << "\n" << text;
            }
        }
    }
}

TEST(Replay, UnderOtherSettingsGivesOtherBits)
{
    const TemporaryFile file;
    const std::string recorded = record(file.path, with_method(Method::soft_step));
    StepProblem problem = load_problem(file.path);
    problem.settings.substeps = 5;
    EXPECT_NE(hashes_in(replay(std::move(problem), {}, 3)), recorded);
}

TEST(Replay, OfAStepThatIsRefusedSaysWhy)
{
    motley::testing::MixedScene mixed(2);
    StepProblem problem{mixed.scene, {}, 1.0F / 60, mixed.contacts()};
    ASSERT_FALSE(problem.contacts.empty());
    problem.contacts[0].friction = -1;
    try {
        replay(std::move(problem), {}, 1);
        FAIL() << "expected a refusal";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()).find("step 1 refused: contacts[0].friction is -1"), 0U)
            << error.what();
    }
}

#ifdef MOTLEY_PROGRAM
struct Outcome {
    int exit_code;
    std::string text;  ///< of both outputs
};
Outcome run_program(const std::string& arguments)
{
    std::FILE* const pipe = popen((MOTLEY_PROGRAM " " + arguments + " 2>&1").c_str(), "r");
    Outcome outcome{-1, ""};
    if (pipe == nullptr) return outcome;
    std::array<char, 4096> part{};
    for (std::size_t size = 0; (size = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
        outcome.text.append(part.data(), size);
    const int status = pclose(pipe);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}

TEST(ReplayProgram, PrintsTheBitsOfTheRecordedStep)
{
    const TemporaryFile file;
    const std::string recorded = record(file.path, with_method(Method::soft_step));
    const Outcome outcome = run_program("replay " + file.path + " --steps 3 --isa scalar --threads 2");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_EQ(hashes_in(outcome.text), recorded) << outcome.text;
}

TEST(ReplayProgram, SaysWhatIsWrongWithAFileAndExitsWithOne)
{
    const TemporaryFile file;
    record(file.path, with_method(Method::soft_step));
    std::ifstream in(file.path, std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(in), {}};
    ASSERT_GT(good.size(), 1000U);
    std::string changed = good;
    changed[good.size() / 2] = static_cast<char>(changed[good.size() / 2] ^ 4);
    const std::pair<const char*, std::string> cases[] = {{"changed", changed},
                                                         {"truncated", good.substr(0, good.size() / 2)},
                                                         {"foreign", "a letter"},
                                                         {"empty", ""}};
    for (const auto& [name, bytes] : cases) {
        std::ofstream(file.path, std::ios::binary | std::ios::trunc) << bytes;
        const Outcome outcome = run_program("replay " + file.path);
        EXPECT_EQ(outcome.exit_code, 1) << name << ": " << outcome.text;
        // One line that names the file.
        EXPECT_EQ(outcome.text.find("motley: " + file.path + ": "), 0U) << name << ": " << outcome.text;
        EXPECT_EQ(outcome.text.find('\n'), outcome.text.size() - 1) << name << ": " << outcome.text;
    }
    const Outcome missing = run_program("replay " + file.path + "-nowhere");
    EXPECT_EQ(missing.exit_code, 1) << missing.text;
    EXPECT_NE(missing.text.find(file.path + "-nowhere"), std::string::npos) << missing.text;
}

TEST(ReplayProgram, RefusesWrongDialsWithTwo)
{
    const TemporaryFile file;
    record(file.path, with_method(Method::soft_step));
    for (const char* const dials : {"--isa abacus", "--steps 0", "--substeps 0"}) {
        const Outcome outcome = run_program("replay " + file.path + " " + dials);
        EXPECT_EQ(outcome.exit_code, 2) << dials << ": " << outcome.text;
        EXPECT_FALSE(outcome.text.empty()) << dials;
    }
    EXPECT_EQ(run_program("replay").exit_code, 2);
}
#endif

}  // namespace
}  // namespace motley::bench
