// Colours and blocks of a scene that changes from step to step: RapidCheck decides what is added, removed and
// touched. Checks the properties of every valid colouring, over what the layout has kept and what it has made anew.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "block_walk.h"
#include "lay_out.h"

namespace motley {
namespace {

/// Checks that no two constraints of one colour share a body that can move. Returns the number of constraints.
std::size_t check_colours(const Layout& layout)
{
    std::set<std::pair<int, std::uint64_t>> taken;  // colour, and kind and row of a body
    std::set<std::pair<int, std::int32_t>> seen;    // type, and constraint
    for (const std::span<const Placement> placements :
         {layout.joint_placements(), layout.contact_placements()}) {
        for (const Placement& placement : placements) {
            if (placement.is_gap()) continue;
            RC_ASSERT(seen.insert({placement.type, placement.constraint}).second);
            RC_ASSERT(placement.colour <= overflow_colour);
            if (placement.colour == overflow_colour) continue;
            for (const BodyRow body : {placement.a, placement.b}) {
                if (body.kind() == BodyKind::fixed) continue;
                const auto who =
                    static_cast<std::uint64_t>(body.kind()) << 32 | static_cast<std::uint32_t>(body.row());
                RC_ASSERT(taken.insert({placement.colour, who}).second);
            }
        }
    }
    return seen.size();
}

/// Checks that each constraint is in one lane of the blocks. Returns the number of constraints.
std::size_t check_blocks(const Layout& layout)
{
    std::set<std::pair<int, std::int32_t>> seen;
    testing::for_each_lane(layout.sweeps(), [&](const SweepChunk& chunk, std::int32_t block, int lane) {
        RC_ASSERT(seen.insert({chunk.type, chunk.streams.constraints[block].lane[lane]}).second);
    });
    return seen.size();
}

RC_GTEST_PROP(Recolouring, IsValidWhateverCameAndWentSinceTheLastStep,
              (const std::vector<std::vector<std::uint16_t>>& steps))
{
    Scene scene;
    Layout layout(kernel_table(Isa::scalar));
    std::vector<BodyId> bodies;
    std::vector<ConstraintId> joints;
    const auto add_body = [&](unsigned what) {
        BodyDefinition body;
        body.model = static_cast<BodyModel>(what % 3);
        if (what % 7 == 0) body.motion = BodyMotion::static_body;
        bodies.push_back(scene.add_body(body));
    };
    for (unsigned i = 0; i < 12; ++i) add_body(i);
    for (const auto& step : steps) {
        std::vector<Contact> contacts;
        std::set<std::uint64_t> keys;
        for (const std::uint16_t word : step) {
            const unsigned what = word;
            const BodyId a = bodies[what / 8 % bodies.size()], b = bodies[what / 128 % bodies.size()];
            const bool moves =
                scene.motion(a) == BodyMotion::dynamic_body || scene.motion(b) == BodyMotion::dynamic_body;
            switch (what % 8) {
                case 0:
                    add_body(what / 8);
                    break;
                case 1: {
                    if (bodies.size() <= 4) break;
                    scene.remove_body(a);
                    std::erase(bodies, a);
                    std::erase_if(joints, [&](ConstraintId joint) { return !scene.is_alive(joint); });
                    // Contacts of the removed body are removed too.
                    std::erase_if(contacts, [&](const Contact& contact) {
                        return contact.body_a == a || contact.body_b == a;
                    });
                    break;
                }
                case 2:
                    if (a != b && moves)
                        joints.push_back(scene.add_joint(BallSocketDefinition{a, b, {}, {}}));
                    break;
                case 3:
                    if (joints.empty()) break;
                    scene.remove_joint(joints[what / 8 % joints.size()]);
                    joints.erase(joints.begin() + static_cast<std::ptrdiff_t>(what / 8 % joints.size()));
                    break;
                default:
                    // The key depends on the pair alone, so that it recurs in later steps.
                    if (a == b || !moves || !keys.insert(std::uint64_t{a.slot} << 32 | b.slot).second) break;
                    Contact contact;
                    contact.body_a = a;
                    contact.body_b = b;
                    contact.key = std::uint64_t{a.slot} << 32 | b.slot;
                    contact.normal = {1, 0, 0};
                    contact.friction = what % 2 == 0 ? 0.5F : 0;
                    contacts.push_back(contact);
            }
        }
        testing::lay_out(layout, scene, contacts);
        RC_ASSERT(check_colours(layout) == contacts.size() + scene.joint_count());
        RC_ASSERT(check_blocks(layout) == contacts.size() + scene.joint_count());
    }
}

}  // namespace
}  // namespace motley
