// Scenes as bytes, to continue from later, and the input of a step, to reproduce a bug: in files and in memory.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/scene.h"
#include "motley/core/settings.h"

#pragma GCC visibility push(default)
namespace motley {

/// The whole input of one step.
struct StepProblem {
    Scene scene;
    SolverSettings settings;
    float dt = 0;  ///< s, duration of the step
    std::vector<Contact> contacts;
};

/// Everything that decides what the next steps compute, as bytes: bodies, joints, handles, user data, colours, and the
/// accumulated impulses. A scene that is read back continues with the same bits, and the host's handles stay valid. Scenes that are
/// built alike have other handles (ids.h), and so other bytes, unless they began as copies of one scene.
[[nodiscard]] std::vector<std::byte> save_scene(const Scene& scene);
/// Reads what save_scene returned, with the same version of the format and the same layout of data in memory. Throws
/// std::runtime_error saying what is wrong with the bytes: not a scene, of another version or layout, truncated, or
/// corrupted.
[[nodiscard]] Scene load_scene(std::span<const std::byte> bytes);

/// Writes the same bytes to a file, which appears completely or not at all. Throws std::runtime_error naming the file
/// when it cannot be written.
void save_scene(const Scene& scene, const std::string& file);
/// Reads them from a file. Throws std::runtime_error naming the file and what is wrong with it, also when it is missing.
Scene load_scene(const std::string& file);

/// The same for the input of a step.
[[nodiscard]] std::vector<std::byte> save_problem(const StepProblem& problem);
[[nodiscard]] StepProblem load_problem(std::span<const std::byte> bytes);
void save_problem(const StepProblem& problem, const std::string& file);
StepProblem load_problem(const std::string& file);

}  // namespace motley
#pragma GCC visibility pop
