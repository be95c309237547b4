// Doors that close on people: a kinematic wall sweeps through a room at 0.5, 2 and 20 m/s and stops where everybody still
// has room; and one pushes somebody along at 1 m/s, and then squeezes him to less than a diameter.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/random.h"
#include "worlds/scenes/rows.h"

namespace motley::bench {

/// Contacts are inelastic, so a door gives nobody more than its own speed: in a step it can press no harder than if it
/// brought everybody in the room from rest to its speed in that step.
class DoorCloses final : public CrowdScene {
  public:
    static constexpr std::array<double, 4> speeds{0.5, 2, 20, 1};      ///< m/s; the last one squeezes
    static constexpr double depth = 10, height = 4;                    ///< m, of a room
    static constexpr double squeezed_to = 0.3;                         ///< m, of a diameter of 0.4
    static constexpr double pushing_force = 80 / 0.5 * speeds.back();  ///< N: m v / tau
    static constexpr double packed = 5.5;  ///< people per m2 once a door has stopped

    explicit DoorCloses(const RunOptions& options)
    {
        Random random(options.seed);
        const auto count = static_cast<std::size_t>(std::clamp<std::int64_t>(options.agents / 3, 1, 150));
        for (std::size_t k = 0; k < speeds.size(); ++k) {
            const double low = 6 * static_cast<double>(k), high = low + height;
            const bool squeezes = k + 1 == speeds.size();
            const double end = squeezes ? 2 : depth;
            const double stop =
                end - (squeezes ? squeezed_to : static_cast<double>(count) / (packed * height));
            rooms_[k].low = low;
            rooms_[k].end = end;
            rooms_[k].stop = stop;
            people.walls.insert(
                people.walls.end(),
                {{{-1, low}, {end, low}}, {{end, low}, {end, high}}, {{end, high}, {-1, high}}});
            rooms_[k].first = people.agents.size();
            rooms_[k].people = squeezes ? 1 : count;
            fill(rooms_[k], random);
        }
        people.relaxation_time = 0.5F;
        for (Agent& agent : people.agents) agent.desired_speed = 0;
        people.hand_over(scene);
        for (std::size_t k = 0; k < speeds.size(); ++k) {
            BodyDefinition body;
            body.motion = BodyMotion::kinematic_body;
            rooms_[k].door = scene.add_body(body);
            const Vec2<double> ends[] = {{0, rooms_[k].low}, {0, rooms_[k].low + height}};
            scene.add_wall({.points = ends, .body = rooms_[k].door});
        }
    }

    void steer(double, Executor& executor) override
    {
        people.observe(scene, executor);
        people.steer(scene, executor);
    }
    std::span<const Contact> find_contacts(Executor&) override
    {
        // The doors stop where they are to stop and not a step later.
        for (std::size_t k = 0; k < speeds.size(); ++k) {
            const double left = rooms_[k].stop - scene.state(rooms_[k].door).position.x;
            scene.set_velocity(rooms_[k].door,
                               {static_cast<float>(std::min(speeds[k], std::max(0.0, left / dt_))), 0, 0},
                               {});
        }
        return {};
    }
    void observe(double, const Solver&) override
    {
        dt_ = static_cast<double>(scene.last_step());
        std::array<double, speeds.size()> forces{};
        deepest_ = 0;
        for (const DiscContact& contact : scene.disc_contacts()) {
            const bool is_squeezed = contact.b == people.agents.back().body;
            if (!is_squeezed) deepest_ = std::max(deepest_, -static_cast<double>(contact.separation));
            for (std::size_t k = 0; k < speeds.size(); ++k) {
                if (contact.a == rooms_[k].door)
                    forces[k] += static_cast<double>(contact.normal_force * contact.normal.x);
            }
        }
        for (std::size_t k = 0; k < speeds.size(); ++k) {
            Room& room = rooms_[k];
            room.peak = std::max(room.peak, forces[k]);
            room.last = forces[k];
            const double door = scene.state(room.door).position.x;
            // The one in the last room wants to stand still, is pushed from 0.8 m on, and reaches the far wall at 1.6.
            if (k + 1 == speeds.size() && door > 1 && door < 1.5)
                push_off_.add(forces[k] / pushing_force - 1);
            for (std::size_t i = room.first; i < room.first + room.people; ++i) {
                const Vec3<double> p = scene.state(people.agents[i].body).position;
                if (p.x < door || p.x > room.end || p.y < room.low || p.y > room.low + height) ++breaches_;
            }
        }
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        std::vector<Figure> figures;
        for (std::size_t k = 0; k + 1 < speeds.size(); ++k) {
            figures.emplace_back(fmt::format("peak force of the door at {:g} m/s (N)", speeds[k]),
                                 rooms_[k].peak);
            figures.emplace_back(
                fmt::format("force that brings all from rest to {:g} m/s in a step (N)", speeds[k]),
                bound(k));
            figures.emplace_back(
                fmt::format("force of the door at {:g} m/s once it has stopped (N)", speeds[k]),
                rooms_[k].last);
        }
        figures.emplace_back("force on one who is squeezed from 0.4 to 0.3 m, peak (N)", rooms_.back().peak);
        figures.emplace_back("force on one who is held squeezed (N)", rooms_.back().last);
        return figures;
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        std::vector<Mark> marks{
            {"people through a wall or a door, summed over the steps", static_cast<double>(breaches_), 0},
            {"force on one pushed at 1 m/s off m v / tau, rms per step (share)", push_off_.root(), 0.01}};
        for (std::size_t k = 0; k + 1 < speeds.size(); ++k) {
            marks.push_back(
                {fmt::format("peak force at {:g} m/s (share of all from rest to that in a step)", speeds[k]),
                 rooms_[k].peak / bound(k), 1});
        }
        marks.push_back(
            {"overlap once the doors have stopped, deepest (share of radius)", deepest_ / 0.2, 0.01});
        return marks;
    }

  private:
    struct Room {
        BodyId door{};
        double low = 0, end = 0, stop = 0;  ///< m: lower y, x of the far wall, x at which the door stops
        std::size_t first = 0, people = 0;
        double peak = 0, last = 0;  ///< N
    };
    std::array<Room, speeds.size()> rooms_;
    MeanSquare push_off_;
    double dt_ = 1.0 / 60;
    double deepest_ = 0;  ///< m, in the last step
    std::int64_t breaches_ = 0;

    /// N: m v of everybody in the room, given in one step.
    [[nodiscard]] double bound(std::size_t k) const
    {
        return static_cast<double>(rooms_[k].people) * 80 * speeds[k] / dt_;
    }
    void fill(const Room& room, Random& random)
    {
        const auto columns =
            static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(room.people) * 2)));
        const std::size_t rows = (room.people + columns - 1) / columns;
        for (std::size_t i = 0; i < room.people; ++i) {
            Agent agent;
            const double x = (0.5 + static_cast<double>(i % columns)) / static_cast<double>(columns),
                         y = (0.5 + static_cast<double>(i / columns)) / static_cast<double>(rows);
            people.add(scene, agent,
                       {0.1 + (room.end - 0.2) * x + 0.03 * random.symmetric(),
                        room.low + height * y + 0.03 * random.symmetric()});
        }
    }
};

}  // namespace motley::bench
