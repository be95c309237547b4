// Figures from files: bodies, capsules and joints in MJCF, the format of MuJoCo ("XML Reference" of its documentation). A
// library of its own, motley::mjcf, because it links pugixml.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motley/core/assembly.h"
#include "motley/core/shapes.h"

#pragma GCC visibility push(default)
namespace motley {

/// One body of the world with all bodies below it.
struct MjcfFigure {
    std::string name;  ///< of that body; may be empty
    /// In the coordinates of the file: add_assembly() with a placing at the origin puts it where the file has it. All
    /// bodies have the orientation of the world in the pose of the file.
    Figure figure;
    std::vector<std::string> bodies;  ///< the names of figure.bodies(); empty for a link between two hinges
};

/// What a file holds. Lengths in m, masses in kg, z up if gravity says so.
struct MjcfModel {
    Vec3<float> gravity{0, 0, -9.81F};  ///< m/s2, for SolverSettings
    std::vector<MjcfFigure> figures;
    std::vector<HalfSpaceDefinition> floors;   ///< planes of the world, infinite whatever their size
    std::vector<CapsuleDefinition> obstacles;  ///< capsules and spheres of the world
};

/// How read_mjcf() takes what it reads.
struct MjcfOptions {
    /// Elements below <mujoco> that push or hold and are to be left out all the same, such as "tendon", "actuator",
    /// "equality", "keyframe" or "contact". Otherwise they are refused.
    std::vector<std::string> leave_out;
};

/// Reads a file's text.
///
/// What is read: bodies with pos and an orientation; inertial, or else mass and inertia from geoms by density or mass;
/// geoms that are spheres, capsules or, in the world, planes, with the first of their coefficients of friction; hinges with
/// range, stiffness, springref, damping, armature and frictionloss; ball joints without limits; free joints; default classes;
/// compiler angle, autolimits and eulerseq; option gravity. A body without a joint becomes a part of the body above it, or
/// of the world. Up to three hinges of one body whose axes are perpendicular and meet in a point become a ball-socket with
/// Euler angles; others are separated by links that take a twentieth of the body's mass and inertia each. Links are light:
/// with SolverSettings::exact_joints they hold, while sweeps let the joints of a figure that falls come apart by
/// centimetres, and by decimetres under others. Capsules of a figure do not touch each other.
///
/// What only looks (assets, visuals, lights, cameras, sites, groups, materials) or belongs to MuJoCo's solver (solref,
/// solimp, condim, timestep) is passed over. Everything else is refused.
///
/// Throws InvalidInput naming the element, its name and its line: "MJCF: geom 'belly', line 12: type is box; expected
/// sphere, capsule or, in the world, plane".
MjcfModel read_mjcf(std::string_view text, const MjcfOptions& options = {});

}  // namespace motley
#pragma GCC visibility pop
