// Momentum and angular momentum of a chain that floats freely and tumbles. Independent evidence: both are conserved; what
// is lost is bounded by the rounding of floats and, where a method moves bodies without their velocities or turns them
// beneath its impulses, by a bound of first order in the substep.
#include <algorithm>
#include <vector>

#include "mixed_scene.h"
#include "momentum_rounding.h"
#include "rig.h"

namespace motley {
namespace {

using testing::length;
using Vector = Vec3<double>;

struct Momenta {
    Vector linear{}, angular{};                      ///< about the origin
    double linear_squares = 0, angular_squares = 0;  ///< sums over the bodies, for rounding_of_momenta()
};

/// Twelve bodies joined by ball-sockets, after a first very short step that makes their velocities fit the joints.
class Chain {
  public:
    static constexpr int links = 12;
    Scene scene;

    explicit Chain(const SolverSettings& settings) : solver_(settings), settings_(settings.resolved())
    {
        testing::Random random(77);
        for (int i = 0; i < links; ++i) {
            BodyDefinition body;
            body.position = {0.5 * i, 0.2 * random.symmetric(), 0.2 * random.symmetric()};
            body.mass = static_cast<float>(1.5 + random.symmetric());
            const float inertia = 0.4F * body.mass * 0.09F;
            body.inertia = {inertia, 0, 0, inertia, 0, inertia};
            const auto r = [&] { return static_cast<float>(random.symmetric()); };
            body.linear_velocity = {r(), r(), r()};
            body.angular_velocity = {2 * r(), 2 * r(), 2 * r()};
            definitions_.push_back(body);
            bodies_.push_back(scene.add_body(body));
            if (i == 0) continue;
            const std::size_t b = bodies_.size() - 1, a = b - 1;
            const Vec3<float> half =
                convert<float>(0.5 * (definitions_[b].position - definitions_[a].position));
            arms_.push_back(length(convert<double>(half)));
            scene.add_joint(BallSocketDefinition{bodies_[a], bodies_[b], half, -half});
        }
        solver_.step(scene, 1e-6F);
    }
    void step() { ASSERT_EQ(solver_.step(scene, testing::frame_time).status, StepStatus::done); }

    [[nodiscard]] Momenta momenta() const
    {
        Momenta sum;
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const BodyState s = scene.state(bodies_[i]);
            const double mass = definitions_[i].mass, inertia = definitions_[i].inertia.xx;
            const Vector p = mass * convert<double>(s.linear_velocity);
            const Vector spin = inertia * convert<double>(s.angular_velocity);
            sum.linear = sum.linear + p;
            sum.angular = sum.angular + cross(s.position, p) + spin;
            const double turning = length(s.position) * length(p) + length(spin);
            sum.linear_squares += dot(p, p);
            sum.angular_squares += turning * turning;
        }
        return sum;
    }
    /// How often a step stores the velocity of a link.
    [[nodiscard]] double stores() const
    {
        const bool relaxes = settings_.method == Method::soft_step;
        return settings_.substeps *
               testing::stores_of(2, settings_.iterations + (relaxes ? settings_.relaxations : 0));
    }
    /// The most that a step changes L because it projects positions. While bodies turn by h w their arms r end h w r
    /// elsewhere, and the anchors of a joint part by h^2 w^2 r. A projection moves the bodies back by that, as far as the
    /// reduced mass says, past momenta m w r.
    [[nodiscard]] double drift() const
    {
        const double h = static_cast<double>(testing::frame_time) / settings_.substeps;
        double sum = 0;
        for (std::size_t b = 1; b < bodies_.size(); ++b) {
            const double m_a = definitions_[b - 1].mass, m_b = definitions_[b].mass, r = arms_[b - 1],
                         w_a = length(convert<double>(scene.state(bodies_[b - 1]).angular_velocity)),
                         w_b = length(convert<double>(scene.state(bodies_[b]).angular_velocity));
            sum += h * h * m_a * m_b / (m_a + m_b) * (w_a * w_a + w_b * w_b) * r * (w_a + w_b) * r;
        }
        return settings_.substeps * sum;
    }

  private:
    std::vector<BodyDefinition> definitions_;
    std::vector<BodyId> bodies_;
    std::vector<double> arms_;
    Solver solver_;
    SolverSettings settings_;
};

/// Runs a second, and checks that both momenta stay within their bounds.
void expect_kept(const SolverSettings& settings, bool drifts, const char* name)
{
    Chain chain(settings);
    const Momenta before = chain.momenta();
    double drift = 0;
    for (int step = 0; step < 60; ++step) {
        chain.step();
        drift += drifts ? chain.drift() : 0;
    }
    const Momenta after = chain.momenta();
    const double lost_p = length(after.linear - before.linear),
                 lost_l = length(after.angular - before.angular),
                 bound_p = testing::rounding_of_momenta(60 * chain.stores(), before.linear_squares),
                 bound_l = testing::rounding_of_momenta(60 * chain.stores(), before.angular_squares) + drift;
    std::printf("%s: p %.2g (bound %.2g), L %.2g (bound %.2g) of %.2g kg m2/s\n", name, lost_p, bound_p,
                lost_l, bound_l, length(before.angular));
    EXPECT_LT(lost_p, bound_p) << name;
    EXPECT_LT(lost_l, bound_l) << name;
    EXPECT_LT(bound_l, 2e-3 * length(before.angular)) << name << ": the bound binds";
}

TEST(Momentum, OfAFloatingChainChangesByRoundingAlone)
{
    SolverSettings settings;
    settings.relaxations = 0;
    expect_kept(settings, false, "soft_step without relaxation");
    settings.substeps = 1;
    expect_kept(settings, false, "soft_step without relaxation, one substep");
    settings = {};
    expect_kept(settings, false, "soft_step");
    settings.substeps = 16;
    expect_kept(settings, false, "soft_step, 16 substeps");
    settings = {};
    settings.exact_joints = true;
    expect_kept(settings, false, "exact joints");
    settings = {};
    settings.method = Method::direct;
    expect_kept(settings, false, "direct");
    settings.method = Method::sequential_impulse;
    settings.substeps = 1;
    settings.drift_correction = DriftCorrection::none;
    expect_kept(settings, false, "sequential impulses");
    settings.drift_correction = DriftCorrection::baumgarte;
    expect_kept(settings, false, "sequential impulses, Baumgarte");
}

TEST(Momentum, OfAFloatingChainDriftsToFirstOrderWhereArmsAreOld)
{
    SolverSettings settings;
    settings.substeps = 16;
    settings.method = Method::sequential_impulse;
    settings.drift_correction = DriftCorrection::projection;
    expect_kept(settings, true, "sequential impulses, projection");
}

}  // namespace
}  // namespace motley
