// N people who follow flow fields among pillars: the crowd whose cost is measured from a thousand to a million. The square
// is tiled with blocks of four kinds, and everybody walks to the nearest block of the kind that is next, so that the
// density stays about the same everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "worlds/bench_scene.h"
#include "worlds/flow_field.h"
#include "worlds/random.h"

namespace motley::bench {

class Flow final : public CrowdScene {
  public:
    static constexpr double default_density = 5;  ///< people per m2

    explicit Flow(const RunOptions& options) : random_(options.seed)
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        const double density = options.density > 0 ? options.density : default_density;
        const auto count = static_cast<std::size_t>(options.agents);
        side_ = std::max(2 * tile,
                         static_cast<int>(std::lround(std::sqrt(static_cast<double>(count) / density))));
        add_walls();
        place_people(count);
        make_fields();
        people.steering = make_steering(options.steering);
        share_out_contacts(options);
    }

    void steer(double, Executor& executor) override
    {
        people.observe(scene, executor);
        constexpr std::int64_t a_chunk = 1024;
        parallel_for(executor, static_cast<std::int64_t>(people.agents.size()), a_chunk,
                     [&](std::int64_t begin, std::int64_t end) {
                         for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                              ++i)
                             follow_field(i);
                     });
        people.steer(scene, executor);
    }

    void observe(double, const Solver&) override
    {
        for (const Vec3<double>& at : people.positions) {
            const bool is_inside = at.x > 0 && at.y > 0 && at.x < side_ && at.y < side_;
            if (!is_inside || cell_at({at.x, at.y}) == FlowField::Cell::closed) ++strays_;
        }
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        double speed = 0;
        for (const Vec3<float>& v : people.velocities) speed += std::hypot(v.x, v.y);
        return {{"speed, mean (m/s)",
                 speed / static_cast<double>(std::max<std::size_t>(1, people.agents.size()))}};
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        return {{"people through a wall, summed over the steps", static_cast<double>(strays_), 0}};
    }

  private:
    static constexpr int tile = 7;  ///< m: the side of a block; one of four has a pillar of a square metre
    static constexpr int kinds = 4;
    Random random_;
    int side_ = 0;                    ///< m
    std::vector<FlowField> fields_;   ///< by kind of block
    std::vector<std::uint8_t> next_;  ///< by person: the kind of block that is next
    std::int64_t strays_ = 0;

    static int kind_at(int x, int y) { return x / tile % 2 + 2 * (y / tile % 2); }
    static bool is_pillar(int x, int y) { return x % (2 * tile) == tile / 2 && y % (2 * tile) == tile / 2; }
    static FlowField::Cell cell_at(const Vec2<double>& at)
    {
        return is_pillar(static_cast<int>(at.x), static_cast<int>(at.y)) ? FlowField::Cell::closed
                                                                         : FlowField::Cell::open;
    }

    void add_walls()
    {
        const auto add_square = [&](double x, double y, double size) {
            const Vec2<double> corners[] = {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
            for (std::size_t i = 0; i < 4; ++i) people.walls.push_back({corners[i], corners[(i + 1) % 4]});
        };
        add_square(0, 0, side_);
        for (int y = tile / 2; y + 1 < side_; y += 2 * tile) {
            for (int x = tile / 2; x + 1 < side_; x += 2 * tile) add_square(x, y, 1);
        }
    }

    /// On a square lattice, those of it that are in no pillar.
    void place_people(std::size_t count)
    {
        constexpr double clear = 0.25;  // m, from walls
        const auto is_free = [&](double x, double y) {
            for (const double dx : {-clear, clear}) {
                for (const double dy : {-clear, clear}) {
                    if (x + dx < 0 || y + dy < 0 || x + dx > side_ || y + dy > side_ ||
                        cell_at({x + dx, y + dy}) == FlowField::Cell::closed)
                        return false;
                }
            }
            return true;
        };
        auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
        std::vector<Vec2<double>> places;
        for (; places.size() < count; ++columns) {
            places.clear();
            const double pitch = side_ / static_cast<double>(columns);
            for (std::size_t i = 0; i < columns * columns; ++i) {
                const double x = pitch * (0.5 + static_cast<double>(i % columns)),
                             y = pitch * (0.5 + static_cast<double>(i / columns));
                if (is_free(x, y)) places.push_back({x, y});
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            Agent agent;
            // Radius 0.20 m +- 8 %, as in a crowd of men and women.
            agent.radius = static_cast<float>(0.20 * (1 + 0.08 * random_.symmetric()));
            const Vec2<double> at = places[i * places.size() / count];
            people.add(scene, agent, {at.x + 0.01 * random_.symmetric(), at.y + 0.01 * random_.symmetric()});
            next_.push_back(static_cast<std::uint8_t>(random_.uniform() * kinds));
        }
    }

    void make_fields()
    {
        for (int kind = 0; kind < kinds; ++kind) {
            std::vector<FlowField::Cell> cells;
            for (int y = 0; y < side_; ++y) {
                for (int x = 0; x < side_; ++x)
                    cells.push_back(is_pillar(x, y)         ? FlowField::Cell::closed
                                    : kind_at(x, y) == kind ? FlowField::Cell::goal
                                                            : FlowField::Cell::open);
            }
            fields_.emplace_back(side_, cells);
        }
    }

    /// Who has come to a block turns to the next kind, or the one after it, by the number of the person.
    void follow_field(std::size_t i)
    {
        const Vec2<double> at{people.positions[i].x, people.positions[i].y};
        if (fields_[next_[i]].distance(at) == 0)
            next_[i] = static_cast<std::uint8_t>((next_[i] + 1 + people.number_of(i) % 3) % kinds);
        const Vec2<float> direction = fields_[next_[i]].direction(at);
        people.agents[i].goal = {at.x + static_cast<double>(direction.x),
                                 at.y + static_cast<double>(direction.y)};
    }
};

}  // namespace motley::bench
