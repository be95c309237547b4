// Extremes: inertia, spin, the length of a step, and distance from the origin.
#pragma once

#include <algorithm>
#include <cmath>

#include "commands/extremes/trial.h"
#include "scene/scene_core.h"
#include "stores/joint_store.h"

namespace motley::bench {

/// A body that spins at the end of a lever of 10 m.
inline double on_a_lever(const ExtremeRun& run, Vec3<float> inertia)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    const BodyId body = trial.box({10, 0, 0}, 1, inertia);
    trial.scene.add_joint(BallSocketDefinition{trial.scene.ground(), body, {}, {-10, 0, 0}});
    trial.scene.set_velocity(body, {}, {50, 0, 0});
    return trial.worst_separation(300) / 10;
}
inline double needle_on_a_lever(const ExtremeRun& run)
{
    return on_a_lever(run, {1e-4F, 1, 1});
}
inline double plate_on_a_lever(const ExtremeRun& run)
{
    return on_a_lever(run, {2e-4F, 1e-4F, 1e-4F});
}
/// The largest gain of energy of a free box with this spin in rad/s, in per cent.
inline double gain_of_spin(const ExtremeRun& run, const Vec3<float>& spin, int steps)
{
    Trial trial(run, {});
    trial.scene.set_velocity(trial.box({}, 1, {0.1F, 0.2F, 0.25F}), {}, spin);
    const double before = trial.energy();
    const double peak = trial.peak_energy(steps);
    return trial.figure(100 * (peak / before - 1));
}
inline double tumbling(const ExtremeRun& run)
{
    return gain_of_spin(run, {0.01F, 5, 0.01F}, 3600);
}
inline double fast_spin(const ExtremeRun& run)
{
    return gain_of_spin(run, {3e3F, 1e4F, 2e3F}, 600);
}
inline double coarse_steps(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(5, {1, 0, 0}, 1);
    const double before = trial.energy();
    const double peak = trial.peak_energy(100, [](int) { return 0.5F; });
    return trial.figure((peak - before) / (5 * 9.81 * 1.25));
}
inline double alternating_steps(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(5, {1, 0, 0}, 1);
    const double before = trial.energy();
    const double peak = trial.peak_energy(1200, [](int i) { return i % 2 == 0 ? 1.0F / 30 : 1.0F / 3000; });
    return trial.figure(100 * (peak - before) / (5 * 9.81 * 1.25));
}
inline double tiny_steps(const ExtremeRun& run)
{
    const auto end = [&](float dt, int steps) {
        Trial trial(run);
        trial.settings.substeps = 1;
        trial.chain(3, {1, 0, 0}, 1);
        for (int i = 0; i < steps; ++i) trial.step(dt);
        return trial.scene.state(trial.bodies().back()).position;
    };
    const Vec3<double> fine = end(1e-6F, 100000), usual = end(1e-3F, 100);
    const Vec3<double> start{1.25, 0, 0};
    return 100 * length(fine - usual) / length(usual - start);
}
inline double far_away(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(10, {1, 0, 0}, 1, {1e7, -1e7, 1e7});
    Trial home(run);
    home.chain(10, {1, 0, 0}, 1);
    return trial.worst_separation(300) - home.worst_separation(300);
}
inline double fast_travel(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(10, {1, 0, 0}, 1);
    // The whole chain and the post that it hangs on move at 10 km/s.
    Scene& scene = trial.scene;
    BodyDefinition post;
    post.motion = BodyMotion::kinematic_body;
    post.linear_velocity = {1e4F, 0, 0};
    const BodyId carrier = scene.add_body(post);
    for (const BodyId id : trial.bodies()) scene.set_velocity(id, {1e4F, 0, 0}, {});
    core_of(scene).joints->for_each([&](auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        if constexpr (std::is_same_v<typename Store::Type, BallSocket>) {
            const ConstraintId first{store.slots[0], core_of(scene).joints->slots[store.slots[0]].generation};
            const BallSocketDefinition hook = store.definitions[0];
            scene.remove_joint(first);
            scene.add_joint(BallSocketDefinition{carrier, hook.body_b, {}, hook.local_anchor_b});
        }
    });
    return trial.worst_separation(300);
}

}  // namespace motley::bench
