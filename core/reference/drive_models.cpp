// Drives, swing limits and servos: see joint_models.cpp.
#include "model_parts.h"

namespace motley::reference {
namespace {

class DriveModel : public JointModel {
  public:
    DriveModel(const SlideDriveDefinition& drive, DriveAxis axis)
        : drive_(drive), frame_a_(eigen(drive.frame_a)), frame_b_(eigen(drive.frame_b)), axis_(axis)
    {
    }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool, double) const override
    {
        const Jacobian jacobian = drive_jacobian(a, b, frame_a_, frame_b_, axis_, drive_.angle);
        const double value = drive_value(a, b, frame_a_, frame_b_, axis_, drive_.angle);
        std::vector<Block> blocks;
        if (drive_.has_spring()) {
            blocks.push_back({.jacobian = jacobian,
                              .error = scalar(value - static_cast<double>(drive_.spring_target)),
                              .hertz = drive_.spring_hertz,
                              .damping_ratio = drive_.spring_damping_ratio,
                              .stiffness = drive_.spring_stiffness,
                              .damping = drive_.spring_damping,
                              .most = drive_.spring_max_force});
        }
        blocks.push_back({.kind = Block::Kind::motor,
                          .jacobian = jacobian,
                          .error = scalar(0),
                          .speed = scalar(drive_.motor_speed),
                          .most = drive_.motor_max_force});
        blocks.push_back(limit_block(jacobian, value, drive_.lower, drive_.upper));
        for (Block& block : blocks) block.armature = drive_.armature;
        return blocks;
    }

    [[nodiscard]] std::vector<double> memory(const Joint& joint) const override
    {
        const std::vector<Eigen::VectorXd>& impulses = joint.impulses;
        const std::size_t motor = impulses.size() - 2;
        return {impulses[motor](0), motor > 0 ? impulses[0](0) : 0, impulses[motor + 1](0), joint.rotor_lag,
                joint.rotor_change};
    }
    [[nodiscard]] double rotor_lag_in(const float* memory) const override
    {
        return static_cast<double>(memory[3]);
    }
    [[nodiscard]] double rotor_change_in(const float* memory) const override
    {
        return static_cast<double>(memory[4]);
    }
    void recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const override
    {
        const std::size_t motor = impulses.size() - 2;
        impulses[0](0) = static_cast<double>(memory[1]);
        impulses[motor](0) = static_cast<double>(memory[0]);
        impulses[motor + 1](0) = static_cast<double>(memory[2]);
    }

  private:
    SlideDriveDefinition drive_;
    Frame frame_a_, frame_b_;
    DriveAxis axis_;
};

class SwingLimitModel : public JointModel {
  public:
    explicit SwingLimitModel(const SwingLimitDefinition& limit)
        : frame_a_(eigen(limit.frame_a)), frame_b_(eigen(limit.frame_b)), max_angle_(limit.max_angle)
    {
    }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool, double) const override
    {
        return {{.kind = Block::Kind::limit,
                 .jacobian = swing_jacobian(a, b, frame_a_, frame_b_),
                 .error = scalar(max_angle_ - swing_angle(a, b, frame_a_, frame_b_)),
                 .side = -1}};
    }

    [[nodiscard]] std::vector<double> memory(const Joint& joint) const override
    {
        return {-joint.impulses[0](0)};  // the lanes' limit is positive
    }
    void recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const override
    {
        impulses[0](0) = -static_cast<double>(memory[0]);
    }

  private:
    Frame frame_a_, frame_b_;
    double max_angle_;
};

/// With a frequency a soft equation C = 0, without one a motor; both towards the velocity `speed`.
Block servo_block(const Jacobian& jacobian, const Eigen::VectorXd& error, const Eigen::VectorXd& speed,
                  double hertz, double damping_ratio, double most)
{
    return {.kind = hertz > 0 ? Block::Kind::equality : Block::Kind::motor,
            .jacobian = jacobian,
            .error = error,
            .speed = speed,
            .hertz = hertz,
            .damping_ratio = damping_ratio,
            .most = most};
}

class PointServoModel : public JointModel {
  public:
    explicit PointServoModel(const PointServoDefinition& servo) : servo_(servo) {}
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool in_plane,
                                            double) const override
    {
        const Eigen::Vector3d local_a = eigen(servo_.local_anchor_a), local_b = eigen(servo_.local_anchor_b);
        const Eigen::Index rows = in_plane ? 2 : 3;
        return {servo_block(point_jacobian(a, b, local_a, local_b).topRows(rows),
                            point_error(a, b, local_a, local_b).head(rows),
                            eigen(servo_.target_velocity).head(rows), servo_.hertz, servo_.damping_ratio,
                            servo_.max_force)};
    }

  private:
    PointServoDefinition servo_;
};

class AngularServoModel : public JointModel {
  public:
    explicit AngularServoModel(const AngularServoDefinition& servo)
        : servo_(servo), frame_a_(eigen(servo.frame_a)), frame_b_(eigen(servo.frame_b))
    {
    }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool, double) const override
    {
        const Eigen::Vector3d error =
            frame_error(a, b, frame_a_, frame_b_, LinearLock::none, AngularLock::all);
        const Jacobian jacobian =
            frame_jacobian(a, b, frame_a_, frame_b_, LinearLock::none, AngularLock::all);
        // dC/dt where the angular velocity of b relative to a is the target.
        const Eigen::Vector3d speed = jacobian.rightCols<3>() * eigen(servo_.target_velocity);
        Block block =
            servo_block(jacobian, error, speed, servo_.hertz, servo_.damping_ratio, servo_.max_torque);
        block.bounds_torque = true;
        return {block};
    }

  private:
    AngularServoDefinition servo_;
    Frame frame_a_, frame_b_;
};

}  // namespace

Model drive_model(const SlideDriveDefinition& drive, DriveAxis axis)
{
    return std::make_shared<DriveModel>(drive, axis);
}
Model model_of(const SwingLimitDefinition& limit)
{
    return std::make_shared<SwingLimitModel>(limit);
}
Model model_of(const PointServoDefinition& servo)
{
    return std::make_shared<PointServoModel>(servo);
}
Model model_of(const AngularServoDefinition& servo)
{
    return std::make_shared<AngularServoModel>(servo);
}

}  // namespace motley::reference
