// Floor plans in WKT. Independent evidence: shapes drawn by hand, texts as Shapely and JuPedSim write them, and a room
// that people cannot leave.
#include "motley/wkt/wkt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "mixed_scene.h"
#include "motley/motley.h"

namespace motley {
namespace {

using Points = std::vector<Vec2<double>>;

void expect_points(const Points& points, const Points& expected)
{
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points[i].x, expected[i].x) << "point " << i;
        EXPECT_EQ(points[i].y, expected[i].y) << "point " << i;
    }
}

std::string message_of(const std::string& text, const WktOptions& options = {})
{
    try {
        read_wkt(text, options);
    } catch (const InvalidInput& refused) {
        return refused.what();
    }
    return "accepted";
}

TEST(Wkt, ReadsEachShape)
{
    const WktShapes room = read_wkt("POLYGON ((0 0, 10 0, 10 10.5, -1e-1 10, 0 0), (2 2, 2 3, 3 3, 2 2))");
    ASSERT_EQ(room.polygons.size(), std::size_t{1});
    expect_points(room.polygons[0].outer, {{0, 0}, {10, 0}, {10, 10.5}, {-0.1, 10}});
    ASSERT_EQ(room.polygons[0].holes.size(), std::size_t{1});
    expect_points(room.polygons[0].holes[0], {{2, 2}, {2, 3}, {3, 3}});
    EXPECT_TRUE(room.lines.empty());

    const WktShapes two = read_wkt("MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((5 0, 6 0, 6 1, 5 0)))");
    ASSERT_EQ(two.polygons.size(), std::size_t{2});
    expect_points(two.polygons[1].outer, {{5, 0}, {6, 0}, {6, 1}});

    const WktShapes lines = read_wkt("MULTILINESTRING ((0 0, 1 0), (5 0, 6 0, 6 1))");
    ASSERT_EQ(lines.lines.size(), std::size_t{2});
    expect_points(lines.lines[1], {{5, 0}, {6, 0}, {6, 1}});
    expect_points(read_wkt("LINESTRING(3 4,5 6)").lines.at(0), {{3, 4}, {5, 6}});
    expect_points(read_wkt("LINEARRING (0 0, 1 0, 1 1, 0 0)").lines.at(0), {{0, 0}, {1, 0}, {1, 1}, {0, 0}});

    const WktShapes all = read_wkt(
        "GEOMETRYCOLLECTION (POLYGON ((0 0, 1 0, 1 1, 0 0)), LINESTRING (0 0, 9 9), POLYGON EMPTY, "
        "GEOMETRYCOLLECTION (MULTIPOLYGON (((5 0, 6 0, 6 1, 5 0))), GEOMETRYCOLLECTION EMPTY))");
    EXPECT_EQ(all.polygons.size(), std::size_t{2});
    EXPECT_EQ(all.lines.size(), std::size_t{1});
    expect_points(all.polygons[1].outer, {{5, 0}, {6, 0}, {6, 1}});
}

TEST(Wkt, LeavesOutHeightsAndRepeatedPoints)
{
    const Points triangle{{0, 0}, {1, 0}, {1, 1}};
    for (const char* text :
         {"POLYGON Z ((0 0 7, 1 0 7, 1 1 8, 0 0 7))", "POLYGON ((0 0 7, 1 0 7, 1 1 8, 0 0 7))",
          "POLYGON ZM ((0 0 7 1, 1 0 7 2, 1 1 8 3, 0 0 7 4))", "polygon((0 0,0 0,1 0,1 1,1 1,0 0))",
          "\n POLYGON\t((0 0 , 1.0 0,+1 1e0,0 -0)) \n"}) {
        const WktShapes shapes = read_wkt(text);
        ASSERT_EQ(shapes.polygons.size(), std::size_t{1}) << text;
        expect_points(shapes.polygons[0].outer, triangle);
    }
    expect_points(read_wkt("LINESTRING Z (0 0 5, 0 0 6, 1 1 7)").lines.at(0), {{0, 0}, {1, 1}});
}

