// What walls hide. An index is built from a scene at one moment, and answers for that moment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "motley/core/boxed.h"
#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

struct [[gnu::visibility("hidden")]] WallIndexCore;
extern template class __attribute__((visibility("default"))) Boxed<WallIndexCore>;

/// Where a line of sight meets a wall.
struct WallHit {
    WallId wall{};
    double fraction = 0;  ///< of the way, 0 to 1
};

/// Finds the walls of a scene along straight lines. As CrowdIndex, it answers for the scene as it was at build(): build
/// it anew after the host has added or removed a wall or teleported a body that has one, and after a step if such a body
/// moves. Its const calls may run at the same time as each other. first_hit() and is_free() allocate nothing, and refuse
/// coordinates that are not from -1e12 to 1e12 m. People hide nothing. An index that was never built has no walls.
class WallIndex {
  public:
    WallIndex();
    /// Replaces the index by that of `scene`, which is read as by const calls. If memory runs out, the index is empty. A
    /// warm build allocates nothing.
    void build(const Scene& scene);
    /// Whether the walls of the scene are those of the index and are where they were. Looks at every one of them.
    [[nodiscard]] bool is_current(const Scene& scene) const;
    /// Number of straight pieces of walls.
    [[nodiscard]] std::size_t size() const;

    /// The wall that is first met on the way from `from` to `to` (m, world), of those that have a category bit that
    /// `mask` has. Touching a wall, beginning on it and running along it are meetings; nothing passes between two
    /// pieces of a wall that share a point. Of several met at the same place, that of the least slot.
    [[nodiscard]] std::optional<WallHit> first_hit(const Vec2<double>& from, const Vec2<double>& to,
                                                   std::uint32_t mask = UINT32_MAX) const;
    /// Whether there is none.
    [[nodiscard]] bool is_free(const Vec2<double>& from, const Vec2<double>& to,
                               std::uint32_t mask = UINT32_MAX) const;

  private:
    Boxed<WallIndexCore> core_;
};

}  // namespace motley
#pragma GCC visibility pop
