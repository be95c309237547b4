// A scene: bodies, joints, and what is remembered of contacts from step to step. A plain value: copy it to continue
// from one state in two ways.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "motley/core/body.h"
#include "motley/core/boxed.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/crowd.h"
#include "motley/core/ids.h"
#include "motley/core/invalid_input.h"
#include "motley/core/joint_definitions.h"
#include "motley/core/joint_report.h"
#include "motley/core/shapes.h"
#include "motley/core/step_report.h"
#include "motley/core/strided_span.h"

#pragma GCC visibility push(default)
namespace motley {

struct [[gnu::visibility("hidden")]] SceneCore;
struct SixDofDefinition;
struct WeldDefinition;
struct WheelDefinition;
extern template class __attribute__((visibility("default"))) Boxed<SceneCore>;

/// Holds everything that decides what the next step computes. A refused call throws InvalidInput and changes nothing. A
/// call that runs out of memory throws std::bad_alloc and changes nothing either. A scene that was moved from, or whose
/// assignment ran out of memory, may only be assigned to or destroyed.
///
/// Threads. Different scenes are independent of each other. For one scene:
/// - const calls may run at the same time as each other;
/// - set_velocity, set_velocities, set_force and set_forces may run at the same time as each other and as const calls
///   about single bodies or lists of bodies, as long as a body that one of them names is named by no other call: they
///   access only the data of the bodies that they name;
/// - every other call, and a step, must run alone. A second step at the same time is refused; no other violation is
///   detected.
class Scene {
  public:
    Scene();

    // ---- bodies -------------------------------------------------------------------------------------------
    /// Adds a body. Refuses a definition out of the ranges stated at BodyDefinition.
    BodyId add_body(const BodyDefinition& definition);
    /// Adds many and writes their handles to `ids`, which must be as long as `definitions`. Either all are added or
    /// none.
    void add_bodies(std::span<const BodyDefinition> definitions, std::span<BodyId> ids);
    /// Removes a body and every joint on it. Refuses the ground.
    void remove_body(BodyId body);
    /// Removes many, or none: refuses a list that names a body twice, or the ground.
    void remove_bodies(std::span<const BodyId> bodies);
    [[nodiscard]] bool is_alive(BodyId body) const;
    /// The static body at the origin of the world, to which joints with the world are attached.
    [[nodiscard]] BodyId ground() const;
    /// Number of bodies alive, without the ground.
    [[nodiscard]] std::size_t body_count() const;
    /// Replaces the contents of `bodies` by the bodies alive without the ground, in the order of their slots, as bulk
    /// calls take them. Allocates only what the vector lacks.
    void read_bodies(std::vector<BodyId>& bodies) const;

