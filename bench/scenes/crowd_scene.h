// The common part of all scenes of people: read, steer, search; a derived scene says who, where and whither.
#pragma once

#include <memory>

#include "crowd/contact_search.h"
#include "crowd/crowd.h"
#include "crowd/steering.h"
#include "scenes/bench_scene.h"

namespace motley::bench {

class CrowdScene : public BenchScene {
  public:
    std::span<const Contact> prepare_step(Executor& executor, HostSeconds& seconds) override;
    void observe_step(std::span<const Contact>, bool) override { ++steps_; }
    [[nodiscard]] Picture picture(std::span<const Contact> contacts) const override;
    [[nodiscard]] std::span<const int> numbers() const override { return crowd_.numbers; }
    [[nodiscard]] std::span<const Vec3<double>> positions() const override { return crowd_.positions; }
    [[nodiscard]] double nominal_radius() const override { return nominal_radius_; }
    [[nodiscard]] const Crowd& crowd() const { return crowd_; }

  protected:
    explicit CrowdScene(const SceneOptions& options) : options_(options) {}

    /// To be called by a derived constructor when walls_ and crowd_ are complete. The grid covers the walls.
    void start_search();
    /// Fills crowd_.forces from positions, velocities and goals.
    virtual void steer(Executor& executor) = 0;
    /// Seconds simulated at the end of the present step.
    [[nodiscard]] double time() const { return (steps_ + 1) * double(options_.dt); }

    SceneOptions options_;
    Walls walls_;
    Crowd crowd_;
    double nominal_radius_ = 0.20;      ///< m
    double pressure_full_scale_ = 1000;  ///< N/m, of pictures
    std::int64_t steps_ = 0;

  private:
    std::unique_ptr<ContactSearch> search_;
};

/// Corners of a rectangle, counterclockwise.
std::vector<Vec2<double>> rectangle(const Vec2<double>& low, const Vec2<double>& high);

/// Triangular lattice of `density` persons a square metre that fills a rectangle row by row, each point moved
/// by up to `jitter` m along both axes: at most `count` points.
std::vector<Vec2<double>> lattice(const Vec2<double>& low, const Vec2<double>& high, double density,
                                  std::size_t count, double jitter, std::uint64_t seed);

}  // namespace motley::bench
