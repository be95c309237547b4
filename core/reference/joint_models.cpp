// The constraints of each joint, written from the formulas in the header of its type; they share no code with it. Here: what all
// models have, and locks. drive_models.cpp, transmission_models.cpp and manifold_model.cpp have the others.
#include "model_parts.h"

namespace motley::reference {
namespace {

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
Model frame_model(const JointFrame& frame_a, const JointFrame& frame_b, const JointStiffness& stiffness,
                  LinearLock linear, AngularLock angular)
{
    return std::make_shared<FrameModel>(eigen(frame_a), eigen(frame_b), stiffness, linear, angular);
}

}  // namespace motley::reference
