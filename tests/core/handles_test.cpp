// Handles of bodies and joints, compared with a map that is updated in the same way: RapidCheck decides what is added and removed.
// And handles of other scenes, which are refused.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include "motley/motley.h"
#include "stores/generations.h"

namespace motley {
namespace {

using Name = std::pair<std::uint32_t, std::uint32_t>;
template <class Id>
Name name_of(const Id& id)
{
    return {id.slot, id.generation};
}

RC_GTEST_PROP(Handles, NameWhoTheyNamedUntilRemovedAndNobodyAfterwards,
              (const std::vector<std::uint16_t>& calls))
{
    Scene scene;
    struct Known {
        BodyId id;
        double x;
    };
    std::vector<Known> alive;
    std::map<Name, std::pair<BodyId, BodyId>> joints;  // alive, with their bodies
    std::vector<BodyId> dead;
    std::vector<ConstraintId> dead_joints;
    std::map<Name, bool> bodies_ever, joints_ever;
    const auto forget_joints_of = [&](BodyId body) {
        for (auto joint = joints.begin(); joint != joints.end();) {
            const bool gone = joint->second.first == body || joint->second.second == body;
            if (gone) dead_joints.push_back({joint->first.first, joint->first.second});
            joint = gone ? joints.erase(joint) : std::next(joint);
        }
    };
    double next = 1;
    for (const unsigned call : calls) {
        const unsigned which = call / 4;
        if (call % 4 <= 1 || alive.size() < 2) {
            BodyDefinition body;
            body.model = static_cast<BodyModel>(which % 3);
            body.position.x = next;
            const BodyId id = scene.add_body(body);
            RC_ASSERT(bodies_ever.insert({name_of(id), true}).second);
            alive.push_back({id, next++});
        } else if (call % 4 == 2) {
            const std::size_t at = which % alive.size();
            const BodyId id = alive[at].id;
            scene.remove_body(id);
            forget_joints_of(id);
            dead.push_back(id);
            alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(at));
        } else if (which % 3 == 0 && !joints.empty()) {
            const auto joint = std::next(joints.begin(), static_cast<std::ptrdiff_t>(which % joints.size()));
            const ConstraintId id{joint->first.first, joint->first.second};
            scene.remove_joint(id);
            dead_joints.push_back(id);
            joints.erase(joint);
        } else {
            const BodyId a = alive[which % alive.size()].id, b = alive[which / 7 % alive.size()].id;
            if (a == b) continue;
            const ConstraintId id = which % 2 == 0
                                        ? scene.add_joint(BallSocketDefinition{a, b, {}, {}})
                                        : scene.add_joint(DistanceDefinition{.body_a = a, .body_b = b});
            RC_ASSERT(joints_ever.insert({name_of(id), true}).second);
            joints[name_of(id)] = {a, b};
        }
        // Rows move when others are removed, but a handle still names the same body.
        for (const Known& known : alive) {
            RC_ASSERT(scene.is_alive(known.id));
            RC_ASSERT(scene.state(known.id).position.x == known.x);
        }
        for (const auto& [name, ends] : joints)
            RC_ASSERT(scene.is_alive(ConstraintId{name.first, name.second}));
        for (const BodyId id : dead) RC_ASSERT(!scene.is_alive(id));
        for (const ConstraintId id : dead_joints) RC_ASSERT(!scene.is_alive(id));
        RC_ASSERT(scene.body_count() == alive.size());
        RC_ASSERT(scene.joint_count() == joints.size());
    }
    for (const BodyId id : dead) RC_ASSERT_THROWS_AS(scene.remove_body(id), InvalidInput);
    for (const ConstraintId id : dead_joints) RC_ASSERT_THROWS_AS(scene.remove_joint(id), InvalidInput);
}

/// A scene with one of everything that has a handle.
struct OneOfEach {
    Scene scene;
    BodyId ground = scene.ground(), body = scene.add_body({}),
           person = scene.add_body({.model = BodyModel::planar});
    ConstraintId joint = scene.add_joint(BallSocketDefinition{ground, body, {}, {}});
    ShapeId shape = scene.add_capsule({.body = body});
    std::vector<Vec2<double>> corners{{0, 0}, {1, 0}};
    WallId wall = scene.add_wall({.points = corners});

