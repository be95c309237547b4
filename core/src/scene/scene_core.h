// What a scene consists of. A host sees a Scene; the solver, the files and the reference open it with core_of().
#pragma once

#include <cstdint>
#include <span>

#include "motley/core/boxed.h"
#include "motley/core/scene.h"
#include "scene/sleep.h"
#include "stores/array.h"
#include "stores/body_store.h"
#include "stores/busy_flag.h"
#include "stores/contact_cache.h"
#include "stores/disc_store.h"
#include "stores/shape_store.h"

namespace motley {

/// Impulses of a body's contacts in the last step, N s.
struct Borne {
    double normal = 0, largest = 0;
    Vec3<double> net{};
};

struct JointBodies;
struct JointStores;
extern template class Boxed<JointStores>;

/// At least so many sweeps of `solve` a substep for the island of a body.
struct IslandIterations {
    BodyId body;
    int at_least;
};

/// Copies with its scene. Its functions are what the calls of Scene are made of.
struct SceneCore {
    BodyStore bodies;
    Boxed<JointStores> joints;
    ContactCache contacts;
    DiscStore discs;
    ShapeStore shapes;
    SleepStore sleep;
    Array<BreakEvent> break_events;             ///< with room for every watched joint
    Array<IslandIterations> island_iterations;  ///< of bodies alive
    Array<std::uint64_t> user_data;             ///< by body slot, of the host; 0 beyond its end
    BodyId ground{};
    std::size_t body_count = 0;  ///< alive, without the ground
    BusyFlag busy;               ///< held by a step for as long as it lasts
    /// Seconds of the last step and of its last substep: they turn impulses into forces. 0 before the first step.
    float last_step = 0, last_substep = 0;

    /// Handles of all kinds begin with this generation, so that those of other scenes are refused. Before the first one.
    void begin_generations(std::uint32_t first);
    [[nodiscard]] bool is_alive(ConstraintId joint) const;
    [[nodiscard]] BodyState state(BodyId body) const;
    /// Body to world, unit; the identity for a particle.
    [[nodiscard]] Quat<double> orientation(BodyRow where) const;
    /// World, m/s and rad/s.
    struct Velocity {
        Vec3<float> linear{}, angular{};
    };
    [[nodiscard]] Velocity velocity(BodyRow where) const;
    [[nodiscard]] JointReport joint_report(ConstraintId joint) const;
    /// Whether any joint or island wants more sweeps than the settings say.
    [[nodiscard]] bool asks_for_iterations() const;

    /// Makes room for a break event of each watched joint; then find_break_events() allocates nothing.
    void make_room_for_break_events();
    /// Finds the joints that bore more than their limit, once a step is done.
    void find_break_events() noexcept;

    // What a call refuses. `what` names the argument in the message.
    [[gnu::always_inline]] void require_alive(BodyId body, const char* what) const
    {
        if (!bodies.is_alive(body)) refuse_dead(body, what);
    }
    void require_alive(std::span<const BodyId> named, const char* what) const;
    void require_alive(ConstraintId joint, const char* what) const;
    [[noreturn]] static void refuse_dead(BodyId body, const char* what);
    JointBodies check_joint_bodies(BodyId a, BodyId b) const;
    /// Refuses what Scene::change_body refuses.
    void check_change(BodyId body, const BodyChange& change) const;
    /// Refuses a model of a body under which one of its joints would be refused, and names the joint.
    void check_joints_after(BodyId body, BodyModel model) const;
    static void check_break_limit(const BreakLimit& limit);
    static void check_wish(const char* field, int at_least);
    void check_island_wish(const IslandIterations& asked) const;
    void check_velocity(BodyId body, const Vec3<float>* linear, const Vec3<float>* angular) const;
    void require_list_of_last_step(std::span<const Contact> list, const char* what) const;
    [[nodiscard]] std::size_t index_of_joint(ConstraintId joint, int type) const;

    // ---- discs: scene_discs.cpp ----
    void check_has_disc(BodyId body, const char* what) const;
    [[nodiscard]] bool has_disc(BodyId body) const { return discs.shape_of(body.slot) != nullptr; }
    /// Refuses what Scene::add_wall refuses.
    void check_wall(const WallDefinition& wall) const;
    /// Makes room for so many walls of so many segments in all, so that put_wall() cannot fail.
    void make_room_for_walls(std::size_t walls, std::size_t segments);
    /// Adds a wall that is checked.
    WallId put_wall(const WallDefinition& wall);
    /// Calls work(DiscImpulse) for each contact of discs that pushed in the last step.
    template <class Work>
    void for_each_disc_impulse(const Work& work) const;
    /// Adds what discs bore to `borne`, by slot.
    void bear_disc_impulses(std::span<Borne> borne) const;
    /// What this is as a load on a body with such a circumference, m; 0: not known.
    [[nodiscard]] BodyLoad load_of(const Borne& borne, float circumference) const;

