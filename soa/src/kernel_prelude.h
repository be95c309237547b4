// What kernels_*.cpp need from outside, before they open their anonymous namespaces.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "block.h"
#include "motley/core/constraint_types.h"
#include "motley/core/joint_pose.h"
#include "motley/core/lane_body.h"
#include "motley/core/lane_residual.h"
#include "motley/core/rest.h"
