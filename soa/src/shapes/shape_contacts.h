// The contacts of capsules, as a host would list them: from where shapes are when a step begins. A contact is listed when
// its bodies may touch within the step, so that nothing that moves fast is missed, and which contacts are listed follows
// from the state of the scene alone.
#pragma once

#include <array>
#include <cstdint>
#include <tuple>

#include "maths/contact_surface.h"
#include "motley/core/constraints/contact_definition.h"
#include "scene/scene_core.h"
#include "shapes/shape_pairs.h"
#include "stores/array.h"

namespace motley {

/// The highest bit of a key says that the library gave it out. The next two say what a capsule touches; then come the slot
/// of the capsule, what it touches, and which of the points of such a contact it is.
inline constexpr std::uint64_t found_key = std::uint64_t{1} << 63;

/// The segment of a wall in the key of a contact with one, or -1.
std::int64_t segment_of(std::uint64_t key);
/// Whether two keys are of the points of one capsule with one partner.
constexpr bool are_of_one_pair(std::uint64_t key, std::uint64_t other)
{
    return key >> 4 == other >> 4;
}

class ShapeContacts {
  public:
    /// Starts a step of dt seconds.
    void open(const SceneCore& scene, const ShapePairs& pairs, double dt);
    [[nodiscard]] std::int64_t chunk_count() const { return first_chunk_[4]; }
    /// Lists the contacts of a chunk. May run on any thread.
    void list(const SceneCore& scene, const ShapePairs& pairs, std::int64_t chunk);
    /// Appends all that were listed: those with half-spaces, of capsules with each other, with walls and with discs, each
    /// in the order of the capsules.
    void append_to(Array<Contact>& contacts) const;
    /// The segment of a wall that a contact is with, and its side.
    static WallMet wall_met(const SceneCore& scene, const ShapePairs& pairs, std::size_t segment,
                            const Contact& contact);
    /// What the surface of a segment of a wall does.
    [[nodiscard]] static ContactSurface<float> surface_of(const SceneCore& scene, const ShapePairs& pairs,
                                                          std::size_t segment);

  private:
    static constexpr std::int64_t a_chunk = 1024;  ///< capsules or pairs
    /// A capsule that was near a wall in the last step.
    struct Beside {
        std::uint32_t capsule, wall, number, body;  ///< slots; the number of the segment in its wall
        int side;                                   ///< 1: left; -1: right; 0: at an end of the segment
        [[nodiscard]] auto order() const { return std::tuple(capsule, wall, number, body, side); }
        [[nodiscard]] bool is_of(const Beside& other) const
        {
            return capsule == other.capsule && wall == other.wall && number == other.number &&
                   body == other.body;
        }
    };
    struct Hold {
        bool holds;
        double side;  ///< 1, -1, or 0: where it is
    };
    Array<PlacedHalfSpace> half_spaces_;
    Array<Beside> beside_;  ///< sorted
    double dt_ = 0;
    std::array<std::int64_t, 5> first_chunk_{};  ///< of each of the four parts, and behind the last one
    Array<Array<Contact>> listed_;               ///< by chunk

    void list_half_spaces(const SceneCore& scene, const ShapePairs& pairs, std::uint32_t capsule,
                          Array<Contact>& contacts) const;
    static void list_pair(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                          Array<Contact>& contacts);
    void list_wall(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                   Array<Contact>& contacts) const;
    void remember_sides(const SceneCore& scene, const ShapePairs& pairs);
    [[nodiscard]] Hold hold_of(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                               const Axis& wall) const;
    void list_disc(const SceneCore& scene, const ShapePairs& pairs, const ShapePair& pair,
                   Array<Contact>& contacts) const;
};

}  // namespace motley