TEST(Wkt, OfNothingIsNothing)
{
    for (const char* text :
         {"POLYGON EMPTY", "MULTIPOLYGON EMPTY", "LINESTRING EMPTY", "MULTILINESTRING EMPTY",
          "GEOMETRYCOLLECTION EMPTY", "POLYGON Z EMPTY", "GEOMETRYCOLLECTION (POLYGON EMPTY)"}) {
        const WktShapes shapes = read_wkt(text);
        EXPECT_TRUE(shapes.polygons.empty() && shapes.lines.empty()) << text;
    }
}

/// Texts of shapely.to_wkt() and of a JuPedSim example.
TEST(Wkt, ReadsWhatShapelyAndJuPedSimWrite)
{
    const WktShapes plan = read_wkt(
        "GEOMETRYCOLLECTION (POLYGON ((0.0000000000000000 0.0000000000000000, 14.0000000000000000 "
        "0.0000000000000000, "
        "14.0000000000000000 5.2000000000000002, 0.0000000000000000 5.2000000000000002, 0.0000000000000000 "
        "0.0000000000000000), (6 2, 6 3, 7 3, 7 2, 6 2)), POLYGON ((14 2, 20 2, 20 3, 14 3, 14 2)))");
    ASSERT_EQ(plan.polygons.size(), std::size_t{2});
    EXPECT_EQ(plan.polygons[0].outer[2].y, 5.2);
    EXPECT_EQ(plan.polygons[0].holes.size(), std::size_t{1});
    const Points circle =
        read_wkt("LINESTRING Z (1 0 0, 6.123233995736766e-17 1 0, -1 1.2246467991473532e-16 0)").lines.at(0);
    EXPECT_EQ(circle[1].x, 6.123233995736766e-17);
}

TEST(Wkt, IsRefusedByWhatIsWrongAndWhere)
{
    EXPECT_EQ(message_of("POLYGON ((0 0, 2 4, 2 0, 0 4, 0 0))"),
              "WKT: self-intersection at (1 2), in geometry 1, a Polygon");
    EXPECT_EQ(message_of("POLYGON ((0 0, 4 0, 2 2, 4 4, 0 4, 2 2, 0 0))"),
              "WKT: ring Self-intersection at (2 2), in geometry 1, a Polygon");
    EXPECT_EQ(message_of("GEOMETRYCOLLECTION (LINESTRING (0 0, 1 1), POLYGON ((0 0, 4 0, 4 4, 0 0), (5 5, 6 "
                         "5, 6 6, 5 5)))"),
              "WKT: hole lies outside shell at (5 5), in geometry 2, a Polygon");
    EXPECT_EQ(message_of("MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4, 0 0)), ((1 1, 2 1, 2 2, 1 1)))"),
              "WKT: nested shells at (1 1), in geometry 1, a MultiPolygon");
    EXPECT_EQ(message_of("LINESTRING (3 3, 3 3)"),
              "WKT: too few points in geometry component at (3 3), in geometry 1, a LineString");
    EXPECT_EQ(message_of("POLYGON ((0 0, 1 0, 1 1))"), "WKT: ring from (0 0) to (1 1) is not closed");
    EXPECT_EQ(
        message_of(
            "GEOMETRYCOLLECTION (LINESTRING (0 0, 9 9), MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0), (7 7 1, 8 7 "
            "1, 8 8.5 1))))"),
        "WKT: ring from (7 7) to (8 8.5) is not closed");
    EXPECT_EQ(message_of("CIRCLE (0 0, 1)"), "WKT: unknown type: 'CIRCLE'");
    EXPECT_EQ(message_of("POINT (1 2)"),
              "WKT: expected polygons, lines and collections of these, in geometry 1, a Point");
    EXPECT_EQ(message_of("GEOMETRYCOLLECTION (LINESTRING (0 0, 9 9), POINT (1 2))"),
              "WKT: expected polygons, lines and collections of these, in geometry 2, a Point");
    EXPECT_EQ(message_of("POLYGON ((NaN 0, 1 0, 1 1, NaN 0))"), "WKT: no finite number: NaN at character 11");
    EXPECT_EQ(message_of("POLYGON ((0 0, -inf 0, 1 1, 0 0))"), "WKT: no finite number: -inf at character 16");
    EXPECT_EQ(message_of("POLYGON ((0 0, 1e999 0, 1 1, 0 0))"),
              "WKT: no finite number: 1e999 at character 16");
    EXPECT_EQ(message_of("LINESTRING (0 0, 1.2.3 4)"), "WKT: no finite number: 1.2.3 at character 18");
    EXPECT_EQ(message_of("LINESTRING (0 0, 1)"), "WKT: expected number but encountered ')'");
    EXPECT_EQ(message_of(""), "WKT: expected word but encountered end of stream");
    EXPECT_EQ(message_of("POLYGON ((0 0, 1 0, 1 1, 0 0)"),
              "WKT: a parenthesis that is not closed at character 9");
    EXPECT_EQ(message_of("POLYGON ((0 0, 1 0, 1 1, 0 0)))"), "WKT: text after the geometry at character 31");
    EXPECT_EQ(message_of("POLYGON ((0 0, 1 0, 1 1, 0 0)) POLYGON EMPTY"),
              "WKT: text after the geometry at character 32");
    EXPECT_EQ(message_of("POLYGON EMPTY x"), "WKT: text after the geometry at character 15");
    EXPECT_EQ(message_of(") POLYGON"), "WKT: a parenthesis that was not opened at character 1");
    EXPECT_EQ(message_of("SRID=4326;POINT (1 1)"), "WKT: a character that WKT does not have at character 5");
    EXPECT_EQ(message_of(std::string("POLYGON\0 EMPTY", 14)),
              "WKT: a character that WKT does not have at character 8");
    std::string nested;
    for (int i = 0; i < 100000; ++i) nested += "GEOMETRYCOLLECTION (";
    EXPECT_EQ(message_of(nested), "WKT: more than 64 parentheses in each other at character 1300");
}

