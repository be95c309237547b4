// Which shapes may come to touch. They are kept from step to step: each shape has a skin, and those whose skins do not
// meet cannot touch until one of them has moved through its skin. Then all are found anew.
//
// What is found does not decide what touches: a pair is dropped or kept with the same contacts. So results depend neither
// on when pairs were found last nor on who found them, and a scene need not remember them.
//
// The calls of one stage for different chunks may run on different threads, after all calls of the stage before:
//   1. place(chunk), place_discs(chunk), then find_fastest() and are_current(); if not:
//   2. begin(), then anchor_discs(chunk)
//   3. find(chunk), then collect()
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "queries/box_tree.h"
#include "queries/curve_order.h"
#include "scene/scene_core.h"
#include "shapes/placed_shapes.h"
#include "stores/array.h"

namespace motley {

/// A capsule, by its index in ShapeStore::capsules, and what it may touch.
struct ShapePair {
    std::uint32_t capsule, partner;
    [[nodiscard]] std::uint64_t order() const { return std::uint64_t{capsule} << 32 | partner; }
};

class ShapePairs {
  public:
    static constexpr std::int64_t capsules_a_chunk = 512;

    /// Starts a step of dt seconds.
    void open(const SceneCore& scene, double dt);
    [[nodiscard]] std::int64_t chunk_count() const;
    void place(const SceneCore& scene, std::int64_t chunk);
    [[nodiscard]] std::int64_t disc_chunk_count() const;
    void place_discs(const SceneCore& scene, std::int64_t chunk);
    /// What is placed goes at most so far within the step, m: a blow may make anybody that fast.
    void find_fastest();
    [[nodiscard]] double fastest() const { return fastest_; }
    [[nodiscard]] bool are_current(const SceneCore& scene) const;
    void begin(const SceneCore& scene);
    void anchor_discs(const SceneCore& scene, std::int64_t chunk);
    void find(const SceneCore& scene, std::int64_t chunk);
    /// Puts what the chunks found in order. Refuses far more pairs than shapes, as of a crowd on one spot, whose contacts
    /// memory might not hold; find() has then stopped early.
    void collect(SceneCore& scene);

    /// Where capsules and wall ends are now.
    [[nodiscard]] const PlacedCapsule& capsule(std::uint32_t index) const { return placed_[index]; }
    [[nodiscard]] const Array<Vec2<double>>& wall_ends() const { return wall_ends_; }
    [[nodiscard]] double walls_go() const { return walls_go_; }
    /// Pairs of capsules, of which the first one has the lower index, in order...
    [[nodiscard]] std::span<const ShapePair> capsules() const { return capsules_; }
    /// ...of capsules with segments of walls...
    [[nodiscard]] std::span<const ShapePair> walls() const { return walls_; }
    /// ...and with discs, by the slots of their bodies.
    [[nodiscard]] std::span<const ShapePair> discs() const { return discs_; }

  private:
    struct Anchor {
        Vec3<double> from{}, to{};  ///< m, world, of the axis
        double skin = -1;           ///< m
    };
    struct DiscAnchor {
        Vec2<double> at{};  ///< m, world
        double skin = -1;   ///< m; below 0 of a row without a disc
    };
    /// What one chunk found.
    struct Found {
        Array<ShapePair> capsules, walls, discs;
        Array<std::uint32_t> near;                 ///< places in the order: space for find_capsules()
        bool leaves = false, discs_leave = false;  ///< whether a shape may leave its skin in this step
        double fastest = 0, fastest_disc = 0;      ///< m: how far any of them goes
    };
    double dt_ = 0;
    std::size_t count_ = 0, disc_rows_ = 0;
    Array<PlacedCapsule> placed_;
    Array<Anchor> anchors_;            ///< by capsule
    Array<DiscAnchor> disc_anchors_;   ///< by row of planar bodies
    Array<std::uint32_t> disc_slots_;  ///< by row: whose anchor it is
    Array<Vec2<double>> wall_ends_, wall_anchors_;
    double walls_go_ = 0, wall_skin_ = -1;
    double fastest_ = 0, blow_skin_ = -1;  ///< m: fastest(), and how far a blow may throw what is near a wall
    Array<std::uint64_t> joined_;          ///< pairs of bodies that joints connect, by slots, sorted
    std::shared_ptr<const char> shape_version_, joint_version_;
    /// The plane of the tree, by two of the coordinates: x and y where anything is met as seen from above, else those along
    /// which the capsules are spread furthest.
    std::array<Vec3<double>, 2> plane_{};
    Array<Vec2<double>> centres_;
    CurveOrder order_;
    BoxTree tree_;  ///< over capsules with their skins, in that order
    Array<Found> found_;
    std::atomic<std::int64_t> found_in_all_{0};
    Array<ShapePair> capsules_, walls_, discs_, spare_;

    static bool leaves(const PlacedCapsule& placed, const Anchor& anchor);
    void choose_plane();
    [[nodiscard]] Vec2<double> in_tree(const Vec3<double>& at) const
    {
        return {dot(plane_[0], at), dot(plane_[1], at)};
    }
    [[nodiscard]] Box box_of(std::uint32_t capsule) const;
    /// Calls work(place) for the places in the order of the capsules whose boxes may meet this one.
    template <class Work>
    void for_each_near(const Box& box, const Work& work) const;
    void list_joined(const SceneCore& scene);
    /// Whether two capsules meet each other, but for joints between their bodies.
    [[nodiscard]] bool may_meet(const SceneCore& scene, std::uint32_t a, std::uint32_t b) const;
    [[nodiscard]] bool are_joined(BodyId a, BodyId b) const;
    void find_capsules(const SceneCore& scene, std::size_t first, std::size_t last, Found& found) const;
    [[nodiscard]] std::int64_t most_pairs() const
    {
        return (std::int64_t{1} << 22) + 16 * static_cast<std::int64_t>(count_ + disc_rows_);
    }
    /// Counts what a chunk has found since it had `before` pairs. Returns whether there are too many in all.
    bool are_too_many(std::size_t before, const Array<ShapePair>& pairs);
    void find_discs(const SceneCore& scene, std::int64_t chunk, Found& found);
    void find_walls(const SceneCore& scene, std::int64_t chunk, Found& found);
    void sort(Array<ShapePair>& pairs);
};

}  // namespace motley
