// Every field of a scene that outlives a step and does not follow from others, named once for writing and reading
// alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "scene/scene_core.h"
#include "stores/array.h"
#include "stores/disc_fields.h"
#include "stores/joint_store.h"

namespace motley {

/// Writes fields as bytes. The bytes between and behind the members of a struct are written as zeros (g++ only; other
/// compilers cannot tell them, and write what lies there), so that equal scenes have equal files.
class ArchiveWriter {
  public:
    static constexpr bool reads = false;
    std::vector<std::byte> bytes;

    template <class T>
    void operator()(const T& value)
    {
        append_each(&value, 1);
    }
    template <class T, class Allocator>
    void operator()(const std::vector<T, Allocator>& values)
    {
        (*this)(static_cast<std::uint64_t>(values.size()));
        append_each(values.data(), values.size());
    }

  private:
    template <class T>
    void append_each(const T* values, std::size_t count)
    {
        static_assert(std::is_trivially_copyable_v<T>);
#if __has_builtin(__builtin_clear_padding)
        if constexpr (!std::is_arithmetic_v<T> && !std::has_unique_object_representations_v<T>) {
            for (std::size_t i = 0; i < count; ++i) {
                T value = values[i];
                __builtin_clear_padding(&value);
                append(&value, sizeof value);
            }
            return;
        }
#endif
        append(values, count * sizeof(T));
    }
    void append(const void* from, std::size_t size)
    {
        const auto* first = static_cast<const std::byte*>(from);
        bytes.insert(bytes.end(), first, first + size);
    }
};

/// Reads fields from bytes. Throws std::runtime_error rather than read past the end.
class ArchiveReader {
  public:
    static constexpr bool reads = true;
    explicit ArchiveReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <class T>
    void operator()(T& value)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        take(&value, sizeof value);
    }
    template <class T, class Allocator>
    void operator()(std::vector<T, Allocator>& values)
    {
        std::uint64_t count = 0;
        (*this)(count);
        if (count > rest_.size() / sizeof(T)) throw std::runtime_error("ends in the middle of a list");
        values.resize(static_cast<std::size_t>(count));
        take(values.data(), values.size() * sizeof(T));
    }
    [[nodiscard]] bool is_done() const { return rest_.empty(); }

  private:
    std::span<const std::byte> rest_;
    void take(void* to, std::size_t size)
    {
        if (size > rest_.size()) throw std::runtime_error("ends in the middle of a field");
        if (size > 0) std::memcpy(to, rest_.data(), size);
        rest_ = rest_.subspan(size);
    }
};

/// A friend of Scene and BodyStore that reads and writes their private fields.
struct SceneArchive {
    template <class Archive, class S>
    static void visit(Archive& archive, S& scene)
    {
        visit_bodies(archive, scene.bodies);
        visit_joints(archive, *scene.joints);
        visit_contacts(archive, scene.contacts);
        visit_discs(archive, scene.discs);
        visit_shapes(archive, scene.shapes);
        visit_sleep(archive, scene.sleep);
        archive(scene.user_data);
        archive(scene.island_iterations);
        archive(scene.ground);
        archive(scene.body_count);
        archive(scene.last_substep);
        archive(scene.last_step);
        if constexpr (Archive::reads) {
            check(scene);
            derive(scene);
        }
    }

  private:
    /// Throws unless the scene is one that a host could have made: every index is valid, and bad input is refused here
    /// by the same checks as in Scene.
    static void check(const SceneCore& scene);
    static void check_bodies(const SceneCore& scene);
    static void check_joints(const SceneCore& scene);
    static void check_discs(const SceneCore& scene);
    static void check_capsules(const SceneCore& scene);
    static void check_sleep(const SceneCore& scene);
    /// Computes what is not stored in files.
    static void derive(SceneCore& scene);

