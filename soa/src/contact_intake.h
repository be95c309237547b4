// The contacts of a step on their way in: checked, found again from the step before, and classified.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "batches.h"
#include "motley/core/scene.h"

namespace motley {

/// What the layout needs of each contact, in list order.
class ContactIntake {
  public:
    /// Makes room for a list and clears the scene's staged list.
    void begin(Scene& scene, std::size_t count);
    /// Checks contacts [first, last) and looks their keys up in the last step's. Ranges may run on different threads.
    void take(Scene& scene, std::span<const Contact> contacts, std::size_t first, std::size_t last);
    /// Empty when every contact is good; else what is wrong with the first bad one. Serial.
    [[nodiscard]] std::string error(const Scene& scene, std::span<const Contact> contacts) const;

    /// Whether one of the contacts taken in gives anything back.
    [[nodiscard]] bool bounces() const { return bounces_.load(std::memory_order_relaxed); }
    /// What is wrong when a key came twice. Serial.
    [[nodiscard]] static std::string repeated_key(std::span<const Contact> contacts);

    AlignedVector<Placement> placements;  ///< with the colour of the step before, or no_colour
    std::vector<std::int32_t>
        memory_index;  ///< entry in the last list's impulses; 0, the zero entry, when new

  private:
    static constexpr std::size_t none = SIZE_MAX;
    std::atomic<std::size_t> first_bad_{none};
    std::atomic<bool> bounces_{false};

    void mark_bad(std::size_t index);
    static bool place(const BodyStore& bodies, const Contact& contact, Placement& placement);
    void remember(ContactCache& cache, std::uint32_t i, std::uint32_t before);
};

}  // namespace motley
