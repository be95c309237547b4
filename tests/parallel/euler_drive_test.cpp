// Limits and springs on Euler angles. Independent evidence: virtual work on the axes of three hinges in series, whose
// rotations give the body's orientation.
#include <Eigen/Geometry>

#include "rig.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;

struct Hinges {
    Eigen::Vector3d angles;
    Eigen::Matrix3d axes;  ///< in the world, a column each

    explicit Hinges(const Quat<double>& orientation)
    {
        const Eigen::Matrix3d r =
            Eigen::Quaterniond(orientation.w, orientation.x, orientation.y, orientation.z).toRotationMatrix();
        // R = R_x R_y R_z: its third column is that of R_x R_y, its first row that of R_y R_z.
        angles = {std::atan2(-r(1, 2), r(2, 2)), std::asin(r(0, 2)), std::atan2(-r(0, 1), r(0, 0))};
        const Eigen::AngleAxisd x(angles.x(), Eigen::Vector3d::UnitX()),
            y(angles.y(), Eigen::Vector3d::UnitY()), z(angles.z(), Eigen::Vector3d::UnitZ());
        EXPECT_LT(((x * y * z).toRotationMatrix() - r).norm(), 1e-6);
        axes << Eigen::Vector3d::UnitX(), x * Eigen::Vector3d::UnitY(), x * (y * Eigen::Vector3d::UnitZ());
    }
};

SixDofDefinition euler_joint(Scene& scene, BodyId body)
{
    SixDofDefinition joint;
    joint.body_a = scene.ground();
    joint.body_b = body;
    joint.rotations = SixDofRotation::euler;
    return joint;
}

TEST(EulerDrive, SpringsRestWhereATorqueDoesNoWorkOnAnyOfTheAngles)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        if (testing::is_sanitized && method != Method::soft_step) continue;
        Scene scene;
        const BodyId body = scene.add_body(box({0, 0, 0}));
        SixDofDefinition joint = euler_joint(scene, body);
        const Eigen::Vector3d k(3, 5, 8);
        for (int i = 0; i < 3; ++i) {
            joint.rotation[i] = AxisSetup::free();
            joint.rotation[i].spring_stiffness = static_cast<float>(k(i));
            joint.rotation[i].spring_damping = 2;
        }
        EXPECT_EQ(add_six_dof(scene, joint).size(), 4);
        const Eigen::Vector3d torque(1, 4, -2);
        scene.set_force(body, {}, {1, 4, -2});
        SolverSettings settings;
        settings.method = method;
        Solver solver(settings);
        testing::run(scene, solver, 20);
        const Hinges hinges(scene.state(body).orientation);
        EXPECT_GT(std::abs(hinges.angles.y()), 0.3) << "a place where the axes are askew";
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(k(i) * hinges.angles(i), hinges.axes.col(i).dot(torque), 5e-3)
                << static_cast<int>(method) << ", angle " << i;
        }
    }
}

TEST(EulerDrive, LimitsHoldEachAngleAndBearItsShareOfTheTorque)
{
    const Eigen::Vector3d lower(-0.5, -0.3, -1), upper(0.4, 0.6, 0.8);
    for (const Eigen::Vector3d& push : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(-1, 1, -1),
                                        Eigen::Vector3d(1, -1, 0.3), Eigen::Vector3d(-0.2, 1, 1)}) {
        if (testing::is_sanitized && push.x() != 1) continue;
        Scene scene;
        const BodyId body = scene.add_body(box({0, 0, 0}));
        SixDofDefinition joint = euler_joint(scene, body);
        for (int i = 0; i < 3; ++i) {
            joint.rotation[i] =
                AxisSetup::limited(static_cast<float>(lower(i)), static_cast<float>(upper(i)));
            joint.rotation[i].spring_damping = 1;  // so that it comes to rest
        }
        const std::vector<ConstraintId> ids = add_six_dof(scene, joint);
        ASSERT_EQ(ids.size(), 4);
        scene.set_force(
            body, {},
            {static_cast<float>(push.x()), static_cast<float>(push.y()), static_cast<float>(push.z())});
        Solver solver;
        testing::run(scene, solver, 30);
        const Hinges hinges(scene.state(body).orientation);
        for (int i = 0; i < 3; ++i) {
            EXPECT_GT(hinges.angles(i), lower(i) - 2e-3);
            EXPECT_LT(hinges.angles(i), upper(i) + 2e-3);
            // At rest each angle is at the limit towards which the torque pushes it.
            const double work = hinges.axes.col(i).dot(push);
            if (std::abs(work) > 0.1) {
                EXPECT_NEAR(hinges.angles(i), work > 0 ? upper(i) : lower(i), 2e-3) << "angle " << i;
            }
        }
    }
}

TEST(EulerDrive, AloneItIsATwist)
{
    // For a rotation about one axis all conventions of angles agree.
    for (int which = 0; which < 3; ++which) {
        Scene scene;
        const BodyId body = scene.add_body(box({0, 0, 0}));
        SixDofDefinition joint = euler_joint(scene, body);
        joint.rotation[which] = AxisSetup::limited(-0.7F, 0.7F);
        EXPECT_EQ(add_six_dof(scene, joint).size(), 2);
        Vec3<float> torque{};
        (which == 0 ? torque.x : which == 1 ? torque.y : torque.z) = -2;
        scene.set_force(body, {}, torque);
        Solver solver;
        testing::run(scene, solver, 5);
        EXPECT_NEAR(Hinges(scene.state(body).orientation).angles(which), -0.7, 2e-3);
    }
}

TEST(EulerDrive, GoesAllTheWayRound)
{
    for (const float target : {2.5F, -3.0F}) {
        Scene scene;
        const BodyId body = scene.add_body(box({0, 0, 0}));
        SixDofDefinition joint = euler_joint(scene, body);
        joint.rotation[2] = AxisSetup::free();
        joint.rotation[2].spring_stiffness = 5;
        joint.rotation[2].spring_damping = 3;
        joint.rotation[2].spring_target = target;
        add_six_dof(scene, joint);
        Solver solver;
        testing::run(scene, solver, 10);
        EXPECT_NEAR(Hinges(scene.state(body).orientation).angles.z(), target, 1e-3);
    }
}

TEST(EulerDrive, NearARightAngleItStaysFiniteAndGainsNoEnergy)
{
    Scene scene;
    BodyDefinition definition = box({0, 0, 0});
    definition.angular_velocity = {0.3F, 2, 0.2F};
    const BodyId body = scene.add_body(definition);
    SixDofDefinition joint = euler_joint(scene, body);
    joint.rotation[0] = AxisSetup::limited(-0.2F, 0.2F);
    joint.rotation[1] = AxisSetup::limited(-1.5F, 1.5F);  // 4 degrees from the pose where x and z coincide
    joint.rotation[2] = AxisSetup::limited(-0.2F, 0.2F);
    add_six_dof(scene, joint);
    Solver solver;
    for (int step = 0; step < 600; ++step) {
        ASSERT_EQ(solver.step(scene, frame_time).bodies_contained, 0);
        const Vec3<float> w = scene.state(body).angular_velocity;
        ASSERT_LT(std::sqrt(dot(w, w)), 3) << step;
    }
}

}  // namespace
}  // namespace motley
