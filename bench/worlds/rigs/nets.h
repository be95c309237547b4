// Nets, chains and ragdolls: joint scenes on which other engines have been measured, with the same numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "worlds/random.h"
#include "worlds/rig.h"

namespace motley::bench {

/// N x N bodies of 1 kg, unit spacing, neighbours tied midway, the top row static, a little out-of-plane speed.
inline Rig make_grid(std::int64_t bodies, std::uint64_t seed)
{
    const int side = std::max(2, static_cast<int>(std::lround(std::sqrt(static_cast<double>(bodies)))));
    Random random(seed);
    Rig rig;
    for (int column = 0; column < side; ++column) {
        for (int row = 0; row < side; ++row) {
            RigBody body;
            body.position = {static_cast<double>(column), -static_cast<double>(row), 0};
            body.inertia = {0.064F, 0.064F, 0.064F};
            body.moves = row > 0;
            if (body.moves) body.velocity.z = static_cast<float>(0.5 * random.symmetric());
            rig.bodies.push_back(body);
        }
    }
    for (int column = 0; column < side; ++column) {
        for (int row = 1; row < side; ++row) {
            const int here = column * side + row;
            const double x = column, y = -row;
            rig.joints.push_back({.a = here - 1, .b = here, .anchor = {x, y + 0.5, 0}});
            if (column > 0) rig.joints.push_back({.a = here - side, .b = here, .anchor = {x - 0.5, y, 0}});
        }
    }
    return rig;
}

/// A link of a chain along x: 0.5 m, 1 kg, a capsule's inertia.
inline RigBody chain_link(Vec3<double> position)
{
    return {.position = position, .mass = 1, .inertia = {0.005F, 0.02333F, 0.02333F}};
}

/// Chains of 20 links, the first tied to the world, starting level.
inline Rig make_chains(std::int64_t bodies, std::uint64_t)
{
    constexpr int links = 20;
    Rig rig;
    for (int chain = 0; chain < bodies / links; ++chain) {
        const double y = -(chain / 32), z = chain % 32;
        int before = rig_world;
        for (int i = 0; i < links; ++i) {
            const int link = rig.add(chain_link({0.25 + 0.5 * i, y, z}));
            rig.joints.push_back({.a = before, .b = link, .anchor = {0.5 * i, y, z}});
            before = link;
        }
    }
    return rig;
}

/// One figure of eleven boxes, y up, about the centre of its pelvis, which is the first; its hinges and swing-twists all
/// have limits.
inline Rig make_figure()
{
    struct Part {
        Vec3<double> centre;
        float mass;
        Vec3<float> half;
    };
    static constexpr std::array<Part, 11> parts{{{{0, 0, 0}, 10, {.16F, .1F, .1F}},
                                                 {{0, .35, 0}, 15, {.18F, .22F, .1F}},
                                                 {{0, .75, 0}, 5, {.1F, .13F, .1F}},
                                                 {{-.36, .5, 0}, 2.5F, {.15F, .05F, .05F}},
                                                 {{.36, .5, 0}, 2.5F, {.15F, .05F, .05F}},
                                                 {{-.66, .5, 0}, 2, {.15F, .04F, .04F}},
                                                 {{.66, .5, 0}, 2, {.15F, .04F, .04F}},
                                                 {{-.1, -.32, 0}, 7, {.07F, .21F, .07F}},
                                                 {{.1, -.32, 0}, 7, {.07F, .21F, .07F}},
                                                 {{-.1, -.75, 0}, 4, {.05F, .21F, .05F}},
                                                 {{.1, -.75, 0}, 4, {.05F, .21F, .05F}}}};
    Rig rig;
    for (const Part& part : parts) {
        const Vec3<float>& h = part.half;
        const float third = part.mass / 3;
        rig.bodies.push_back({.position = part.centre,
                              .mass = part.mass,
                              .inertia = {third * (h.y * h.y + h.z * h.z), third * (h.x * h.x + h.z * h.z),
                                          third * (h.x * h.x + h.y * h.y)},
                              .half_extents = h});
    }
    rig.joints = {{0, 1, {0, .12, 0}, RigTie::swing_twist, {0, 1, 0}, -.3F, .3F, .3F},
                  {1, 2, {0, .6, 0}, RigTie::swing_twist, {0, 1, 0}, -.5F, .5F, .4F},
                  {1, 3, {-.2, .5, 0}, RigTie::swing_twist, {-1, 0, 0}, -.5F, .5F, .8F},
                  {1, 4, {.2, .5, 0}, RigTie::swing_twist, {1, 0, 0}, -.5F, .5F, .8F},
                  {3, 5, {-.51, .5, 0}, RigTie::hinge, {0, 0, 1}, -.6F, .6F, 0},
                  {4, 6, {.51, .5, 0}, RigTie::hinge, {0, 0, 1}, -.6F, .6F, 0},
                  {0, 7, {-.1, -.1, 0}, RigTie::swing_twist, {0, -1, 0}, -.4F, .4F, .6F},
                  {0, 8, {.1, -.1, 0}, RigTie::swing_twist, {0, -1, 0}, -.4F, .4F, .6F},
                  {7, 9, {-.1, -.53, 0}, RigTie::hinge, {1, 0, 0}, -.6F, .6F, 0},
                  {8, 10, {.1, -.53, 0}, RigTie::hinge, {1, 0, 0}, -.6F, .6F, 0}};
    return rig;
}

/// Figures that hang by the pelvis, each with its own spin.
inline Rig make_ragdolls(std::int64_t bodies, std::uint64_t seed)
{
    const Rig one = make_figure();
    const Vec3<double> hook{0, .1, 0};
    Random random(seed);
    Rig rig;
    for (int figure = 0; figure < bodies / static_cast<int>(one.bodies.size()); ++figure) {
        const Vec3<double> at{3.0 * (figure % 32), 0, 3.0 * (figure / 32)};
        Vec3<float> spin;
        spin.x = static_cast<float>(3 * random.symmetric());
        spin.y = static_cast<float>(3 * random.symmetric());
        spin.z = static_cast<float>(3 * random.symmetric());
        const int first = static_cast<int>(rig.bodies.size());
        for (RigBody part : one.bodies) {
            part.velocity = cross(spin, convert<float>(part.position - hook));
            part.spin = spin;
            part.position = at + part.position;
            rig.bodies.push_back(part);
        }
        rig.joints.push_back({.a = rig_world, .b = first, .anchor = at + hook});
        for (RigJoint joint : one.joints) {
            joint.a += first;
            joint.b += first;
            joint.anchor = at + joint.anchor;
            rig.joints.push_back(joint);
        }
    }
    return rig;
}

}  // namespace motley::bench
