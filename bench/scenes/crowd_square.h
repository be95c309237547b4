// `crowd`: N people at 5 a square metre in a walled square, each walking from one random goal to the next.
#pragma once

#include "scenes/crowd_scene.h"

namespace motley::bench {

class CrowdSquare final : public CrowdScene {
  public:
    explicit CrowdSquare(const SceneOptions& options);
    [[nodiscard]] std::vector<Finding> findings() const override;

  protected:
    void steer(Executor& executor) override;

  private:
    double side_ = 0;  ///< m
    std::vector<std::uint32_t> goals_reached_;
    [[nodiscard]] Vec2<double> draw_goal(std::size_t person) const;
};

}  // namespace motley::bench
