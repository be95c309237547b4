// A scene and a solver of the C interface beside those of C++: both must step alike, to the bit.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "motley/c/motley.h"
#include "motley/motley.h"
#include "rig.h"

namespace motley::testing {

/// The text of the last error, where a call fails.
inline ::testing::AssertionResult done(motley_status status)
{
    if (status == MOTLEY_DONE) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << motley_last_error();
}

template <class C, class Cpp>
C as_c(const Cpp& value)
{
    static_assert(sizeof(C) == sizeof(Cpp));
    return std::bit_cast<C>(value);
}

/// A scene and a solver of each interface.
class Both {
  public:
    Scene scene;
    motley_scene* c_scene = nullptr;
    Solver solver;
    motley_solver* c_solver = nullptr;

    explicit Both(const Scene& of, const SolverSettings& settings = {}) : scene(of), solver(settings)
    {
        const std::vector<std::byte> bytes = save_scene(scene);
        EXPECT_TRUE(done(motley_scene_load(bytes.data(), bytes.size(), &c_scene)));
        motley_solver_settings c = motley_default_solver_settings();
        c.gravity = as_c<motley_vec3f>(settings.gravity);
        c.method = static_cast<motley_method>(settings.method);
        c.exact_joints = settings.exact_joints;
        c.exact_limits = settings.exact_limits;
        c.exact_above_ratio = settings.exact_above_ratio;
        c.exact_contacts = settings.exact_contacts;
        c.measures = settings.measures;
        c.sleep_speed = settings.sleep_speed;
        EXPECT_TRUE(done(motley_solver_create(&c, nullptr, &c_solver)));
    }
    Both(const Both&) = delete;
    Both& operator=(const Both&) = delete;
    ~Both()
    {
        motley_solver_destroy(c_solver);
        motley_scene_destroy(c_scene);
    }

    [[nodiscard]] std::uint64_t c_hash() const
    {
        std::uint64_t hash = 0;
        EXPECT_TRUE(done(motley_scene_state_hash(c_scene, &hash)));
        return hash;
    }
    /// Steps both; the states must then have the same bits, and the reports the same numbers.
    void step(const std::vector<Contact>& contacts = {})
    {
        std::vector<motley_contact> list(contacts.size());
        for (std::size_t i = 0; i < list.size(); ++i) list[i] = as_c<motley_contact>(contacts[i]);
        motley_step_report c = motley_default_step_report();
        const StepReport cpp = solver.step(scene, frame_time, contacts);
        ASSERT_EQ(cpp.status, StepStatus::done) << cpp.error;
        ASSERT_TRUE(done(motley_solver_step(c_solver, c_scene, frame_time, list.size(), list.data(), &c)));
        ASSERT_EQ(c_hash(), scene.state_hash());
        EXPECT_EQ(c.refused, 0);
        EXPECT_EQ(c.contacts, cpp.contacts);
        EXPECT_EQ(c.disc_contacts, cpp.disc_contacts);
        EXPECT_EQ(c.shape_contacts, cpp.shape_contacts);
        EXPECT_EQ(c.joints, cpp.joints);
        EXPECT_EQ(c.joints_in_lockstep, cpp.joints_in_lockstep);
        EXPECT_EQ(c.colours, cpp.colours);
        EXPECT_EQ(c.blocks, cpp.blocks);
        EXPECT_EQ(c.lane_occupancy, cpp.lane_occupancy);
        EXPECT_EQ(c.sweeps, cpp.sweeps);
        EXPECT_EQ(c.substeps, cpp.substeps);
        EXPECT_EQ(c.bodies_asleep, cpp.bodies_asleep);
        EXPECT_EQ(c.measures.residual_max, cpp.measures.residual_max);
        EXPECT_EQ(c.measures.before.kinetic_energy, cpp.measures.before.kinetic_energy);
        EXPECT_EQ(c.measures.after.momentum[2], cpp.measures.after.momentum[2]);
    }
};

}  // namespace motley::testing