    [[nodiscard]] BodyModel model(BodyId body) const;
    [[nodiscard]] BodyMotion motion(BodyId body) const;
    [[nodiscard]] BodyState state(BodyId body) const;
    /// Teleports a body: `position` of its centre of mass (m, each coordinate -1e12 to 1e12), `orientation` (of a
    /// length from 1e-6 to 1e6; used by rigid, kinematic and static bodies) and `yaw` (rad, -1e9 to 1e9; used by planar
    /// ones), all in the world. Velocities are kept. Joints on it lose their accumulated impulses and counted turns.
    /// Refuses the ground.
    void set_pose(BodyId body, const Vec3<double>& position, const Quat<double>& orientation, double yaw);
    /// Sets the velocity of a body, world, m/s and rad/s, each component -1e9 to 1e9. Refuses a velocity other than
    /// zero of a static body, and of components that the model does not have. Without effect on a contained body: see
    /// revive().
    void set_velocity(BodyId body, const Vec3<float>& linear, const Vec3<float>& angular);
    /// Sets a force (N, at the centre of mass) and a torque (N m), world, finite, that act in every step until changed;
    /// on a contained body only after it is revived. Dynamic bodies only.
    void set_force(BodyId body, const Vec3<float>& force, const Vec3<float>& torque);
    /// Changes the mass (kg, 1e-10 to 1e10) of a dynamic body, and its inertia (kg m2, about the centre of mass in the
    /// body frame, of which the model reads what BodyDefinition::inertia says, in the same ranges). Its pose and
    /// velocities stay; so do its force and torque, as far as their accelerations were finite, with a rounding more.
    /// The next steps have the bits of a body that was added with this mass, if its force is set anew or 0. A
    /// contained body takes it when it is revived. Refuses what add_body refuses, and static and kinematic bodies.
    /// Where the body has joints, the next step lays out all joints anew.
    void set_mass(BodyId body, float mass, const Sym3<float>& inertia);
    /// Changes the damping (1/s, each 0 to 1e6) of a dynamic body: see BodyDefinition::linear_damping. The next steps have
    /// the bits of a body that was added with it. It stays when the body changes its model. Refuses values out of these
    /// ranges, and static and kinematic bodies.
    void set_damping(BodyId body, float linear, float angular);
    /// Gives a dynamic body another model in place: who is near, far or has fallen is modelled by what the scene requires
    /// of them. The handle stays, and with it user data, joints, break limits, island iterations, and what contacts of
    /// the host's list are found again by.
    ///
    /// Kept: the mass, position and linear velocity, bit for bit; the angular momentum and the torque, to the rounding of
    /// floats (for a model with another inertia the angular velocity changes); the force. Joints and contacts keep the
    /// impulses from which the next step starts.
    /// Kept only as far as the new model has it: a planar body has no velocity, force and momentum along z, and no
    /// angular momentum and torque about x and y; it keeps its z. A particle has no rotation and no torque. What is
    /// given up does not come back.
    /// A planar body that becomes rigid is turned by its yaw about z. A rigid one that becomes planar gives up its tilt,
    /// by the least rotation that makes it upright, and gets as its yaw the turn about z that is left, in the turn that
    /// is nearest to the yaw that it had last; upside down it gets that yaw itself. A particle remembers its yaw.
    /// The model that a body has already may be given: then only its inertia and its angular velocity change, and a disc
    /// stays.
    ///
    /// Refuses static, kinematic and contained bodies; a body with a disc that leaves the planar model, which wants
    /// clear_disc() first; inertias out of their ranges, and so small ones that the angular velocity would exceed 1e9
    /// rad/s; and a model that a joint or a capsule on the body cannot have, such as a particle under an anchor off its
    /// centre. A contact of the host's list may be refused by the next step: between planar bodies its normal has z = 0.
    /// Takes a time in proportion to the joints on the body and, in a scene with capsules, to their number; where there
    /// are joints on it, the next step lays out all joints anew.
    void change_body(BodyId body, const BodyChange& change);
    /// A number of the host's own for a body: an index, or a pointer. 0 at birth; kept in copies and files of the
    /// scene. No step reads it. The first call for a scene allocates eight bytes a body.
    void set_user_data(BodyId body, std::uint64_t value);
    [[nodiscard]] std::uint64_t user_data(BodyId body) const;
    /// Lets a contained body move again, from `position` (m, world) with the velocity `linear` (m/s, world) and no
    /// angular velocity; its orientation stays. Refuses a body that is not contained.
    void revive(BodyId body, const Vec3<double>& position, const Vec3<float>& linear);
    /// Whether the body sleeps: see SolverSettings::sleep_speed. A sleeper stays where it is, to the bit, with no speed;
    /// it bears and reports its loads as of when it fell asleep. Its island wakes as a whole: at once by wake() and every
    /// call that changes one of its bodies, their joints, or a wall that touches them; when the next step begins by a
    /// velocity other than zero, and by a force that differs from that of when it fell asleep by enough to bring a free
    /// body to sleep_speed within a second, so that a host may write the same forces in every step; and in the step in
    /// which a body that moves is about to touch it, or in which a contact that pushed is no longer in the host's list.
    [[nodiscard]] bool is_asleep(BodyId body) const;
    /// Wakes the island of a body. Without effect on a body that is awake, kinematic or static.
    void wake(BodyId body);
    /// Whether a step has contained the body: frozen it at its last finite pose because its state became infinite or
    /// NaN.
    [[nodiscard]] bool is_contained(BodyId body) const;

