// What a solver refuses, leaves out and reports. Independent evidence: the same steps without the bad input.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <string>
#include <utility>

#include "mixed_scene.h"
#include "system.h"

namespace motley {
namespace {

using testing::MixedScene;

constexpr float dt = 1.0F / 60;

TEST(Solver, ThatHasBeenMovedFromRefusesEverything)
{
    Solver solver;
    const Solver other = std::move(solver);
    Scene scene;
    // NOLINTBEGIN(bugprone-use-after-move): that is what is tested
    const StepReport report = solver.step(scene, dt);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_EQ(report.error, "Solver is moved from; expected a solver that nobody has moved from");
    EXPECT_THROW(static_cast<void>(solver.settings()), InvalidInput);
    EXPECT_THROW(solver.set_settings({}), InvalidInput);
    EXPECT_THROW(static_cast<void>(solver.isa()), InvalidInput);
    EXPECT_THROW(static_cast<void>(solver.threads()), InvalidInput);
    EXPECT_THROW(static_cast<void>(solver.executor()), InvalidInput);
    // NOLINTEND(bugprone-use-after-move)
}

TEST(Solver, RefusesAnInstructionSetOfTheEnvironmentUnlessItsOptionsNameOne)
{
    const char* before = std::getenv("MOTLEY_ISA");
    const std::string kept = before == nullptr ? "" : before;
    testing::set_environment("MOTLEY_ISA", "abacus");
    std::string refusal;
    try {
        Solver solver;
    } catch (const InvalidInput& error) {
        refusal = error.what();
    }
    EXPECT_NO_THROW(Solver({}, {.isa = Isa::scalar}));
    testing::set_environment("MOTLEY_ISA", kept.c_str());
    EXPECT_EQ(refusal.find("MOTLEY_ISA is abacus; expected one of scalar"), 0U) << refusal;
}

TEST(Solver, TellsOfABudgetThatItHasMissed)
{
    for (const Method method : {Method::soft_step, Method::direct}) {
        for (const float budget_ms : {0.0F, 1e-6F, 1e6F}) {
            MixedScene mixed(2);
            SolverSettings settings;
            settings.method = method;
            settings.budget_ms = budget_ms;
            const StepReport report = Solver(settings).step(mixed.scene, dt, mixed.contacts());
            EXPECT_EQ(report.status, StepStatus::done);
            EXPECT_EQ(report.over_budget, budget_ms == 1e-6F);
        }
    }
}

/// Contacts that cannot be taken in, each for another reason.
std::vector<Contact> bad_contacts(const MixedScene& mixed, BodyId dead)
{
    Contact good;
    good.body_a = mixed.balls[1];
    good.body_b = mixed.balls[2];
    good.normal = {0, 1, 0};
    std::vector<Contact> bad(6, good);
    bad[0].normal = {0, 1, 1};
    bad[1].separation = std::numeric_limits<float>::quiet_NaN();
    bad[2].body_a = dead;
    bad[3].body_b = good.body_a;
    bad[4].arm_a.x = std::numeric_limits<float>::infinity();
    bad[5].body_a = mixed.scene.ground();
    bad[5].body_b = mixed.paddle;
    for (std::size_t i = 0; i < bad.size(); ++i) bad[i].key = std::uint64_t{1} << 60 | i;
    return bad;
}

TEST(BadContacts, AreLeftOutIfAskedForAndNothingElseChanges)
{
    struct Way {
        Method method;
        int threads;
    };
    for (const Way& way : {Way{Method::soft_step, 1}, Way{Method::soft_step, 2},
                           Way{Method::sequential_impulse, 2}, Way{Method::direct, 1}}) {
        MixedScene mixed(4), without(4);
        const BodyId dead = mixed.scene.add_body({});
        mixed.scene.remove_body(dead);
        without.scene.remove_body(without.scene.add_body({}));
        SolverSettings settings;
        settings.method = way.method;
        settings.gravity = {0, -9.81F, 0};
        settings.measures = true;
        Solver other(settings);
        settings.bad_contacts = BadContacts::skip;
        Solver solver(settings, {.threads = way.threads, .alone_below = 0});
        const int steps = way.method == Method::direct ? 10 : 60;
        for (int step = 0; step < steps; ++step) {
            std::vector<Contact> contacts = mixed.contacts();
            const std::vector<Contact> bad = bad_contacts(mixed, dead);
            for (std::size_t i = 0; i < bad.size(); ++i) {
                const std::size_t at = std::min(contacts.size(), 3 * i + 2);
                contacts.insert(contacts.begin() + static_cast<std::ptrdiff_t>(at), bad[i]);
            }
            const StepReport report = solver.step(mixed.scene, dt, contacts);
            const StepReport as_good = other.step(without.scene, dt, without.contacts());
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            EXPECT_EQ(report.contacts_skipped, 6);
            const std::size_t first = std::min<std::size_t>(contacts.size() - bad.size(), 2);
            EXPECT_EQ(report.skipped_error.find("contacts[" + std::to_string(first) + "].normal is 1.41"), 0U)
                << report.skipped_error;
            EXPECT_EQ(report.contacts, as_good.contacts);
            EXPECT_EQ(report.measures.penetration_rms, as_good.measures.penetration_rms);
            EXPECT_EQ(as_good.contacts_skipped, 0);
            ASSERT_EQ(mixed.scene.state_hash(), without.scene.state_hash()) << "step " << step;
            EXPECT_EQ(mixed.scene.contact_impulses()[first].normal, 0);
        }
    }
}

TEST(BadContacts, RefuseTheStepByDefault)
{
    MixedScene mixed(4);
    const std::uint64_t before = mixed.scene.state_hash();
    const StepReport report = Solver().step(mixed.scene, dt, bad_contacts(mixed, BodyId{}));
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_EQ(report.error.find("contacts[0].normal"), 0U) << report.error;
    EXPECT_EQ(mixed.scene.state_hash(), before);
}

TEST(BadContacts, WhoseKeyComesTwiceAreRefusedAllTheSame)
{
    MixedScene mixed(4);
    std::vector<Contact> bad = bad_contacts(mixed, BodyId{});
    bad[3].key = bad[1].key;
    SolverSettings settings;
    settings.bad_contacts = BadContacts::skip;
    const StepReport report = Solver(settings).step(mixed.scene, dt, bad);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_NE(report.error.find("twice in the list"), std::string::npos) << report.error;
}

}  // namespace
}  // namespace motley
