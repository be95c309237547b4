// A joint of the reference: what it wants, as blocks of rows over the velocities of its two bodies.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "motley/reference/constraints.h"

namespace motley::reference {

/// A few rows that share one impulse.
struct Block {
    enum class Kind {
        equality,  ///< C = 0; with a frequency of its own a spring
        limit,     ///< one row, side * lambda >= 0, and `error` is the room left: C >= 0
        contact,   ///< the same with the softness of contacts, and their slop
        motor      ///< J v = speed
    };
    Kind kind = Kind::equality;
    Jacobian jacobian{};
    Eigen::VectorXd error{};
    Eigen::VectorXd speed{};              ///< what J v shall be; empty is zero
    double side = 1;                      ///< of a limit: along the row, or against it
    double hertz = 0, damping_ratio = 0;  ///< of a spring, on the block's own effective mass
    double stiffness = 0, damping = 0;    ///< of a spring of one row, N/m and N s/m or the same of turning
    double most = std::numeric_limits<double>::infinity();  ///< largest norm of the force, N or N m...
    bool bounds_torque = false;                             ///< ...or of the torque that comes of it
    /// m or 1, of a motor, >= 0: the bound is this times the sum of the joint's contacts instead.
    double most_per_contact = -1;
    double restitution = 0;  ///< of a contact
    double armature = 0;     ///< of a rotor that goes along with the block's one row, kg or kg m2

    [[nodiscard]] bool is_spring() const { return hertz > 0 || stiffness > 0 || damping > 0; }
    [[nodiscard]] bool is_one_sided() const { return kind == Kind::limit || kind == Kind::contact; }
};

/// A type of joint with its numbers. `in_plane`: the pair cannot leave the plane, and rows across it are left out.
class JointModel {
  public:
    virtual ~JointModel() = default;
    /// Always as many blocks, of as many rows, in the order in which they are solved. `travelled` is the C that the
    /// joint has piled up, for those that have no C of the poses alone.
    [[nodiscard]] virtual std::vector<Block> blocks(const Body& a, const Body& b, bool in_plane,
                                                    double travelled) const = 0;
    /// Its impulses on the two bodies do not cancel, as if the world pushed: pulleys and racks keep no momentum.
    [[nodiscard]] virtual bool acts_from_world() const { return false; }
    /// Rows stay as they were when the step began, and C follows by them: contacts, whose arms do not turn with a ball.
    [[nodiscard]] virtual bool keeps_rows_of_start() const { return false; }
    /// By how much C has grown between two poses of the bodies, for those that pile it up.
    [[nodiscard]] virtual double travel(const Body& /*start_a*/, const Body& /*start_b*/, const Body& /*a*/,
                                        const Body& /*b*/) const
    {
        return 0;
    }

    /// What a joint remembers in lanes, in the order of its type's Memory: of most the impulses in line.
    [[nodiscard]] virtual std::vector<double> memory(const std::vector<Eigen::VectorXd>& impulses,
                                                     double travelled) const;
    /// The impulses again, from there, as far as they say; `impulses` has the sizes of the blocks.
    virtual void recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const;
    /// What has piled up, from there.
    [[nodiscard]] virtual double travelled_in(const float* /*memory*/) const { return 0; }
};

/// A joint between bodies of the world by index.
struct Joint {
    int a = 0, b = 0;
    std::shared_ptr<const JointModel> model{};
    std::vector<Eigen::VectorXd> impulses{};  ///< of each block, carried from step to step
    double travelled = 0;
    double rotor_speed = 0;           ///< J v of what has an armature, as the last solve left it
    std::span<const float> memory{};  ///< where impulses are recalled from while there are none
    /// What the last step did to b, N s where the rows act and N m s beside it.
    Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
    std::vector<double> approaches{},
        peaks{};  ///< of a step: J v when it began, and the largest impulse, of each block
};

}  // namespace motley::reference
