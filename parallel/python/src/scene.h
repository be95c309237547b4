// A scene as Python has it, and what each file of the module adds to its class.
#pragma once

#include <stdexcept>
#include <utility>

#include "values.h"

namespace motley::python {

/// While a step runs on another thread without the interpreter's lock, nobody may look at the scene.
class PythonScene {
  public:
    PythonScene() = default;
    explicit PythonScene(Scene scene) : scene_(std::move(scene)) {}
    /// Throws RuntimeError while the scene is in a step.
    Scene& get()
    {
        if (is_in_step_) throw std::runtime_error("the scene is in a step on another thread");
        return scene_;
    }
    /// Keeps everybody else away while it lives. Made and destroyed with the interpreter's lock.
    class InStep {
      public:
        explicit InStep(PythonScene& scene) : scene_(scene.get()), is_in_step_(scene.is_in_step_)
        {
            is_in_step_ = true;
        }
        ~InStep() { is_in_step_ = false; }
        InStep(const InStep&) = delete;
        InStep& operator=(const InStep&) = delete;
        Scene& scene() { return scene_; }

      private:
        Scene& scene_;
        bool& is_in_step_;
    };

  private:
    Scene scene_;
    bool is_in_step_ = false;
};

using SceneClass = py::class_<PythonScene>;

// Definitions from keyword arguments.
BodyDefinition body_from(const py::kwargs& fields);
CapsuleDefinition capsule_from(std::uint64_t body, const py::object& start, const py::object& end,
                               const py::kwargs& fields);
SixDofDefinition six_dof_from(std::uint64_t body_a, std::uint64_t body_b, const py::kwargs& fields);
/// Adds a joint of a type that has this name.
void add_joint(Figure& figure, const std::string& type, std::uint64_t body_a, std::uint64_t body_b,
               const py::kwargs& fields);

void add_assemblies_to(py::module_& module, SceneClass& scene);
void add_bodies_to(SceneClass& scene);
void add_bulk_calls_to(SceneClass& scene);
void add_crowds_to(SceneClass& scene);
void add_joints_to(SceneClass& scene);
void add_shapes_to(SceneClass& scene);
void add_composed_joints_to(SceneClass& scene);
void add_solver_to(py::module_& module);
void add_queries_to(py::module_& module);

}  // namespace motley::python
