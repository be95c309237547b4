// People mixing in a full square: the scene that measures how fast a crowd is solved.
#include "scenes/crowd_square.h"

#include <cmath>
#include <numeric>

#include "crowd/random.h"

namespace motley::bench {
namespace {

constexpr double density = 5;         // persons / m2
constexpr double goal_distance = 1;   // m: a goal this near is reached

}  // namespace

CrowdSquare::CrowdSquare(const SceneOptions& options) : CrowdScene(options)
{
    const auto count = static_cast<std::size_t>(options.agents);
    side_ = std::sqrt(static_cast<double>(count) / density);
    const auto corners = rectangle({0, 0}, {side_, side_});
    walls_.add_room(corners);

    // A little denser than asked for, as rows seldom divide a side; row after row, so that neighbours in the
    // square are neighbours in memory.
    Random random(options.seed);
    const auto places = lattice({0.05, 0.05}, {side_ - 0.05, side_ - 0.05}, density * (1 + 1.2 / side_), count,
                                0.015, options.seed + 1);
    goals_reached_.resize(places.size());
    std::vector<Person> people(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        people[i].number = static_cast<int>(i + 1);
        people[i].position = places[i];
        people[i].goal = draw_goal(i);
        people[i].radius = static_cast<float>(0.20 * random.between(0.92, 1.08));
    }
    crowd_.add(scene_, people);
    start_search();
}

Vec2<double> CrowdSquare::draw_goal(std::size_t person) const
{
    // Drawn from who and how often, not from a shared stream: threads may ask in any order.
    const std::uint64_t draw =
        mix_bits(options_.seed ^ mix_bits(person)) + 2 * std::uint64_t{goals_reached_[person]};
    const double inside = side_ - 2 * goal_distance;
    return {goal_distance + inside * unit_interval(mix_bits(draw)),
            goal_distance + inside * unit_interval(mix_bits(draw + 1))};
}

void CrowdSquare::steer(Executor& executor)
{
    const SteeringSettings settings{.dt = options_.dt};
    parallel_for(executor, static_cast<std::int64_t>(crowd_.size()), people_per_chunk,
                 [&](std::int64_t begin, std::int64_t end) {
                     for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         const double x = crowd_.goals[i].x - crowd_.positions[i].x;
                         const double y = crowd_.goals[i].y - crowd_.positions[i].y;
                         if (x * x + y * y < goal_distance * goal_distance) {
                             ++goals_reached_[i];
                             crowd_.goals[i] = draw_goal(i);
                         }
                         crowd_.forces[i] =
                             drive_force(settings, crowd_.masses[i],
                                         direction_to(crowd_.goals[i], crowd_.positions[i]),
                                         crowd_.desired_speeds[i], crowd_.velocities[i]);
                     }
                 });
}

std::vector<Finding> CrowdSquare::findings() const
{
    double speed = 0;
    for (const Vec3<float>& v : crowd_.velocities) speed += std::sqrt(double(v.x) * double(v.x) + double(v.y) * double(v.y));
    const double reached = std::accumulate(goals_reached_.begin(), goals_reached_.end(), 0.0);
    return {{"density", static_cast<double>(crowd_.size()) / (side_ * side_), "persons/m2"},
            {"mean speed at the end", speed / static_cast<double>(crowd_.size()), "m/s"},
            {"goals reached", reached, ""}};
}

}  // namespace motley::bench
