// Reports on joints and contacts of the C interface beside those of C++.
#pragma once

#include "handles.h"
#include "motley/c/joints.h"
#include "motley/core/joint_report.h"

namespace motley::c {

static_assert(static_cast<int>(JointState::inactive) == MOTLEY_JOINT_INACTIVE);
static_assert(static_cast<int>(JointState::active) == MOTLEY_JOINT_ACTIVE);
static_assert(static_cast<int>(JointState::lower) == MOTLEY_JOINT_LOWER);
static_assert(static_cast<int>(JointState::upper) == MOTLEY_JOINT_UPPER);

template <>
struct Mirror<motley_joint_report, JointReport> : Pair<motley_joint_report, JointReport> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(force), MOTLEY_FIELD(torque), MOTLEY_FIELD(error),
                                              MOTLEY_FIELD(angle_error), MOTLEY_FIELD(state));
};
template <>
struct Mirror<motley_break_event, BreakEvent> : Pair<motley_break_event, BreakEvent> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(joint), MOTLEY_FIELD(force), MOTLEY_FIELD(torque));
};

}  // namespace motley::c