    [[nodiscard]] bool all_alive_in(const Scene& other) const
    {
        return other.is_alive(ground) && other.is_alive(body) && other.is_alive(person) &&
               other.is_alive(joint) && other.is_alive(shape) && other.is_alive(wall);
    }
};

/// The second scene is built as the first one: all slots are the same.
TEST(Handles, OfAnotherSceneAreRefused)
{
    const OneOfEach one;
    OneOfEach other;
    ASSERT_EQ(one.body.slot, other.body.slot);
    Scene& scene = other.scene;
    EXPECT_TRUE(one.all_alive_in(one.scene));
    EXPECT_FALSE(scene.is_alive(one.ground) || scene.is_alive(one.body) || scene.is_alive(one.person));
    EXPECT_FALSE(scene.is_alive(one.joint) || scene.is_alive(one.shape) || scene.is_alive(one.wall));
    const std::function<void()> calls[] = {
        [&] { (void)scene.state(one.body); },
        [&] {
            scene.set_velocity(one.body, {1, 0, 0}, {});
        },
        [&] { scene.remove_body(one.body); },
        [&] {
            scene.add_joint(BallSocketDefinition{one.ground, other.body, {}, {}});
        },
        [&] {
            scene.add_joint(BallSocketDefinition{other.ground, one.body, {}, {}});
        },
        [&] { scene.add_capsule({.body = one.body}); },
        [&] { scene.set_discs(std::vector{one.person}, std::vector{DiscDefinition{}}); },
        [&] { scene.add_wall({.points = one.corners, .body = one.ground}); },
        [&] { (void)scene.joint_report(one.joint); },
        [&] { scene.remove_joint(one.joint); },
        [&] { scene.remove_shape(one.shape); },
        [&] { scene.remove_wall(one.wall); },
    };
    const std::vector<std::byte> before = save_scene(scene);
    for (std::size_t i = 0; i < std::size(calls); ++i) EXPECT_THROW(calls[i](), InvalidInput) << "call " << i;
    EXPECT_EQ(save_scene(scene), before);

    Contact contact;
    contact.body_a = one.body;
    contact.body_b = other.body;
    Solver solver;
    EXPECT_EQ(solver.step(scene, 0.01F, {&contact, 1}).status, StepStatus::refused);
}

/// Also those of slots that are used again, and of what is added later in the same order.
TEST(Handles, OfASceneAreThoseOfItsCopies)
{
    OneOfEach one;
    const Scene copy = one.scene;
    EXPECT_TRUE(one.all_alive_in(copy));
    Scene read = load_scene(save_scene(one.scene));
    EXPECT_TRUE(one.all_alive_in(read));
    const auto renew = [&](Scene& scene) {
        scene.remove_body(one.person);
        return std::pair(scene.add_body({}), scene.add_body({}));
    };
    EXPECT_EQ(renew(one.scene), renew(read));
    Scene moved = std::move(read);
    EXPECT_TRUE(moved.is_alive(one.body));
    EXPECT_FALSE(OneOfEach{}.all_alive_in(moved));
}

/// As ids.h says.
TEST(Handles, OfManyScenesBeginFarApart)
{
    for (const auto& [scenes, apart] : {std::pair(1000U, 970'000U), std::pair(10'000U, 140'000U)}) {
        std::vector<std::uint32_t> begins(scenes);
        for (std::uint32_t i = 0; i < scenes; ++i) begins[i] = first_generation(i);
        std::sort(begins.begin(), begins.end());
        EXPECT_GT(begins.front(), 0U);
        std::uint32_t least = begins.front() + 0x80000000U - begins.back();
        for (std::uint32_t i = 1; i < scenes; ++i) least = std::min(least, begins[i] - begins[i - 1]);
        EXPECT_GE(least, apart) << scenes;
    }
    EXPECT_EQ(next_generation(UINT32_MAX), 1U) << "0 is the null handle's";
}

}  // namespace
}  // namespace motley
