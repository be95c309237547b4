// Two hundred and forty people leave a hall by two doors: what a host of a crowd has to write.
//
//   evacuation [PEOPLE]     prints who is inside, the flow through each door, and the highest pressure, every five seconds
#include <motley/motley.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace {

using motley::Vec2;
using motley::Vec3;

constexpr float dt = 1.0F / 60;
constexpr float radius = 0.2F, mass = 80, walking_speed = 1.3F, relaxation_time = 0.5F;  // m, kg, m/s, s

/// A hall of 16 by 12 m with a door of 1.2 m on the right and one of 1 m at the top left.
constexpr double width = 16, depth = 12;
struct Door {
    Vec2<double> middle;
    Vec2<double> out;  ///< unit, the way out
};
constexpr std::array<Door, 2> doors{{{{width, 6}, {1, 0}}, {{3, depth}, {0, 1}}}};

void add_hall(motley::Scene& scene)
{
    const std::vector<Vec2<double>> right_of_the_doors{{width, 6.6}, {width, depth}, {3.5, depth}};
    const std::vector<Vec2<double>> left_of_the_doors{
        {2.5, depth}, {0, depth}, {0, 0}, {width, 0}, {width, 5.4}};
    scene.add_wall({.points = right_of_the_doors});
    scene.add_wall({.points = left_of_the_doors});
}

/// Rows of people, half a metre apart, from the lower left of the hall on.
std::vector<motley::BodyId> add_people(motley::Scene& scene, int count)
{
    std::vector<motley::BodyId> people;
    for (int i = 0; i < count; ++i) {
        motley::BodyDefinition person;
        person.model = motley::BodyModel::planar;
        person.position = {2 + 0.5 * (i % 24), 1 + 0.5 * static_cast<double>(i / 24), 0};
        person.mass = mass;
        person.inertia.zz = 0.5F * mass * radius * radius;
        people.push_back(scene.add_body(person));
        scene.set_disc(people.back(), {.radius = radius});
    }
    return people;
}

double beyond(const Door& door, const Vec3<double>& place)
{
    return (place.x - door.middle.x) * door.out.x + (place.y - door.middle.y) * door.out.y;
}

/// The door that is nearest from where a person stands.
std::size_t nearest_door(const Vec3<double>& place)
{
    const auto distance = [&](const Door& door) {
        return std::hypot(place.x - door.middle.x, place.y - door.middle.y);
    };
    return distance(doors[0]) <= distance(doors[1]) ? 0 : 1;
}

/// The force that brings a person to walking speed towards a point 0.3 m behind the door, and straight on from there.
Vec3<float> steering(const Door& door, const Vec3<double>& place, const Vec3<float>& velocity)
{
    Vec2<double> way = door.out;
    if (beyond(door, place) < 0) {
        way = {door.middle.x + 0.3 * door.out.x - place.x, door.middle.y + 0.3 * door.out.y - place.y};
        const double length = std::hypot(way.x, way.y);
        way = {way.x / length, way.y / length};
    }
    constexpr float rate = mass / relaxation_time;
    return {rate * (walking_speed * static_cast<float>(way.x) - velocity.x),
            rate * (walking_speed * static_cast<float>(way.y) - velocity.y), 0};
}

}  // namespace

int main(int count, char** arguments)
{
    const int number = count > 1 ? std::atoi(arguments[1]) : 240;
    if (number < 1 || number > 480) {
        std::fprintf(stderr, "evacuation: PEOPLE is %s; expected 1 to 480\n", arguments[1]);
        return 2;
    }
    motley::Scene scene;
    add_hall(scene);
    const std::vector<motley::BodyId> people = add_people(scene, number);
    motley::Solver solver({}, {.threads = 2});

    std::vector<Vec3<double>> places(people.size());
    std::vector<Vec3<float>> velocities(people.size()), forces(people.size());
    std::vector<std::size_t> ways(people.size());
    std::vector<motley::BodyLoad> loads(people.size());
    const std::vector<float> circumferences(people.size(), 2 * std::numbers::pi_v<float> * radius);
    std::array<int, 2> out{};
    float highest = 0;
    std::printf("    s  inside  door 1  door 2  highest pressure (N/m)\n");
    scene.read_positions(people, places);
    std::transform(places.begin(), places.end(), ways.begin(), nearest_door);
    for (int step = 1; step <= 180 * 60; ++step) {
        scene.read_velocities(people, velocities);
        for (std::size_t i = 0; i < people.size(); ++i)
            forces[i] = steering(doors[ways[i]], places[i], velocities[i]);
        scene.set_forces(people, forces);
        const motley::StepReport report = solver.step(scene, dt);
        if (report.status != motley::StepStatus::done) {
            std::fprintf(stderr, "evacuation: %s\n", report.error.c_str());
            return 1;
        }
        scene.read_positions(people, places);
        scene.read_loads(people, {}, loads, circumferences);
        out = {};
        for (std::size_t i = 0; i < people.size(); ++i) {
            out[ways[i]] += beyond(doors[ways[i]], places[i]) > 0 ? 1 : 0;
            highest = std::max(highest, loads[i].pressure);
        }
        const int inside = number - out[0] - out[1];
        if (step % 300 == 0 || inside == 0) {
            std::printf("%5.1f  %6d  %6d  %6d  %.0f\n", step / 60.0, inside, out[0], out[1],
                        static_cast<double>(highest));
            highest = 0;
        }
        if (inside == 0) {
            const double seconds = step / 60.0;
            std::printf("all are out after %.1f s: %.2f people/s by door 1, %.2f by door 2; hash %016llx\n",
                        seconds, out[0] / seconds, out[1] / seconds,
                        static_cast<unsigned long long>(scene.state_hash()));
            return 0;
        }
    }
    std::fprintf(stderr, "evacuation: somebody is still inside after three minutes\n");
    return 1;
}
