// The headers that files of kernels include before they open their anonymous namespaces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <utility>

#ifndef MOTLEY_SCALAR_LANES
#include <xsimd/xsimd.hpp>
#endif

#include "figure.h"
#include "kernel_entries.h"
#include "motley/core/equality_row.h"
#include "motley/core/joint_pose.h"
#include "motley/core/joint_report.h"
#include "motley/core/lane_body.h"
#include "motley/core/lane_residual.h"
#include "motley/core/tension.h"
