// Where two axes are nearest to each other. Independent evidence: the least of many sampled distances, and the condition
// that a nearest point fulfils (the gap is across an axis that it does not leave at an end).
// The test that spares pairs this search is held to what the search finds.
#include <gtest/gtest.h>

#include <cmath>

#include "mixed_scene.h"
#include "shapes/placed_shapes.h"

namespace motley {
namespace {

using testing::Random;

double distance2(const Axis& a, const Axis& b, const AxisPlaces& places)
{
    const Vec3<double> gap = b.at(places.on_b) - a.at(places.on_a);
    return dot(gap, gap);
}

Vec3<double> anywhere(Random& random)
{
    return {random.symmetric(), random.symmetric(), random.symmetric()};
}

/// Axes of all kinds: in general position, parallel, in one plane, without length, and one behind the other.
std::pair<Axis, Axis> some_axes(Random& random, int kind)
{
    Axis a{anywhere(random), anywhere(random)}, b{anywhere(random), anywhere(random)};
    if (kind == 1) b.along = random.symmetric() * a.along;
    if (kind == 2) a.from.z = b.from.z = a.along.z = b.along.z = 0;
    if (kind == 3) a.along = {};
    if (kind == 4) b.along = {};
    if (kind == 5) a.along = b.along = {};
    if (kind == 6) b = {a.at(1.5), 0.5 * a.along};
    return {a, b};
}

TEST(ClosestPlaces, NoSampledPlacesAreNearer)
{
    Random random;
    for (int trial = 0; trial < 700; ++trial) {
        const auto [a, b] = some_axes(random, trial % 7);
        const AxisPlaces places = nearest_places(a, b);
        ASSERT_TRUE(places.on_a >= 0 && places.on_a <= 1 && places.on_b >= 0 && places.on_b <= 1);
        const double found = distance2(a, b, places);
        for (int i = 0; i <= 40; ++i) {
            for (int j = 0; j <= 40; ++j)
                ASSERT_LE(found, distance2(a, b, {i / 40.0, j / 40.0}) + 1e-12)
                    << "axes of kind " << trial % 7;
        }
    }
}

TEST(ClosestPlaces, TheGapIsAcrossAnAxisUnlessItLeavesAnEnd)
{
    Random random;
    for (int trial = 0; trial < 7000; ++trial) {
        const auto [a, b] = some_axes(random, trial % 7);
        const AxisPlaces places = nearest_places(a, b);
        const Vec3<double> gap = b.at(places.on_b) - a.at(places.on_a);
        const auto expect_across = [&](const Vec3<double>& along, double place, double towards) {
            const double slope = towards * dot(gap, along);  // how fast the gap closes along the axis
            if (place > 0) {
                EXPECT_GT(slope, -1e-9);
            }
            if (place < 1) {
                EXPECT_LT(slope, 1e-9);
            }
        };
        expect_across(a.along, places.on_a, 1);
        expect_across(b.along, places.on_b, -1);
    }
}

TEST(TouchingPlaces, OfAxesSideBySideAreTheEndsOfTheStretchTheyShare)
{
    const Axis a{{0, 0, 0}, {4, 0, 0}}, b{{6, 0.01, 1}, {-3, 0.01, 0}};  // from x = 6 to x = 3
    const TouchingPlaces touching = touching_places(a, b);
    ASSERT_EQ(touching.count, 2);
    EXPECT_DOUBLE_EQ(a.at(touching.places[0].on_a).x, 4);
    EXPECT_NEAR(b.at(touching.places[0].on_b).x, 4, 1e-4);
    EXPECT_DOUBLE_EQ(a.at(touching.places[1].on_a).x, 3);
    EXPECT_NEAR(b.at(touching.places[1].on_b).x, 3, 1e-4);
}

TEST(TouchingPlaces, AreOneOfAxesThatCrossOrLieOneBehindTheOther)
{
    EXPECT_EQ(touching_places({{0, 0, 0}, {1, 0, 0}}, {{0.5, -1, 1}, {0, 2, 0}}).count, 1);
    const TouchingPlaces behind = touching_places({{0, 0, 0}, {1, 0, 0}}, {{2, 0, 0}, {1, 0, 0}});
    ASSERT_EQ(behind.count, 1);
    EXPECT_DOUBLE_EQ(behind.places[0].on_a, 1);
    EXPECT_DOUBLE_EQ(behind.places[0].on_b, 0);
    EXPECT_EQ(touching_places({{0, 0, 0}, {}}, {{1, 0, 0}, {}}).count, 1);
}

PlacedCapsule capsule_on(const Axis& axis, bool is_flat)
{
    PlacedCapsule placed;
    placed.axis = axis;
    placed.middle = axis.at(0.5);
    placed.is_flat = is_flat;
    return placed;
}

/// No pair within the distance is ever spared, in space and as seen from above; of those at twice the distance most are.
TEST(ClosestPlaces, OnlyPairsThatAreFurtherApartAreSparedTheSearch)
{
    Random random;
    int far = 0, spared = 0;
    for (int trial = 0; trial < 70'000; ++trial) {
        auto [a, b] = some_axes(random, trial % 7);
        b.from = b.from + 2.0 * anywhere(random);
        const bool is_flat = trial % 2 == 0;
        const PlacedCapsule one = capsule_on(a, is_flat), other = capsule_on(b, false);
        if (is_flat) a = flattened(a), b = flattened(b);
        const double apart = std::sqrt(distance2(a, b, nearest_places(a, b)));
        ASSERT_TRUE(may_be_within(one, other, apart)) << "axes of kind " << trial % 7;
        ASSERT_TRUE(may_be_within(other, one, apart));
        if (!(apart > 0.1)) continue;
        ++far;
        spared += may_be_within(one, other, 0.5 * apart) ? 0 : 1;
    }
    EXPECT_GT(far, 50'000);
    EXPECT_GT(spared, far * 3 / 4);
}

}  // namespace
}  // namespace motley
