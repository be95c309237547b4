// Method::direct where light links bear heavy loads. Independent evidence: conservation of energy, momentum and
// angular momentum; and a chain in angle coordinates, written here, whose joints cannot part.
#include <Eigen/Dense>
#include <array>
#include <cstdio>
#include <numbers>

#include "loaded_chain.h"

namespace motley {
namespace {

using testing::ChainStart;
using testing::frame_time;
using testing::LoadedChain;

constexpr double g = LoadedChain::g, length = LoadedChain::length,
                 inertia_of_unit_mass = LoadedChain::inertia_of_unit_mass;
constexpr int links = LoadedChain::links;

SolverSettings direct(Vec3<float> gravity)
{
    SolverSettings settings = testing::with_gravity(gravity);
    settings.method = Method::direct;
    return settings;
}

TEST(DirectTension, ChainsHoldAnyLoadAndGainNoEnergy)
{
    for (const ChainStart start : {ChainStart::hanging, ChainStart::level}) {
        for (const double load : {1e6, 1e3, 30.0, 1.0}) {
            if (testing::is_sanitized && load < 1e6) break;
            Scene scene;
            LoadedChain chain(scene);
            chain.hang(start, load);
            Solver solver(direct({0, static_cast<float>(-g), 0}));
            const double before = chain.energy(), height = chain.height();
            double separation = 0, gain = -height;
            for (int step = 0; step < testing::long_run(600, 12); ++step) {
                const StepReport report = solver.step(scene, frame_time);
                ASSERT_EQ(report.status, StepStatus::done);
                ASSERT_EQ(report.direct_unsolved, 0) << load << " kg, step " << step;
                separation = std::max(separation, chain.separation());
                gain = std::max(gain, chain.energy() - before);
            }
            std::printf("%g kg, %s: separation %.2g m, energy grows by %.2g of what the fall can give\n",
                        load, name_of(start), separation, gain / height);
            EXPECT_LT(separation, 1e-6) << load;
            EXPECT_LT(gain, 0.01 * height) << load;
        }
    }
}

TEST(DirectTension, FloatingChainsKeepMomentumAndAngularMomentum)
{
    for (const double load : {1.0, 100.0, 1e4}) {
        Scene scene;
        LoadedChain chain(scene);
        chain.set_afloat(load);
        const Vec3<double> before = chain.momenta();
        const double energy = chain.kinetic_energy();
        Solver solver(direct({}));
        double gain = 0;
        for (int step = 0; step < testing::long_run(300); ++step) {
            ASSERT_EQ(solver.step(scene, frame_time).direct_unsolved, 0);
            gain = std::max(gain, chain.kinetic_energy() / energy - 1);
        }
        const Vec3<double> after = chain.momenta();
        // Velocities are stored as floats between steps: half an ulp of 5.5 m/s, 300 times, in either direction.
        const double rounding = 300 * 2.5e-7 * (2 * load + 10);
        EXPECT_NEAR(after.x, before.x, rounding) << load;
        EXPECT_NEAR(after.y, before.y, rounding) << load;
        EXPECT_NEAR(after.z, before.z, 1e-5 * before.z) << load;
        EXPECT_LT(gain, 0.01) << load;
        EXPECT_LT(chain.separation(), 1e-6) << load;
    }
}

/// The same chain in the angles of its links against the horizontal, by Lagrange's equations:
///   sum_k c_ik (cos(q_i - q_k) q_k'' + sin(q_i - q_k) q_k'^2) = -g cos(q_i) s_i.
class AngleChain {
  public:
    using Vector = Eigen::Matrix<double, links, 1>;
    Vector angle = Vector::Zero(), rate = Vector::Zero();

    explicit AngleChain(double load)
    {
        Vector mass = Vector::Ones(), beyond;
        mass(links - 1) = load;
        for (int i = 0; i < links; ++i) {
            beyond(i) = mass.tail(links - 1 - i).sum();
            pull_(i) = length * (mass(i) / 2 + beyond(i));
        }
        for (int i = 0; i < links; ++i) {
            for (int k = 0; k < links; ++k) {
                const int outer = std::max(i, k);
                c_(i, k) = i == k ? mass(i) * (inertia_of_unit_mass + length * length / 4) +
                                        length * length * beyond(i)
                                  : length * length * (mass(outer) / 2 + beyond(outer));
            }
        }
    }
    /// One step of fourth order Runge-Kutta.
    void step(double h)
    {
        const Vector k1 = rate, a1 = acceleration(angle, k1);
        const Vector k2 = rate + h / 2 * a1, a2 = acceleration(angle + h / 2 * k1, k2);
        const Vector k3 = rate + h / 2 * a2, a3 = acceleration(angle + h / 2 * k2, k3);
        const Vector k4 = rate + h * a3, a4 = acceleration(angle + h * k3, k4);
        angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    /// The centre of the load.
    [[nodiscard]] Eigen::Vector2d load() const
    {
        Eigen::Vector2d at = Eigen::Vector2d::Zero();
        for (int i = 0; i < links; ++i)
            at += (i == links - 1 ? length / 2 : length) *
                  Eigen::Vector2d(std::cos(angle(i)), std::sin(angle(i)));
        return at;
    }

  private:
    Eigen::Matrix<double, links, links> c_;
    Vector pull_;

    [[nodiscard]] Vector acceleration(const Vector& q, const Vector& w) const
    {
        Eigen::Matrix<double, links, links> m;
        Vector right;
        for (int i = 0; i < links; ++i) {
            right(i) = -g * std::cos(q(i)) * pull_(i);
            for (int k = 0; k < links; ++k) {
                m(i, k) = c_(i, k) * std::cos(q(i) - q(k));
                right(i) -= c_(i, k) * std::sin(q(i) - q(k)) * w(k) * w(k);
            }
        }
        return m.llt().solve(right);
    }
};

TEST(DirectTension, AFallingLoadGoesTheWayOfAChainInAngles)
{
    for (const double load : {1e3, 1e6}) {
        AngleChain truth(load);
        double most_before = 1e9;
        for (const int substeps : {4, 16}) {
            Scene scene;
            LoadedChain chain(scene);
            chain.hang(ChainStart::level, load);
            truth.angle.setZero();
            truth.rate.setZero();
            SolverSettings settings = direct({0, static_cast<float>(-g), 0});
            settings.substeps = substeps;
            Solver solver(settings);
            double most = 0;
            for (int step = 0; step < testing::long_run(60); ++step) {
                solver.step(scene, frame_time);
                const int fine = 1667;  // substeps of 1e-5 s
                for (int i = 0; i < fine; ++i) truth.step(static_cast<double>(frame_time) / fine);
                const Vec3<double> at = scene.state(chain.bodies.back()).position;
                most = std::max(most, (Eigen::Vector2d(at.x, at.y) - truth.load()).norm());
            }
            std::printf("%g kg falling for a second, %d substeps: %.3g m off\n", load, substeps, most);
            // v += h a, x += h v is ahead by h g t / 2, and what turns loses h w^2 of its energy: both are
            // proportional to h.
            EXPECT_LT(most, 0.2 / substeps);
            EXPECT_LT(most, most_before / 3);
            most_before = most;
        }
    }
}

}  // namespace
}  // namespace motley