/// Random changes of a text are read or refused, and what is read becomes walls or is refused.
TEST(Wkt, OfAnyBytesIsReadOrRefused)
{
    const std::string good =
        "GEOMETRYCOLLECTION (POLYGON Z ((0 0 1, 9 0 1, 9 9 1, 0 0 1), (4 1 0, 5 1 0, 5 2 0, 4 1 0)), "
        "LINESTRING (0 0, "
        "1.5e1 1), MULTIPOLYGON (((5 0, 6 0, 6 1, 5 0)), EMPTY))";
    const std::string letters = "(), 019.-eEZMnaPOLYGNSTRIUC\0\n\xFF";
    testing::Random random(3);
    int read = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        std::string text = good;
        for (int change = 0; change < 1 + trial % 3; ++change) {
            const auto at = static_cast<std::size_t>(random.below(static_cast<int>(text.size())));
            const auto length = static_cast<std::size_t>(random.below(4));
            text.replace(at, length, 1,
                         letters[static_cast<std::size_t>(random.below(static_cast<int>(letters.size())))]);
        }
        try {
            const WktShapes shapes = read_wkt(text, {.repair = trial % 2 == 0});
            ++read;
            Scene scene;
            for (const Polygon& polygon : shapes.polygons) {
                for (const Vec2<double>& point : polygon.outer)
                    ASSERT_TRUE(std::isfinite(point.x + point.y)) << text;
                add_polygon(scene, polygon);
            }
            for (const Points& line : shapes.lines) scene.add_wall({.points = line});
        } catch (const InvalidInput& refused) {
            const std::string message = refused.what();
            ASSERT_TRUE(message.rfind("WKT: ", 0) == 0 || message.rfind("Polygon.", 0) == 0 ||
                        message.rfind("WallDefinition.", 0) == 0)
                << message;
        }
    }
    EXPECT_GT(read, 300);
}

double area_of(const Points& ring)
{
    double area = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) area += cross(ring[i], ring[(i + 1) % ring.size()]) / 2;
    return std::abs(area);
}

