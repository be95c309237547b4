// A scene in a file, and a step's problem in a file: to go on from later, and to send to whoever has to find a bug.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/scene.h"
#include "motley/core/settings.h"

namespace motley {

/// What goes into one step.
struct StepProblem {
    Scene scene;
    SolverSettings settings;
    float dt = 0;  ///< s
    std::vector<Contact> contacts;
};

/// Writes everything that decides what the next steps compute: bodies, joints, handles, colours, the impulses to start
/// warm from. A scene read back goes on with the same bits, and the host's handles stay good.
/// The file appears whole or not at all. Throws std::runtime_error naming the file when it cannot be written.
void save_scene(const Scene& scene, const std::string& file);
/// Reads what save_scene wrote, with the same version of motley, on a machine with the same layout of numbers. Throws
/// std::runtime_error naming the file and what is wrong with it: missing, foreign, of another version, truncated, changed.
Scene load_scene(const std::string& file);

/// The same for a step's whole problem.
void save_problem(const StepProblem& problem, const std::string& file);
StepProblem load_problem(const std::string& file);

}  // namespace motley
