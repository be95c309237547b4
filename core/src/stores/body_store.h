// Bodies as rows. What a sweep reads of a body lies together in quads of four floats, 16 bytes a row for
// particles and planar bodies, 32 for rigid ones, because loading bodies into lanes and storing them is what costs.
//
//   kind      velocity                     delta since the step began       acceleration
//   particle  vx vy vz 1/m                 dx dy dz  -                      ax ay az  -
//   planar    vx vy w  1/m                 dx dy yaw 1/I                    ax ay alpha -
//   rigid     vx vy vz 1/m | wx wy wz -    dx dy dz  - | qx qy qz qw        ax ay az - | tx ty tz -  (torque)
//   fixed     as rigid with 1/m = 0        as rigid                         zero
//
// Positions stay in double (or, if the build says so, in float); the lanes only ever see differences and the deltas of
// one step.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "maths/flight.h"
#include "motley/core/body.h"
#include "motley/core/ids.h"
#include "stores/aligned_vector.h"
#include "stores/permutation.h"

namespace motley {

/// Where the rows of a body are kept. Static and kinematic bodies are `fixed`: read by lanes, never written.
enum class BodyKind : std::uint8_t { particle, planar, rigid, fixed };
inline constexpr int body_kind_count = 4;

/// Quads in the velocity, delta and acceleration rows of a kind.
constexpr int quads_of(BodyKind kind)
{
    return kind == BodyKind::rigid || kind == BodyKind::fixed ? 2 : 1;
}

/// The kind of a body, in two bits, and its row, in thirty.
struct BodyRow {
    std::uint32_t bits = 0;
    BodyRow() = default;
    BodyRow(BodyKind kind, std::uint32_t row) : bits(static_cast<std::uint32_t>(kind) << 30 | row) {}
    [[nodiscard]] BodyKind kind() const { return static_cast<BodyKind>(bits >> 30); }
    [[nodiscard]] std::uint32_t row() const { return bits & 0x3FFFFFFFU; }
    friend bool operator==(const BodyRow&, const BodyRow&) = default;
};

/// Whether a body sleeps: see scene/sleep.h.
enum class Sleep : std::uint8_t {
    awake,
    asleep,
    roused  ///< it sleeps until the next step begins; of a body that is not dynamic: it was changed since the last step
};

/// The damping of a body, 1/s: see BodyDefinition::linear_damping.
struct Damping {
    float linear = 0, angular = 0;
    [[nodiscard]] bool is_any() const { return linear > 0 || angular > 0; }
};

/// The type of positions and orientations from step to step. Floats halve their bytes, but resolve positions at 1 km
/// from the origin only to 0.06 mm.
#ifdef MOTLEY_FLOAT_POSITIONS
using PoseReal = float;
#else
using PoseReal = double;
#endif

/// The position of a body, m, and, of a planar one, its yaw, rad. Orientations of rigid and fixed bodies are in
/// BodyRows.
struct BodyPose {
    Vec3<PoseReal> position{};
    PoseReal yaw = 0;
};

/// 1/kg, and 1/(kg m2) in the body's frame. Zeros for bodies that are not rigid or cannot move.
struct RigidMass {
    float inverse_mass = 0;
    Sym3<float> inverse_inertia{};
};

/// The rows of one kind. Row 0 is the null body of padding lanes: it cannot move and nothing is tied to it.
struct BodyRows {
    AlignedVector<float> velocity, delta, acceleration;
    AlignedVector<float> unpushed;  ///< as velocity: its value in this substep before any constraint impulse
    AlignedVector<BodyPose> pose;
    AlignedVector<Quat<PoseReal>> orientation;   ///< rigid and fixed only
    AlignedVector<float> world_inverse_inertia;  ///< rigid, and zero for fixed: xx xy xz yy | yz zz - -
    AlignedVector<float> start_inverse_inertia;  ///< the same when the step began
    AlignedVector<Sym3<float>> inertia;          ///< rigid only, body frame
    AlignedVector<Sym3<float>> inverse_inertia;  ///< rigid only, body frame
    Array<std::uint32_t> slot;                   ///< the handle slot of each row, 0 for a free one
    Array<std::uint32_t> free_rows;              ///< the last one is reused first
    /// A bit for each row, which is 1 if there is a body that does not sleep, in words of a group of rows. Steps skip groups
    /// without any: small ones, because the rows of those who are awake lie among those of sleepers.
    Array<std::uint16_t> awake;
    static constexpr std::uint32_t rows_per_group = 16;
    static constexpr std::uint32_t rows_per_chunk = 1024;
    /// Whether the group of this row has a body that is awake.
    [[nodiscard]] bool is_awake_beside(std::uint32_t row) const { return awake[row / rows_per_group] != 0; }
    void set_awake(std::uint32_t row, bool is_awake)
    {
        const auto bit = static_cast<std::uint16_t>(1U << row % rows_per_group);
        std::uint16_t& group = awake[row / rows_per_group];
        group = static_cast<std::uint16_t>(is_awake ? group | bit : group & ~bit);
    }
    /// The words of `awake` of a chunk of rows.
    [[nodiscard]] std::span<const std::uint16_t> awake_in_chunk(std::int64_t chunk) const
    {
        constexpr std::size_t groups = rows_per_chunk / rows_per_group;
        const auto from = std::span(awake).subspan(static_cast<std::size_t>(chunk) * groups);
        return from.first(std::min(groups, from.size()));
    }
    [[nodiscard]] bool is_chunk_awake(std::int64_t chunk) const
    {
        const std::span<const std::uint16_t> groups = awake_in_chunk(chunk);
        return std::any_of(groups.begin(), groups.end(), [](std::uint16_t rows) { return rows != 0; });
    }
    /// Calls work(row) for each row of a chunk whose body is awake, also where work() puts one to sleep.
    template <class Work>
    void for_each_awake_row(std::int64_t chunk, const Work& work) const
    {
        auto first = static_cast<std::uint32_t>(chunk) * rows_per_chunk;
        for (const std::uint16_t group : awake_in_chunk(chunk)) {
            for (unsigned rows = group; rows != 0; rows &= rows - 1)
                work(first + static_cast<std::uint32_t>(std::countr_zero(rows)));
            first += rows_per_group;
        }
    }
    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(slot.size()); }
};

