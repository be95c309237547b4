// The reference itself: its Jacobians against finite differences of C along random motions, for every pair of
// body models that makes sense; its effective masses and its conservation of momentum.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "mixed_scene.h"
#include "motley/reference/world.h"
#include "small_inverse.h"
#include "symmetric_modes.h"

namespace motley::reference {
namespace {

using motley::testing::Random;

Body random_body(BodyModel model, BodyMotion motion, Random& random)
{
    const auto vector = [&] {
        return Eigen::Vector3d(random.symmetric(), random.symmetric(), random.symmetric());
    };
    Body body;
    body.model = model;
    body.motion = motion;
    body.position = 2 * vector();
    body.mass = 1.5 + random.symmetric();
    const Eigen::Vector3d spread = vector();
    body.inertia = Eigen::Matrix3d::Identity() + 0.3 * spread * spread.transpose();
    body.velocity << vector(), vector();
    if (motion == BodyMotion::static_body) body.velocity.setZero();
    if (motion == BodyMotion::dynamic_body && model == BodyModel::particle) body.velocity.tail<3>().setZero();
    if (motion == BodyMotion::dynamic_body && model == BodyModel::planar) {
        body.velocity(2) = body.velocity(3) = body.velocity(4) = 0;
        body.orientation = Eigen::AngleAxisd(3 * random.symmetric(), Eigen::Vector3d::UnitZ());
    } else if (model != BodyModel::particle) {
        body.orientation =
            Eigen::Quaterniond(random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric())
                .normalized();
    }
    return body;
}

struct Pair {
    Body a, b;
    Eigen::Vector3d local_a, local_b;
    [[nodiscard]] Eigen::Matrix<double, 12, 1> velocity() const
    {
        Eigen::Matrix<double, 12, 1> v;
        v << a.velocity, b.velocity;
        return v;
    }
    /// The pair after `seconds` of its own motion.
    [[nodiscard]] Pair moved(double seconds) const
    {
        Pair p = *this;
        p.a.advance(a.velocity, seconds);
        p.b.advance(b.velocity, seconds);
        return p;
    }
};

/// Calls claim(pair) for random pairs of every combination of models, with one of them static or kinematic too.
template <class Claim>
void for_every_pair(const Claim& claim)
{
    Random random(5);
    for (int model_a = 0; model_a < 5; ++model_a) {
        for (int model_b = 0; model_b < 5; ++model_b) {
            if (model_a > 2 && model_b > 2) continue;
            for (int trial = 0; trial < 20; ++trial) {
                const auto make = [&](int kind) {
                    const BodyMotion motion = kind == 3   ? BodyMotion::static_body
                                              : kind == 4 ? BodyMotion::kinematic_body
                                                          : BodyMotion::dynamic_body;
                    return random_body(kind > 2 ? BodyModel::rigid : static_cast<BodyModel>(kind), motion,
                                       random);
                };
                Pair pair{make(model_a), make(model_b), {}, {}};
                const auto anchor = [&](int kind) {
                    return kind == 0
                               ? Eigen::Vector3d(0, 0, 0)
                               : Eigen::Vector3d(random.symmetric(), random.symmetric(), random.symmetric());
                };
                pair.local_a = anchor(model_a);
                pair.local_b = anchor(model_b);
                claim(pair);
            }
        }
    }
}

constexpr double epsilon = 1e-5;
constexpr double tolerance = 1e-7;  // relative: central differences leave epsilon^2 and 1e-16 / epsilon

TEST(Reference, PointJacobianMatchesFiniteDifferences)
{
    for_every_pair([](const Pair& p) {
        const auto error = [&](const Pair& q) { return point_error(q.a, q.b, p.local_a, p.local_b); };
        const Eigen::Vector3d difference =
            (error(p.moved(epsilon)) - error(p.moved(-epsilon))) / (2 * epsilon);
        const Eigen::Vector3d analytic = point_jacobian(p.a, p.b, p.local_a, p.local_b) * p.velocity();
        EXPECT_LT((difference - analytic).norm(), tolerance * (1 + analytic.norm()));
    });
}

TEST(Reference, DistanceJacobianMatchesFiniteDifferences)
{
    for_every_pair([](const Pair& p) {
        const auto error = [&](const Pair& q) { return distance_error(q.a, q.b, p.local_a, p.local_b, 0.7); };
        const double difference = (error(p.moved(epsilon)) - error(p.moved(-epsilon))) / (2 * epsilon);
        const double analytic = (distance_jacobian(p.a, p.b, p.local_a, p.local_b) * p.velocity())(0);
        EXPECT_NEAR(difference, analytic, tolerance * (1 + std::abs(analytic)));
    });
}

TEST(Reference, FrameJacobiansMatchFiniteDifferencesForEveryCombinationOfLocks)
{
    Random random(9);
    for_every_pair([&](const Pair& p) {
        const auto frame = [&](const Eigen::Vector3d& position) {
            return Frame{position, Eigen::Quaterniond(random.symmetric(), random.symmetric(),
                                                      random.symmetric(), random.symmetric())
                                       .normalized()};
        };
        const Frame a = frame(p.local_a), b = frame(p.local_b);
        for (int linear = 0; linear <= 3; ++linear) {
            for (int angular = 0; angular <= 3; ++angular) {
                if (linear + angular == 0) continue;
                const auto locks =
                    std::pair{static_cast<LinearLock>(linear), static_cast<AngularLock>(angular)};
                const auto error = [&](const Pair& q) -> Eigen::VectorXd {
                    return frame_error(q.a, q.b, a, b, locks.first, locks.second);
                };
                Eigen::VectorXd difference =
                    (error(p.moved(epsilon)) - error(p.moved(-epsilon))) / (2 * epsilon);
                // The Jacobian of a locked point gives the derivative of C in a frame that turns with the mean of
                // both spins.
                if (locks.first == LinearLock::point) {
                    const Eigen::Vector3d spin = (p.a.velocity.tail<3>() + p.b.velocity.tail<3>()) / 2;
                    difference.head<3>() -= spin.cross(point_error(p.a, p.b, a.position, b.position));
                }
                const Eigen::VectorXd analytic =
                    frame_jacobian(p.a, p.b, a, b, locks.first, locks.second) * p.velocity();
                EXPECT_LT((difference - analytic).norm(), tolerance * (1 + analytic.norm()))
                    << linear << " linear and " << angular << " angular rows";
            }
        }
    });
}

TEST(Reference, DriveJacobiansMatchFiniteDifferencesAlongMotionsThatTheirJointsAllow)
{
    // Both bodies turn about one axis, as a hinge allows: only then does the Jacobian give the derivative of the
    // twist.
    Random random(10);
    for_every_pair([&](const Pair& p) {
        const Frame a{p.local_a, Eigen::Quaterniond(random.symmetric(), random.symmetric(),
                                                    random.symmetric(), random.symmetric())
                                     .normalized()};
        const Eigen::Quaterniond world_a = p.a.orientation * a.rotation;
        const double angle = 2.5 * random.symmetric();
        const Frame b{p.local_b, p.b.orientation.conjugate() * world_a *
                                     Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX())};
        Pair hinged = p;
        hinged.b.velocity.tail<3>() = p.a.velocity.tail<3>() + 1.3 * (world_a * Eigen::Vector3d::UnitX());
        for (const DriveAxis axis : {DriveAxis::slide, DriveAxis::twist}) {
            const auto value = [&](const Pair& q) { return drive_value(q.a, q.b, a, b, axis); };
            const double difference =
                (value(hinged.moved(epsilon)) - value(hinged.moved(-epsilon))) / (2 * epsilon);
            const double analytic = (drive_jacobian(hinged.a, hinged.b, a, b, axis) * hinged.velocity())(0);
            EXPECT_NEAR(difference, analytic, tolerance * (1 + std::abs(analytic)));
            if (axis == DriveAxis::twist) {
                EXPECT_NEAR(value(hinged), angle, 1e-12);
            }
        }
    });
}

TEST(Reference, EulerAnglesAreThoseOfThreeHingesAndTheirRowsMatchFiniteDifferences)
{
    using Eigen::AngleAxisd, Eigen::Vector3d;
    Random random(12);
    for_every_pair([&](const Pair& p) {
        const Eigen::Quaterniond in_a(
            Eigen::Quaterniond(random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric())
                .normalized());
        const Vector3d angles(3 * random.symmetric(), 1.4 * random.symmetric(), 3 * random.symmetric());
        const Eigen::Quaterniond three_hinges = AngleAxisd(angles.x(), Vector3d::UnitX()) *
                                                AngleAxisd(angles.y(), Vector3d::UnitY()) *
                                                AngleAxisd(angles.z(), Vector3d::UnitZ());
        const Frame a{p.local_a, in_a},
            b{p.local_b, p.b.orientation.conjugate() * (p.a.orientation * in_a * three_hinges)};
        for (const EulerAngle angle : {EulerAngle::x, EulerAngle::y, EulerAngle::z}) {
            const auto value = [&](const Pair& q) {
                return drive_value(q.a, q.b, a, b, DriveAxis::euler, angle);
            };
            EXPECT_NEAR(value(p), angles(static_cast<int>(angle)), 1e-10);
            const double difference = (value(p.moved(epsilon)) - value(p.moved(-epsilon))) / (2 * epsilon);
            const double analytic =
                (drive_jacobian(p.a, p.b, a, b, DriveAxis::euler, angle) * p.velocity())(0);
            EXPECT_NEAR(difference, analytic,
                        tolerance * (1 + std::abs(analytic)) / std::pow(std::cos(angles.y()), 2));
        }
    });
}

TEST(Reference, SwingJacobianMatchesFiniteDifferences)
{
    Random random(11);
    for_every_pair([&](const Pair& p) {
        const auto frame = [&] {
            return Frame{Eigen::Vector3d::Zero(), Eigen::Quaterniond(random.symmetric(), random.symmetric(),
                                                                     random.symmetric(), random.symmetric())
                                                      .normalized()};
        };
        const Frame a = frame(), b = frame();
        const double angle = swing_angle(p.a, p.b, a, b);
        if (angle < 0.05 || angle > 3.1) return;  // at 0 and pi a swing has no direction
        const double difference = (swing_angle(p.moved(epsilon).a, p.moved(epsilon).b, a, b) -
                                   swing_angle(p.moved(-epsilon).a, p.moved(-epsilon).b, a, b)) /
                                  (2 * epsilon);
        const double analytic = (swing_jacobian(p.a, p.b, a, b) * p.velocity())(0);
        EXPECT_NEAR(difference, analytic, tolerance * (1 + std::abs(analytic)) / std::sin(angle));
    });
}

TEST(Reference, ContactRowsMatchFiniteDifferencesOfTheGapBetweenMaterialPoints)
{
    for_every_pair([](const Pair& p) {
        const Eigen::Vector3d n = Eigen::Vector3d(0.6, -0.48, 0.64).normalized();
        const Eigen::Vector3d arm_a = p.a.orientation * p.local_a, arm_b = p.b.orientation * p.local_b;
        for (const Eigen::Vector3d& direction :
             {n, Eigen::Vector3d(n.unitOrthogonal()), Eigen::Vector3d(n.cross(n.unitOrthogonal()))}) {
            const auto gap = [&](const Pair& q) {
                return direction.dot(point_error(q.a, q.b, p.local_a, p.local_b));
            };
            const double difference = (gap(p.moved(epsilon)) - gap(p.moved(-epsilon))) / (2 * epsilon);
            EXPECT_NEAR(difference, (direction_jacobian(direction, arm_a, arm_b) * p.velocity())(0),
                        tolerance * 10);
        }
    });
}

TEST(Reference, EffectiveMassIsSymmetricPositiveAndInvertsWhatCanMove)
{
    for_every_pair([](const Pair& p) {
        const Jacobian j = point_jacobian(p.a, p.b, p.local_a, p.local_b);
        const Eigen::MatrixXd mass = effective_mass(j, p.a, p.b);
        const Eigen::MatrixXd k = j * pair_inverse_mass(p.a, p.b) * j.transpose();
        EXPECT_LT((mass - mass.transpose()).norm(), 1e-9 * (1 + mass.norm()));
        EXPECT_LT((k * mass * k - k).norm(), 1e-9 * (1 + k.norm()));
        EXPECT_GT(mass.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-9);
    });
}

TEST(Reference, APairOfImpulsesConservesMomentumAboutTheCommonPoint)
{
    // J^T lambda of a satisfied joint has no resultant force, and no resultant torque about any point.
    for_every_pair([](Pair p) {
        p.b.position -= point_error(p.a, p.b, p.local_a, p.local_b);
        const Eigen::Matrix<double, 12, 1> f =
            point_jacobian(p.a, p.b, p.local_a, p.local_b).transpose() * Eigen::Vector3d(1, 2, -3);
        const Eigen::Vector3d force = f.segment<3>(0) + f.segment<3>(6);
        const Eigen::Vector3d torque = f.segment<3>(3) + f.segment<3>(9) +
                                       p.a.position.cross(f.segment<3>(0)) +
                                       p.b.position.cross(f.segment<3>(6));
        EXPECT_LT(force.norm(), 1e-12);
        EXPECT_LT(torque.norm(), 1e-12);
    });
}

/// A random matrix of `rows` rows and columns.
Eigen::MatrixXd random_square(motley::testing::Random& random, Eigen::Index rows)
{
    return Eigen::MatrixXd::NullaryExpr(rows, rows,
                                        [&](Eigen::Index, Eigen::Index) { return random.symmetric(); });
}

/// Evidence: Eigen's solvers, which the reference itself does not use.
TEST(Reference, SmallMatricesHaveTheInversesAndModesThatEigenFinds)
{
    motley::testing::Random random;
    for (Eigen::Index rows = 1; rows <= 12; ++rows) {
        for (int k = 0; k < 20; ++k) {
            const Eigen::MatrixXd any = random_square(random, rows);
            Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 12, 12> inverse = any;
            invert_small(inverse);
            const Eigen::MatrixXd expected = any.completeOrthogonalDecomposition().pseudoInverse();
            EXPECT_LT((inverse - expected).norm(), 1e-11 * expected.norm() * any.norm() * expected.norm());

            // Of half the rank: the other values are 0.
            const Eigen::MatrixXd half = any.leftCols((rows + 1) / 2);
            const Eigen::MatrixXd symmetric = half * half.transpose();
            const SymmetricModes<Eigen::MatrixXd> modes(symmetric);
            Eigen::VectorXd values = modes.values;
            std::sort(values.begin(), values.end());
            const Eigen::VectorXd those_of_eigen =
                Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues();
            const double size = symmetric.norm();
            EXPECT_LT((values - those_of_eigen).norm(), 1e-13 * size);
            const Eigen::MatrixXd again =
                modes.vectors * modes.values.asDiagonal() * modes.vectors.transpose();
            EXPECT_LT((again - symmetric).norm(), 1e-13 * size);
            const Eigen::MatrixXd of_eigen = symmetric.completeOrthogonalDecomposition().pseudoInverse();
            EXPECT_LT((symmetric_pseudo_inverse(symmetric) - of_eigen).norm(),
                      1e-11 * of_eigen.norm() * size * of_eigen.norm());
        }
    }
    Eigen::Matrix3d singular = Eigen::Matrix3d::Ones();
    invert_small(singular);
    EXPECT_FALSE(singular.allFinite());
}

}  // namespace
}  // namespace motley::reference
