// The constraints of each joint, written from the formulas in the header of its type; they share no code with it.
#include "motley/reference/joint_models.h"

#include "as_eigen.h"

namespace motley::reference {
namespace {

Eigen::VectorXd scalar(double value)
{
    return Eigen::VectorXd::Constant(1, value);
}

/// lower <= C <= upper: the nearer end as an inequality, or an equation where both are equal.
Block limit_block(const Jacobian& jacobian, double value, double lower, double upper)
{
    const double above = value - lower, below = upper - value;
    Block block{.jacobian = jacobian, .error = scalar(above)};
    if (lower == upper) return block;
    block.kind = Block::Kind::limit;
    block.side = above < below ? 1 : -1;
    block.error = scalar(std::min(above, below));
    return block;
}

/// Both impulses of a locked point act midway between the anchors.
Block::Point midway(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                    const Eigen::Vector3d& local_b)
{
    const Eigen::Vector3d half = point_error(a, b, local_a, local_b) / 2;
    return {a.orientation * local_a + half, b.orientation * local_b - half};
}

class BallSocketModel : public JointModel {
  public:
    explicit BallSocketModel(const BallSocketDefinition& j)
        : local_a_(eigen(j.local_anchor_a)), local_b_(eigen(j.local_anchor_b))
    {
    }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool in_plane,
                                            double) const override
    {
        const Eigen::Index rows = in_plane ? 2 : 3;
        return {{.jacobian = lock_jacobian(a, b, local_a_, local_b_).topRows(rows),
                 .error = point_error(a, b, local_a_, local_b_).head(rows),
                 .point = midway(a, b, local_a_, local_b_)}};
    }

  private:
    Eigen::Vector3d local_a_, local_b_;
};

class DistanceModel : public JointModel {
  public:
    explicit DistanceModel(const DistanceDefinition& j) : joint_(j) {}
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool, double) const override
    {
        const Eigen::Vector3d local_a = eigen(joint_.local_anchor_a), local_b = eigen(joint_.local_anchor_b);
        const Jacobian jacobian = distance_jacobian(a, b, local_a, local_b);
        const double length = distance_error(a, b, local_a, local_b, 0);
        const Block::Line line{a.orientation * local_a, b.orientation * local_b,
                               point_error(a, b, local_a, local_b)};
        std::vector<Block> blocks;
        if (joint_.has_spring()) {
            blocks.push_back({.jacobian = jacobian,
                              .error = scalar(length - static_cast<double>(joint_.rest_length)),
                              .hertz = joint_.spring_hertz,
                              .damping_ratio = joint_.spring_damping_ratio,
                              .stiffness = joint_.spring_stiffness,
                              .damping = joint_.spring_damping,
                              .most = joint_.spring_max_force});
        }
        blocks.push_back(limit_block(jacobian, length, joint_.min_length, joint_.max_length));
        for (Block& block : blocks) block.line = line;
        return blocks;
    }

    [[nodiscard]] std::vector<double> memory(const Joint& joint) const override
    {
        const std::vector<Eigen::VectorXd>& impulses = joint.impulses;
        return {impulses.size() > 1 ? impulses[0](0) : 0, impulses.back()(0)};  // spring, limit
    }
    void recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const override
    {
        impulses.front()(0) = static_cast<double>(memory[0]);
        impulses.back()(0) = static_cast<double>(memory[1]);
    }

  private:
    DistanceDefinition joint_;
};

class FrameModel : public JointModel {
  public:
    FrameModel(const Frame& a, const Frame& b, const JointStiffness& stiffness, LinearLock linear,
               AngularLock angular)
        : frame_a_(a), frame_b_(b), stiffness_(stiffness), linear_(linear), angular_(angular)
    {
    }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool, double) const override
    {
        Block block{.jacobian = frame_jacobian(a, b, frame_a_, frame_b_, linear_, angular_),
                    .error = frame_error(a, b, frame_a_, frame_b_, linear_, angular_),
                    .hertz = stiffness_.hertz,
                    .damping_ratio = stiffness_.damping_ratio};
        if (linear_ == LinearLock::point) block.point = midway(a, b, frame_a_.position, frame_b_.position);
        return {block};
    }

  private:
    Frame frame_a_, frame_b_;
    JointStiffness stiffness_;
    LinearLock linear_;
    AngularLock angular_;
};

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

