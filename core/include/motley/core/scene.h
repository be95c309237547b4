// A scene: bodies, joints, and the memory of contacts. A plain value: copy it to run one state two ways.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "motley/core/body.h"
#include "motley/core/boxed.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/ids.h"
#include "motley/core/invalid_input.h"
#include "motley/core/joint_definitions.h"
#include "motley/core/joint_report.h"
#include "motley/core/step_report.h"
#include "motley/core/strided_span.h"

namespace motley {

struct SceneCore;
struct SixDofDefinition;
struct WheelDefinition;
extern template class Boxed<SceneCore>;

/// Holds everything that decides what the next step computes. Every call that is refused throws
/// InvalidInput and changes nothing; so does one for which memory runs out, which throws std::bad_alloc. A scene that was
/// moved from, or whose assignment ran out of memory, may be assigned to and destroyed, and nothing else.
///
/// Threads. Different scenes know nothing of each other. Of one scene,
/// - calls that are const may run beside each other;
/// - set_velocity, set_velocities, set_force and set_forces may run beside each other, and beside const calls about one or
///   some bodies, as long as no body that one of them names is named by another: they touch those bodies' rows alone;
/// - every other call, and a step, must be alone. A second step at the same time is refused; nothing else is found out.
class Scene {
  public:
    Scene();

    // ---- bodies -------------------------------------------------------------------------------------------
    /// Adds a body. Refuses a definition out of the ranges stated at BodyDefinition.
    BodyId add_body(const BodyDefinition& definition);
    /// Adds many; `ids` must be as long as `definitions`. Either all are added or none.
    void add_bodies(std::span<const BodyDefinition> definitions, std::span<BodyId> ids);
    /// Removes a body and every joint on it.
    void remove_body(BodyId body);
    /// Removes many. Refuses a list that names a body twice.
    void remove_bodies(std::span<const BodyId> bodies);
    [[nodiscard]] bool is_alive(BodyId body) const;
    /// The static body at the origin to which joints to "the world" are tied.
    [[nodiscard]] BodyId ground() const;
    /// Bodies alive, the ground not counted.
    [[nodiscard]] std::size_t body_count() const;

    [[nodiscard]] BodyModel model(BodyId body) const;
    [[nodiscard]] BodyMotion motion(BodyId body) const;
    [[nodiscard]] BodyState state(BodyId body) const;
    /// Teleports a body. Velocities are kept. Joints on it start cold in the next step.
    void set_pose(BodyId body, const Vec3<double>& position, const Quat<double>& orientation, double yaw);
    /// Sets one body's velocity. Refused for static bodies and for components that the model does not have. Of no effect on
    /// a contained body, which stays where it is: revive() says how it moves.
    void set_velocity(BodyId body, const Vec3<float>& linear, const Vec3<float>& angular);
    /// A force (N) and torque (N m), world, that act in every step until changed; on a contained body once it is revived.
    /// Dynamic bodies only.
    void set_force(BodyId body, const Vec3<float>& force, const Vec3<float>& torque);
    /// Thaws a body that a step contained: the host says where it is and how it moves.
    void revive(BodyId body, const Vec3<double>& position, const Vec3<float>& linear);
    /// True when a step froze the body because its state was not finite.
    [[nodiscard]] bool is_contained(BodyId body) const;

    /// Bulk writes: element i belongs to bodies[i]. `angular`, `torques` may be empty: left alone.
    void set_velocities(std::span<const BodyId> bodies, StridedSpan<const Vec3<float>> linear,
                        StridedSpan<const Vec3<float>> angular = {});
    void set_forces(std::span<const BodyId> bodies, StridedSpan<const Vec3<float>> forces,
                    StridedSpan<const Vec3<float>> torques = {});
    /// Bulk reads into arrays of the host; an empty span is skipped.
    void read_positions(std::span<const BodyId> bodies, StridedSpan<Vec3<double>> positions) const;
    void read_velocities(std::span<const BodyId> bodies, StridedSpan<Vec3<float>> linear,
                         StridedSpan<Vec3<float>> angular = {}) const;
    void read_yaws(std::span<const BodyId> bodies, StridedSpan<double> yaws) const;

