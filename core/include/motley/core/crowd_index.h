// Who is near a point or in an area. An index is built from a scene at one moment, and answers for that moment.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "motley/core/boxed.h"
#include "motley/core/polygon.h"
#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

struct [[gnu::visibility("hidden")]] CrowdIndexCore;
extern template class __attribute__((visibility("default"))) Boxed<CrowdIndexCore>;

/// Somebody, and how far away.
struct NearPerson {
    BodyId body{};
    double distance = 0;  ///< m, from the point to the centre
};

/// Finds people: the bodies of a scene that have discs, contained ones included. A value of its own, which the scene
/// does not know: build() copies what it needs, and the answers are those of the scene as it was then. After a step, or
/// after the host has added, removed or teleported anybody or changed a disc, build it anew; is_current() tells. An index
/// that was never built finds nobody.
///
/// Const calls may run at the same time as each other, whatever happens to the scene meanwhile. They allocate only what
/// the vector of the answer lacks, and refuse coordinates that are not from -1e12 to 1e12 m. Answers depend on where
/// people are and on nothing else. A build takes time in proportion to the people, however they are spread, and a query
/// about in proportion to its answer; a warm build allocates nothing.
class CrowdIndex {
  public:
    CrowdIndex();
    /// Replaces the index by that of `scene`, which is read as by const calls. If memory runs out, the index is empty.
    void build(const Scene& scene);
    /// Whether the people of the scene are those of the index and are where they were. Looks at every one of them.
    [[nodiscard]] bool is_current(const Scene& scene) const;
    /// Number of people.
    [[nodiscard]] std::size_t size() const;

    /// Replaces the contents of `found` by those whose centres are at most `radius` (m, 0 or more) away from `point` (m,
    /// world), in the order of their slots.
    void centres_within(const Vec2<double>& point, double radius, std::vector<BodyId>& found) const;
    /// The same for those of whose disc any part is at most `radius` away.
    void discs_within(const Vec2<double>& point, double radius, std::vector<BodyId>& found) const;
    /// The `count` people nearest to `point` (m, world), or as many as there are at most `furthest` (m, 0 or more) away:
    /// nearest first, those at the same distance in the order of their slots.
    void nearest(const Vec2<double>& point, std::size_t count, std::vector<NearPerson>& found,
                 double furthest = std::numeric_limits<double>::infinity()) const;
    /// Those whose centres are in the area, in the order of their slots. A centre is in it if a ray from there crosses an
    /// odd number of edges of all rings; rings may cross themselves and each other. Refuses rings of fewer than three
    /// points. A centre on an edge, to within the rounding of doubles, may count as in or out.
    void inside(const Polygon& area, std::vector<BodyId>& found) const;

  private:
    Boxed<CrowdIndexCore> core_;
};

}  // namespace motley
#pragma GCC visibility pop
