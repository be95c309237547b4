// Capsules and half-spaces that are refused: the message names the field, the value and the valid range, and nothing is
// changed. One line for each field and each way in which it can be wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "motley/motley.h"

namespace motley {
namespace {

const float nan = std::nanf("");

struct Bodies {
    Scene scene;
    BodyId rigid = scene.add_body({}), planar = scene.add_body({.model = BodyModel::planar}),
           particle = scene.add_body({.model = BodyModel::particle}), removed = scene.add_body({});
    Bodies() { scene.remove_body(removed); }
};

/// What the refusal says; empty when there is none.
std::string message_of(const std::function<void()>& call)
{
    try {
        call();
    } catch (const InvalidInput& refusal) {
        return refusal.what();
    }
    return {};
}

template <class Definition>
struct Case {
    std::function<void(const Bodies&, Definition&)> spoil;
    const char* message;
};

TEST(BadCapsule, IsRefusedByFieldValueAndRange)
{
    using Spoilt = CapsuleDefinition;
    const Case<Spoilt> cases[] = {
        {[](const Bodies& b, Spoilt& c) { c.body = b.removed; },
         "CapsuleDefinition.body is slot 5, not alive; expected a body of this scene"},
        {[](const Bodies&, Spoilt& c) { c.from.y = nan; },
         "CapsuleDefinition.from.y is nan; expected a finite value from -1e6 to 1e6 (m)"},
        {[](const Bodies&, Spoilt& c) { c.to.z = 2e6F; },
         "CapsuleDefinition.to.z is 2000000; expected a finite value from -1e6 to 1e6 (m)"},
        {[](const Bodies& b, Spoilt& c) { c.body = b.planar, c.to.z = 0.25F; },
         "CapsuleDefinition.to.z is 0.25; expected 0 of a planar body (m)"},
        {[](const Bodies& b, Spoilt& c) { c.body = b.particle, c.from.x = 0.5F; },
         "CapsuleDefinition.from.x is 0.5; expected 0 of a particle (m)"},
        {[](const Bodies&, Spoilt& c) { c.radius = 0; },
         "CapsuleDefinition.radius is 0; expected 1e-6 to 1e6 (m)"},
        {[](const Bodies&, Spoilt& c) { c.radius = nan; },
         "CapsuleDefinition.radius is nan; expected 1e-6 to 1e6 (m)"},
        {[](const Bodies&, Spoilt& c) { c.friction = -1; },
         "CapsuleDefinition.friction is -1; expected a finite value from 0 to 1e9"},
        {[](const Bodies&, Spoilt& c) { c.restitution = 1.5F; },
         "CapsuleDefinition.restitution is 1.5; expected 0 to 1"},
        {[](const Bodies&, Spoilt& c) { c.group = 1U << 31; },
         "CapsuleDefinition.group is 2.14748365e+09; expected 0 to 2^31 - 1"},
    };
    for (const Case<Spoilt>& bad : cases) {
        Bodies bodies;
        const CapsuleDefinition good{.body = bodies.rigid};
        CapsuleDefinition both[] = {good, good};
        bad.spoil(bodies, both[1]);
        ShapeId ids[2];
        EXPECT_EQ(message_of([&] { bodies.scene.add_capsules(both, ids); }), bad.message);
        EXPECT_EQ(bodies.scene.add_capsule(good).slot, 1U) << "something was added: " << bad.message;
    }
}

TEST(BadHalfSpace, IsRefusedByFieldValueAndRange)
{
    using Spoilt = HalfSpaceDefinition;
    const Case<Spoilt> cases[] = {
        {[](const Bodies& b, Spoilt& h) { h.body = b.removed; },
         "HalfSpaceDefinition.body is slot 5, not alive; expected a body of this scene"},
        {[](const Bodies& b, Spoilt& h) { h.body = b.rigid; },
         "HalfSpaceDefinition.body is a dynamic body; expected a static or kinematic body"},
        {[](const Bodies&, Spoilt& h) { h.point.x = std::nan(""); },
         "HalfSpaceDefinition.point.x is nan; expected a finite value from -1e12 to 1e12 (m)"},
        {[](const Bodies&, Spoilt& h) { h.normal = {}; },
         "HalfSpaceDefinition.normal is 0; expected a length from 1e-6 to 1e6 (length shown)"},
        {[](const Bodies&, Spoilt& h) { h.normal.z = nan; },
         "HalfSpaceDefinition.normal is nan; expected a length from 1e-6 to 1e6 (length shown)"},
        {[](const Bodies&, Spoilt& h) { h.friction = nan; },
         "HalfSpaceDefinition.friction is nan; expected a finite value from 0 to 1e9"},
        {[](const Bodies&, Spoilt& h) { h.restitution = -0.5F; },
         "HalfSpaceDefinition.restitution is -0.5; expected 0 to 1"},
    };
    for (const Case<Spoilt>& bad : cases) {
        Bodies bodies;
        HalfSpaceDefinition half_space;
        bad.spoil(bodies, half_space);
        EXPECT_EQ(message_of([&] { bodies.scene.add_half_space(half_space); }), bad.message);
        EXPECT_EQ(bodies.scene.add_half_space({}).slot, 1U) << "something was added: " << bad.message;
    }
}

TEST(BadShapes, AreRefusedByHandleAndCount)
{
    Bodies bodies;
    const CapsuleDefinition capsule{.body = bodies.rigid};
    EXPECT_EQ(message_of([&] {
                  bodies.scene.add_capsules({&capsule, 1}, {});
              }),
              "add_capsules.ids.size() is 0; expected the size of capsules");
    EXPECT_EQ(message_of([&] { bodies.scene.remove_shape({}); }),
              "remove_shape.shape is slot 0, not alive; expected a shape of this scene");
    EXPECT_EQ(message_of([&] { (void)bodies.scene.shape_contacts_of(bodies.removed); }),
              "shape_contacts_of.body is slot 5, not alive; expected a body of this scene");
    Figure figure;
    EXPECT_EQ(
        message_of([&] { figure.add_capsule({}); }),
        "CapsuleDefinition.body is the ground; expected a body of the figure; a static one for the world");
}

}  // namespace
}  // namespace motley
