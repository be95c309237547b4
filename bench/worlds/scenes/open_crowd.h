// N people, 5 per m2 unless the options say otherwise, in a walled square, each with a goal some metres away, and a new goal when it is reached.
#pragma once

#include "worlds/bench_scene.h"
#include "worlds/scenes/open_crowd_people.h"

namespace motley::bench {

class OpenCrowd final : public CrowdScene {
  public:
    explicit OpenCrowd(const RunOptions& options) : who_(options)
    {
        people.friction = who_.friction;
        for (std::size_t i = 0; i < who_.count; ++i) people.add(scene, who_.person(i), who_.start_of(i));
        for (const Wall& wall : who_.walls()) people.walls.push_back(wall);
        people.steering = make_steering(options.steering);
        share_out_contacts(options);
    }

    void steer(double time, Executor& executor) override
    {
        CrowdScene::steer(time, executor);
        for (std::size_t i = OpenCrowdPeople::first_to_look(step_); i < people.agents.size();
             i += OpenCrowdPeople::one_in) {
            if (OpenCrowdPeople::has_reached(people.agents[i].goal, people.positions[i]))
                people.agents[i].goal = who_.next_goal(i, people.positions[i], step_);
        }
        ++step_;
    }

  private:
    OpenCrowdPeople who_;
    std::int64_t step_ = 0;
};

}  // namespace motley::bench
