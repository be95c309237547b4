// Files of scenes, to continue from later, and of the input of a step, to reproduce a bug.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/scene.h"
#include "motley/core/settings.h"

namespace motley {

/// The whole input of one step.
struct StepProblem {
    Scene scene;
    SolverSettings settings;
    float dt = 0;  ///< s, duration of the step
    std::vector<Contact> contacts;
};

/// Writes everything that decides what the next steps compute: bodies, joints, handles, colours, and the accumulated
/// impulses. A scene that is read back continues with the same bits, and the host's handles stay valid. The file
/// appears completely or not at all. Throws std::runtime_error naming the file when it cannot be written.
void save_scene(const Scene& scene, const std::string& file);
/// Reads what save_scene wrote, with the same version of the format and the same layout of data in memory. Throws
/// std::runtime_error naming the file and what is wrong with it: missing, not such a file, of another version or
/// layout, truncated, or corrupted.
Scene load_scene(const std::string& file);

/// The same for the input of a step.
void save_problem(const StepProblem& problem, const std::string& file);
StepProblem load_problem(const std::string& file);

}  // namespace motley
