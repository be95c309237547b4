// Which of its two bodies a host calls a, and which b, is of no consequence: the same contact told the other way round (normal
// and arms exchanged) moves both bodies alike, and its friction, which is told as it acts on b, changes its sign. Independent
// evidence: Newton's third law; the two ways are compared with each other. Blocks hold bodies in the order of their kinds, so
// one of the two ways is exchanged for each pair of different kinds (see ContactIntake).
#include <gtest/gtest.h>

#include <tuple>
#include <utility>
#include <vector>

#include "motley/motley.h"
#include "rig.h"

namespace motley {
namespace {

using testing::frame_time;

enum class Kind { particle, planar, rigid, fixed };

BodyDefinition body_of(Kind kind)
{
    BodyDefinition body;
    body.model = kind == Kind::particle ? BodyModel::particle
                 : kind == Kind::planar ? BodyModel::planar
                                        : BodyModel::rigid;
    if (kind == Kind::fixed) body.motion = BodyMotion::static_body;
    body.mass = 3;
    return body;
}

/// Two bodies that overlap, meet and slide along each other.
struct Meeting {
    Scene scene;
    BodyId first, second;
    std::vector<Contact> contacts;

    Meeting(Kind first_kind, Kind second_kind, Contact touch, bool exchanges)
    {
        BodyDefinition definition = body_of(first_kind);
        first = scene.add_body(definition);
        definition = body_of(second_kind);
        definition.position = {0.8, 0.1, 0};
        second = scene.add_body(definition);
        for (const auto& [body, kind, velocity] : {std::tuple(first, first_kind, Vec3<float>{1, 0.3F, 0}),
                                                   std::tuple(second, second_kind, Vec3<float>{-2, 1, 0})}) {
            if (kind != Kind::fixed)
                scene.set_velocity(body, velocity, {0, 0, kind == Kind::particle ? 0 : 0.7F});
        }
        touch.body_a = first;
        touch.body_b = second;
        touch.key = 7;
        touch.normal = {0.8F, 0.6F, 0};
        touch.separation = -0.01F;
        touch.arm_a = {0.4F, 0.1F, 0};
        touch.arm_b = {-0.4F, 0.05F, 0};
        if (exchanges) {
            std::swap(touch.body_a, touch.body_b);
            std::swap(touch.arm_a, touch.arm_b);
            touch.normal = {-touch.normal.x, -touch.normal.y, -touch.normal.z};
        }
        contacts = {touch};
    }
};

void expect_same(const BodyState& x, const BodyState& y)
{
    EXPECT_EQ(x.position.x, y.position.x);
    EXPECT_EQ(x.position.y, y.position.y);
    EXPECT_EQ(x.position.z, y.position.z);
    EXPECT_EQ(x.linear_velocity.x, y.linear_velocity.x);
    EXPECT_EQ(x.linear_velocity.y, y.linear_velocity.y);
    EXPECT_EQ(x.linear_velocity.z, y.linear_velocity.z);
    EXPECT_EQ(x.angular_velocity.x, y.angular_velocity.x);
    EXPECT_EQ(x.angular_velocity.y, y.angular_velocity.y);
    EXPECT_EQ(x.angular_velocity.z, y.angular_velocity.z);
}

void expect_same(const Meeting& one, const Meeting& other)
{
    expect_same(one.scene.state(one.first), other.scene.state(other.first));
    expect_same(one.scene.state(one.second), other.scene.state(other.second));
    const ContactImpulse& told = one.scene.contact_impulses()[0];
    const ContactImpulse& exchanged = other.scene.contact_impulses()[0];
    EXPECT_EQ(told.normal, exchanged.normal);
    EXPECT_EQ(told.friction.x, -exchanged.friction.x);
    EXPECT_EQ(told.friction.y, -exchanged.friction.y);
    EXPECT_EQ(told.friction.z, -exchanged.friction.z);
}

TEST(ContactOrder, WhichBodyIsAIsOfNoConsequence)
{
    const Kind kinds[] = {Kind::particle, Kind::planar, Kind::rigid, Kind::fixed};
    for (const Isa isa : available_isas()) {
        for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
            for (const Contact& touch :
                 {Contact{}, Contact{.friction = 0.4F}, Contact{.friction = 0.4F, .restitution = 0.5F}}) {
                for (const Kind a : kinds) {
                    for (const Kind b : kinds) {
                        if (a == Kind::fixed && b == Kind::fixed) continue;
                        SCOPED_TRACE(::testing::Message()
                                     << isa_name(isa) << ", method " << static_cast<int>(method)
                                     << ", friction " << touch.friction << ", restitution "
                                     << touch.restitution << ", kinds " << static_cast<int>(a) << " and "
                                     << static_cast<int>(b));
                        Meeting one(a, b, touch, false), other(a, b, touch, true);
                        Solver solver({.method = method}, {.isa = isa});
                        for (int step = 0; step < 3; ++step) {
                            for (Meeting* meeting : {&one, &other})
                                ASSERT_EQ(solver.step(meeting->scene, frame_time, meeting->contacts).status,
                                          StepStatus::done);
                            expect_same(one, other);
                            if (step == 0) EXPECT_GT(one.scene.contact_impulses()[0].normal, 0);
                        }
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace motley
