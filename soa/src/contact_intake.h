// The contacts of a step on their way in: checked, found again from the step before, and classified.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "batches.h"
#include "motley/core/scene.h"
#include "patches.h"

namespace motley {

/// What the layout needs of each contact, in list order.
class ContactIntake {
  public:
    /// Checks a list and finds its contacts again among those of the last step. `run(count, chunk)` calls chunk(i) for each
    /// i in [0, count), on whichever threads. Empty when every contact is good, but for keys that come twice, which
    /// ContactCache::verify() finds; else what is wrong with the first bad one. Unless bad ones are skipped, none is then
    /// taken in.
    template <class Run>
    [[nodiscard]] std::string take_in(Scene& scene, std::span<const Contact> contacts, bool skips_bad,
                                      const Run& run)
    {
        ContactCache& cache = scene.contact_cache();
        begin(scene, contacts.size());
        const std::int64_t parts = cache.part_count();
        run(parts, [&](std::int64_t part) { walk(scene, contacts, part); });
        std::string first_error;
        if (bad_contacts() > 0) first_error = error(scene, contacts);
        if (bad_contacts() > 0 && !skips_bad) return first_error;
        run(parts, [&](std::int64_t part) { cache.find_lost(part); });
        cache.open_table();
        run(parts, [&](std::int64_t part) { cache.enter_lost(part); });
        run(parts, [&](std::int64_t part) { trace(cache, part); });
        return first_error;
    }

    /// When all have colours: marks those of a patch's stretch of the list that are inside it, and lists its bodies.
    void fill_patch(std::int64_t patch);

    /// Contacts that cannot be taken in.
    [[nodiscard]] std::int64_t bad_contacts() const { return bad_contacts_.load(std::memory_order_relaxed); }
    /// Whether one of the contacts taken in gives anything back.
    [[nodiscard]] bool bounces() const { return bounces_.load(std::memory_order_relaxed); }
    /// What is wrong when a key came twice. Serial.
    [[nodiscard]] static std::string repeated_key(std::span<const Contact> contacts);

    AlignedVector<Placement> placements;  ///< with the colour of the step before, or no_colour
    Patches patches;
    std::vector<std::int32_t>
        memory_index;  ///< entry in the last list's impulses; 0, the zero entry, when new

  private:
    static constexpr std::size_t none = SIZE_MAX;
    std::size_t count_ = 0;
    std::atomic<std::size_t> first_bad_{none};
    std::atomic<std::int64_t> bad_contacts_{0};
    std::atomic<bool> bounces_{false};

    void begin(Scene& scene, std::size_t count);
    void walk(Scene& scene, std::span<const Contact> contacts, std::int64_t part);
    void trace(ContactCache& cache, std::int64_t part);
    void mark_bad(std::size_t index);
    [[nodiscard]] std::string error(const Scene& scene, std::span<const Contact> contacts) const;
    static bool place(const BodyStore& bodies, const Contact& contact, Placement& placement);
    void remember(ContactCache& cache, std::uint32_t i, std::uint32_t before);
};

}  // namespace motley
