// Random contacts of figures, sorted into blocks of one copy per lane. Independent evidence: each contact is found once,
// in a lane that says the same of it as the contact itself.
#include "figures/copy_contacts.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "mixed_scene.h"

namespace motley {
namespace {

using testing::Random;

/// A block of copies whose body i of copy k has the row 1 + 16 i + k.
struct Copies {
    FigureShape shape;
    std::vector<std::int32_t> offsets, places{0};
    FigureBlock block;

    Copies(int bodies, int count)
    {
        shape.bodies.assign(static_cast<std::size_t>(bodies), BodyKind::rigid);
        for (int i = 0; i < bodies * block_lanes; ++i) {
            offsets.push_back(i % block_lanes < count ? offset_of(row(i)) : 0);
            places.push_back(i);
        }
        block.shape = &shape;
        block.count = count;
        block.offsets = offsets.data();
    }
    [[nodiscard]] static BodyRow row(int place)
    {
        return {BodyKind::rigid, static_cast<std::uint32_t>(place + 1)};
    }
};

/// Contacts of any type with one of six fixed bodies; those of a body differ in colour. Left-out ones
/// and those of other figures are among the placements, but not listed.
std::vector<std::uint32_t> random_contacts(Random& random, const Copies& copies, Array<Placement>& placements)
{
    std::set<std::pair<int, int>> taken;
    std::vector<std::uint32_t> listed;
    for (int i = 0; i < 300; ++i) {
        const int body = random.below(static_cast<int>(copies.shape.bodies.size()));
        const int place = body * block_lanes + random.below(copies.block.count), colour = random.below(6);
        Placement contact;
        contact.constraint = i;
        contact.type = static_cast<std::uint8_t>(random.below(contact_type_count));
        contact.colour = static_cast<std::uint8_t>(colour);
        contact.a = Copies::row(place);
        contact.b = BodyRow(BodyKind::fixed, 1 + static_cast<std::uint32_t>(random.below(6)));
        if (taken.insert({place, colour}).second) listed.push_back(static_cast<std::uint32_t>(i));
        placements.push_back(contact);
    }
    return listed;
}

TEST(CopyContacts, EachIsInTheLaneOfItsCopyOnce)
{
    Random random(5);
    CopyContacts sorted;
    for (int trial = 0; trial < 200; ++trial) {
        const Copies copies(1 + random.below(12), 1 + random.below(block_lanes));
        Array<Placement> placements;
        const std::vector<std::uint32_t> listed = random_contacts(random, copies, placements);
        sorted.make_room(listed.size(), copies.shape.bodies.size());
        sorted.sort(copies.block, listed, placements, copies.places);
        std::set<std::int32_t> seen;
        std::set<std::tuple<int, int, int>> kinds;
        int colour = 0;
        for (const CopyContacts::Slot& slot : sorted.slots()) {
            EXPECT_GE(slot.colour, colour) << "by colour";
            colour = slot.colour;
            EXPECT_TRUE(kinds.insert({slot.body, slot.colour, slot.type}).second)
                << "no more blocks than needed";
            EXPECT_EQ(*sorted.count(slot), copies.block.count);
            ASSERT_LT(slot.fixed, sorted.fixed_count());
            bool any = false;
            for (int lane = 0; lane < block_lanes; ++lane) {
                const std::int32_t constraint = sorted.constraints(slot)->lane[lane];
                const std::int32_t a = sorted.bodies(slot)->a[lane], b = sorted.bodies(slot)->b[lane];
                const Placement& contact = placements[static_cast<std::size_t>(constraint)];
                EXPECT_EQ(contact.type, slot.type) << "padding copies a contact of its type";
                if (!(sorted.present(slot)[lane] > 0)) {
                    EXPECT_EQ(a, 0);
                    EXPECT_EQ(b, 0);
                    continue;
                }
                any = true;
                EXPECT_TRUE(seen.insert(constraint).second);
                EXPECT_EQ(contact.colour, slot.colour);
                EXPECT_EQ(a, offset_of(contact.a));
                EXPECT_EQ(b, offset_of(contact.b));
                EXPECT_EQ(a, copies.offsets[static_cast<std::size_t>(slot.body * block_lanes + lane)]);
                EXPECT_EQ(b, sorted.fixed_offsets()[slot.fixed * block_lanes + lane]);
            }
            EXPECT_TRUE(any);
        }
        EXPECT_EQ(seen, std::set<std::int32_t>(listed.begin(), listed.end()));
    }
}

TEST(CopyContacts, AllOnOneFloorShareItsLanes)
{
    const Copies copies(11, 16);
    Array<Placement> placements;
    std::vector<std::uint32_t> listed;
    for (int place = 0; place < 11 * block_lanes; place += 3) {
        Placement contact;
        contact.a = Copies::row(place);
        contact.b = BodyRow(BodyKind::fixed, 1);
        contact.constraint = static_cast<std::int32_t>(placements.size());
        contact.colour = 0;
        listed.push_back(static_cast<std::uint32_t>(placements.size()));
        placements.push_back(contact);
    }
    CopyContacts sorted;
    sorted.make_room(listed.size(), 11);
    sorted.sort(copies.block, listed, placements, copies.places);
    EXPECT_EQ(sorted.slots().size(), 11U);
    EXPECT_EQ(sorted.fixed_count(), 1);
}

}  // namespace
}  // namespace motley