    /// Bulk writes, as set_velocity() and set_force(): element i belongs to bodies[i]. Where `angular` or `torques` is
    /// empty, these values stay as they are.
    void set_velocities(std::span<const BodyId> bodies, StridedSpan<const Vec3<float>> linear,
                        StridedSpan<const Vec3<float>> angular = {});
    void set_forces(std::span<const BodyId> bodies, StridedSpan<const Vec3<float>> forces,
                    StridedSpan<const Vec3<float>> torques = {});
    /// Bulk reads into arrays of the host, world frame, m, m/s, rad/s and rad: element i belongs to bodies[i]. An empty
    /// span of velocities is skipped. Orientations are those of state(): body to world, unit, the identity for a
    /// particle, and from the yaw for a planar body.
    void read_positions(std::span<const BodyId> bodies, StridedSpan<Vec3<double>> positions) const;
    void read_velocities(std::span<const BodyId> bodies, StridedSpan<Vec3<float>> linear,
                         StridedSpan<Vec3<float>> angular = {}) const;
    void read_yaws(std::span<const BodyId> bodies, StridedSpan<double> yaws) const;
    void read_orientations(std::span<const BodyId> bodies, StridedSpan<Quat<double>> orientations) const;

    // ---- joints -------------------------------------------------------------------------------------------
    /// Adds a joint of any type of joint_definitions.h: add_joint(BallSocketDefinition{...}).
    template <class Definition>
    ConstraintId add_joint(const Definition& definition);
    /// Definitions that make several joints have functions of their own; the error names them.
    template <class Definition>
    requires(std::is_same_v<Definition, SixDofDefinition> || std::is_same_v<Definition, WeldDefinition> ||
             std::is_same_v<Definition, WheelDefinition>) ConstraintId add_joint(const Definition&)
    {
        static_assert(!std::is_same_v<Definition, SixDofDefinition>,
                      "a SixDofDefinition makes several joints: call add_six_dof(scene, definition)");
        static_assert(!std::is_same_v<Definition, WeldDefinition>,
                      "a WeldDefinition may make two joints: call add_weld(scene, definition)");
        static_assert(!std::is_same_v<Definition, WheelDefinition>,
                      "a WheelDefinition makes several joints: call add_wheel(scene, definition)");
        return {};
    }
    /// Replaces the definition of a joint: the speed of a motor, the target of a servo, a limit. Its accumulated
    /// impulses are kept. Refuses what add_joint refuses, and a definition of another type or of other bodies.
    template <class Definition>
    void set_joint(ConstraintId joint, const Definition& definition);
    void remove_joint(ConstraintId joint);
    [[nodiscard]] bool is_alive(ConstraintId joint) const;
    [[nodiscard]] std::size_t joint_count() const;
    /// The mean force and torque that a joint applied over the last step, and its position error now.
    [[nodiscard]] JointReport joint_report(ConstraintId joint) const;
    /// The same of many joints: reports[i] is of joints[i].
    void read_joint_reports(std::span<const ConstraintId> joints, StridedSpan<JointReport> reports) const;

    /// Reports the joint in break_events() after every step in which it bore more than `limit`; an infinite limit
    /// reports nothing. The joint holds all the same: the host breaks it by removing it. Refuses limits that are not
    /// above 0.
    void set_break_limit(ConstraintId joint, const BreakLimit& limit);
    /// Joints whose mean force or torque over the last step exceeded their break limit, in the order in which they were
    /// first given one.
    [[nodiscard]] std::span<const BreakEvent> break_events() const;

    // ---- discs and walls, whose contacts the library finds itself -----------------------------------------
    /// Gives a planar, dynamic body the shape of a disc, or another one than it has. From then on steps find its
    /// contacts with other discs and with walls; contacts of the host's list act beside them.
    void set_disc(BodyId body, const DiscDefinition& disc);
    /// The same for many: disc i is of bodies[i].
    void set_discs(std::span<const BodyId> bodies, StridedSpan<const DiscDefinition> discs);
    /// Takes the disc of a body away. Refuses a body without one.
    void clear_disc(BodyId body);
    [[nodiscard]] bool has_disc(BodyId body) const;
    /// Adds a wall. It is removed with its body.
    WallId add_wall(const WallDefinition& wall);
    void remove_wall(WallId wall);
    [[nodiscard]] bool is_alive(WallId wall) const;
    /// The contacts of discs with each other and with walls that pushed in the last step. They were solved in this
    /// order.
    [[nodiscard]] std::vector<DiscContact> disc_contacts() const;
    /// Those of one body with a disc.
    [[nodiscard]] std::vector<DiscContact> disc_contacts_of(BodyId body) const;