    // ---- joints -------------------------------------------------------------------------------------------
    /// Adds a joint of any type of joint_definitions.h: add_joint(BallSocketDefinition{...}).
    template <class Definition>
    ConstraintId add_joint(const Definition& definition);
    /// What makes several joints is added by a function of its own, which this names.
    template <class Definition>
    requires(std::is_same_v<Definition, SixDofDefinition> ||
             std::is_same_v<Definition, WheelDefinition>) ConstraintId add_joint(const Definition&)
    {
        static_assert(!std::is_same_v<Definition, SixDofDefinition>,
                      "a SixDofDefinition makes several joints: call add_six_dof(scene, definition)");
        static_assert(!std::is_same_v<Definition, WheelDefinition>,
                      "a WheelDefinition makes several joints: call add_wheel(scene, definition)");
        return {};
    }
    /// Says a joint anew: a motor's speed, a servo's target, a limit. Type and bodies stay as they are, and so does what
    /// the joint remembers from the last step. Refuses what add_joint refuses, and a definition of another type or of
    /// other bodies.
    template <class Definition>
    void set_joint(ConstraintId joint, const Definition& definition);
    void remove_joint(ConstraintId joint);
    [[nodiscard]] bool is_alive(ConstraintId joint) const;
    [[nodiscard]] std::size_t joint_count() const;
    /// The force and torque that a joint applied over the last step, and its error now.
    [[nodiscard]] JointReport joint_report(ConstraintId joint) const;

    /// Asks to be told when a joint bears more than this; infinite limits ask no more. The joint holds on: whether it
    /// breaks, the host decides, by removing it. Refuses limits that are not above 0.
    void set_break_limit(ConstraintId joint, const BreakLimit& limit);
    /// Joints that bore more than their limit on average over the last step, in the order in which they were first watched.
    [[nodiscard]] std::span<const BreakEvent> break_events() const;

    // ---- memory -------------------------------------------------------------------------------------------
    /// Puts bodies that are near each other near each other in memory. Handles and results stay what they are, to the bit;
    /// steps of a large crowd whose people have mixed get faster. Costs about a step: call it now and then.
    void renumber_bodies();

    // ---- accuracy where it is wanted ----------------------------------------------------------------------
    /// Asks for at least so many sweeps of `solve` a substep for one joint, 0 to 10000; 0: as the solver's settings say.
    /// The up to fifteen constraints that share its block are swept along. Not of Method::direct.
    void set_iterations(ConstraintId joint, int at_least);
    /// The same for every joint and contact of the island that the body is in, as it is in each step. Dynamic bodies only.
    void set_island_iterations(BodyId body, int at_least);

    // ---- contacts -----------------------------------------------------------------------------------------
    /// What the contacts of the last step did in all its substeps together, in the order of its list: what changed the
    /// bodies' momentum. Divided by last_step() it is the mean force.
    [[nodiscard]] std::span<const ContactImpulse> contact_impulses() const;
    /// What they did in its last substep alone, which takes last_substep().
    [[nodiscard]] std::span<const ContactImpulse> last_substep_impulses() const;
    /// Seconds of the last step, and of its last substep: they turn impulses into forces. 0 before the first step.
    [[nodiscard]] float last_step() const;
    [[nodiscard]] float last_substep() const;

    /// What contact `index` of the list of the last step did, as a joint tells it: the force on b at the point, the depth
    /// that the host gave, active when it pushed. Refuses an index beyond the last list, or another contact's.
    [[nodiscard]] JointReport contact_report(std::span<const Contact> contacts, std::size_t index) const;

    /// What bodies bear of the contacts of the last step, `contacts` being its list: element i is of bodies[i], be it
    /// dynamic, kinematic, static or contained. `circumferences` (m, > 0), if there are any, give the pressure of each.
    /// Refuses another list. Allocates room for a sum a body of the scene.
    void read_loads(std::span<const BodyId> bodies, std::span<const Contact> contacts,
                    StridedSpan<BodyLoad> loads, StridedSpan<const float> circumferences = {}) const;

    // ---- whole scene --------------------------------------------------------------------------------------
    /// 64-bit hash of every body's position, orientation and velocity bits, in slot order.
    [[nodiscard]] std::uint64_t state_hash() const;
    [[nodiscard]] SceneErrors errors() const;

  private:
    friend struct SceneAccess;
    Boxed<SceneCore> core_;
};

}  // namespace motley