/// The angle by which a body has turned about an axis that is fixed in it.
double turn_about(const Body& start, const Body& now, const Eigen::Vector3d& local_axis)
{
    const Eigen::Quaterniond turn = now.orientation * start.orientation.conjugate();
    const double along = (start.orientation * local_axis).dot(turn.vec());
    return 2 * std::atan2(turn.w() < 0 ? -along : along, std::abs(turn.w()));
}

class TransmissionModel : public JointModel {
  public:
    TransmissionModel(const Eigen::Vector3d& axis_a, const Eigen::Vector3d& axis_b, double ratio, bool slides)
        : axis_a_(axis_a.normalized()), axis_b_(axis_b.normalized()), ratio_(ratio), slides_(slides)
    {
    }
    [[nodiscard]] bool acts_from_world() const override { return slides_; }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool,
                                            double travelled) const override
    {
        Jacobian jacobian = Jacobian::Zero(1, 12);
        jacobian.block<1, 3>(0, 3) = -ratio_ * (a.orientation * axis_a_).transpose();
        jacobian.block<1, 3>(0, slides_ ? 6 : 9) = (b.orientation * axis_b_).transpose();
        return {{.jacobian = jacobian, .error = scalar(travelled)}};
    }
    [[nodiscard]] double travel(const Body& start_a, const Body& start_b, const Body& a,
                                const Body& b) const override
    {
        const double of_b = slides_ ? (b.orientation * axis_b_).dot(b.position - start_b.position)
                                    : turn_about(start_b, b, axis_b_);
        return of_b - ratio_ * turn_about(start_a, a, axis_a_);
    }

    [[nodiscard]] std::vector<double> memory(const Joint& joint) const override
    {
        return {joint.impulses[0](0), joint.travelled};
    }
    [[nodiscard]] double travelled_in(const float* memory) const override
    {
        return static_cast<double>(memory[1]);
    }

  private:
    Eigen::Vector3d axis_a_, axis_b_;
    double ratio_;
    bool slides_;
};

/// C is how far b has moved along the axis of a, minus what its rotation about that axis accounts for.
class ScrewModel : public JointModel {
  public:
    explicit ScrewModel(const ScrewDefinition& screw)
        : axis_a_(eigen(screw.axis_a).normalized()),
          local_a_(eigen(screw.local_anchor_a)),
          local_b_(eigen(screw.local_anchor_b)),
          metres_a_radian_(static_cast<double>(screw.pitch) / (2 * EIGEN_PI))
    {
    }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool,
                                            double travelled) const override
    {
        const Eigen::Vector3d x = a.orientation * axis_a_, arm_b = b.orientation * local_b_;
        const Eigen::Vector3d to_b = b.position + arm_b - a.position;
        Jacobian jacobian = Jacobian::Zero(1, 12);
        jacobian.block<1, 3>(0, 0) = -x.transpose();
        jacobian.block<1, 3>(0, 3) = (metres_a_radian_ * x - to_b.cross(x)).transpose();
        jacobian.block<1, 3>(0, 6) = x.transpose();
        jacobian.block<1, 3>(0, 9) = (arm_b.cross(x) - metres_a_radian_ * x).transpose();
        return {{.jacobian = jacobian, .error = scalar(travelled)}};
    }
    [[nodiscard]] double travel(const Body& start_a, const Body& start_b, const Body& a,
                                const Body& b) const override
    {
        const Eigen::Vector3d axis_b = start_b.orientation.conjugate() * (start_a.orientation * axis_a_);
        return slide(a, b) - slide(start_a, start_b) -
               metres_a_radian_ * (turn_about(start_b, b, axis_b) - turn_about(start_a, a, axis_a_));
    }
    [[nodiscard]] std::vector<double> memory(const Joint& joint) const override
    {
        return {joint.impulses[0](0), joint.travelled};
    }
    [[nodiscard]] double travelled_in(const float* memory) const override
    {
        return static_cast<double>(memory[1]);
    }

  private:
    Eigen::Vector3d axis_a_, local_a_, local_b_;
    double metres_a_radian_;

    [[nodiscard]] double slide(const Body& a, const Body& b) const
    {
        const Eigen::Vector3d d =
            b.position + b.orientation * local_b_ - a.position - a.orientation * local_a_;
        return (a.orientation * axis_a_).dot(d);
    }
};

