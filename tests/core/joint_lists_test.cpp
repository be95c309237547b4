// Which joints a body has: the linked lists through the joints against a search of all definitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "mixed_scene.h"
#include "scene/scene_core.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

using Found = std::vector<std::pair<int, std::uint32_t>>;  // types and indices

Found by_the_list(const Scene& scene, BodyId body)
{
    Found found;
    core_of(scene).joints->for_each_on(
        core_of(scene).bodies.first_ends[body.slot],
        [&](const JointStores::Slot& joint) { found.emplace_back(joint.type, joint.index); });
    std::sort(found.begin(), found.end());
    return found;
}

Found by_the_definitions(const Scene& scene, BodyId body)
{
    Found found;
    core_of(scene).joints->for_each([&](const auto& store, int type) {
        for (std::uint32_t i = 0; i < store.size(); ++i) {
            if (store.definitions[i].body_a == body || store.definitions[i].body_b == body)
                found.emplace_back(type, i);
        }
    });
    return found;
}

TEST(JointLists, NameTheJointsOfEachBodyWhateverComesAndGoes)
{
    Scene scene;
    std::vector<BodyId> bodies{scene.ground()};
    std::vector<ConstraintId> joints;
    testing::Random random(99);
    for (int call = 0; call < 2000; ++call) {
        const int what = random.below(10);
        if (what < 2 || bodies.size() < 4) {
            bodies.push_back(scene.add_body({}));
        } else if (what < 7) {
            const auto pick = [&] {
                return bodies[static_cast<std::size_t>(random.below(static_cast<int>(bodies.size())))];
            };
            const BodyId a = pick(), b = pick();
            if (a == b) continue;
            joints.push_back(what < 5 ? scene.add_joint(BallSocketDefinition{a, b, {}, {}})
                                      : scene.add_joint(HingeDefinition{a, b}));
        } else if (what < 9) {
            if (joints.empty()) continue;
            const auto at = joints.begin() + random.below(static_cast<int>(joints.size()));
            if (scene.is_alive(*at)) scene.remove_joint(*at);
            joints.erase(at);
        } else {
            const auto at = bodies.begin() + 1 + random.below(static_cast<int>(bodies.size()) - 1);
            scene.remove_body(*at);
            bodies.erase(at);
        }
        for (const BodyId body : bodies)
            ASSERT_EQ(by_the_list(scene, body), by_the_definitions(scene, body)) << call;
    }
    EXPECT_GT(scene.joint_count(), 20U) << "else nothing was tested";
}

TEST(JointLists, ATeleportForgetsTheImpulsesOfItsOwnJointsAlone)
{
    Scene scene;
    const BodyId a = scene.add_body({.position = {0, -1, 0}}), b = scene.add_body({.position = {5, -1, 0}});
    const ConstraintId of_a = scene.add_joint(BallSocketDefinition{scene.ground(), a, {}, {0, 1, 0}});
    const ConstraintId of_b = scene.add_joint(BallSocketDefinition{b, scene.ground(), {0, 1, 0}, {5, 0, 0}});
    auto& store = std::get<0>(core_of(scene).joints->stores);
    for (float& impulse : store.wrenches) impulse = 1;
    core_of(scene).last_step = 1;
    scene.set_pose(a, {0, -1, 0}, {0, 0, 0, 1}, 0);
    EXPECT_EQ(scene.joint_report(of_a).force.y, 0);
    EXPECT_NE(scene.joint_report(of_b).force.y, 0);
}

}  // namespace
}  // namespace motley
