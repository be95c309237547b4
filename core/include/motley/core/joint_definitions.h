// The definitions of all types of joints in constraint_types.h.
#pragma once

#include "motley/core/constraints/ball_socket_definition.h"
#include "motley/core/constraints/distance_definition.h"
#include "motley/core/constraints/drive_definition.h"
#include "motley/core/constraints/frame_joint_definition.h"
#include "motley/core/constraints/manifold_definition.h"
#include "motley/core/constraints/pulley_definition.h"
#include "motley/core/constraints/screw_definition.h"
#include "motley/core/constraints/servo_definition.h"
#include "motley/core/constraints/swing_limit_definition.h"
#include "motley/core/constraints/transmission_definition.h"
