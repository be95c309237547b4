// Figures through the C interface: the same bits as through C++, and what it refuses.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "both.h"
#include "motley/c/figures.h"
#include "motley/core/assembly.h"
#include "motley/core/six_dof.h"

namespace motley {
namespace {

using testing::as_c;
using testing::Both;
using testing::done;

/// A figure of C with three bodies.
struct ThreeBodies {
    motley_figure* figure = nullptr;
    motley_body_id body[3] = {};
    ThreeBodies()
    {
        EXPECT_TRUE(done(motley_figure_create(&figure)));
        for (int i = 0; i < 3; ++i) {
            motley_body_definition definition = motley_default_body_definition();
            definition.position = {0, 0.5 * i, 0};
            definition.mass = static_cast<float>(1 + i);
            EXPECT_TRUE(done(motley_figure_add_body(figure, &definition, &body[i])));
        }
    }
    ThreeBodies(const ThreeBodies&) = delete;
    ThreeBodies& operator=(const ThreeBodies&) = delete;
    ~ThreeBodies() { motley_figure_destroy(figure); }
};

TEST(CFigures, CopiesHaveTheSameBitsAsThroughCpp)
{
    const ThreeBodies c;
    Figure cpp;
    BodyId body[3];
    for (int i = 0; i < 3; ++i) {
        BodyDefinition definition;
        definition.position = {0, 0.5 * i, 0};
        definition.mass = static_cast<float>(1 + i);
        body[i] = cpp.add_body(definition);
        EXPECT_EQ(c.body[i].slot, body[i].slot);
    }
    motley_hinge_definition hinge = motley_default_hinge_definition();
    hinge.body_a = c.body[0], hinge.body_b = c.body[1];
    hinge.frame_a.position.y = 0.25F, hinge.frame_b.position.y = -0.25F;
    ASSERT_TRUE(done(motley_figure_add_hinge(c.figure, &hinge)));
    cpp.add_joint(HingeDefinition{body[0], body[1], {{0, 0.25F, 0}}, {{0, -0.25F, 0}}});
    motley_six_dof_definition six = motley_default_six_dof_definition();
    six.body_a = c.body[1], six.body_b = c.body[2];
    six.frame_a.position.y = 0.25F, six.frame_b.position.y = -0.25F;
    six.rotation[0].lower = -0.5F, six.rotation[0].upper = 0.5F;
    ASSERT_TRUE(done(motley_figure_add_six_dof(c.figure, &six)));
    SixDofDefinition six_cpp;
    six_cpp.body_a = body[1], six_cpp.body_b = body[2];
    six_cpp.frame_a.position.y = 0.25F, six_cpp.frame_b.position.y = -0.25F;
    six_cpp.rotation[0].lower = -0.5F, six_cpp.rotation[0].upper = 0.5F;
    cpp.add_six_dof(six_cpp);
    motley_capsule_definition capsule = motley_default_capsule_definition();
    capsule.body = c.body[2];
    capsule.group = 1;
    ASSERT_TRUE(done(motley_figure_add_capsule(c.figure, &capsule)));
    cpp.add_capsule({.body = body[2], .group = 1});

    std::size_t bodies = 0, joints = 0;
    ASSERT_TRUE(done(motley_figure_body_count(c.figure, &bodies)));
    ASSERT_TRUE(done(motley_figure_joint_count(c.figure, &joints)));
    EXPECT_EQ(bodies, 3U);
    EXPECT_EQ(joints, cpp.joint_count());

    Both both(Scene{}, testing::with_gravity({0, -9.81F, 0}));
    std::vector<motley_placing> placings(20);
    std::vector<Placing> placings_cpp(placings.size());
    for (std::size_t i = 0; i < placings.size(); ++i) {
        placings[i] = motley_default_placing();
        placings[i].position.x = placings_cpp[i].position.x = 0.15 * static_cast<double>(i);
        placings[i].orientation.z = placings_cpp[i].orientation.z = 0.1 * static_cast<double>(i);
        placings[i].linear_velocity.y = placings_cpp[i].linear_velocity.y = -1;
    }
    std::vector<motley_body_id> ids(3 * placings.size());
    ASSERT_TRUE(done(motley_scene_add_assembly(both.c_scene, c.figure, placings.size(), placings.data(),
                                               sizeof(motley_placing), ids.data())));
    const std::vector<BodyId> ids_cpp = add_assembly(both.scene, cpp, placings_cpp);
    for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(ids[i].slot, ids_cpp[i].slot);
    for (int step = 0; step < 30; ++step) ASSERT_NO_FATAL_FAILURE(both.step());
    EXPECT_FALSE(both.scene.shape_contacts().empty());
}

/// The calls that are refused leave figure and scene as they were, and say what was wrong.
TEST(CFigures, BadInputIsRefusedByName)
{
    const ThreeBodies c;
    motley_scene* scene = nullptr;
    ASSERT_TRUE(done(motley_scene_create(&scene)));
    motley_body_id ids[3];
    const auto refused = [](motley_status status, const std::string& part) {
        EXPECT_EQ(status, MOTLEY_REFUSED) << part;
        EXPECT_NE(std::string(motley_last_error()).find(part), std::string::npos) << motley_last_error();
    };
    motley_body_definition heavy = motley_default_body_definition();
    heavy.mass = -1;
    refused(motley_figure_add_body(c.figure, &heavy, nullptr), "BodyDefinition.mass");
    refused(motley_figure_add_body(nullptr, &heavy, nullptr), "figure");
    motley_ball_socket_definition joint = motley_default_ball_socket_definition();
    joint.body_a = c.body[0];
    refused(motley_figure_add_ball_socket(c.figure, &joint), "body");
    ASSERT_TRUE(done(motley_scene_ground(scene, &joint.body_b)));
    refused(motley_figure_add_ball_socket(c.figure, &joint), "the ground");
    motley_pulley_definition pulley = motley_default_pulley_definition();
    pulley.body_a = c.body[0], pulley.body_b = c.body[1];
    refused(motley_figure_add_pulley(c.figure, &pulley), "pulley");
    motley_capsule_definition capsule = motley_default_capsule_definition();
    refused(motley_figure_add_capsule(c.figure, &capsule), "CapsuleDefinition.body");

    motley_placing placing = motley_default_placing();
    const auto add = [&](std::size_t stride) {
        return motley_scene_add_assembly(scene, c.figure, 1, &placing, stride, ids);
    };
    placing.orientation.w = 0;
    refused(add(sizeof placing), "Placing.orientation");
    placing = motley_default_placing();
    placing.position.x = std::numeric_limits<double>::quiet_NaN();
    refused(add(sizeof placing), "BodyDefinition.position");
    placing = motley_default_placing();
    placing.struct_size = 3;
    refused(add(sizeof placing), "motley_placing");
    placing = motley_default_placing();
    refused(add(1), "copies");
    refused(motley_scene_add_assembly(scene, c.figure, 1, &placing, sizeof placing, nullptr), "bodies");
    refused(motley_scene_add_assembly(scene, c.figure, 1, nullptr, sizeof placing, ids), "copies");
    refused(motley_scene_add_assembly(scene, c.figure, std::numeric_limits<std::size_t>::max() / 2, &placing,
                                      sizeof placing, ids),
            "copies");
    refused(motley_scene_add_assembly(scene, nullptr, 1, &placing, sizeof placing, ids), "figure");
    std::size_t count = 7;
    ASSERT_TRUE(done(motley_scene_body_count(scene, &count)));
    EXPECT_EQ(count, 0U);
    ASSERT_TRUE(done(motley_figure_joint_count(c.figure, &count)));
    EXPECT_EQ(count, 0U);
    EXPECT_TRUE(done(motley_scene_add_assembly(scene, c.figure, 0, nullptr, 0, nullptr)));
    motley_figure_destroy(nullptr);
    motley_scene_destroy(scene);
}

}  // namespace
}  // namespace motley
