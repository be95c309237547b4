// Free motion. Independent evidence: conservation of angular momentum; Euler's equations of a free body; and the
// Newton-Euler equations of a figure with the forces in its joints, integrated here by fourth order Runge-Kutta.
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "rig.h"

namespace motley {
namespace {

using Vector = Vec3<double>;
using testing::angular_momentum;
using testing::length;

/// A chain of boxes that turn relative to each other.
struct FloatingChain {
    Scene scene;
    std::vector<BodyId> bodies;
    static constexpr int count = 16;
    static constexpr double mass = 1.5;
    static constexpr Vec3<float> moments{0.01F, 0.03F, 0.025F};

    enum class Ties { ball_sockets, hinges, fixed_joints, rods, springs };

    explicit FloatingChain(Ties ties = Ties::ball_sockets)
    {
        for (int i = 0; i < count; ++i) {
            BodyDefinition body;
            body.position = {0.4 * i, 0, 0};
            body.mass = static_cast<float>(mass);
            body.inertia = {moments.x, 0, 0, moments.y, 0, moments.z};
            bodies.push_back(scene.add_body(body));
        }
        for (int i = 1; i < count; ++i) {
            const BodyId a = bodies[static_cast<std::size_t>(i) - 1], b = bodies[static_cast<std::size_t>(i)];
            switch (ties) {
                case Ties::ball_sockets:
                    scene.add_joint(BallSocketDefinition{a, b, {0.2F, 0, 0}, {-0.2F, 0, 0}});
                    break;
                case Ties::hinges:
                    scene.add_joint(between_frames<HingeDefinition>(a, b));
                    break;
                case Ties::fixed_joints:
                    scene.add_joint(between_frames<FixedDefinition>(a, b));
                    break;
                case Ties::rods:
                case Ties::springs:
                    scene.add_joint(between_points(a, b, ties == Ties::springs));
                    break;
            }
        }
        // The whole figure turns about z, and each body also spins about the line of the chain.
        for (int i = 0; i < count; ++i) {
            const double x = 0.4 * i;
            scene.set_velocity(bodies[static_cast<std::size_t>(i)], {1, static_cast<float>(2 * x), 0.5F},
                               {0.3F, 0, 2});
        }
    }
    /// Hinges turn about z.
    template <class Definition>
    static Definition between_frames(BodyId a, BodyId b)
    {
        const Quat<float> turned = testing::axis_along(2);
        return {a, b, {{0.2F, 0, 0}, turned}, {{-0.2F, 0, 0}, turned}};
    }
    static DistanceDefinition between_points(BodyId a, BodyId b, bool is_spring)
    {
        DistanceDefinition joint{a, b, {0.1F, 0.05F, 0}, {-0.1F, 0, 0.05F}};
        joint.min_length = joint.max_length = joint.rest_length = std::sqrt(0.2F * 0.2F + 2 * 0.05F * 0.05F);
        if (is_spring) {
            joint.min_length = 0;
            joint.max_length = std::numeric_limits<float>::infinity();
            joint.spring_hertz = 3;
        }
        return joint;
    }
    [[nodiscard]] Vector centre() const
    {
        Vector sum{};
        for (const BodyId body : bodies) sum = sum + scene.state(body).position;
        return 1.0 / static_cast<double>(bodies.size()) * sum;
    }
    /// Angular momentum about the centre of mass.
    [[nodiscard]] Vector spin_about_centre() const
    {
        const Vector middle = centre();
        Vector sum{};
        for (const BodyId body : bodies)
            sum = sum + angular_momentum(scene.state(body), mass, convert<double>(moments), middle);
        return sum;
    }
};

/// The spin, in the body's frame, and the orientation after a time of a body with these principal moments.
struct Tumbling {
    Vector inertia, spin;
    Quat<double> turned{0, 0, 0, 1};