TEST(Wkt, IsMendedIfAskedTo)
{
    // A bow tie becomes its two halves, of 2 m2 each.
    const WktShapes halves = read_wkt("POLYGON ((0 0, 2 4, 2 0, 0 4, 0 0))", {.repair = true});
    ASSERT_EQ(halves.polygons.size(), std::size_t{2});
    for (const Polygon& half : halves.polygons) EXPECT_NEAR(area_of(half.outer), 2, 1e-12);
    // A ring is closed.
    const WktShapes closed = read_wkt("POLYGON ((0 0, 4 0, 4 4, 0 4))", {.repair = true});
    ASSERT_EQ(closed.polygons.size(), std::size_t{1});
    EXPECT_NEAR(area_of(closed.polygons[0].outer), 16, 1e-12);
    // A pillar that sticks out of the room is cut out of it.
    const WktShapes cut =
        read_wkt("POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (3 1, 5 1, 5 2, 3 2, 3 1))", {.repair = true});
    ASSERT_EQ(cut.polygons.size(), std::size_t{1});
    EXPECT_TRUE(cut.polygons[0].holes.empty());
    EXPECT_NEAR(area_of(cut.polygons[0].outer), 15, 1e-12);
    // A room that touches itself in a point has a hole that touches it: walls may.
    const WktShapes touching =
        read_wkt("POLYGON ((0 0, 4 0, 4 4, 0 4, 0 2, 2 1, 2 3, 0 2, 0 0))", {.repair = true});
    Scene scene;
    for (const Polygon& polygon : touching.polygons) add_polygon(scene, polygon);
    EXPECT_EQ(message_of("POLYGON ((0 0, 1 0", {.repair = true}),
              "WKT: a parenthesis that is not closed at character 9");
}

TEST(Wkt, IsReadOnSeveralThreadsAtOnce)
{
    std::vector<std::thread> threads;
    std::vector<int> right(4);
    for (int& count : right) {
        threads.emplace_back([&count] {
            for (int i = 0; i < 200; ++i) {
                count += read_wkt("LINESTRING (0 0, 1.25 2)").lines.at(0)[1].x == 1.25 ? 1 : 0;
                count += message_of("POLYGON ((0 0, 2 4, 2 0, 0 4, 0 0))").rfind("WKT: self", 0) == 0 ? 1 : 0;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(right, std::vector<int>(4, 400));
}

/// People who are thrown about in an L-shaped room stay in it and outside its pillar.
TEST(Wkt, OfARoomWithAPillarKeepsPeopleInIt)
{
    const WktShapes plan =
        read_wkt("POLYGON ((0 0, 12 0, 12 6, 6 6, 6 12, 0 12, 0 0), (2 2, 3.5 2, 4 3, 3 4, 2 3.5, 2 2))");
    Scene scene;
    add_polygon(scene, plan.polygons.at(0));
    const auto is_in_the_room = [](double x, double y) {
        const bool in_pillar = x > 2 && y > 2 && (y - 2) < 2 * (4 - x) + 1 && 2 * x - 7 < y - 2 &&
                               (y - 3) < -(x - 4) && y - 3.5 < (x - 2) / 2;
        return x > 0 && y > 0 && x < 12 && y < 12 && (x < 6 || y < 6) && !in_pillar;
    };
    testing::Random random(8);
    std::vector<BodyId> people;
    constexpr double radius = 0.15, spacing = 0.45;
    constexpr float speed = 5;  // m/s
    for (int i = 0; people.size() < 200; ++i) {
        const double x = spacing * (i % 26 + 0.6), y = spacing * (i / 26 + 0.6);
        ASSERT_LT(y, 12) << "no room";
        bool is_free = true;
        for (const double reach : {-radius, radius}) {
            is_free = is_free && is_in_the_room(x + reach, y) && is_in_the_room(x, y + reach) &&
                      is_in_the_room(x + reach, y + reach) && is_in_the_room(x + reach, y - reach);
        }
        if (!is_free) continue;
        BodyDefinition body;
        body.model = BodyModel::planar;
        body.mass = 80;
        body.inertia.zz = 1.6F;
        body.position = {x, y, 0};
        people.push_back(scene.add_body(body));
        scene.set_disc(people.back(), {.radius = static_cast<float>(radius)});
    }
    Solver solver;
    const auto push = [&] { return speed * static_cast<float>(random.symmetric()); };
    for (int step = 0; step < 300; ++step) {
        for (const BodyId person : people) {
            if (random.below(30) == 0) scene.set_velocity(person, {push(), push(), 0}, {});
        }
        ASSERT_EQ(solver.step(scene, 1.0F / 60).status, StepStatus::done);
        for (const BodyId person : people) {
            const Vec3<double> at = scene.state(person).position;
            ASSERT_TRUE(is_in_the_room(at.x, at.y)) << at.x << " " << at.y << " in step " << step;
        }
    }
    CrowdIndex index;
    index.build(scene);
    std::vector<BodyId> found;
    index.inside(plan.polygons[0], found);
    EXPECT_EQ(found.size(), people.size());
}

}  // namespace
}  // namespace motley
