// Contacts and joints report what they did over the whole step. Independent evidence: Newton's second law. The change
// of a body's momentum, without that by its weight and the host's force, is the sum of what its contacts and joints
// report. No formula of a constraint is used here.
#include <cstdio>

#include "joint_scene.h"
#include "lattice_crowd.h"
#include "rig.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::frame_time;
using testing::length;
using Vector = Vec3<double>;

constexpr Vec3<float> gravity{0.5F, -9.81F, 0.3F};

SolverSettings soft(int substeps, int iterations = 2)
{
    SolverSettings settings = testing::with_gravity(gravity);
    settings.substeps = substeps;
    settings.iterations = iterations;
    return settings;
}
SolverSettings iterative(int substeps, DriftCorrection correction)
{
    SolverSettings settings = soft(substeps, 5);
    settings.method = Method::sequential_impulse;
    settings.drift_correction = correction;
    return settings;
}
SolverSettings exact(int substeps)
{
    SolverSettings settings = soft(substeps);
    settings.exact_joints = true;
    return settings;
}
SolverSettings direct(int substeps)
{
    SolverSettings settings = soft(substeps);
    settings.method = Method::direct;
    settings.drift_correction = DriftCorrection::projection;
    return settings;
}
/// Settings with a tolerance, so that some blocks end earlier than others.
SolverSettings tolerant(int substeps)
{
    SolverSettings settings = soft(substeps, 30);
    settings.tolerance = 1e-3F;
    return settings;
}

/// The reported impulses on the bodies of a scene in a step, by slot, and the change of each body's momentum.
class Ledger {
  public:
    Ledger(const Scene& scene, std::span<const BodyId> bodies) : scene_(scene)
    {
        for (const BodyId body : bodies) {
            if (scene.motion(body) != BodyMotion::dynamic_body) continue;
            Account account{body, 1 / static_cast<double>(core_of(scene).bodies.inverse_masses[body.slot])};
            account.before = convert<double>(scene.state(body).linear_velocity);
            accounts_.push_back(account);
        }
        by_slot_.resize(core_of(scene).bodies.slot_count());
    }
    void note(BodyId body, Vector push)
    {
        if (scene_.model(body) == BodyModel::planar) push.z = 0;
        by_slot_[body.slot].sum = by_slot_[body.slot].sum + push;
        by_slot_[body.slot].size += length(push);
    }
    void note_contacts(std::span<const Contact> contacts, std::span<const ContactImpulse> impulses)
    {
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const Vector push =
                static_cast<double>(impulses[i].normal) * convert<double>(contacts[i].normal) +
                convert<double>(impulses[i].friction);
            note(contacts[i].body_b, push);
            note(contacts[i].body_a, -push);
        }
    }
    /// For pulleys and racks only the impulse on b is reported.
    void note_joints()
    {
        core_of(scene_).joints->for_each([&](const auto& store, int) {
            using Definition = typename std::remove_cvref_t<decltype(store)>::Type::Definition;
            for (std::size_t i = 0; i < store.size(); ++i) {
                const std::uint32_t slot = store.slots[i];
                const ConstraintId id{slot, core_of(scene_).joints->slots[slot].generation};
                const Vector push =
                    static_cast<double>(frame_time) * convert<double>(scene_.joint_report(id).force);
                note(store.definitions[i].body_b, push);
                if (testing::JointCases<Definition>::keeps == testing::Keeps::nothing) {
                    by_slot_[store.definitions[i].body_a.slot].is_complete = false;
                } else {
                    note(store.definitions[i].body_a, -push);
                }
            }
        });
    }
    /// The largest difference between m (v1 - v0 - g dt) and the noted impulses, over m |v| and the sum of the noted
    /// impulses' sizes.
    [[nodiscard]] double difference() const
    {
        double most = 0;
        for (const Account& account : accounts_) {
            const Noted& noted = by_slot_[account.body.slot];
            if (!noted.is_complete) continue;
            Vector g = convert<double>(gravity);
            if (scene_.model(account.body) == BodyModel::planar) g.z = 0;
            const Vector now = convert<double>(scene_.state(account.body).linear_velocity);
            const Vector gained = account.mass * (now - account.before - static_cast<double>(frame_time) * g);
            const double size = account.mass * (length(now) + length(account.before)) + noted.size;
            most = std::max(most, length(gained - noted.sum) / size);
        }
        return most;
    }

  private:
    struct Account {
        BodyId body;
        double mass;
        Vector before{};
    };
    struct Noted {
        Vector sum{};
        double size = 0;
        bool is_complete = true;
    };
    const Scene& scene_;
    std::vector<Account> accounts_;
    std::vector<Noted> by_slot_;
};