/// The rows of every kind, and the table from handles to rows.
class BodyStore {
  public:
    BodyStore();

    /// Reserves room for these, so that add() cannot fail.
    void make_room(std::span<const BodyDefinition> definitions);
    /// Adds a checked definition.
    BodyId add(const BodyDefinition& definition);
    /// Reserves room in the lists of free rows and slots, so that remove() of these cannot fail.
    void make_room_to_remove(std::span<const BodyId> bodies);
    /// Frees the slot and row of a live body.
    void remove(BodyId body);
    /// Changes the mass, kg, and the inertia, kg m2, of a dynamic body; both are checked. Its velocity stays, and so
    /// does the force on it, to rounding.
    void set_mass(BodyId body, float mass, const Sym3<float>& inertia);
    /// Reserves room so that change() of this body to this model cannot fail.
    void make_room_to_change(BodyId body, BodyModel model);
    /// The angular velocity, rad/s, that keeps the angular momentum of a dynamic body through a change.
    [[nodiscard]] Vec3<double> angular_velocity_after(BodyId body, const BodyChange& change) const;
    /// Does what Scene::change_body says of a dynamic body that moves. The change is checked.
    void change(BodyId body, const BodyChange& change);
    /// Gives every body a new row, in the order of a space-filling curve, and closes the gaps of free rows.
    void renumber();
    /// Moves the planar body in row i to row new_rows[i], and calls swap(i, j) for what else is kept by row whenever two
    /// rows are swapped. `new_rows` is a permutation that keeps row 0; afterwards it is the identity.
    template <class Swap>
    void permute_planar(std::span<std::uint32_t> new_rows, const Swap& swap)
    {
        for (std::uint32_t& row : rows(BodyKind::planar).free_rows) row = new_rows[row];
        permute(new_rows, [&](std::uint32_t i, std::uint32_t j) {
            swap_planar(i, j);
            swap(i, j);
        });
        enter_rows(BodyKind::planar);
    }
    /// Bulk calls ask for each of their bodies: a call that is not inlined takes longer than what it looks up.
    [[nodiscard, gnu::always_inline]] bool is_alive(BodyId body) const
    {
        // A removal increments the generation, so a handle that matches is alive; slot 0 is the null handle's.
        return body.slot < slots_.size() && slots_[body.slot].generation == body.generation && body.slot != 0;
    }
    [[nodiscard]] BodyRow row_of(BodyId body) const { return slots_[body.slot].row; }
    /// Prefetches what is_alive() and row_of() will read. Any handle is allowed, also of a removed body.
    void prefetch(BodyId body) const { __builtin_prefetch(slots_.data() + body.slot); }
    [[nodiscard]] BodyId id_of_slot(std::uint32_t slot) const { return {slot, slots_[slot].generation}; }
    /// Slots ever used; slot 0 is never a body.
    [[nodiscard]] std::uint32_t slot_count() const { return static_cast<std::uint32_t>(slots_.size()); }
    [[nodiscard]] bool is_slot_live(std::uint32_t slot) const { return live_[slot] != 0; }

