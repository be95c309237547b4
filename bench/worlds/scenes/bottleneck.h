// A real experiment: 75 people pass a 0.5 m door (bench/data/README.md). The walls are the same; everyone enters
// where and when the recording first has them, and walks to the door. The flow tests the steering, not the solver: it
// is printed with the measured flow, and nothing is judged by it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "worlds/bench_scene.h"
#include "worlds/neighbours.h"
#include "worlds/scenes/door_count.h"
#include "worlds/trajectories.h"

namespace motley::bench {

class Bottleneck final : public CrowdScene {
  public:
    static constexpr double measured_flow = 1.15;  ///< persons a second
    static constexpr float free_speed = 1.34F;     ///< m/s
    static constexpr float yielding_speed = 0.3F;  ///< m/s, of people who touch somebody in front

    explicit Bottleneck(const RunOptions& options)
    {
        people.friction = options.friction < 0 ? 0.0F : options.friction;
        const Trajectories recording =
            read_trajectories(options.data.empty() ? MOTLEY_BENCH_DATA "/040_c_56_h-.txt" : options.data);
        std::map<std::int64_t, TrajectoryPoint> first;
        for (const TrajectoryPoint& point : recording.points) {
            const auto [entry, added] = first.emplace(point.id, point);
            if (!added && point.frame < entry->second.frame) entry->second = point;
        }
        for (const auto& [id, point] : first) {
            arrivals_.push_back(
                {static_cast<double>(point.frame) / recording.frames_a_second, {point.x, point.y}});
        }
        std::stable_sort(arrivals_.begin(), arrivals_.end(),
                         [](const Arrival& a, const Arrival& b) { return a.time < b.time; });
        const Vec2<double> outline[] = {{-0.7, -1.1}, {-0.25, -1.1}, {-0.25, -0.15}, {-0.4, 0},   {-2.8, 0},
                                        {-2.8, 6.7},  {-3.05, 6.7},  {-3.05, -0.3},  {-0.7, -0.3}};
        for (const double side : {1.0, -1.0}) {
            for (std::size_t i = 0; i < std::size(outline); ++i) {
                const Vec2<double>& from = outline[i];
                const Vec2<double>& to = outline[(i + 1) % std::size(outline)];
                people.walls.push_back({{side * from.x, from.y}, {side * to.x, to.y}});
            }
        }
        share_out_contacts(options);
    }

    void steer(double time, Executor& executor) override
    {
        enter(time);
        people.observe(scene, executor);
        leave(time);
        people.observe(scene, executor);
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            const Vec3<double>& p = people.positions[i];
            // People walk to the nearest point of the opening that their disc fits through, then straight on.
            const double half = 0.25 - static_cast<double>(people.agents[i].radius);
            people.agents[i].goal =
                p.y > 0.2 ? Vec2<double>{std::clamp(p.x, -half, half), 0.0} : Vec2<double>{0, -3};
            people.agents[i].desired_speed = free_speed;
        }
        // People who touch somebody nearer to the door slow down. Otherwise frictionless discs form an arch in the
        // door and stay there.
        neighbours_.find(people, people.contact_margin, executor);
        for (std::size_t i = 0; i < people.agents.size(); ++i) {
            for (const std::int32_t other : neighbours_.of(i)) {
                if (to_door(static_cast<std::size_t>(other)) < to_door(i))
                    people.agents[i].desired_speed = yielding_speed;
            }
        }
        people.steer(scene, executor);
    }

    [[nodiscard]] bool is_over(double) const override
    {
        return next_ == arrivals_.size() && people.agents.empty();
    }

    [[nodiscard]] std::vector<Figure> figures() const override
    {
        return {{"people through the door", static_cast<double>(count_.passed())},
                {"people of the experiment", static_cast<double>(arrivals_.size())},
                {"flow (persons/s)", count_.flow()},
                {"flow of the experiment (persons/s)", measured_flow},
                {"clogs: nobody for more than 1 s", static_cast<double>(count_.clogs())},
                {"overlap, deepest of all steps (% of radius)", 100 * deepest_ / 0.18}};
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        return {{"people who came out of the room elsewhere than by the door", static_cast<double>(breaches_),
                 0}};
    }
    void observe(double, const Solver&) override
    {
        for (const Touch& touch : people.touches(scene)) deepest_ = std::max(deepest_, -touch.separation);
    }

  private:
    struct Arrival {
        double time;
        Vec2<double> at;
    };
    std::vector<Arrival> arrivals_;
    std::size_t next_ = 0;
    DoorCount count_;
    int breaches_ = 0;
    double deepest_ = 0;                 ///< m
    std::vector<double> height_before_;  ///< the least y of each agent so far
    Neighbours neighbours_;

    [[nodiscard]] double to_door(std::size_t i) const
    {
        const Vec3<double>& p = people.positions[i];
        return p.y < 0 ? p.y : std::sqrt(p.x * p.x + p.y * p.y);
    }

    void enter(double time)
    {
        for (; next_ < arrivals_.size() && arrivals_[next_].time <= time; ++next_) {
            Agent agent;
            agent.radius = 0.18F;  // same area as the mean man of ANSUR II
            people.add(scene, agent, arrivals_[next_].at);
            height_before_.push_back(arrivals_[next_].at.y);
        }
    }

    void leave(double time)
    {
        for (std::size_t i = people.agents.size(); i-- > 0;) {
            const double y = people.positions[i].y;
            if (height_before_[i] > 0 && y <= 0) {
                count_.pass(time);
                if (std::abs(people.positions[i].x) > 0.4) ++breaches_;
            }
            height_before_[i] = std::min(height_before_[i], y);  // somebody pushed back is not counted twice
            if (y > -2) continue;
            people.remove(scene, i);
            height_before_[i] = height_before_.back();
            height_before_.pop_back();
        }
    }
};

}  // namespace motley::bench
