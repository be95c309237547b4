// What the questions of a crowd's host cost: who is near, who is inside, what walls hide.
// motley_benchmarks --benchmark_filter=query
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "worlds/random.h"

namespace motley::bench {
namespace {

/// People at 5 per m2 on a square, and a pillar of four pieces of wall for every hundred of them.
class Square {
  public:
    Scene scene;
    double side;  ///< m
    explicit Square(std::size_t people) : side(std::sqrt(static_cast<double>(people) / 5))
    {
        std::vector<BodyDefinition> bodies(people);
        for (BodyDefinition& body : bodies) {
            body.model = BodyModel::planar;
            const Vec2<double> at = place();
            body.position = {at.x, at.y, 0};
        }
        std::vector<BodyId> ids(people);
        scene.add_bodies(bodies, ids);
        const std::vector<DiscDefinition> discs(people);
        scene.set_discs(ids, std::span(discs));
        for (std::size_t i = 0; i < people / 100; ++i) {
            const Vec2<double> at = place();
            const Vec2<double> corners[] = {at, at + Vec2<double>{0.5, 0}, at + Vec2<double>{0.5, 0.5},
                                            at + Vec2<double>{0, 0.5}};
            scene.add_wall({.points = corners, .closed = true});
        }
    }
    Vec2<double> place() { return {side * random_.uniform(), side * random_.uniform()}; }

  private:
    Random random_{1};
};

/// Made once for each number of people.
Square& square_of(const benchmark::State& state)
{
    static std::map<std::int64_t, std::unique_ptr<Square>> squares;
    std::unique_ptr<Square>& square = squares[state.range(0)];
    if (!square) square = std::make_unique<Square>(static_cast<std::size_t>(state.range(0)));
    return *square;
}

void query_build_people(benchmark::State& state)
{
    const Square& square = square_of(state);
    CrowdIndex index;
    for (auto _ : state) index.build(square.scene);
}

void query_build_walls(benchmark::State& state)
{
    const Square& square = square_of(state);
    WallIndex index;
    for (auto _ : state) index.build(square.scene);
}

/// Calls ask(index, place, found), which returns the number of answers.
template <class Index, class Ask>
void ask_about_places(benchmark::State& state, const Ask& ask)
{
    Square& square = square_of(state);
    Index index;
    index.build(square.scene);
    std::vector<Vec2<double>> places(1024);
    for (Vec2<double>& place : places) place = square.place();
    std::size_t query = 0, answers = 0;
    for (auto _ : state) answers += ask(index, places[query++ % places.size()]);
    state.counters["answers"] = static_cast<double>(answers) / static_cast<double>(query);
}

void query_within_2_m(benchmark::State& state)
{
    std::vector<BodyId> found;
    ask_about_places<CrowdIndex>(state, [&](const CrowdIndex& index, const Vec2<double>& place) {
        index.centres_within(place, 2, found);
        return found.size();
    });
}

void query_nearest_8(benchmark::State& state)
{
    std::vector<NearPerson> found;
    ask_about_places<CrowdIndex>(state, [&](const CrowdIndex& index, const Vec2<double>& place) {
        index.nearest(place, 8, found);
        return found.size();
    });
}

/// A room of twenty corners, 10 m across.
void query_inside_a_room(benchmark::State& state)
{
    std::vector<BodyId> found;
    Polygon room;
    room.outer.resize(20);
    ask_about_places<CrowdIndex>(state, [&](const CrowdIndex& index, const Vec2<double>& place) {
        for (std::size_t i = 0; i < room.outer.size(); ++i) {
            const double angle = 0.314159 * static_cast<double>(i), radius = i % 2 == 0 ? 5 : 4;
            room.outer[i] = place + radius * Vec2<double>{std::cos(angle), std::sin(angle)};
        }
        index.inside(room, found);
        return found.size();
    });
}

void query_sight_of_20_m(benchmark::State& state)
{
    ask_about_places<WallIndex>(state, [&](const WallIndex& index, const Vec2<double>& place) {
        return index.first_hit(place, place + Vec2<double>{12, 16}).has_value() ? 1 : 0;
    });
}

BENCHMARK(query_build_people)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK(query_build_walls)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK(query_within_2_m)->Arg(100000)->Arg(1000000);
BENCHMARK(query_nearest_8)->Arg(100000)->Arg(1000000);
BENCHMARK(query_inside_a_room)->Arg(100000)->Arg(1000000);
BENCHMARK(query_sight_of_20_m)->Arg(100000)->Arg(1000000);

}  // namespace
}  // namespace motley::bench