class PulleyModel : public JointModel {
  public:
    explicit PulleyModel(const PulleyDefinition& pulley) : pulley_(pulley) {}
    [[nodiscard]] bool acts_from_world() const override { return true; }
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool in_plane,
                                            double) const override
    {
        const Eigen::Vector3d arm_a = a.orientation * eigen(pulley_.local_anchor_a),
                              arm_b = b.orientation * eigen(pulley_.local_anchor_b);
        Eigen::Vector3d rope_a = a.position + arm_a - eigen(pulley_.point_a),
                        rope_b = b.position + arm_b - eigen(pulley_.point_b);
        if (in_plane) rope_a.z() = rope_b.z() = 0;
        const double ratio = pulley_.ratio;
        // Each end of the rope is a row between its wheel, which is no body, and an anchor: only b's half of
        // [-u, .., u, ..] is used.
        const auto row = [](const Eigen::Vector3d& rope, const Eigen::Vector3d& arm) {
            return Eigen::Matrix<double, 1, 6>(
                direction_jacobian(rope.normalized(), Eigen::Vector3d::Zero(), arm).rightCols<6>());
        };
        Jacobian jacobian(1, 12);
        jacobian << row(rope_a, arm_a), ratio * row(rope_b, arm_b);
        return {limit_block(jacobian, rope_a.norm() + ratio * rope_b.norm(), pulley_.min_length,
                            pulley_.max_length)};
    }

  private:
    PulleyDefinition pulley_;
};

class ManifoldModel : public JointModel {
  public:
    explicit ManifoldModel(const ManifoldDefinition& contact) : contact_(contact) {}
    [[nodiscard]] bool keeps_rows_of_start() const override { return true; }
    /// Friction, torsion, rolling, then the points.
    [[nodiscard]] std::vector<Block> blocks(const Body& a, const Body& b, bool, double) const override
    {
        const Eigen::Vector3d local_n = eigen(contact_.normal).normalized(), local_t = tangent_of(local_n),
                              n = a.orientation * local_n, t = a.orientation * local_t, t2 = n.cross(t);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        std::vector<Block> points;
        for (int i = 0; i < contact_.point_count; ++i) {
            const ManifoldPoint& point = contact_.points[i];
            const Eigen::Vector3d arm_b = b.orientation * eigen(point.local_anchor_b);
            mean += arm_b / contact_.point_count;
            points.push_back({.kind = Block::Kind::contact,
                              .jacobian = direction_jacobian(n, b.position + arm_b - a.position, arm_b),
                              .error = scalar(n.dot(point_error(a, b, eigen(point.local_anchor_a),
                                                                eigen(point.local_anchor_b)))),
                              .restitution = contact_.restitution});
        }
        const Eigen::Vector3d arm_a = b.position + mean - a.position, u = eigen(contact_.surface_velocity);
        Jacobian friction(2, 12), torsion = Jacobian::Zero(1, 12), rolling = Jacobian::Zero(2, 12);
        friction << direction_jacobian(t, arm_a, mean), direction_jacobian(t2, arm_a, mean);
        const auto turn = [](Jacobian& rows, Eigen::Index row, const Eigen::Vector3d& axis) {
            rows.block<1, 3>(row, 3) = -axis.transpose();
            rows.block<1, 3>(row, 9) = axis.transpose();
        };
        turn(torsion, 0, n);
        turn(rolling, 0, t);
        turn(rolling, 1, t2);
        const auto motor = [](const Jacobian& rows, const Eigen::VectorXd& speed, double factor) {
            return Block{.kind = Block::Kind::motor,
                         .jacobian = rows,
                         .error = Eigen::VectorXd::Zero(rows.rows()),
                         .speed = speed,
                         .most_per_contact = factor};
        };
        const double mu = contact_.friction;
        std::vector<Block> all = {
            motor(friction, Eigen::Vector2d(local_t.dot(u), local_n.cross(local_t).dot(u)), mu),
            motor(torsion, scalar(0), mu * static_cast<double>(contact_.torsional_radius)),
            motor(rolling, Eigen::Vector2d::Zero(), contact_.rolling_radius)};
        all.insert(all.end(), points.begin(), points.end());
        return all;
    }
    [[nodiscard]] std::vector<double> memory(const Joint& joint) const override
    {
        const std::vector<Eigen::VectorXd>& impulses = joint.impulses;
        std::vector<double> memory(4, 0);
        for (std::size_t i = 3; i < impulses.size(); ++i) memory[i - 3] = impulses[i](0);
        for (std::size_t i = 0; i < 3; ++i)
            memory.insert(memory.end(), impulses[i].begin(), impulses[i].end());
        return memory;
    }
    void recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const override
    {
        for (std::size_t i = 3; i < impulses.size(); ++i) impulses[i](0) = static_cast<double>(memory[i - 3]);
        std::size_t next = 4;
        for (std::size_t i = 0; i < 3; ++i) {
            for (double& impulse : impulses[i]) impulse = static_cast<double>(memory[next++]);
        }
    }

