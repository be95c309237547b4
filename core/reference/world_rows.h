// The rows of a substep, shared by the sequential and the simultaneous solution.
#pragma once

#include "motley/reference/world.h"

namespace motley::reference {

struct World::JointRow {
    Joint* joint;
    Jacobian jacobian;
    Eigen::MatrixXd mass;
    Eigen::VectorXd bias, relax_bias;
    Soft soft, relax_soft;
    double upper;                                 ///< largest impulse: 0 of a rope
    double value = 0, h = 0, push_out_speed = 0;  ///< of a drive
    Soft limit_soft{};
};

struct World::ContactRow {
    const ContactPoint* point;
    Jacobian normal, tangents;
    double normal_mass;
    Eigen::MatrixXd tangent_mass;
    double approach;
    double impulse, peak = 0;
    Eigen::VectorXd friction;
};

}  // namespace motley::reference
