// Splits a weld into joints. A joint has one stiffness for all of its rows, which are solved together; a weld of two stiffnesses has
// a joint for each.
#include "motley/core/weld.h"

#include "scene/joint_checks.h"

namespace motley {
namespace {

void check(const WeldDefinition& weld)
{
    constexpr const char* hertz = "0 (rigid) or up to 1e6 (Hz)";
    check_range("WeldDefinition.linear_hertz", weld.linear_hertz, 0, 1e6F, hertz);
    check_range("WeldDefinition.angular_hertz", weld.angular_hertz, 0, 1e6F, hertz);
    check_range("WeldDefinition.linear_damping_ratio", weld.linear_damping_ratio, 0, 1e6F, "0 to 1e6");
    check_range("WeldDefinition.angular_damping_ratio", weld.angular_damping_ratio, 0, 1e6F, "0 to 1e6");
}

ConstraintId hold_position(Scene& scene, const WeldDefinition& weld)
{
    const Vec3<float>&a = weld.frame_a.position, &b = weld.frame_b.position;
    if (weld.linear_hertz == 0) return scene.add_joint(BallSocketDefinition{weld.body_a, weld.body_b, a, b});
    PointServoDefinition spring{weld.body_a, weld.body_b, a, b};
    spring.hertz = weld.linear_hertz;
    spring.damping_ratio = weld.linear_damping_ratio;
    return scene.add_joint(spring);
}

}  // namespace

Weld add_weld(Scene& scene, const WeldDefinition& definition)
{
    check(definition);
    Weld weld;
    if (definition.linear_hertz == 0 && definition.angular_hertz == 0) {
        weld.position = scene.add_joint(
            FixedDefinition{definition.body_a, definition.body_b, definition.frame_a, definition.frame_b});
        return weld;
    }
    const JointStiffness stiffness{definition.angular_hertz, definition.angular_damping_ratio};
    weld.rotation = scene.add_joint(RotationLockDefinition{
        definition.body_a, definition.body_b, definition.frame_a, definition.frame_b, stiffness});
    try {
        weld.position = hold_position(scene, definition);
    } catch (...) {
        scene.remove_joint(weld.rotation);
        throw;
    }
    return weld;
}

}  // namespace motley