    // ---- capsules and half-spaces, likewise ---------------------------------------------------------------
    /// Gives a body a capsule, or a sphere, beside those that it has. From then on steps find its contacts. It is removed
    /// with its body. In a scene with capsules, keys of the host's contacts are below 2^63.
    ShapeId add_capsule(const CapsuleDefinition& capsule);
    /// Adds many and writes their handles to `ids`, which must be as long as `capsules`: all or none.
    void add_capsules(std::span<const CapsuleDefinition> capsules, std::span<ShapeId> ids);
    /// Adds a half-space. It is removed with its body.
    ShapeId add_half_space(const HalfSpaceDefinition& half_space);
    void remove_shape(ShapeId shape);
    [[nodiscard]] bool is_alive(ShapeId shape) const;
    /// The contacts of capsules that were found in the last step, in the order in which they were listed for it: with
    /// half-spaces, with each other, with walls and with discs.
    [[nodiscard]] std::vector<ShapeContact> shape_contacts() const;
    /// Those on one body, which may be of any kind.
    [[nodiscard]] std::vector<ShapeContact> shape_contacts_of(BodyId body) const;

    // ---- memory -------------------------------------------------------------------------------------------
    /// Reorders the bodies so that neighbours in space are neighbours in memory. Handles stay valid and results keep
    /// every bit. Makes the steps of a large crowd faster after its people have mixed. Costs about as much as a step:
    /// call it rarely.
    void renumber_bodies();

    // ---- accuracy where it is wanted ----------------------------------------------------------------------
    /// Sets the least number of sweeps of `solve` in each substep for one joint, 0 to 10000; 0: as SolverSettings says.
    /// The up to fifteen other constraints in its block of lanes are swept as often. Without effect on Method::direct.
    void set_iterations(ConstraintId joint, int at_least);
    /// The same for every joint and contact of the island that contains the body; islands are found anew in every step.
    /// Dynamic bodies only.
    void set_island_iterations(BodyId body, int at_least);

    // ---- contacts -----------------------------------------------------------------------------------------
    /// The impulses of the contacts of the last step, summed over its substeps, in the order of the host's list. They
    /// are what changed the momentum of the bodies. Divided by last_step() they are mean forces.
    [[nodiscard]] std::span<const ContactImpulse> contact_impulses() const;
    /// Their impulses in the last substep alone, which lasted last_substep().
    [[nodiscard]] std::span<const ContactImpulse> last_substep_impulses() const;
    /// Seconds that the last step took, and its last substep: an impulse divided by them is a mean force. 0 before the first step.
    [[nodiscard]] float last_step() const;
    [[nodiscard]] float last_substep() const;

    /// A report on contact `index` of the last step in the form of a joint's: the mean force on b at the contact point,
    /// the depth that the host gave as the error, and active if it pushed in the last substep. `contacts` is the list
    /// of that step. Refuses an index beyond the list, and a list that has another contact there.
    [[nodiscard]] JointReport contact_report(std::span<const Contact> contacts, std::size_t index) const;

    /// The loads that the contacts of the last step put on bodies: loads[i] is of bodies[i], which may be dynamic,
    /// kinematic, static or contained. `contacts` is the list of that step; another list is refused. Contacts of discs
    /// and of capsules count as well. `circumferences` (m, above 0, to 1e9), if given, turn forces into pressures. Allocates
    /// one sum for each body of the scene.
    void read_loads(std::span<const BodyId> bodies, std::span<const Contact> contacts,
                    StridedSpan<BodyLoad> loads, StridedSpan<const float> circumferences = {}) const;

    // ---- whole scene --------------------------------------------------------------------------------------
    /// 64-bit hash of every body's position, orientation and velocity bits, in slot order.
    [[nodiscard]] std::uint64_t state_hash() const;
    /// Position errors of the joints, energy and momentum of the bodies, as they are now.
    [[nodiscard]] SceneErrors errors() const;

  private:
    friend struct SceneAccess;
    Boxed<SceneCore> core_;
};

}  // namespace motley
#pragma GCC visibility pop
