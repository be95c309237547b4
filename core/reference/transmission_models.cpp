// Gears, racks, screws and pulleys: see joint_models.cpp.
#include "model_parts.h"

namespace motley::reference {
namespace {

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

}  // namespace

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

}  // namespace motley::reference