// Bound: velocities are floats that change a hundred times in a step.
constexpr double rounding = 1e-5;

struct Case {
    const char* name;
    SolverSettings settings;
    friend void PrintTo(const Case& given, std::ostream* out) { *out << given.name; }
};
const Case cases[] = {
    {"one_substep", soft(1)},
    {"default", soft(4)},
    {"many_substeps", soft(16)},
    {"without_relaxation",
     [] {
         SolverSettings settings = soft(4);
         settings.relaxations = 0;
         return settings;
     }()},
    {"tolerant", tolerant(4)},
    {"measured",
     [] {
         SolverSettings settings = soft(4);
         settings.measures = true;
         return settings;
     }()},
    {"sweeps", iterative(1, DriftCorrection::baumgarte)},
    {"projection", iterative(3, DriftCorrection::projection)},
    {"exact", exact(4)},
    {"exact_without_relaxation",
     [] {
         SolverSettings settings = exact(4);
         settings.relaxations = 0;
         return settings;
     }()},
    {"exact_sweeps",
     [] {
         SolverSettings settings = iterative(3, DriftCorrection::baumgarte);
         settings.exact_joints = true;
         return settings;
     }()},
    {"direct", direct(3)},
};

class ImpulsesOfAStep : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Settings, ImpulsesOfAStep, ::testing::ValuesIn(cases),
                         [](const auto& given) { return std::string(given.param.name); });

TEST_P(ImpulsesOfAStep, OfEveryJointChangeTheMomentumOfItsBodies)
{
    testing::JointScene joints;
    Solver solver(GetParam().settings);
    // Joints begin 2 cm off. Correcting that makes high speeds that come and go within a substep and leave rounding
    // errors, so these steps are not counted.
    testing::run(joints.scene, solver, 0.1);
    const int steps = GetParam().settings.method == Method::direct ? 2 : 12;
    double most = 0;
    for (int step = 0; step < steps; ++step) {
        Ledger ledger(joints.scene, joints.bodies);
        ASSERT_EQ(solver.step(joints.scene, frame_time).status, StepStatus::done);
        ledger.note_joints();
        most = std::max(most, ledger.difference());
    }
    std::printf("%-26s %.2g\n", GetParam().name, most);
    EXPECT_LT(most, rounding);
}

TEST_P(ImpulsesOfAStep, OfContactsAndJointsTogetherChangeMomenta)
{
    testing::MixedScene mixed(GetParam().settings.method == Method::direct ? 6 : 20);
    Solver solver(GetParam().settings);
    const int steps = GetParam().settings.method == Method::direct ? 20 : 90;
    double most = 0, of_last_substep = 0;
    for (int step = 0; step < steps; ++step) {
        Ledger ledger(mixed.scene, mixed.balls), last(mixed.scene, mixed.balls);
        const std::vector<Contact>& contacts = mixed.contacts();
        ASSERT_EQ(solver.step(mixed.scene, frame_time, contacts).status, StepStatus::done);
        ledger.note_contacts(contacts, mixed.scene.contact_impulses());
        ledger.note_joints();
        last.note_contacts(contacts, mixed.scene.last_substep_impulses());
        last.note_joints();
        most = std::max(most, ledger.difference());
        of_last_substep = std::max(of_last_substep, last.difference());
    }
    std::printf("%-26s %.2g, by the last substep %.2g\n", GetParam().name, most, of_last_substep);
    EXPECT_LT(most, rounding);
    // The measure must be able to tell the two apart.
    if (GetParam().settings.substeps > 1) {
        EXPECT_GT(of_last_substep, 0.05);
    }
}