    // ---- capsules and half-spaces: scene_shapes.cpp ----
    /// Refuses what Scene::add_capsule and Scene::add_half_space refuse.
    void check_capsule(const CapsuleDefinition& capsule) const;
    void check_half_space(const HalfSpaceDefinition& half_space) const;
    /// Refuses ends of a capsule that a dynamic body of such a model cannot have.
    static void check_capsule_on(BodyModel model, const Vec3<float>& from, const Vec3<float>& to);
    /// Makes room, so that putting so many shapes cannot fail. Refuses more than keys of contacts can name.
    void make_room_for_shapes(std::size_t capsules, std::size_t half_spaces);
    /// Adds a capsule that is checked, and for which there is room.
    ShapeId put_capsule(const CapsuleDefinition& capsule);
    /// The impulses of the contacts that were found in the last step; they are of shapes.contacts.
    [[nodiscard]] std::span<const ContactImpulse> shape_impulses() const;
    /// Calls work(contact, impulse, wall) for each of them whose bodies, and whose wall if there is one, are still there.
    template <class Work>
    void for_each_shape_impulse(const Work& work) const
    {
        const std::span<const ContactImpulse> impulses = shape_impulses();
        for (std::size_t i = 0; i < impulses.size(); ++i) {
            const Contact& contact = shapes.contacts[i];
            const WallId wall = shapes.walls_met[i].wall;
            if (!bodies.is_alive(contact.body_a) || !bodies.is_alive(contact.body_b)) continue;
            if (wall == WallId{} || discs.is_alive(wall)) work(contact, impulses[i], wall);
        }
    }
    /// How many of the contacts of the last step were of the host's list.
    [[nodiscard]] std::size_t listed_contacts() const
    {
        return contacts.current().count - shapes.contacts.size();
    }

    ConstraintId take_joint_slot(int type, std::size_t index);
    void remove_joints_of(std::span<const BodyId> removed);
    void remove_joint_at(int type, std::size_t index);
    /// The discs of bodies that are about to be removed, and the walls on them.
    void remove_discs_of(std::span<const BodyId> removed);
    /// After a teleport: contacts of a disc, or of the walls on a body, start anew.
    void forget_discs_of(BodyId moved);
    /// BodyStore::renumber, and what is kept by row follows.
    void renumber_rows();
    /// Moves planar bodies with discs to where their neighbours are in memory: into the order of the strips, and all others
    /// behind them. Results keep every bit.
    void sort_disc_rows();

    // ---- sleep: scene_sleep.cpp, by the rules in sleep.h ----
    /// Wakes the island of a body at once, if it sleeps; or all islands.
    void wake_island(std::uint32_t slot);
    void wake_all();
    /// After a step that has contained bodies: wakes the islands of sleepers that took part.
    void wake_contained();
    /// Wakes the islands of the bodies that joints connect with this one.
    void wake_joined_to(BodyId body);
    /// Wakes those with a disc within `reach`, m, of a segment, or that touch a wall on this body.
    void wake_near(const WallSegment& segment, double reach);
    void wake_near_walls_of(BodyId body);
    /// Marks a sleeper, whose island then wakes when the next step begins; or notes that a body that is not dynamic has
    /// been moved. Changes the data of this body alone, as the rule on threads at Scene wants it.
    void rouse(BodyId body);
    /// Rouses a sleeper if its acceleration has changed so much since it fell asleep.
    void rouse_if_pushed(BodyId body);

    void write_velocity(BodyId body, const Vec3<float>* linear, const Vec3<float>* angular);
    /// The mean force or torque over the last step of an impulse of that step.
    [[nodiscard]] Vec3<float> force_of(const Vec3<float>& impulse) const;
};

/// Opens scenes.
struct SceneAccess {
    static SceneCore& core(Scene& scene) { return *scene.core_; }
    static const SceneCore& core(const Scene& scene) { return *scene.core_; }
};
inline SceneCore& core_of(Scene& scene)
{
    return SceneAccess::core(scene);
}
inline const SceneCore& core_of(const Scene& scene)
{
    return SceneAccess::core(scene);
}

}  // namespace motley
