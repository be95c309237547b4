// Handles of bodies and joints against a map that is updated in the same way. RapidCheck decides what is added and
// removed.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <vector>

#include "motley/motley.h"

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

}  // namespace
}  // namespace motley
