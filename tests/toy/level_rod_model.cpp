// The toy joint in double.
#include "level_rod.h"
#include "motley/reference/joint.h"

namespace motley {
namespace {

class LevelRodModel : public reference::JointModel {
  public:
    explicit LevelRodModel(const LevelRodDefinition& joint) : offset_(joint.offset) {}
    [[nodiscard]] std::vector<reference::Block> blocks(const reference::Body& a, const reference::Body& b,
                                                       bool, double) const override
    {
        const Eigen::Vector3d none = Eigen::Vector3d::Zero();
        return {{.jacobian = reference::direction_jacobian(Eigen::Vector3d::UnitY(), none, none),
                 .error = Eigen::VectorXd::Constant(1, b.position.y() - a.position.y() - offset_)}};
    }

  private:
    double offset_;
};

}  // namespace

std::shared_ptr<const reference::JointModel> model_of(const LevelRodDefinition& joint)
{
    return std::make_shared<LevelRodModel>(joint);
}

}  // namespace motley
