// A scene under one way of solving, for the table of extremes.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "commands/extremes.h"
#include "scene/scene_core.h"

namespace motley::bench {

inline constexpr float frame = 1.0F / 60;
inline constexpr Vec3<float> gravity{0, -9.81F, 0};

inline double length(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// A scene under one way of solving, which remembers whether anything went wrong.
class Trial {
  public:
    Scene scene;

    explicit Trial(const ExtremeRun& run, Vec3<float> pull = gravity) : settings(settings_of(run.way))
    {
        settings.gravity = pull;
        options_ = run.options;
    }
    SolverSettings settings;

    BodyId box(Vec3<double> at, float mass = 1, Vec3<float> inertia_of_mass = {0.1F, 0.1F, 0.1F})
    {
        BodyDefinition body;
        body.position = at;
        body.mass = mass;
        body.inertia = {inertia_of_mass.x * mass, 0, 0,
                        inertia_of_mass.y * mass, 0, inertia_of_mass.z * mass};
        bodies_.push_back(scene.add_body(body));
        return bodies_.back();
    }
    /// `links` bodies of 0.5 m along `way`, and one of `load` kg at the end, from a static body at `origin`.
    void chain(int links, Vec3<double> way, float load, Vec3<double> origin = {})
    {
        BodyDefinition post;
        post.motion = BodyMotion::static_body;
        post.position = origin;
        BodyId before = scene.add_body(post);
        Vec3<float> hook{};
        for (int i = 0; i < links; ++i) {
            const bool last = i + 1 == links;
            const BodyId link = box(origin + (0.25 + 0.5 * i) * way, last ? load : 1, {0.02F, 0.02F, 0.02F});
            const Vec3<float> half = convert<float>(0.25 * way);
            scene.add_joint(BallSocketDefinition{before, link, hook, -half});
            hook = half;
            before = link;
        }
    }
    void step(float dt = frame, std::span<const Contact> contacts = {})
    {
        if (!solver_) solver_ = std::make_unique<Solver>(settings, options_);
        const StepReport report = solver_->step(scene, dt, contacts);
        went_wrong_ = went_wrong_ || report.status != StepStatus::done || report.bodies_contained > 0;
        for (const BodyId id : bodies_) {
            const BodyState s = scene.state(id);
            const Quat<double>& q = s.orientation;
            const double unit = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
            went_wrong_ = went_wrong_ || !std::isfinite(length(s.position)) || !(std::abs(unit - 1) < 1e-5);
        }
    }
    /// Largest rms separation of the joints over so many steps.
    double worst_separation(int steps, float dt = frame)
    {
        double worst = 0;
        for (int i = 0; i < steps; ++i) {
            step(dt);
            worst = std::max(worst, scene.errors().joint_separation_rms);
        }
        return figure(worst);
    }
    [[nodiscard]] double energy() const
    {
        double sum = scene.errors().kinetic_energy;
        const Vec3<double> pull = convert<double>(settings.gravity);
        for (const BodyId id : bodies_) {
            const auto inverse = core_of(scene).bodies.inverse_masses[id.slot];
            if (inverse > 0) sum -= dot(pull, scene.state(id).position) / static_cast<double>(inverse);
        }
        return sum;
    }
    /// The largest energy now or after any of so many steps; `dt(i)` is the length of step i.
    template <class Length>
    double peak_energy(int steps, const Length& dt)
    {
        double peak = energy();
        for (int i = 0; i < steps; ++i) {
            step(dt(i));
            peak = std::max(peak, energy());
        }
        return peak;
    }
    double peak_energy(int steps)
    {
        return peak_energy(steps, [](int) { return frame; });
    }
    [[nodiscard]] double figure(double value) const
    {
        return went_wrong_ || std::isnan(value) ? no_claim : value;
    }
    [[nodiscard]] std::span<const BodyId> bodies() const { return bodies_; }

  private:
    SolverOptions options_;
    std::unique_ptr<Solver> solver_;
    std::vector<BodyId> bodies_;
    bool went_wrong_ = false;
};

}  // namespace motley::bench