    template <class Archive, class Store>
    static void visit_bodies(Archive& archive, Store& bodies)
    {
        for (auto& rows : bodies.rows_) {
            archive(rows.velocity);
            archive(rows.acceleration);
            archive(rows.pose);
            archive(rows.orientation);
            archive(rows.inertia);
            archive(rows.slot);
            archive(rows.free_rows);
        }
        archive(bodies.slots_);
        archive(bodies.live_);
        archive(bodies.models_);
        archive(bodies.motions_);
        archive(bodies.free_slots_);
        archive(bodies.contained);
        archive(bodies.sleep);
        archive(bodies.slow_for);
        archive(bodies.inverse_masses);
        archive(bodies.inverse_inertias);
        archive(bodies.dampings);
    }
    template <class Archive, class Stores>
    static void visit_joints(Archive& archive, Stores& joints)
    {
        joints.for_each([&](auto& store, int) {
            archive(store.definitions);
            archive(store.memory);
            archive(store.wrenches);
            archive(store.colours);
            archive(store.slots);
        });
        archive(joints.slots);
        archive(joints.free_slots);
        archive(joints.added);
        archive(joints.watched);
    }
    template <class Archive, class Store>
    static void visit_sleep(Archive& archive, Store& sleep)
    {
        archive(sleep.sleepers);
        archive(sleep.speed);
        archive(sleep.gravity);
        archive(sleep.pause);
    }
    /// The blocks as they are solved, without the room behind them.
    template <class Archive, class Store>
    static void visit_discs(Archive& archive, Store& discs)
    {
        archive(discs.shapes);
        archive(discs.walls);
        archive(discs.free_walls);
        archive(discs.segments);
        archive(discs.anchors);
        archive(discs.wall_ends);
        archive(discs.wall_skin);
        archive(discs.found_at);
        archive(discs.frame);
        archive(discs.late);
        archive(discs.late_reach);
        archive(discs.late_drift);
        archive(discs.age);
        auto is_stale = static_cast<std::uint8_t>(discs.is_stale),
             is_divided = static_cast<std::uint8_t>(discs.is_divided);
        archive(is_stale);
        archive(is_divided);
        auto bands = static_cast<std::uint64_t>(discs.band_count);
        archive(bands);
        if constexpr (Archive::reads) {
            if (is_stale > 1 || is_divided > 1)
                throw std::runtime_error("has discs that are neither found nor not");
            discs.is_stale = is_stale != 0;
            discs.is_divided = is_divided != 0;
            if (bands > discs.anchors.size() + 2) throw std::runtime_error("has more bands than discs");
            discs.band_count = static_cast<std::size_t>(bands);
            discs.bands.resize(discs.band_count);
        }
        for (std::size_t band = 0; band < discs.band_count; ++band) {
            archive(discs.bands[band].half_awake);
            for_each_disc_blocks(discs.bands[band], [&](auto c, auto& blocks) {
                using Fields = DiscFieldsOf<c.value>;
                archive(blocks.count);
                const std::size_t count = blocks.count < 0 ? 0 : static_cast<std::size_t>(blocks.count);
                visit_first(archive, blocks.bodies, count);
                visit_first(archive, blocks.lanes, count);
                visit_first(archive, blocks.rows, count * block_lanes * Fields::row_floats);
                visit_first(archive, blocks.impulses, count * block_lanes * Fields::impulse_floats);
                visit_first(archive, blocks.sums, count * block_lanes * Fields::impulse_floats);
                if constexpr (is_wall(c.value)) visit_first(archive, blocks.touches, count * block_lanes);
            });
        }
    }
    template <class Archive, class Store>
    static void visit_shapes(Archive& archive, Store& shapes)
    {
        archive(shapes.slots);
        archive(shapes.free_slots);
        archive(shapes.capsules);
        archive(shapes.half_spaces);
        archive(shapes.next_group);
        archive(shapes.contacts);
        archive(shapes.walls_met);
    }
    /// The first `count` elements of a vector that may have more; read back, it has no more.
    template <class Archive, class Vector>
    static void visit_first(Archive& archive, Vector& values, std::size_t count)
    {
        if constexpr (Archive::reads) {
            archive(values);
            if (values.size() != count) throw std::runtime_error("has lists of different lengths");
        } else {
            archive(Vector(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count)));
        }
    }
    /// Only the list of the last step: the table of keys does not affect results.
    template <class Archive, class Cache>
    static void visit_contacts(Archive& archive, Cache& cache)
    {
        if constexpr (Archive::reads) {
            Array<ContactList::Entry> entries;
            Array<std::uint8_t> colours;
            Array<ContactImpulse> impulses, step_impulses;
            Array<std::uint32_t> sleepers;
            archive(entries);
            archive(colours);
            archive(impulses);
            archive(step_impulses);
            archive(sleepers);
            if (entries.size() > UINT32_MAX / 2) throw std::runtime_error("has more contacts than fit");
            if (colours.size() != entries.size() || impulses.size() != entries.size() ||
                step_impulses.size() != entries.size() ||
                (!sleepers.empty() && sleepers.size() != entries.size()))
                throw std::runtime_error("has lists of different lengths");
            if (!cache.restore(entries, colours, impulses, step_impulses, sleepers))
                throw std::runtime_error("has a contact key twice");
        } else {
            const ContactList& list = cache.current();
            const auto in_use = [&](const auto& values, std::size_t from) {
                using Value = std::remove_cvref_t<decltype(values[0])>;
                const auto first = values.begin() + static_cast<std::ptrdiff_t>(from);
                return Array<Value>(first, first + static_cast<std::ptrdiff_t>(list.count));
            };
            archive(in_use(list.entries, 0));
            archive(in_use(list.colours, 0));
            archive(in_use(list.impulses, 1));
            archive(in_use(list.step_impulses, 0));
            archive(list.has_sleepers ? in_use(list.sleepers, 0) : Array<std::uint32_t>{});
        }
    }
};

}  // namespace motley