/// A mobile that hangs on the world: a tree of all types of locks with loops, whose body a is in turn the nearer and
/// the farther one, with a motor, a limit and a spring that are not part of the tree.
struct Mobile {
    Scene scene;
    std::vector<BodyId> bodies;

    Mobile()
    {
        testing::Random random(5);
        const auto r = [&] { return static_cast<float>(random.symmetric()); };
        for (int i = 0; i < 12; ++i) {
            BodyDefinition body =
                testing::box({0.5 * (i % 4), -0.6 * (i / 4), 0.1 * (i % 3)}, 1 + 0.8F * r());
            body.linear_velocity = {r(), r(), r()};
            body.angular_velocity = {r(), r(), r()};
            bodies.push_back(scene.add_body(body));
        }
        tie<BallSocketDefinition>(-1, 0);
        for (int i = 1; i < 12; ++i) {
            const int on = i % 4 == 0 ? i - 4 : i - 1;
            const int near = i % 3 == 0 ? i : on, far = i % 3 == 0 ? on : i;
            switch (i % 6) {
                case 0:
                    tie<FixedDefinition>(near, far);
                    break;
                case 1:
                    tie<HingeDefinition>(near, far);
                    break;
                case 2:
                    tie<SliderDefinition>(near, far);
                    break;
                case 3:
                    tie<PointOnLineDefinition>(near, far);
                    break;
                case 4:
                    tie<ParallelAxesDefinition>(near, far);
                    tie<BallSocketDefinition>(near, far);
                    break;
                default:
                    tie<BallSocketDefinition>(near, far);
            }
        }
        tie<BallSocketDefinition>(3, 7);
        tie<PointOnPlaneDefinition>(-1, 11);
        tie<PointServoDefinition>(2, 9);
        tie<SwingLimitDefinition>(5, 10);
    }
    template <class Definition>
    void tie(int a, int b)
    {
        const auto body = [&](int i) { return i < 0 ? scene.ground() : bodies[static_cast<std::size_t>(i)]; };
        const Vector at = 0.5 * (scene.state(body(a)).position + scene.state(body(b)).position);
        const auto arm = [&](int i) { return convert<float>(at - scene.state(body(i)).position); };
        Definition joint{};
        joint.body_a = body(a);
        joint.body_b = body(b);
        if constexpr (requires { joint.frame_a; }) {
            joint.frame_a = {arm(a), testing::axis_along(1)};
            joint.frame_b = {arm(b), testing::axis_along(1)};
        } else {
            joint.local_anchor_a = arm(a);
            joint.local_anchor_b = arm(b);
        }
        scene.add_joint(joint);
    }
};

TEST_P(ImpulsesOfAStep, OfAMobileThatSomethingTouchesOrNot)
{
    if (GetParam().settings.method == Method::direct)
        GTEST_SKIP() << "loops that stretch are projected for long";
    for (const bool is_touched : {false, true}) {
        Mobile mobile;
        Solver solver(GetParam().settings);
        double most = 0;
        for (int step = 0; step < 60; ++step) {
            std::vector<Contact> contacts;
            if (is_touched) {
                Contact& floor = contacts.emplace_back();
                floor.body_a = mobile.scene.ground();
                floor.body_b = mobile.bodies[11];
                floor.key = 1;
                floor.normal = {0, 1, 0};
                const Vector at = mobile.scene.state(mobile.bodies[11]).position;
                floor.separation = static_cast<float>(at.y + 1.3);
                floor.arm_a = convert<float>(at);
                floor.friction = 0.5F;
            }
            Ledger ledger(mobile.scene, mobile.bodies);
            ASSERT_EQ(solver.step(mobile.scene, frame_time, contacts).status, StepStatus::done);
            ledger.note_contacts(contacts, mobile.scene.contact_impulses());
            ledger.note_joints();
            most = std::max(most, ledger.difference());
        }
        std::printf("%-26s %.2g\n", GetParam().name, most);
        EXPECT_LT(most, rounding) << (is_touched ? "touched" : "alone");
    }
}

