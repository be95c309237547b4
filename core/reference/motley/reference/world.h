// The whole step in double, with explicit J and M^-1, one constraint after another in the order they are given:
// what the lanes must agree with up to the rounding of floats.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "motley/core/constraints/ball_socket_definition.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/constraints/distance_definition.h"
#include "motley/core/settings.h"
#include "motley/reference/constraints.h"

namespace motley::reference {

/// A joint between bodies of the world by index, of any kind.
struct Joint {
    enum class Kind { ball_socket, distance, frames, drive, swing_limit } kind = Kind::ball_socket;
    int a = 0, b = 0;
    Eigen::Vector3d local_a = Eigen::Vector3d::Zero(), local_b = Eigen::Vector3d::Zero();
    DistanceMode mode = DistanceMode::rod;
    double length = 1;                    ///< m; of a swing limit the largest angle, rad
    double hertz = 0, damping_ratio = 0;  ///< hertz > 0: a spring, also a drive's
    Frame frame_a{}, frame_b{};
    LinearLock linear = LinearLock::none;
    AngularLock angular = AngularLock::none;
    DriveAxis axis = DriveAxis::slide;
    double lower = 0, upper = 0, motor_speed = 0, motor_max_force = 0, spring_target = 0;
    Eigen::VectorXd impulse{};  ///< carried from step to step; of a drive: spring, motor, limit
};

/// A contact of one step between bodies by index.
struct ContactPoint {
    int a = 0, b = 0;
    Contact contact;  ///< the host's numbers; its handles are not read
};

class World {
  public:
    std::vector<Body> bodies;
    std::vector<Joint> joints;  ///< solved in this order, before the contacts

    /// One step. Contacts are solved in the order of the list.
    void step(double dt, const SolverSettings& settings, const std::vector<ContactPoint>& contacts);

    /// One substep solved simultaneously: every row at once, to a residual near the rounding of doubles, instead of one
    /// after another. What a sequential method converges to as its iterations grow: the truth for tests. Redundant rows
    /// share their impulse with the least norm. Contacts must be smooth. Returns the largest violation that is left of
    /// the equations and inequalities, m/s or rad/s.
    double step_directly(double dt, const SolverSettings& settings,
                         const std::vector<ContactPoint>& contacts);

  private:
    struct Soft {
        double rate, mass_scale, impulse_scale;
    };
    struct JointRow;
    struct ContactRow;
    struct Remembered {
        double normal = 0;
        Eigen::Vector3d friction = Eigen::Vector3d::Zero();
    };
    std::map<std::uint64_t, Remembered> memory_;
    double last_substep_ = 0;
    std::vector<Body> start_;  ///< the bodies when the step began

    static Soft softness(double hertz, double damping_ratio, double h);
    [[nodiscard]] bool is_planar_pair(int a, int b) const;
    void apply(int a, int b, const Jacobian& jacobian, const Eigen::VectorXd& impulse);
    [[nodiscard]] Eigen::VectorXd speed(int a, int b, const Jacobian& jacobian) const;

    [[nodiscard]] Jacobian jacobian_of(const Joint& joint) const;
    [[nodiscard]] Eigen::VectorXd error_of(const Joint& joint) const;
    JointRow begin_joint(Joint& joint, double h, const SolverSettings& settings);
    void solve_joint(JointRow& row, bool relax);
    void solve_drive(JointRow& row, bool relax);
    ContactRow begin_contact(const ContactPoint& point, double warm);
    void solve_contact(ContactRow& row, double h, const SolverSettings& settings, bool relax);
    [[nodiscard]] double separation(const ContactRow& row) const;
    void project(std::vector<ContactRow>& contacts, const SolverSettings& settings);
};

}  // namespace motley::reference
