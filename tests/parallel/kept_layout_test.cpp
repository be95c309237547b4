// A solver keeps its layout of a scene from step to step. Whatever changes in between, it must give the results of a
// solver that has never seen the scene, which is the independent evidence: all persistent state is in the scene.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "motley/motley.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;

/// Chains of three links, enough of them for blocks of figures, and bodies without joints.
struct Chains {
    static constexpr int count = 40, light = 7;
    Scene scene;
    std::vector<BodyId> links, loose;

    Chains()
    {
        for (int chain = 0; chain < count; ++chain) {
            BodyId above = scene.ground();
            Vec3<float> anchor{2.0F * static_cast<float>(chain), 0, 0};
            for (int link = 0; link < 3; ++link) {
                // So light that a finite force gives an acceleration that is not finite.
                const float mass = links.size() == light ? 1e-6F : 2;
                const BodyId body =
                    scene.add_body({.position = {2.0 * chain + 0.5 + link, 0, 0}, .mass = mass});
                scene.add_joint(BallSocketDefinition{above, body, anchor, {-0.5F, 0, 0}});
                links.push_back(body);
                above = body;
                anchor = {0.5F, 0, 0};
            }
        }
        for (int i = 0; i < 20; ++i) add_loose();
    }
    void add_loose()
    {
        const auto i = static_cast<double>(loose.size());
        loose.push_back(scene.add_body({.position = {1.5 * i, -0.9, 3}, .angular_velocity = {1, 2, 3}}));
    }
    [[nodiscard]] Contact push(BodyId by) const
    {
        Contact contact;
        contact.body_a = by;
        contact.body_b = links.back();
        contact.key = 7;
        contact.normal = {0, 1, 0};
        contact.separation = -0.01F;
        return contact;
    }
};

/// By default the chain with the light link is solved exactly, and so is a figure of its own.
const SolverSettings all_swept{.exact_above_ratio = std::numeric_limits<float>::infinity()};

TEST(KeptLayout, GoesOnAsASolverThatHasNeverSeenTheScene)
{
    struct Turn {
        const char* what;
        std::function<void(Chains&, SolverSettings&)> change;
        enum { nobody, somebody, the_ground } touches = nobody;
        /// Where the layout follows the change: a block keeps 15 chains. A new layout has blocks of 16 and no block of
        /// fewer than 8.
        int chains_in_lockstep = -1;
    };
    const auto nothing = [](Chains&, SolverSettings&) {};
    const std::vector<Turn> turns = {
        {"as built", nothing},
        {"as it was", nothing},
        {"more bodies than blocks of rows",
         [](Chains& c, SolverSettings&) {
             for (int i = 0; i < 700; ++i) c.add_loose();
         }},
        {"as it was", nothing},
        {"a contact comes", nothing, Turn::somebody},
        {"and stays", nothing, Turn::somebody},
        {"and becomes one with the ground", nothing, Turn::the_ground},
        {"and moves again", nothing, Turn::somebody},
        {"and is with the ground", nothing, Turn::the_ground},
        {"and goes", nothing},
        {"blocks are told apart", [](Chains&, SolverSettings& s) { s.measures = true; }},
        {"and no more", [](Chains&, SolverSettings& s) { s.measures = false; }},
        {"positions are projected",
         [](Chains&, SolverSettings& s) {
             s.method = Method::sequential_impulse;
             s.drift_correction = DriftCorrection::projection;
         }},
        {"and blocks are told apart", [](Chains&, SolverSettings& s) { s.measures = true; }},
        {"as before", [](Chains&, SolverSettings& s) { s = all_swept; }},
        {"rows move", [](Chains& c, SolverSettings&) { c.scene.renumber_bodies(); }},
        {"a loose body goes",
         [](Chains& c, SolverSettings&) {
             c.scene.remove_body(c.loose.back());
             c.loose.pop_back();
         }},
        {"a link goes, and its joints", [](Chains& c, SolverSettings&) { c.scene.remove_body(c.links[4]); },
         Turn::nobody, Chains::count - 1},
        {"a joint comes",
         [](Chains& c, SolverSettings&) {
             c.scene.add_joint(
                 DistanceDefinition{.body_a = c.links[0], .body_b = c.loose[0], .max_length = 9});
         }},
        {"locks at once", [](Chains&, SolverSettings& s) { s.exact_joints = true; }},
        {"with a contact", nothing, Turn::somebody},
        {"with one with the ground", nothing, Turn::the_ground},
        {"and without", nothing},
        {"locks in turn", [](Chains&, SolverSettings& s) { s.exact_joints = false; }},
        {"a link is thrown out of the world",
         [](Chains& c, SolverSettings&) {
             c.scene.set_force(c.links[Chains::light], {3e38F, 3e38F, 0}, {});
         }},
        {"and left out", nothing},
    };
    Chains kept, seen_anew = kept;
    Scene other;
    other.add_joint(BallSocketDefinition{other.ground(), other.add_body({}), {}, {1, 0, 0}});
    SolverSettings settings = all_swept;
    Solver solver(settings);
    for (const Turn& turn : turns) {
        SCOPED_TRACE(turn.what);
        SolverSettings again = settings;
        turn.change(kept, settings);
        turn.change(seen_anew, again);
        solver.set_settings(settings);
        for (int step = 0; step < 3; ++step) {
            std::vector<Contact> contacts;
            if (turn.touches == Turn::somebody) contacts.push_back(kept.push(kept.loose.front()));
            if (turn.touches == Turn::the_ground) contacts.push_back(kept.push(kept.scene.ground()));
            // One solver may serve several scenes.
            if (step == 2) solver.step(other, dt);
            Solver new_solver(settings);
            const StepReport report = solver.step(kept.scene, dt, contacts);
            const StepReport expected = new_solver.step(seen_anew.scene, dt, contacts);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            EXPECT_EQ(report.joints, expected.joints);
            if (turn.chains_in_lockstep >= 0 && step < 2) {
                EXPECT_EQ(report.joints_in_lockstep, 3 * turn.chains_in_lockstep);
            } else {
                EXPECT_EQ(report.joints_in_lockstep, expected.joints_in_lockstep);
                EXPECT_EQ(report.blocks, expected.blocks);
            }
            EXPECT_EQ(report.measures.residual_norm, expected.measures.residual_norm);
            ASSERT_EQ(kept.scene.state_hash(), seen_anew.scene.state_hash()) << "step " << step;
        }
    }
    EXPECT_TRUE(kept.scene.is_contained(kept.links[Chains::light]));
}

}  // namespace
}  // namespace motley