TEST(ImpulsesOfAStep, OfACrowdInPatches)
{
    for (const SolverSettings& settings : {soft(4), soft(8, 1), tolerant(2)}) {
        if (testing::is_sanitized && settings.substeps != 4) continue;
        testing::LatticeCrowd crowd;
        Solver solver(settings);
        for (int step = 0; step < testing::repeats(4); ++step) {
            const std::vector<Contact> contacts = crowd.contacts();
            Ledger ledger(crowd.scene, crowd.bodies);
            ASSERT_EQ(solver.step(crowd.scene, frame_time, contacts).status, StepStatus::done);
            ledger.note_contacts(contacts, crowd.scene.contact_impulses());
            EXPECT_LT(ledger.difference(), rounding);
        }
    }
}

/// Loads read in bulk against sums over what each contact reports.
TEST(ImpulsesOfAStep, AreReadInBulk)
{
    testing::MixedScene mixed;
    Solver solver(soft(8));
    std::vector<BodyId> bodies = mixed.balls;
    bodies.push_back(mixed.scene.ground());
    bodies.push_back(mixed.paddle);
    const std::vector<float> circumferences(bodies.size(), 0.5F);
    std::vector<BodyLoad> loads(bodies.size());
    for (int step = 0; step < 60; ++step) {
        const std::vector<Contact> contacts = mixed.contacts();
        ASSERT_EQ(solver.step(mixed.scene, frame_time, contacts).status, StepStatus::done);
        mixed.scene.read_loads(bodies, contacts, loads, circumferences);
        const std::span<const ContactImpulse> impulses = mixed.scene.contact_impulses();
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            double sum = 0, most = 0, with_friction = 0;
            Vector net{};
            for (std::size_t i = 0; i < contacts.size(); ++i) {
                if (contacts[i].body_a != bodies[k] && contacts[i].body_b != bodies[k]) continue;
                const double force =
                    static_cast<double>(impulses[i].normal) / static_cast<double>(frame_time);
                sum += force;
                most = std::max(most, force);
                const JointReport report = mixed.scene.contact_report(contacts, i);
                const Vector all = convert<double>(report.force);
                net = net + (contacts[i].body_b == bodies[k] ? 1.0 : -1.0) * all;
                with_friction += length(all);
            }
            EXPECT_NEAR(loads[k].normal_force, sum, 1e-5 * sum);
            EXPECT_NEAR(loads[k].largest_normal_force, most, 1e-5 * most);
            EXPECT_NEAR(loads[k].pressure, sum / 0.5, 1e-5 * sum / 0.5);
            EXPECT_LE(length(convert<double>(loads[k].net_force) - net), 3e-7 * with_friction);
        }
    }
    std::vector<Contact> another = mixed.contacts();
    another.emplace_back();
    EXPECT_THROW(mixed.scene.read_loads(bodies, another, loads), InvalidInput);
    EXPECT_THROW(mixed.scene.read_loads({bodies.data(), 1}, mixed.contacts(), loads), InvalidInput);
}

/// A rope that catches a ball bears m v in the step that catches it. Its break limit applies to the mean force of
/// that step.
TEST(ImpulsesOfAStep, AreWhatBreakLimitsAreOf)
{
    for (const int substeps : {1, 4, 16}) {
        Scene scene;
        BodyDefinition ball;
        ball.model = BodyModel::particle;
        ball.mass = 2;
        ball.position = {1e-3, 0, 0};
        ball.linear_velocity = {3, 0, 0};
        const BodyId body = scene.add_body(ball);
        DistanceDefinition rope{scene.ground(), body};
        rope.min_length = 0;
        rope.max_length = 2e-3F;
        const ConstraintId joint = scene.add_joint(rope);
        scene.set_break_limit(joint, {.force = 1});
        SolverSettings settings;
        settings.substeps = substeps;
        Solver solver(settings);
        ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
        const double lost = 2 * (3 - static_cast<double>(scene.state(body).linear_velocity.x));
        ASSERT_EQ(scene.break_events().size(), 1U);
        EXPECT_GT(lost, 5);
        EXPECT_NEAR(scene.break_events()[0].force, lost / static_cast<double>(frame_time),
                    1e-5 * lost / static_cast<double>(frame_time));
    }
}

}  // namespace
}  // namespace motley
