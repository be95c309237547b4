// Colours and blocks of a scene that changes from step to step: RapidCheck decides what is added, removed and
// touched. Checks the properties of every valid colouring, over what the layout has kept and what it has made anew.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "block_walk.h"
#include "large_property.h"
#include "lay_out.h"

namespace motley {
namespace {

/// Checks that no two constraints of one colour share a body that can move. Returns the number of constraints.
std::size_t check_colours(Layout& layout)
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
std::size_t check_blocks(Layout& layout)
{
    std::set<std::pair<int, std::int32_t>> seen;
    testing::for_each_lane(layout.sweeps(), [&](const SweepChunk& chunk, std::int32_t block, int lane) {
        RC_ASSERT(seen.insert({chunk.type, chunk.streams.constraints[block].lane[lane]}).second);
    });
    return seen.size();
}

/// What happens to a scene between two steps, or a contact that it then has.
struct Event {
    unsigned what;  ///< 0: a body comes, 1: one goes, 2: a joint comes, 3: one goes, else: a contact
    std::uint64_t a, b;
};

/// A scene that changes by events, and the contacts of its present step.
struct Changing {
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<ConstraintId> joints;
    std::vector<Contact> contacts;

    explicit Changing(unsigned count)
    {
        for (unsigned i = 0; i < count; ++i) add_body(i);
    }
    void add_body(std::uint64_t what)
    {
        BodyDefinition body;
        body.model = static_cast<BodyModel>(what % 3);
        if (what % 7 == 0) body.motion = BodyMotion::static_body;
        bodies.push_back(scene.add_body(body));
    }
    /// Removes the contacts that `goes` returns true for.
    template <class Goes>
    void drop_contacts(const Goes& goes)
    {
        std::erase_if(contacts, [&](const Contact& contact) {
            const bool gone = goes(contact);
            if (gone) keys_.erase(contact.key);
            return gone;
        });
    }
    void happen(const Event& event)
    {
        const BodyId a = bodies[event.a % bodies.size()], b = bodies[event.b % bodies.size()];
        const bool moves =
            scene.motion(a) == BodyMotion::dynamic_body || scene.motion(b) == BodyMotion::dynamic_body;
        switch (event.what) {
            case 0:
                add_body(event.a);
                break;
            case 1:
                if (bodies.size() <= 4) break;
                scene.remove_body(a);
                std::erase(bodies, a);
                std::erase_if(joints, [&](ConstraintId joint) { return !scene.is_alive(joint); });
                // Contacts of the removed body are removed too.
                drop_contacts(
                    [&](const Contact& contact) { return contact.body_a == a || contact.body_b == a; });
                break;
            case 2:
                if (a != b && moves) joints.push_back(scene.add_joint(BallSocketDefinition{a, b, {}, {}}));
                break;
            case 3:
                if (joints.empty()) break;
                scene.remove_joint(joints[event.a % joints.size()]);
                joints.erase(joints.begin() + static_cast<std::ptrdiff_t>(event.a % joints.size()));
                break;
            default:
                // The key depends on the pair alone, so that it recurs in later steps.
                const std::uint64_t key = std::uint64_t{a.slot} << 32 | b.slot;
                if (a == b || !moves || !keys_.insert(key).second) break;
                Contact contact;
                contact.body_a = a;
                contact.body_b = b;
                contact.key = key;
                contact.normal = {1, 0, 0};
                contact.friction = event.b % 2 == 0 ? 0.5F : 0;
                contacts.push_back(contact);
        }
    }
    /// Lays the scene out and checks the layout.
    void check(Layout& layout)
    {
        testing::lay_out(layout, scene, contacts);
        RC_ASSERT(check_colours(layout) == contacts.size() + scene.joint_count());
        RC_ASSERT(check_blocks(layout) == contacts.size() + scene.joint_count());
    }

  private:
    std::set<std::uint64_t> keys_;  ///< of the contacts
};

RC_GTEST_PROP(Recolouring, IsValidWhateverCameAndWentSinceTheLastStep,
              (const std::vector<std::vector<std::uint16_t>>& steps))
{
    Changing changing(12);
    Layout layout(kernel_table(Isa::scalar));
    for (const auto& step : steps) {
        changing.drop_contacts([](const Contact&) { return true; });
        for (const std::uint16_t word : step) {
            const unsigned what = word;
            changing.happen({what % 8, what / 8, what / 128});
        }
        changing.check(layout);
    }
}

/// How many chunks constraints of these types take.
std::int64_t chunks_of(std::span<const Placement> placements, int first_type, int last_type)
{
    BatchSet set(first_type, last_type);
    set.begin(placements, false);
    return set.chunk_count();
}

TEST(Recolouring, IsValidInASceneOfSeveralChunksWithHubs)
{
    testing::check_large(4, [] {
        std::mt19937_64 random = testing::any_random();
        Changing changing(3'000);
        Layout layout(kernel_table(Isa::scalar));
        // A chunk of joints takes more of them than one of contacts, because joints have more types.
        for (int joint = 0; joint < 14'000; ++joint) changing.happen({2, random(), random()});
        for (int step = 0; step < 4; ++step) {
            changing.drop_contacts([&](const Contact&) { return random() % 8 == 0; });
            const std::size_t events = testing::any_size(4'000, 6'000);
            for (std::size_t i = 0; i < events; ++i) {
                // One event in sixteen changes bodies or joints; one contact in eight is at one of four hubs.
                const auto what = static_cast<unsigned>(random() % 64);
                const bool at_hub = what >= 4 && random() % 8 == 0;
                changing.happen({what, at_hub ? 1 + random() % 4 : 8 + random(), random()});
            }
            changing.check(layout);
            RC_ASSERT(layout.contacts.chunk_count() > 1);
            RC_ASSERT(chunks_of(layout.joint_placements(), contact_type_count, constraint_type_count) > 1);
            RC_ASSERT(!layout.sweeps().of_colour(overflow_colour).empty());
            std::size_t found_again = 0;
            for (std::size_t i = 0; i < changing.contacts.size(); ++i)
                found_again += layout.intake.memory_index[i] > 0 ? 1 : 0;
            RC_ASSERT(step == 0 || found_again > changing.contacts.size() / 3);
        }
    });
}

}  // namespace
}  // namespace motley
