// Manifolds: see joint_models.cpp.
#include "model_parts.h"

namespace motley::reference {
namespace {

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

Model model_of(const ManifoldDefinition& contact)
{
    return std::make_shared<ManifoldModel>(contact);
}

}  // namespace motley::reference