    [[nodiscard]] std::array<double, 7> rate(const std::array<double, 7>& s) const
    {
        const Vector w{s[0], s[1], s[2]};
        return {
            (inertia.y - inertia.z) * w.y * w.z / inertia.x, (inertia.z - inertia.x) * w.z * w.x / inertia.y,
            (inertia.x - inertia.y) * w.x * w.y / inertia.z, 0.5 * (s[6] * w.x + s[4] * w.z - s[5] * w.y),
            0.5 * (s[6] * w.y + s[5] * w.x - s[3] * w.z),    0.5 * (s[6] * w.z + s[3] * w.y - s[4] * w.x),
            -0.5 * (s[3] * w.x + s[4] * w.y + s[5] * w.z)};
    }
    void advance(double seconds)
    {
        constexpr int steps = 20000;
        const double h = seconds / steps;
        std::array<double, 7> s{spin.x, spin.y, spin.z, turned.x, turned.y, turned.z, turned.w};
        const auto plus = [](std::array<double, 7> x, double k, const std::array<double, 7>& d) {
            for (std::size_t i = 0; i < 7; ++i) x[i] += k * d[i];
            return x;
        };
        for (int i = 0; i < steps; ++i) {
            const auto k1 = rate(s), k2 = rate(plus(s, h / 2, k1)), k3 = rate(plus(s, h / 2, k2)),
                       k4 = rate(plus(s, h, k3));
            for (std::size_t j = 0; j < 7; ++j) s[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
        }
        spin = {s[0], s[1], s[2]};
        turned = {s[3], s[4], s[5], s[6]};
    }
};

/// The angle between a body after 2 s and the true orientation, rad, and the shares of angular momentum and energy
/// that it lost.
struct Lost {
    double angle, angular_momentum, energy;
};
Lost after_tumbling(Method method, int substeps)
{
    const Vec3<float> moments{1, 2, 2.7F}, spin{1.2F, 3.6F, 1.3F};
    Scene scene;
    BodyDefinition body;
    body.inertia = {moments.x, 0, 0, moments.y, 0, moments.z};
    body.angular_velocity = spin;
    const BodyId id = scene.add_body(body);
    SolverSettings settings;
    settings.method = method;
    settings.substeps = substeps;
    Solver solver(settings);
    for (int i = 0; i < 120; ++i) solver.step(scene, 1.0F / 60);
    Tumbling truth{convert<double>(moments), convert<double>(spin)};
    const Vector start{truth.inertia.x * truth.spin.x, truth.inertia.y * truth.spin.y,
                       truth.inertia.z * truth.spin.z};
    truth.advance(120 * static_cast<double>(1.0F / 60));
    const Quat<double> q = scene.state(id).orientation, &r = truth.turned;
    const double along = q.x * r.x + q.y * r.y + q.z * r.z + q.w * r.w;
    const Vector l = angular_momentum(scene.state(id), static_cast<double>(body.mass), truth.inertia);
    const double energy = dot(start, convert<double>(spin));
    return {2 * std::acos(std::min(1.0, std::abs(along))), length(l - start) / length(start),
            std::abs(dot(l, convert<double>(scene.state(id).angular_velocity)) - energy) / energy};
}

/// Thin bodies precess many times as fast as they tumble. Nothing acts on them, so their energy stays.
TEST(FreeTumbling, GivesAThinBodyNoEnergy)
{
    for (const int substeps : {1, 4}) {
        for (const float speed : {4.0F, 20.0F, 50.0F, 100.0F}) {
            for (const float thinness : {0.1F, 0.02F, 0.004F}) {
                for (int spin = 0; spin < testing::repeats(16); ++spin) {
                    const double turn = 0.1 + 0.2 * spin;
                    Scene scene;
                    BodyDefinition body;
                    body.inertia = {0.1F * thinness, 0, 0, 0.1F, 0, 0.1F};
                    body.angular_velocity = {speed * static_cast<float>(std::cos(turn)), 0,
                                             speed * static_cast<float>(std::sin(turn))};
                    scene.add_body(body);
                    const double at_start = scene.errors().kinetic_energy;
                    SolverSettings settings;
                    settings.substeps = substeps;
                    Solver solver(settings);
                    double most = 0;
                    for (int step = 0; step < 600; ++step) {
                        solver.step(scene, 1.0F / 60);
                        most = std::max(most, scene.errors().kinetic_energy);
                    }
                    EXPECT_LT(most, 1.03 * at_start)
                        << substeps << " " << speed << " " << thinness << " " << turn;
                }
            }
        }
    }
}

TEST(FreeTumbling, KeepsItsAngularMomentumAndTurnsToSecondOrder)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        double before = 0;
        for (const int substeps : {1, 2, 4, 8}) {
            const Lost lost = after_tumbling(method, substeps);
            std::printf("method %d, %d substeps: %.2g rad, L %.2g, energy %.2g\n", static_cast<int>(method),
                        substeps, lost.angle, lost.angular_momentum, lost.energy);
            EXPECT_LT(lost.angular_momentum, 1e-5);
            EXPECT_LT(lost.energy, 0.02 / (substeps * substeps));
            // Rounding of floats adds 5e-5 rad in so many substeps.
            if (substeps > 1) {
                EXPECT_LT(lost.angle, before / 3.5 + (method == Method::direct ? 0 : 5e-5));
            }
            before = lost.angle;
        }
    }
}

/// The share of its angular momentum that a figure loses in a second of flight.
double lost_in_flight(FloatingChain::Ties ties, const SolverSettings& settings)
{
    FloatingChain figure(ties);
    Solver solver(settings);
    EXPECT_EQ(solver.step(figure.scene, 1e-6F).status, StepStatus::done);
    const Vector start = figure.spin_about_centre();
    for (int i = 0; i < 60; ++i) solver.step(figure.scene, 1.0F / 60);
    const double lost = length(figure.spin_about_centre() - start) / length(start);
    std::printf("ties %d, exact %d, %d substeps, %d relaxations: %.2g of L\n", static_cast<int>(ties),
                settings.exact_joints, settings.substeps, settings.relaxations, lost);
    return lost;
}

TEST(FreeFigure, KeepsItsAngularMomentum)
{
    for (const bool exact : {false, true}) {
        for (const int relaxations : {0, 1}) {
            SolverSettings settings;
            settings.exact_joints = exact;
            settings.relaxations = relaxations;
            EXPECT_LT(lost_in_flight(FloatingChain::Ties::ball_sockets, settings), 1e-6)
                << exact << relaxations;
        }
    }
}

/// Relaxation acts after the bodies have moved. Its impulses must act at one point of both bodies, or along the line between two,
/// all the same.
TEST(FreeFigure, KeepsItsAngularMomentumWithEveryLockOfAPointAndPullAlongALine)
{
    using enum FloatingChain::Ties;
    for (const FloatingChain::Ties ties : {ball_sockets, hinges, fixed_joints, rods, springs}) {
        for (const int substeps : {1, 4, 16}) {
            for (const int relaxations : {1, 3}) {
                SolverSettings settings;
                settings.substeps = substeps;
                settings.relaxations = relaxations;
                EXPECT_LT(lost_in_flight(ties, settings), substeps == 1 ? 1e-4 : 2e-5)
                    << static_cast<int>(ties);
            }
        }
    }
}

/// The same figure, computed from the forces in its joints: those that keep coincident anchors together, given the
/// accelerations of both bodies (Newton and Euler). Integrated by fourth order Runge-Kutta in steps of 0.25 ms.
class FloatingChainByForces {
  public:
    explicit FloatingChainByForces(const FloatingChain& figure)
    {
        for (const BodyId id : figure.bodies) {
            const BodyState state = figure.scene.state(id);
            const Quat<double>& q = state.orientation;
            const Vector &x = state.position, v = convert<double>(state.linear_velocity),
                         w = convert<double>(state.angular_velocity);
            bodies_.push_back({{x.x, x.y, x.z}, {v.x, v.y, v.z}, {w.x, w.y, w.z}, {q.w, q.x, q.y, q.z}});
        }
    }
    void advance(double seconds)
    {
        const auto steps = static_cast<int>(seconds / 2.5e-4) + 1;
        const double h = seconds / steps;
        for (int i = 0; i < steps; ++i) {
            const Bodies k1 = rate(bodies_), k2 = rate(plus(bodies_, h / 2, k1)),
                         k3 = rate(plus(bodies_, h / 2, k2)), k4 = rate(plus(bodies_, h, k3));
            bodies_ = plus(plus(plus(plus(bodies_, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
        }
    }
    [[nodiscard]] Eigen::Quaterniond orientation(std::size_t i) const
    {
        const Eigen::Vector4d& q = bodies_[i].turned;
        return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
    }

  private:
    using Vector3 = Eigen::Vector3d;
    using Matrix3 = Eigen::Matrix3d;
    struct Motion {
        Vector3 position, velocity, spin;
        Eigen::Vector4d turned;  ///< w, x, y, z
    };
    using Bodies = std::vector<Motion>;

    static Bodies plus(Bodies x, double k, const Bodies& d)
    {
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i].position += k * d[i].position;
            x[i].velocity += k * d[i].velocity;
            x[i].spin += k * d[i].spin;
            x[i].turned += k * d[i].turned;
        }
        return x;
    }
    /// The matrix of u -> lever x u.
    static Matrix3 crossed(const Vector3& lever)
    {
        Matrix3 m;
        m << 0, -lever.z(), lever.y(), lever.z(), 0, -lever.x(), -lever.y(), lever.x(), 0;
        return m;
    }
    static Bodies rate(const Bodies& x)
    {
        const std::size_t count = x.size();
        const Vec3<double> i0 = convert<double>(FloatingChain::moments);
        const Vector3 moments(i0.x, i0.y, i0.z);
        const Vector3 anchor(static_cast<double>(0.2F), 0, 0);
        std::vector<Matrix3> inverse(count);
        std::vector<Vector3> lever(count), gyration(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Eigen::Vector4d& q = x[i].turned;
            const Matrix3 turn = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
            inverse[i] = turn * moments.cwiseInverse().asDiagonal() * turn.transpose();
            const Vector3 momentum = turn * moments.asDiagonal() * turn.transpose() * x[i].spin;
            gyration[i] = -(inverse[i] * x[i].spin.cross(momentum));
            lever[i] = turn * anchor;
        }
        // The acceleration of body i at its end on `side`: without forces, and in response to forces at an end.
        const auto alone = [&](std::size_t i, double side) -> Vector3 {
            const Vector3 r = side * lever[i];
            return gyration[i].cross(r) + x[i].spin.cross(x[i].spin.cross(r));
        };
        const auto response = [&](std::size_t i, double to, double from) -> Matrix3 {
            return Matrix3::Identity() / FloatingChain::mass -
                   crossed(to * lever[i]) * inverse[i] * crossed(from * lever[i]);
        };
        // Joint i pulls body i by f_i at its far end and body i + 1 by -f_i: a block tridiagonal system, eliminated
        // from its first block on.
        std::vector<Matrix3> diagonal(count - 1);
        std::vector<Vector3> force(count - 1);
        for (std::size_t i = 0; i + 1 < count; ++i) {
            diagonal[i] = response(i, 1, 1) + response(i + 1, -1, -1);
            force[i] = alone(i + 1, -1) - alone(i, 1);
            if (i == 0) continue;
            const Matrix3 share = -response(i, 1, -1) * diagonal[i - 1].inverse();
            diagonal[i] += share * response(i, -1, 1);
            force[i] -= share * force[i - 1];
        }
        for (std::size_t i = count - 1; i-- > 0;) {
            if (i + 2 < count) force[i] += response(i + 1, -1, 1) * force[i + 1];
            force[i] = diagonal[i].inverse() * force[i];
        }
        Bodies rates(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vector3 none = Vector3::Zero();
            const Vector3 far = i + 1 < count ? force[i] : none, near = i > 0 ? Vector3(-force[i - 1]) : none;
            const Vector3& w = x[i].spin;
            const Eigen::Vector4d& q = x[i].turned;
            rates[i].position = x[i].velocity;
            rates[i].velocity = (far + near) / FloatingChain::mass;
            rates[i].spin = gyration[i] + inverse[i] * (lever[i].cross(far) - lever[i].cross(near));
            const Vector3 v(q[1], q[2], q[3]);
            const Vector3 turning = 0.5 * (q[0] * w + w.cross(v));
            rates[i].turned << -0.5 * w.dot(v), turning;
        }
        return rates;
    }

    Bodies bodies_;
};

/// The rms angle in rad between the bodies of a figure after a second of flight and their true orientations.
double after_a_flight(bool exact, int substeps)
{
    FloatingChain figure;
    SolverSettings settings;
    settings.exact_joints = exact;
    // A first, very short step removes what velocity error the joints have before the flight.
    settings.substeps = 1;
    Solver(settings).step(figure.scene, 1e-6F);
    FloatingChainByForces truth(figure);
    settings.substeps = substeps;
    Solver solver(settings);
    for (int i = 0; i < 60; ++i) solver.step(figure.scene, 1.0F / 60);
    truth.advance(60 * static_cast<double>(1.0F / 60));
    double sum = 0;
    for (std::size_t i = 0; i < figure.bodies.size(); ++i) {
        const Quat<double> q = figure.scene.state(figure.bodies[i]).orientation;
        const double angle = truth.orientation(i).angularDistance(Eigen::Quaterniond(q.w, q.x, q.y, q.z));
        sum += angle * angle;
    }
    return std::sqrt(sum / static_cast<double>(figure.bodies.size()));
}

TEST(FreeFigure, TurnsAsTheForcesInItsJointsSay)
{
    for (const bool exact : {false, true}) {
        double before = 0;
        for (const int substeps : {1, 2, 4, 8, 16, 32}) {
            if (testing::is_sanitized && substeps > 2) break;
            const double angle = after_a_flight(exact, substeps);
            std::printf("exact %d, %d substeps: %.2g rad\n", exact, substeps, angle);
            if (substeps == 4) {
                EXPECT_LT(angle, exact ? 1e-3 : 0.01);
            }
            // Both are of second order, up to the rounding of floats.
            if (substeps > 1) {
                EXPECT_LT(angle, before / (exact ? 3.5 : 3.2) + 2e-5);
            }
            before = angle;
        }
    }
}

}  // namespace
}  // namespace motley
