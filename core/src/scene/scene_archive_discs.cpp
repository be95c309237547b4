// Checks that discs, walls and their blocks, as read from a file, are such as a search could have made.
#include <algorithm>
#include <cmath>

#include "scene/archive_checks.h"
#include "scene/body_checks.h"
#include "scene/scene_archive.h"
#include "stores/array.h"

namespace motley {
namespace {

bool is_planar_disc(const SceneCore& scene, std::uint32_t slot)
{
    return scene.bodies.is_slot_live(slot) && scene.discs.shape_of(slot) != nullptr;
}

void check_shapes(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    demand(discs.shapes.size() <= 2 * std::size_t{scene.bodies.slot_count()} + 1, "more discs than bodies");
    for (std::uint32_t slot = 0; slot < discs.shapes.size(); ++slot) {
        const DiscShape& shape = discs.shapes[slot];
        if (shape.radius == 0) continue;
        demand(slot < scene.bodies.slot_count() && scene.bodies.is_slot_live(slot), "a disc of no body");
        const BodyId body = scene.bodies.id_of_slot(slot);
        demand(scene.bodies.model(body) == BodyModel::planar &&
                   scene.bodies.motion(body) == BodyMotion::dynamic_body,
               "a disc on a body that is not planar");
        check_disc({shape.radius, shape.friction, shape.category, shape.mask});
    }
}

void check_walls(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    demand(!discs.walls.empty() && discs.walls[0].live == 0, "a wall of the null handle");
    for (const DiscStore::WallSlot& wall : discs.walls)
        demand(wall.live <= 1 && wall.generation != 0, "a handle of no wall");
    check_free_list(
        discs.free_walls, discs.walls.size(), [&](std::uint32_t slot) { return discs.walls[slot].live != 0; },
        "a free wall that is taken");
    for (const WallSegment& segment : discs.segments) {
        check_segment("WallSegment.from", segment.from, segment.to);
        check_position("WallSegment.to", {segment.to.x, segment.to.y, 0});
        check_wall_surface(segment.friction, segment.surface_speed);
        check_wall_force(segment.max_force);
        demand(segment.is_one_way <= 1, "a wall that is one-way or not");
        demand(segment.wall < discs.walls.size() && discs.walls[segment.wall].live == 1,
               "a wall without a handle");
        demand(scene.bodies.is_alive(segment.body) &&
                   scene.bodies.motion(segment.body) != BodyMotion::dynamic_body,
               "a wall on no body");
    }
}

void check_anchors(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    const StripFrame& frame = discs.frame;
    demand(discs.anchors.size() >= planar.size() && discs.found_at.size() == discs.anchors.size(),
           "discs that were not searched for");
    demand(frame.per_metre > 0 && std::isfinite(frame.per_metre) && frame.most_reach >= 0 &&
               std::isfinite(frame.most_reach) && frame.strips >= 1 &&
               frame.strips <= 4 * static_cast<std::int64_t>(discs.shapes.size()) + 65 &&
               std::isfinite(frame.origin.x) && std::isfinite(frame.origin.y),
           "strips out of range");
    demand(discs.band_count >= 1, "a search without bands");
    for (const float length : {discs.late_reach, discs.late_drift, discs.wall_skin})
        demand(length >= 0 && std::isfinite(length), "a search out of range");
    for (const Vec2<double>& end : discs.wall_ends)
        demand(std::isfinite(end.x) && std::isfinite(end.y), "a wall that ends nowhere");
    for (std::size_t row = 0; row < discs.found_at.size(); ++row) {
        for (const DiscAnchor& anchor : {discs.found_at[row], discs.anchors[row]}) {
            if (anchor.skin == INFINITY) continue;
            demand(row < planar.size() && is_planar_disc(scene, planar.slot[row]) && anchor.skin >= 0 &&
                       std::isfinite(anchor.x) && std::isfinite(anchor.y),
                   "an anchor without a disc");
        }
    }
}

/// Whatever has changed since the search, blocks name rows and segments that exist, or that a removal has marked.
void check_indices(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    const std::size_t planar =
        std::min<std::size_t>(scene.bodies.rows(BodyKind::planar).size(), discs.anchors.size());
    const std::size_t fixed = scene.bodies.rows(BodyKind::fixed).size();
    const auto check_offset = [](std::int32_t offset, BodyKind kind, std::size_t rows) {
        const std::int32_t a_row = offsets_a_row(kind);
        demand(offset >= 0 && offset % a_row == 0 && static_cast<std::size_t>(offset / a_row) < rows,
               "a contact of no row");
    };
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        for_each_disc_blocks(discs.bands[band], [&](auto c, const DiscBlocks& blocks) {
            demand(blocks.count >= 0, "fewer blocks than none");
            for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
                demand(blocks.lanes[block] > 0 && blocks.lanes[block] <= block_lanes, "a block of no lanes");
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    check_offset(blocks.bodies[block].a[lane], DiscFieldsOf<c.value>::kind_a,
                                 is_wall(c.value) ? fixed : planar);
                    check_offset(blocks.bodies[block].b[lane], BodyKind::planar, planar);
                    if constexpr (is_wall(c.value)) {
                        const WallTouch& touch = blocks.touches[block_lanes * block + lane];
                        demand(lane >= blocks.lanes[block] || touch.segment == UINT32_MAX ||
                                   touch.segment < discs.segments.size(),
                               "a touch of no wall");
                    }
                }
            }
        });
    }
}

/// No two lanes of a block may share a moving body, nor two bands that are solved at the same time.
void check_blocks(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    Array<std::size_t> first_band(planar.size(), 0), block_of(planar.size(), 0);
    std::size_t number = 0;
    const auto take = [&](std::int32_t offset, std::size_t band) {
        const auto row = static_cast<std::size_t>(offset / offsets_a_row(BodyKind::planar));
        demand(is_planar_disc(scene, planar.slot[row]), "a contact of no disc");
        demand(block_of[row] != number, "two contacts of a block on one disc");
        block_of[row] = number;
        if (band == 0) return;
        if (first_band[row] == 0) first_band[row] = band;
        demand(band - first_band[row] <= 1, "a disc in bands that are apart");
    };
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        for_each_disc_blocks(discs.bands[band], [&](auto c, const DiscBlocks& blocks) {
            for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
                ++number;
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    const std::int32_t a = blocks.bodies[block].a[lane], b = blocks.bodies[block].b[lane];
                    if (lane >= blocks.lanes[block]) {
                        demand(a == 0 && b == 0, "padding that is a body");
                        continue;
                    }
                    take(b, band);
                    if (!is_wall(c.value)) {
                        take(a, band);
                        continue;
                    }
                    const WallTouch& touch = blocks.touches[block_lanes * block + lane];
                    demand(touch.segment < discs.segments.size() &&
                               (std::abs(touch.side) == 1 || touch.side == WallTouch::passing),
                           "a touch of no wall");
                }
            }
        });
    }
}

}  // namespace

void SceneArchive::check_discs(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    check_shapes(scene);
    check_walls(scene);
    demand(discs.age >= 0, "a search of a negative age");
    check_indices(scene);
    // After a change, blocks may name bodies and walls that are gone: the next step searches anew before it solves them.
    if (discs.is_stale) return;
    check_anchors(scene);
    demand(discs.wall_ends.size() == 2 * discs.segments.size(), "walls that were not searched for");
    check_blocks(scene);
}

}  // namespace motley