  private:
    ManifoldDefinition contact_;

    /// The same tangent as in the lanes. Any would do, because bounds are circles, but so a host that changes to
    /// Method::direct and back keeps its impulses along the same directions.
    static Eigen::Vector3d tangent_of(const Eigen::Vector3d& n)
    {
        const Eigen::Vector3d v =
            std::abs(n.x()) < 0.57735 ? Eigen::Vector3d(0, n.z(), -n.y()) : Eigen::Vector3d(n.y(), -n.x(), 0);
        return v.normalized();
    }
};

}  // namespace

std::vector<double> JointModel::memory(const Joint& joint) const
{
    std::vector<double> in_line;
    for (const Eigen::VectorXd& block : joint.impulses)
        in_line.insert(in_line.end(), block.begin(), block.end());
    return in_line;
}

void JointModel::recall(std::span<const float> memory, std::vector<Eigen::VectorXd>& impulses) const
{
    std::size_t next = 0;
    for (Eigen::VectorXd& block : impulses) {
        for (double& impulse : block)
            impulse = next < memory.size() ? static_cast<double>(memory[next++]) : 0;
    }
}

Model model_of(const BallSocketDefinition& joint)
{
    return std::make_shared<BallSocketModel>(joint);
}
Model model_of(const DistanceDefinition& joint)
{
    return std::make_shared<DistanceModel>(joint);
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
Model model_of(const GearDefinition& gear)
{
    return std::make_shared<TransmissionModel>(eigen(gear.axis_a), eigen(gear.axis_b), gear.ratio, false);
}
Model model_of(const RackAndPinionDefinition& rack)
{
    return std::make_shared<TransmissionModel>(eigen(rack.axis_a), eigen(rack.axis_b), rack.travel, true);
}
Model model_of(const ScrewDefinition& screw)
{
    return std::make_shared<ScrewModel>(screw);
}
Model model_of(const PulleyDefinition& pulley)
{
    return std::make_shared<PulleyModel>(pulley);
}
Model model_of(const ManifoldDefinition& contact)
{
    return std::make_shared<ManifoldModel>(contact);
}
Model frame_model(const JointFrame& frame_a, const JointFrame& frame_b, const JointStiffness& stiffness,
                  LinearLock linear, AngularLock angular)
{
    return std::make_shared<FrameModel>(eigen(frame_a), eigen(frame_b), stiffness, linear, angular);
}
Model drive_model(const SlideDriveDefinition& drive, DriveAxis axis)
{
    return std::make_shared<DriveModel>(drive, axis);
}

}  // namespace motley::reference
