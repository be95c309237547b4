// Eleven traps in textbooks of this theory: for each, the error of the printed form, as a number, and that of the
// form used here ("mended"). Independent evidence: finite differences and closed forms in double, on the reference's
// own rows. tests/parallel/traps_test.cpp tests the lanes.
#include <gtest/gtest.h>

#include "mixed_scene.h"
#include "motley/reference/constraints.h"

namespace motley::reference {
namespace {

using motley::testing::Random;
constexpr double pi = 3.14159265358979323846;
using Vector12 = Eigen::Matrix<double, 12, 1>;

Eigen::Vector3d random_vector(Random& random)
{
    return {random.symmetric(), random.symmetric(), random.symmetric()};
}
Eigen::Quaterniond random_turn(Random& random)
{
    return Eigen::Quaterniond(random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric())
        .normalized();
}
Body moving_body(const Eigen::Vector3d& position, Random& random)
{
    Body body;
    body.position = position;
    body.orientation = random_turn(random);
    body.velocity << random_vector(random), random_vector(random);
    return body;
}
Vector12 velocity_of(const Body& a, const Body& b)
{
    Vector12 v;
    v << a.velocity, b.velocity;
    return v;
}
/// dC/dt along the motion of both bodies, by a central difference.
template <class Function>
double rate_of(const Body& a, const Body& b, const Function& c)
{
    constexpr double epsilon = 1e-6;
    Body a_after = a, b_after = b, a_before = a, b_before = b;
    a_after.advance(a.velocity, epsilon);
    b_after.advance(b.velocity, epsilon);
    a_before.advance(a.velocity, -epsilon);
    b_before.advance(b.velocity, -epsilon);
    return (c(a_after, b_after) - c(a_before, b_before)) / (2 * epsilon);
}

TEST(Trap1, ASquaredPositionConstraintLosesItsJacobianWhereItIsSatisfied)
{
    // Printed: C = d . d, J = 2 d^T [-1, .., 1, ..]. K is proportional to d^2, so lambda = -J v / K loses every
    // digit.
    Body a, b;
    b.position = {1e-8, 0, 0};
    const Eigen::Vector3d none = Eigen::Vector3d::Zero(), d = point_error(a, b, none, none);
    const Jacobian rows = point_jacobian(a, b, none, none);
    const Jacobian printed = 2 * d.transpose() * rows;
    const double printed_k = (printed * pair_inverse_mass(a, b) * printed.transpose())(0, 0);
    EXPECT_NEAR(printed_k, 8e-16, 1e-20);  // 4 d^2 (1/m_a + 1/m_b)
    // Mended: three rows, whose K does not depend on d.
    const Eigen::Matrix3d k = rows * pair_inverse_mass(a, b) * rows.transpose();
    EXPECT_LT((k - 2 * Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(Trap2, AnAxisThatTurnsWithAHasItsLeverEndAtB)
{
    // Printed: [-e, -(r_a x e), e, r_b x e]. The true derivative of e . d has r_a + d, so the error grows with d.
    Random random;
    double printed_fault[3] = {}, mended_fault = 0;
    const double distances[3] = {0.01, 0.1, 1};
    for (int i = 0; i < 3; ++i) {
        for (int trial = 0; trial < 50; ++trial) {
            const Body a = moving_body({0, 0, 0}, random);
            Body b = moving_body({0, 0, 0}, random);
            const Eigen::Vector3d local_a = random_vector(random), local_b = random_vector(random),
                                  local_e = random_vector(random).normalized();
            b.position +=
                distances[i] * random_vector(random).normalized() - point_error(a, b, local_a, local_b);
            const auto c = [&](const Body& p, const Body& q) {
                return (p.orientation * local_e).dot(point_error(p, q, local_a, local_b));
            };
            const Eigen::Vector3d e = a.orientation * local_e, arm_a = a.orientation * local_a,
                                  arm_b = b.orientation * local_b, d = point_error(a, b, local_a, local_b);
            const double truth = rate_of(a, b, c);
            const double printed = (direction_jacobian(e, arm_a, arm_b) * velocity_of(a, b))(0);
            const double mended = (direction_jacobian(e, arm_a + d, arm_b) * velocity_of(a, b))(0);
            printed_fault[i] = std::max(printed_fault[i], std::abs(printed - truth));
            mended_fault = std::max(mended_fault, std::abs(mended - truth));
        }
    }
    EXPECT_LT(mended_fault, 1e-8);
    EXPECT_GT(printed_fault[0], 3e-3);  // m/s of about 1, at 1 cm
    EXPECT_GT(printed_fault[1], 5 * printed_fault[0]);
    EXPECT_GT(printed_fault[2], 0.3);
}

TEST(Trap3, TheQuaternionMatricesWithTheScalarFirstTurnTheWrongWay)
{
    // Printed: products of L(q) and R(q), which are meant for quaternions (w, x, y, z), applied to (x, y, z, w). At
    // the identity the result is diag(-1, 1, 1) / 2, and a correction with it increases an error about x.
    const Eigen::Vector3d printed_diagonal(-0.5, 0.5, 0.5);
    const Eigen::Matrix3d printed = printed_diagonal.asDiagonal();
    const Frame frame;
    const auto error_after = [&](const Eigen::Matrix3d& g) {
        Body a, b;
        a.motion = BodyMotion::static_body;
        b.orientation = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX());
        for (int step = 0; step < 5; ++step) {
            const Eigen::Vector3d c = frame_error(a, b, frame, frame, LinearLock::none, AngularLock::all);
            Vector6 move = Vector6::Zero();
            move.tail<3>() = -0.2 * g.transpose() * (g * g.transpose()).inverse() * c;
            b.advance(move, 1);
        }
        return frame_error(a, b, frame, frame, LinearLock::none, AngularLock::all).norm();
    };
    EXPECT_GT(error_after(printed), 0.4);  // started at 0.1
    const Body identity;
    const Eigen::Matrix3d mended =
        frame_jacobian(identity, identity, frame, frame, LinearLock::none, AngularLock::all).rightCols<3>();
    EXPECT_LT((mended - Eigen::Matrix3d::Identity()).norm(), 1e-15);
    EXPECT_LT(error_after(mended), 0.04);
}

TEST(Trap4, AnAngleByArcsineIsNotANumberNearHalfATurn)
{
    // Printed: theta = 2 asin(v . e), in float. For some of the poses near pi rounding makes the argument larger than
    // 1.
    Random random;
    int printed_nan = 0, mended_nan = 0;
    double mended_fault = 0;
    constexpr int trials = 2000;
    for (int trial = 0; trial < trials; ++trial) {
        const Eigen::Vector3f e = random_vector(random).normalized().cast<float>().normalized();
        const double angle = pi + 1e-4 * random.symmetric();
        const Eigen::Quaternionf q =
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, e.cast<double>())).cast<float>();
        const float along = q.vec().dot(e);
        if (std::isnan(2 * std::asin(along))) ++printed_nan;
        const float mended = 2 * std::atan2(q.w() < 0 ? -along : along, std::abs(q.w()));
        if (std::isnan(mended)) ++mended_nan;
        mended_fault =
            std::max(mended_fault, std::abs(std::remainder(static_cast<double>(mended) - angle, 2 * pi)));
    }
    EXPECT_GT(printed_nan, trials / 20);
    EXPECT_EQ(mended_nan, 0);
    EXPECT_LT(mended_fault, 1e-6);  // two roundings of a float near pi, 2.4e-7 each, and of the quaternion
    // q and -q are the same rotation and must give the same error.
    Body a, b, flipped;
    b.orientation = random_turn(random);
    flipped.orientation.coeffs() = -b.orientation.coeffs();
    const Frame frame;
    EXPECT_EQ((frame_error(a, b, frame, frame, LinearLock::none, AngularLock::all) -
               frame_error(a, flipped, frame, frame, LinearLock::none, AngularLock::all))
                  .norm(),
              0);
}

TEST(Trap5, TheLockOfAllRotationsIsSingularAtHalfATurn)
{
    // det G = cos(theta / 2): an unguarded inverse of K grows without bound; the pseudo-inverse leaves the singular
    // row out.
    const Frame frame;
    double largest = 0;
    for (const double short_of_pi : {1e-2, 1e-4, 1e-6, 0.0}) {
        Body a, b;
        b.orientation = Eigen::AngleAxisd(pi - short_of_pi, Eigen::Vector3d::UnitZ());
        const Jacobian j = frame_jacobian(a, b, frame, frame, LinearLock::none, AngularLock::all);
        EXPECT_NEAR(j.rightCols<3>().determinant(), std::cos((pi - short_of_pi) / 2), 1e-12);
        const Eigen::Matrix3d k = j * pair_inverse_mass(a, b) * j.transpose();
        if (short_of_pi == 1e-6) {
            EXPECT_GT(k.inverse().norm(), 1e12);
        }
        if (short_of_pi == 0) largest = effective_mass(j, a, b).norm();
    }
    EXPECT_LT(largest, 1);  // the other two rows have 1/2 each
}

TEST(Trap6, ALimitSolvedAsAnEqualitySticks)
{
    // A body that leaves its limit at 2 m/s. Printed: lambda = -K^-1 J v, which stops it. Mended: lambda is clamped
    // at zero.
    Body a, b;
    a.motion = BodyMotion::static_body;
    b.velocity(0) = 2;
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    const Jacobian row = direction_jacobian(Eigen::Vector3d::UnitX(), none, none);
    const double lambda = -(effective_mass(row, a, b) * row * velocity_of(a, b))(0);
    EXPECT_EQ(2 + lambda, 0);
    EXPECT_EQ(2 + std::max(lambda, 0.0), 2);
    // A row along which neither body can move has a zero diagonal: it must be skipped, not divided by.
    b.motion = BodyMotion::static_body;
    EXPECT_EQ(effective_mass(row, a, b)(0, 0), 0);
}

TEST(Trap7, BaumgartesSignAsPrintedDiverges)
{
    // v = +-(beta / h) C each step: C grows by 1 + beta, or falls by 1 - beta.
    double printed = 1e-3, mended = 1e-3;
    const double h = 1.0 / 60, beta = 0.2;
    for (int step = 0; step < 60; ++step) {
        printed += h * (beta / h) * printed;
        mended -= h * (beta / h) * mended;
    }
    EXPECT_GT(printed, 50);
    EXPECT_LT(mended, 2e-9);
}

TEST(Trap8, RectificationByHalvesMovesTheCommonCentreAndLeavesHalfAgainstAStaticBody)
{
    // Masses 1 and 100, 0.1 m apart. Printed: each body moves by half the error.
    const double m_a = 1, m_b = 100, error = 0.1;
    const double printed_centre = (m_a * error / 2 - m_b * error / 2) / (m_a + m_b);
    EXPECT_GT(std::abs(printed_centre), 0.04);
    const double printed_left_against_static = error - error / 2;
    EXPECT_EQ(printed_left_against_static, 0.05);
    // Mended: bodies share the correction by inverse masses, through the rows.
    for (const bool is_static : {false, true}) {
        Body a, b;
        a.mass = m_a;
        b.mass = m_b;
        b.position.x() = error;
        if (is_static) b.motion = BodyMotion::static_body;
        const Eigen::Vector3d none = Eigen::Vector3d::Zero(), centre = m_a * a.position + m_b * b.position;
        const Jacobian j = point_jacobian(a, b, none, none);
        const Vector12 move = -pair_inverse_mass(a, b) * j.transpose() * effective_mass(j, a, b) *
                              point_error(a, b, none, none);
        a.advance(move.head<6>(), 1);
        b.advance(move.tail<6>(), 1);
        EXPECT_LT(point_error(a, b, none, none).norm(), 1e-15);
        if (!is_static) {
            EXPECT_LT((m_a * a.position + m_b * b.position - centre).norm(), 1e-14);
        }
    }
}

TEST(Trap9, IntegratingPositionsBeforeTheSolveDrifts)
{
    // A body held against gravity. Printed: v += g h, x += h v, and only then the solve removes v: each step adds g
    // h^2 to x.
    const double h = 1.0 / 60, g = -9.81;
    double printed_x = 0, printed_v = 0, mended_x = 0, mended_v = 0;
    for (int step = 0; step < 60; ++step) {
        printed_v += h * g;
        printed_x += h * printed_v;
        printed_v = 0;
        mended_v += h * g;
        mended_v = 0;
        mended_x += h * mended_v;
    }
    EXPECT_NEAR(printed_x, 60 * g * h * h, 1e-12);
    EXPECT_LT(printed_x, -0.16);
    EXPECT_EQ(mended_x, 0);
}

TEST(Trap10, ASweepOverTheRowsOfAJointLeavesMostOfTheErrorOfALongLever)
{
    // The part of J v that a Gauss-Seidel sweep over the three rows leaves, against the inverse of the block.
    Random random;
    double left_by_rows[2] = {}, left_by_block = 0;
    const double levers[2] = {2, 5};
    for (int i = 0; i < 2; ++i) {
        for (int trial = 0; trial < 200; ++trial) {
            Body a, b;
            a.motion = BodyMotion::static_body;
            b.inertia = 0.1 * Eigen::Matrix3d::Identity();
            const Eigen::Vector3d lever = levers[i] * random_vector(random).normalized(),
                                  speed = random_vector(random).normalized();
            const Jacobian j = point_jacobian(a, b, Eigen::Vector3d::Zero(), lever);
            const Eigen::Matrix3d k = j * pair_inverse_mass(a, b) * j.transpose();
            Eigen::Vector3d lambda = Eigen::Vector3d::Zero();
            for (int row = 0; row < 3; ++row) lambda(row) -= (speed + k * lambda)(row) / k(row, row);
            left_by_rows[i] = std::max(left_by_rows[i], (speed + k * lambda).norm());
            left_by_block = std::max(left_by_block, (speed - k * effective_mass(j, a, b) * speed).norm());
        }
    }
    EXPECT_GT(left_by_rows[0], 0.4);
    EXPECT_GT(left_by_rows[1], 0.4);
    EXPECT_LT(left_by_block, 1e-9);
}

TEST(Trap11, AWarmStartClampedAtAFixedNumberKnowsNothingOfUnitsOrSteps)
{
    // Printed: cached impulses are clamped at 1e5. A crane's load of 1e7 kg needs 1.6e6 N s in each step of 1/60 s.
    const double needed = 1e7 * 9.81 / 60;
    EXPECT_LT(std::min(needed, 1e5), 0.1 * needed);
    // Used unscaled in a step of 1/600 s, the impulse of a step of 1/60 s throws its load up at nine tenths of g /
    // 60.
    const double thrown = 9.81 / 60 - 9.81 / 600, scaled = 0.1 * 9.81 / 60 - 9.81 / 600;
    EXPECT_GT(thrown, 0.14);
    EXPECT_NEAR(scaled, 0, 1e-15);
}

}  // namespace
}  // namespace motley::reference
