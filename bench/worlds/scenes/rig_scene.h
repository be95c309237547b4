// A rig as a scene of the program: joints and boxes, no people.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "engines/engine.h"
#include "worlds/bench_scene.h"
#include "worlds/box_contacts.h"

namespace motley::bench {

class RigScene final : public BenchScene {
  public:
    RigScene(const RigEntry& entry, const RunOptions& options)
        : entry_(entry),
          rig_(entry.make(options.agents, options.seed)),
          bodies_(add_rig(scene, rig_)),
          poses_(rig_.bodies.size())
    {
        if (rig_.collides) boxes_ = std::make_unique<BoxContacts>(rig_, bodies_);
    }
    void adjust(SolverSettings& settings) const override { settings.gravity = rig_gravity; }
    void steer(double, Executor&) override {}
    std::span<const Contact> find_contacts(Executor&) override
    {
        if (!boxes_) return {};
        read_poses();
        return boxes_->find(poses_, scene.ground());
    }
    void observe(double time, const Solver&) override { time_ = time; }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        if (!rig_.truth) return {};
        read_poses();
        return {{std::string("at the end: ") + entry_.error_name, rig_.truth(poses_, time_ + 1.0 / 60)}};
    }

  private:
    const RigEntry& entry_;
    Rig rig_;
    std::vector<BodyId> bodies_;
    mutable std::vector<RigPose> poses_;
    std::unique_ptr<BoxContacts> boxes_;
    double time_ = 0;

    void read_poses() const
    {
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const BodyState state = scene.state(bodies_[i]);
            poses_[i] = {state.position, state.orientation};
        }
    }
};

}  // namespace motley::bench
