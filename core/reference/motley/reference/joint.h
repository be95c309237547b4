// A joint of the reference: blocks of rows over the velocities of its two bodies.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "motley/reference/constraints.h"

namespace motley::reference {

/// Rows of one kind that are solved together.
struct Block {
    /// From the centres of a and b to the point where the impulses of linear rows act, m, world.
    struct Point {
        Eigen::Vector3d arm_a, arm_b;
    };
    /// The line between two points, along which the one row of a block acts: arms to its ends, and from one to the other, m.
    struct Line {
        Eigen::Vector3d arm_a, arm_b, between;
    };
    enum class Kind {
        equality,  ///< C = 0; with a frequency, stiffness or damping a spring
        limit,     ///< one row: C >= 0 with side * lambda >= 0; `error` is C, the room that is left
        contact,   ///< the same with the softness and the slop of contacts
        motor      ///< J v = speed
    };
    Kind kind = Kind::equality;
    Jacobian jacobian{};
    Eigen::VectorXd error{};
    Eigen::VectorXd speed{};              ///< target of J v, m/s or rad/s; empty: zero
    double side = 1;                      ///< of a limit: 1 if its impulse is along the row, -1 if against it
    double hertz = 0, damping_ratio = 0;  ///< of a spring, on the block's own effective mass
    double stiffness = 0, damping = 0;    ///< of a spring of one row, N/m and N s/m, or N m/rad and N m s/rad
    double most = std::numeric_limits<double>::infinity();  ///< largest norm of the force, N or N m
    bool bounds_torque = false;  ///< `most` bounds the torque that the rows make, not lambda
    /// Of a motor, m or 1; if >= 0, the bound is this times the sum of the impulses of the joint's contacts.
    double most_per_contact = -1;
    double restitution = 0;  ///< of a contact
    double armature = 0;     ///< kg or kg m2: inertia of a rotor that is geared to the block's one row
    /// Of locks of a point, and of rows along a line: bodies carry them along before relaxation.
    std::optional<Point> point{};
    std::optional<Line> line{};

    [[nodiscard]] bool is_spring() const { return hertz > 0 || stiffness > 0 || damping > 0; }
    [[nodiscard]] bool is_one_sided() const { return kind == Kind::limit || kind == Kind::contact; }
};

struct Joint;

/// The constraints of a joint with the numbers of its definition. `in_plane`: the pair cannot leave the plane, and rows
/// perpendicular to it are left out.
class JointModel {
  public:
    virtual ~JointModel() = default;
    /// The blocks in the order in which they are solved. Their number and their numbers of rows never change.
    /// `travelled` is the accumulated C, for joints whose C is no function of the poses.
    [[nodiscard]] virtual std::vector<Block> blocks(const Body& a, const Body& b, bool in_plane,
                                                    double travelled) const = 0;
    /// Whether its impulses on the two bodies do not cancel, as if the world pushed: pulleys and racks do not keep
    /// momentum.
    [[nodiscard]] virtual bool acts_from_world() const { return false; }
    /// Whether rows stay as they were when the step began, and C follows from them: contacts, whose arms do not turn
    /// with a ball.
    [[nodiscard]] virtual bool keeps_rows_of_start() const { return false; }
    /// By how much C has changed between two poses of the bodies, for joints that accumulate it.
    [[nodiscard]] virtual double travel(const Body& /*start_a*/, const Body& /*start_b*/, const Body& /*a*/,
                                        const Body& /*b*/) const
    {
        return 0;
    }

    /// The Memory of the joint's type, number by number. By default the impulses one after another.
    [[nodiscard]] virtual std::vector<double> memory(const Joint& joint) const;
    /// Reads the impulses from such a memory; `impulses` has the sizes of the blocks. Numbers that it lacks are zero.
    virtual void recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const;
    /// Reads the accumulated C from such a memory.
    [[nodiscard]] virtual double travelled_in(const float* /*memory*/) const { return 0; }
    /// Reads Joint::rotor_lag and Joint::rotor_change from such a memory.
    [[nodiscard]] virtual double rotor_lag_in(const float* /*memory*/) const { return 0; }
    [[nodiscard]] virtual double rotor_change_in(const float* /*memory*/) const { return 0; }
};

/// A joint between bodies of the world by index.
struct Joint {
    int a = 0, b = 0;
    std::shared_ptr<const JointModel> model{};
    std::vector<Eigen::VectorXd> impulses{};  ///< of each block, carried from step to step
    double travelled = 0;
    double rotor_speed = 0;           ///< J v of the blocks with an armature, as the last solve left it
    double rotor_change = 0;          ///< what the present substep added to it, or the last one
    double rotor_start = 0;           ///< what it was when the substep began
    double rotor_lag = 0;             ///< by how much J v was above it when the last step ended
    std::span<const float> memory{};  ///< where impulses are read from while `impulses` is empty
    /// The impulse on b in the last step: N s at the point where the rows act, then N m s.
    Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
    std::vector<double> approaches{},
        peaks{};  ///< of each block in the step: J v when it began, and its largest impulse
};

}  // namespace motley::reference
