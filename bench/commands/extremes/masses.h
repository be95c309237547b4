// Extremes: mass ratios.
#pragma once

#include <algorithm>
#include <cmath>

#include "commands/extremes/trial.h"

namespace motley::bench {

template <int exponent>
double light_tip(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(10, {0, -1, 0}, static_cast<float>(std::pow(10.0, -exponent)));
    trial.scene.set_velocity(trial.bodies()[4], {3, 0, 0}, {});
    return trial.worst_separation(300) / 0.5;
}
template <int exponent>
double hanging_load(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 16;
    trial.settings.joint_hertz = 1e6F;
    trial.chain(11, {0, -1, 0}, static_cast<float>(std::pow(10.0, exponent)));
    return trial.worst_separation(600) / 0.5;
}
inline double level_load(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 16;
    trial.settings.joint_hertz = 1e6F;
    trial.chain(11, {1, 0, 0}, 1000);
    return trial.worst_separation(600) / 0.5;
}
inline double long_chain(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(1000, {0, -1, 0}, 1);
    return trial.worst_separation(run.way == ExtremeWay::direct ? 3 : 120) / 0.5;
}

}  // namespace motley::bench