    [[nodiscard]] BodyRows& rows(BodyKind kind) { return rows_[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] const BodyRows& rows(BodyKind kind) const { return rows_[static_cast<std::size_t>(kind)]; }

    [[nodiscard]] BodyMotion motion(BodyId body) const { return motions_[body.slot]; }
    [[nodiscard]] BodyModel model(BodyId body) const { return models_[body.slot]; }
    /// For each slot the first end in its list of joints (JointStores::ends); 0 when there is none.
    Array<std::uint32_t> first_ends;
    /// For each slot 1 if a step froze the body because its state was not finite: its constraints are then left out.
    Array<std::uint8_t> contained;
    std::size_t contained_count = 0;
    [[nodiscard]] bool is_contained(BodyRow where) const
    {
        return contained_count > 0 && contained[rows(where.kind()).slot[where.row()]] != 0;
    }
    /// For each slot whether the body sleeps. A sleeper's row has no speed and no inverse mass, as a contained body's.
    Array<Sleep> sleep;
    std::size_t sleepers = 0;  ///< dynamic bodies that sleep
    [[nodiscard]] bool is_asleep(std::uint32_t slot) const
    {
        return sleepers > 0 && sleep[slot] != Sleep::awake && motions_[slot] == BodyMotion::dynamic_body;
    }
    [[nodiscard]] bool is_asleep(BodyRow where) const
    {
        return sleepers > 0 && where.kind() != BodyKind::fixed &&
               sleep[rows(where.kind()).slot[where.row()]] != Sleep::awake;
    }
    /// s, for each slot: for how long the body has been slower than SolverSettings::sleep_speed.
    Array<float> slow_for;
    /// Takes speed and inverse mass from the row of an awake, dynamic body...
    void fall_asleep(std::uint32_t slot);
    /// ...and gives the inverse mass of a sleeper back, unless it is contained.
    void wake(std::uint32_t slot);

    /// For each slot the inverse mass, 1/kg; kept while the body is contained, for its revival.
    AlignedVector<float> inverse_masses;
    [[nodiscard]] RigidMass rigid_mass_of(BodyRow body) const
    {
        if (body.kind() != BodyKind::rigid) return {};
        const BodyRows& rigid = rows(BodyKind::rigid);
        return {inverse_masses[rigid.slot[body.row()]], rigid.inverse_inertia[body.row()]};
    }
    Array<float> inverse_inertias;  ///< likewise, planar only
    /// 1/(kg m2): at least the trace of the inverse inertia of each rigid body that there is or was; see torque.h.
    float largest_response = 0;

    Array<Damping> dampings;  ///< for each slot; none for bodies that are not dynamic
    std::size_t damped = 0;   ///< how many of them are above 0
    void set_damping(std::uint32_t slot, const Damping& damping)
    {
        damped += (damping.is_any() ? 1U : 0U) - (dampings[slot].is_any() ? 1U : 0U);
        dampings[slot] = damping;
    }

    /// Adds the deltas of a step to the poses of rows [begin, end) of a kind, minus the excess of free flight (see
    /// Flight), and clears them. A body whose velocity or delta is not finite keeps its pose, loses its velocity and is
    /// contained; the least slot of such bodies goes to `contained_slot`. Returns how many were contained.
    int commit(BodyKind kind, std::uint32_t begin, std::uint32_t end, const Flight& flight,
               std::uint32_t& contained_slot);
    /// After the commits of a step: gives planar bodies that were stiffened for it (tension.h) their own inertia back.
    /// That of rigid bodies is recomputed by every commit.
    void restore_planar_inertia();
    /// Ends the containment of a body: gives it its mass and inertia back.
    void revive(BodyId body);
    /// Handles begin with this generation from now on. Without bodies.
    void begin_generations(std::uint32_t first) { slots_[0].generation = first; }
    /// Computes what follows from other fields and is not stored in files: displacements, inverse inertias, counts.
    void derive();
    /// World inverse inertia of a rigid row from its orientation, now and for the start of the next step.
    void refresh_world_inertia(std::uint32_t row);

  private:
    friend struct SceneArchive;
    std::array<BodyRows, body_kind_count> rows_;
    struct Slot {
        std::uint32_t generation = 1;
        BodyRow row;
    };
    AlignedVector<Slot> slots_;  ///< the first is the null handle's: new slots get its generation
    Array<std::uint8_t> live_;
    Array<BodyModel> models_;
    AlignedVector<BodyMotion> motions_;
    Array<std::uint32_t> free_slots_;

    /// Reserves room for so many more bodies of a kind, so that take_row() cannot fail.
    void make_room_in_rows(BodyKind kind, std::size_t more);
    std::uint32_t take_row(BodyKind kind);
    /// Frees a row, and stops it: nothing may move it.
    void free_row(BodyRow where);
    /// A body as a row has it, whatever its kind. Numbers that a kind lacks are zero.
    struct Content {
        BodyPose pose;
        Quat<PoseReal> orientation{0, 0, 0, 1};  ///< rigid and fixed
        Vec3<float> linear, angular;             ///< velocity, m/s and rad/s
        Vec3<float> acceleration;                ///< by the force, m/s2
        Vec3<float> torque;                      ///< N m
    };
    [[nodiscard]] Content read(BodyRow where) const;
    /// Gives a slot a row with this content and, if it is planar or rigid, this inertia.
    void write(std::uint32_t slot, BodyRow where, const Content& content, const Sym3<float>& inertia);
    /// The inverse inertia of a rigid row from its inertia, and largest_response.
    void invert_inertia(std::uint32_t row);
    /// Takes the inverse mass and inertia from a row, so that nothing moves it; or gives them back.
    void freeze(std::uint32_t slot);
    void thaw(std::uint32_t slot);
    /// Notes which bodies of a kind are awake.
    void note_awake(BodyKind kind);
    void swap_planar(std::uint32_t i, std::uint32_t j);
    /// Enters the rows of a kind into the table of slots.
    void enter_rows(BodyKind kind);
};

}  // namespace motley
