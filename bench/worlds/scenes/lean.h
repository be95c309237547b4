// Rows of people who lean on each other, and the first of each on a wall.
#pragma once

#include "worlds/scenes/rows.h"

namespace motley::bench {

/// Rows of `length`, each disc leaning on the next with 50 N towards a wall: contact k from the back carries 50 k N.
template <int length>
class Lean final : public Rows {
  public:
    static constexpr double force = 50;  ///< N
    static constexpr double settle = 4;  ///< s until the load has run through a row and back

    explicit Lean(const RunOptions& options) : Rows(options.lists_contacts)
    {
        add_rows(options.agents, length, 0);
        add_wall();
        std::vector<Vec3<float>> forces(bodies_.size(), {-static_cast<float>(force), 0, 0});
        scene.set_forces(bodies_, forces);
    }

    void observe(double time, const Solver&) override
    {
        if (time < settle) return;
        read_forces(forces_);
        for (std::size_t i = 0; i < forces_.size(); ++i) {
            const auto place = static_cast<int>(i) % length;
            const double behind = length - place;
            off_.add((forces_[i] - behind * force) / (length * force));
            if (place == 0) wall_off_.add(forces_[i] / (length * force) - 1);
        }
        deepest_ = std::max(deepest_, deepest_overlap());
    }
    [[nodiscard]] std::optional<SceneError> error() const override
    {
        return SceneError{"force profile off kF, rms (share of nF)", off_.root()};
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        if (off_.is_empty()) return {};  // the run was shorter than the settling time
        return {{"force profile off kF, rms per step (share of nF)", off_.root(), 0.01},
                {"wall force off nF, rms per step (share)", wall_off_.root(), 0.01},
                {"overlap, deepest of all steps (share of radius)", deepest_ / radius, 0.01}};
    }

  private:
    MeanSquare off_, wall_off_;
    double deepest_ = 0;  ///< m
    std::vector<double> forces_;
};

}  // namespace motley::bench
