// Limits and motors beside exact joints: how far they step, and how well they hold. Independent evidence: the system of two
// bodies and a locked point, dense and in double; and the law of an arm that leans on its limit.
#include "maths/locked_point.h"

#include <Eigen/Dense>

#include "mixed_scene.h"
#include "motley/reference/body.h"
#include "rig.h"

namespace motley {
namespace {

using Rigid = LaneBody<float, BodyKind::rigid>;
using testing::frame_time;

Eigen::Matrix3d dense(const Sym3<float>& s)
{
    Eigen::Matrix3d m;
    m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
    return m;
}
Eigen::Vector3d dense(const Vec3<float>& v)
{
    return {v.x, v.y, v.z};
}
/// The speed along the row after a unit impulse along it, of two bodies that are held together at a point: from
/// M v = J^T 1 + G^T mu, G v = 0.
double response_of_two(const Rigid& a, const Vec3<float>& arm_a, const Rigid& b, const Vec3<float>& arm_b,
                       const Vec3<float>& axis)
{
    Eigen::Matrix<double, 12, 12> inverse_mass = Eigen::Matrix<double, 12, 12>::Zero();
    inverse_mass.block<3, 3>(0, 0) = Eigen::Matrix3d::Identity() * static_cast<double>(a.inverse_mass);
    inverse_mass.block<3, 3>(3, 3) = dense(a.inverse_inertia);
    inverse_mass.block<3, 3>(6, 6) = Eigen::Matrix3d::Identity() * static_cast<double>(b.inverse_mass);
    inverse_mass.block<3, 3>(9, 9) = dense(b.inverse_inertia);
    Eigen::Matrix<double, 1, 12> row = Eigen::Matrix<double, 1, 12>::Zero();
    row.segment<3>(3) = -dense(axis).transpose();
    row.segment<3>(9) = dense(axis).transpose();
    Eigen::Matrix<double, 3, 12> point;
    point << -Eigen::Matrix3d::Identity(), reference::skew(dense(arm_a)), Eigen::Matrix3d::Identity(),
        -reference::skew(dense(arm_b));
    const Eigen::Matrix<double, 12, 1> alone = inverse_mass * row.transpose();
    const Eigen::Vector3d mu = (point * inverse_mass * point.transpose()).fullPivLu().solve(-point * alone);
    return (row * (alone + inverse_mass * point.transpose() * mu))(0);
}

class Bodies {
  public:
    Rigid body()
    {
        // Principal moments of a box, turned any way.
        const Eigen::Vector3d sides(between(0.05, 0.5), between(0.05, 0.5), between(0.05, 0.5));
        const double mass = between(0.5, 20);
        const Eigen::Vector3d s = sides.cwiseProduct(sides),
                              moments = mass / 12 * (Eigen::Vector3d::Constant(s.sum()) - s);
        const Eigen::Matrix3d r =
            Eigen::Quaterniond(between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1))
                .normalized()
                .toRotationMatrix();
        const Eigen::Matrix3d i = r * moments.cwiseInverse().asDiagonal() * r.transpose();
        Rigid out{};
        out.inverse_mass = static_cast<float>(1 / mass);
        const auto f = [&](int row, int column) { return static_cast<float>(i(row, column)); };
        out.inverse_inertia = {f(0, 0), f(0, 1), f(0, 2), f(1, 1), f(1, 2), f(2, 2)};
        return out;
    }
    Vec3<float> arm(double most)
    {
        const auto any = [&] { return static_cast<float>(between(-most, most)); };
        return {any(), any(), any()};
    }

  private:
    testing::Random random_;
    double between(double low, double high)
    {
        return (low + high) / 2 + (high - low) / 2 * random_.symmetric();
    }
};

TEST(LockedPoint, AStepIsThatOfTwoBodiesThatShareThePointUpToItsBound)
{
    Bodies random;
    int whole = 0, bounded = 0;
    for (int i = 0; i < 2000; ++i) {
        Rigid a = random.body(), b = random.body();
        if (i % 5 == 0) a = Rigid{};  // a body that cannot move
        const double reach = i % 2 == 0 ? 0.05 : 0.5;
        const Vec3<float> arm_a = random.arm(reach), arm_b = random.arm(reach), axis = random.arm(1);
        const double found = effective_mass_at_point(axis, a, arm_a, b, arm_b);
        const float k = dot(axis, a.inverse_inertia * axis + b.inverse_inertia * axis);
        const double alone = 1 / static_cast<double>(k),
                     together = 1 / response_of_two(a, arm_a, b, arm_b, axis);
        ASSERT_GE(together, 0.9999 * alone) << "a lock only makes bodies heavier";
        const double expected = std::min(together, static_cast<double>(longest_step) * alone);
        ASSERT_NEAR(found, expected, 2e-4 * expected) << i;
        (together < static_cast<double>(longest_step) * alone ? whole : bounded) += 1;
    }
    EXPECT_GT(whole, 300);
    EXPECT_GT(bounded, 300);
}

/// A rod of 2 kg and 0.6 m leans on the limit of the hinge at its end. A limit gives way by torque / (moment w^2), where w is
/// the stiffest spring that a substep can follow. The moment that the limit's row knows is that about the rod's centre,
/// m L^2 / 12. About the hinge it is four times as large, so the row steps 1.8 times as far, as if its moment were 1.8 times
/// as large, and gives way by so much less.
TEST(LockedPoint, AnArmLeansOnItsLimitAsFarAsALongerStepSays)
{
    for (const bool swings : {false, true}) {
        Scene scene;
        BodyDefinition rod;
        rod.position = {0.3, 0, 0};
        rod.mass = 2;
        const float moment = 2 * 0.36F / 12;
        rod.inertia = {moment, 0, 0, moment, 0, moment};
        const BodyId arm = scene.add_body(rod);
        const JointFrame at_end{{-0.3F, 0, 0}, testing::axis_along(2)};
        scene.add_joint(HingeDefinition{scene.ground(), arm, {{0, 0, 0}, testing::axis_along(2)}, at_end});
        if (swings) {
            SwingLimitDefinition limit{scene.ground(), arm};
            limit.frame_b.position = {-0.3F, 0, 0};
            limit.max_angle = 0.001F;
            scene.add_joint(limit);
        } else {
            TwistDriveDefinition limit{scene.ground(), arm};
            limit.frame_a.rotation = limit.frame_b.rotation = testing::axis_along(2);
            limit.lower = -0.001F;
            scene.add_joint(limit);
        }
        SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
        settings.exact_joints = true;
        settings.substeps = 1;
        Solver solver(settings);
        for (int step = 0; step < 300; ++step) solver.step(scene, frame_time);
        const BodyState state = scene.state(arm);
        const double beyond = -std::asin(2 * (state.orientation.w * state.orientation.z)) - 0.001;
        const double w = 2 * 3.14159265358979 * 0.25 / frame_time, torque = 2 * 9.81 * 0.3;
        const double alone = torque / (static_cast<double>(moment) * w * w);
        EXPECT_NEAR(beyond, alone / static_cast<double>(longest_step), 0.02 * alone) << swings;
        EXPECT_LT(std::abs(state.angular_velocity.z), 1e-5F);
    }
}

}  // namespace
}  // namespace motley
