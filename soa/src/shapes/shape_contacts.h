// The contacts of capsules, as a host would list them: from where shapes are when a step begins. A contact is listed when
// its bodies may touch within the step, so that nothing that moves fast is missed, and which contacts are listed follows
// from the state of the scene alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "motley/core/constraints/contact_definition.h"
#include "scene/scene_core.h"
#include "shapes/shape_pairs.h"

namespace motley {

/// The highest bit of a key says that the library gave it out. The next two say what a capsule touches; then come the slot
/// of the capsule, what it touches, and which of the two points of such a contact it is.
inline constexpr std::uint64_t found_key = std::uint64_t{1} << 63;

/// The segment of a wall in the key of a contact with one, or -1.
std::int64_t segment_of(std::uint64_t key);

class ShapeContacts {
  public:
    /// Starts a step of dt seconds.
    void open(const SceneCore& scene, const ShapePairs& pairs, double dt);
    [[nodiscard]] std::int64_t chunk_count() const { return first_chunk_[4]; }
    /// Lists the contacts of a chunk. May run on any thread.
    void list(const SceneCore& scene, const ShapePairs& pairs, std::int64_t chunk);
    /// Appends all that were listed: those with half-spaces, of capsules with each other, with walls and with discs, each
    /// in the order of the capsules.
    void append_to(std::vector<Contact>& contacts) const;

  private:
    static constexpr std::int64_t a_chunk = 1024;  ///< capsules or pairs
    std::vector<PlacedHalfSpace> half_spaces_;
    double dt_ = 0;
    std::array<std::int64_t, 5> first_chunk_{};  ///< of each of the four parts, and behind the last one
    std::vector<std::vector<Contact>> listed_;   ///< by chunk

    void list_half_spaces(const SceneCore& scene, const ShapePairs& pairs, std::uint32_t capsule,
                          std::vector<Contact>& contacts) const;
    static void list_pair(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                          std::vector<Contact>& contacts);
    static void list_wall(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                          std::vector<Contact>& contacts);
    void list_disc(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                   std::vector<Contact>& contacts) const;
};

}  // namespace motley
