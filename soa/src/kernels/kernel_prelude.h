// The headers that files of kernels include before they open their anonymous namespaces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <utility>

#ifndef MOTLEY_SCALAR_LANES
#include <xsimd/xsimd.hpp>
#endif

#include "figures/figure.h"
#include "kernels/kernel_entries.h"
#include "kernels/prefetch.h"
#include "maths/any_body.h"
#include "maths/bounded_impulse.h"
#include "maths/equality_row.h"
#include "maths/lane_body.h"
#include "maths/lane_residual.h"
#include "maths/tension.h"
#include "maths/turned_inertia.h"
#include "motley/core/joint_report.h"
#include "scene/joint_pose.h"
