// No kernel divides by zero or makes a not-a-number out of a finite scene, not even in padding lanes: a host that
// unmasks floating-point exceptions can step. Independent evidence: the processor's own flags.
#include <gtest/gtest.h>

#include <cfenv>

#include "fallen_figures.h"
#include "joint_scene.h"
#include "rig.h"

namespace motley {
namespace {

using testing::JointScene;
using testing::MixedScene;

constexpr float dt = 1.0F / 60;
constexpr int trapped = FE_INVALID | FE_DIVBYZERO;

std::string names_of(int flags)
{
    return std::string((flags & FE_INVALID) != 0 ? "invalid " : "") +
           ((flags & FE_DIVBYZERO) != 0 ? "division by zero" : "");
}

struct Way {
    const char* name;
    SolverSettings settings;
};

std::vector<Way> ways()
{
    SolverSettings soft;
    soft.gravity = {0, -9.81F, 0};
    SolverSettings exact = soft, contacts = soft, measured = soft, impulse = soft;
    exact.exact_joints = true;
    contacts.exact_contacts = true;
    measured.measures = true;
    impulse.method = Method::sequential_impulse;
    impulse.iterations = 4;
    SolverSettings projected = impulse;
    projected.drift_correction = DriftCorrection::projection;
    return {{"soft_step", soft},         {"exact joints", exact}, {"exact contacts", contacts},
            {"with measures", measured}, {"Baumgarte", impulse},  {"projection", projected}};
}

/// The floating-point flags that a step raised.
template <class Step>
int flags_of(const Step& step)
{
    std::feclearexcept(FE_ALL_EXCEPT);
    step();
    const int flags = std::fetestexcept(trapped);
    std::feclearexcept(FE_ALL_EXCEPT);
    return flags;
}

class Trapping : public ::testing::TestWithParam<Isa> {
  protected:
    void SetUp() override
    {
#ifdef __clang__
        GTEST_SKIP()
            << "LLVM divides in lanes that a select then drops: nobody is meant to look at the flags";
#endif
    }
};

TEST_P(Trapping, NothingIsRaisedByContactsOfEveryPair)
{
    for (const Way& way : ways()) {
        MixedScene mixed;
        Solver solver(way.settings, {.isa = GetParam()});
        for (int step = 0; step < 120; ++step) {
            const std::vector<Contact> contacts = mixed.contacts();
            const int flags = flags_of([&] { solver.step(mixed.scene, dt, contacts); });
            ASSERT_EQ(flags, 0) << names_of(flags) << " in step " << step << ", " << way.name;
        }
    }
}

TEST_P(Trapping, NothingIsRaisedByJointsOfEveryTypeAndPair)
{
    for (const Way& way : ways()) {
        JointScene joints;
        Solver solver(way.settings, {.isa = GetParam()});
        for (int step = 0; step < 60; ++step) {
            const int flags = flags_of([&] { solver.step(joints.scene, dt); });
            ASSERT_EQ(flags, 0) << names_of(flags) << " in step " << step << ", " << way.name;
        }
    }
}

TEST_P(Trapping, NothingIsRaisedByFiguresInLockstep)
{
    for (const Way& way : ways()) {
        Scene scene;
        // Twenty-one chains of six links: a full block and a padded one.
        for (int chain = 0; chain < 21; ++chain) {
            BodyId before = scene.ground();
            for (int i = 0; i < 6; ++i) {
                BodyDefinition body;
                body.position = {i + 0.5, 0, 2.0 * chain};
                const BodyId id = scene.add_body(body);
                const Vec3<float> anchor =
                    i == 0 ? Vec3<float>{0, 0, 2.0F * static_cast<float>(chain)} : Vec3<float>{0.5F, 0, 0};
                scene.add_joint(BallSocketDefinition{before, id, anchor, {-0.5F, 0, 0}});
                before = id;
            }
        }
        Solver solver(way.settings, {.isa = GetParam()});
        for (int step = 0; step < 60; ++step) {
            const int flags = flags_of([&] { solver.step(scene, dt); });
            ASSERT_EQ(flags, 0) << names_of(flags) << " in step " << step << ", " << way.name;
        }
    }
}

TEST_P(Trapping, NothingIsRaisedByFallenFiguresInLockstep)
{
    for (const Way& way : ways()) {
        testing::FallenFigures fallen({.copies = 21, .all_touches = true, .turntable = true});
        Solver solver(way.settings, {.isa = GetParam()});
        for (int step = 0; step < 120; ++step) {
            fallen.turn();
            const std::vector<Contact> contacts = fallen.contacts();
            const int flags = flags_of([&] { solver.step(fallen.scene, dt, contacts); });
            ASSERT_EQ(flags, 0) << names_of(flags) << " in step " << step << ", " << way.name;
        }
    }
}

TEST(Environment, OfTheHostIsLeftAsFound)
{
    // The rounding mode by <cfenv>, and on x86 all control bits of MXCSR: flushing of denormals, masks, rounding.
    const auto control = [] {
#ifdef __x86_64__
        return __builtin_ia32_stmxcsr() & 0xffc0U;
#else
        return 0U;
#endif
    };
    const auto steps_leave_it = [&] {
        for (const Way& way : ways()) {
            for (const Isa isa : available_isas()) {
                MixedScene mixed;
                Solver solver(way.settings, {.threads = 2, .alone_below = 0, .isa = isa});
                const int rounding = std::fegetround();
                const unsigned before = control();
                for (int step = 0; step < 3; ++step) solver.step(mixed.scene, dt, mixed.contacts());
                EXPECT_EQ(std::fegetround(), rounding) << way.name;
                EXPECT_EQ(control(), before) << way.name << " on " << isa_name(isa);
            }
        }
    };
    for (const int rounding : {FE_TONEAREST, FE_UPWARD, FE_TOWARDZERO}) {
        std::fesetround(rounding);
        steps_leave_it();
    }
    std::fesetround(FE_TONEAREST);
#ifdef __x86_64__
    const unsigned usual = __builtin_ia32_stmxcsr();
    __builtin_ia32_ldmxcsr(usual | 0x8040U);  // denormals are read and written as zero
    steps_leave_it();
    __builtin_ia32_ldmxcsr(usual);
#endif
}

/// The hash after sixty steps of every kind of contact and joint, each called in a rounding mode that the host has
/// set.
std::uint64_t hash_with_rounding(int rounding, const Way& way, const SolverOptions& options)
{
    MixedScene mixed;
    Solver solver(way.settings, options);
    for (int step = 0; step < testing::long_run(60); ++step) {
        const std::vector<Contact> contacts = mixed.contacts();
        std::fesetround(rounding);
        solver.step(mixed.scene, dt, contacts);
        std::fesetround(FE_TONEAREST);
    }
    return mixed.scene.state_hash();
}

TEST(Environment, OfAStepIsTheSameWhateverTheHosts)
{
    for (const Way& way : ways()) {
        for (const int threads : {1, 2}) {
            const SolverOptions options{.threads = threads, .alone_below = 0};
            const std::uint64_t nearest = hash_with_rounding(FE_TONEAREST, way, options);
            EXPECT_EQ(hash_with_rounding(FE_UPWARD, way, options), nearest) << way.name;
            EXPECT_EQ(hash_with_rounding(FE_TOWARDZERO, way, options), nearest) << way.name;
        }
    }
}

#if defined(__x86_64__) || defined(__aarch64__)
TEST(Environment, OfAStepTakesDenormalsForNothing)
{
    constexpr float denormal = 1e-40F;
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 2}) {
            Scene scene;
            std::vector<BodyId> bodies;
            // More rows than one thread's share.
            for (int i = 0; i < 10000; ++i) {
                BodyDefinition body;
                body.position = {2.0 * i, 0, 0};
                body.linear_velocity = {denormal, 0, -denormal};
                body.angular_velocity = {0, denormal, 0};
                bodies.push_back(scene.add_body(body));
            }
            SolverSettings weightless;
            weightless.gravity = {};
            Solver solver(weightless, {.threads = threads, .alone_below = 0, .isa = isa});
            solver.step(scene, dt);
            for (const BodyId body : bodies) {
                const BodyState state = scene.state(body);
                const Vec3<float> v = state.linear_velocity, w = state.angular_velocity;
                for (const float speed : {v.x, v.y, v.z, w.x, w.y, w.z})
                    ASSERT_EQ(speed, 0) << isa_name(isa) << ", " << threads;
            }
        }
    }
}
#endif

INSTANTIATE_TEST_SUITE_P(Isas, Trapping, ::testing::ValuesIn(available_isas()),
                         [](const auto& isa) { return std::string(isa_name(isa.param)); });

}  // namespace
}  // namespace motley
