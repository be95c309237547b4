// Checks that discs, walls and their blocks, as read from a file, are such as a search could have made.
#include <cmath>
#include <string>

#include "scene/scene_archive.h"

namespace motley {
namespace {

void demand(bool holds, const char* what)
{
    if (!holds) throw std::runtime_error(std::string("is no scene: ") + what);
}

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
        demand(shape.radius >= 1e-6F && shape.radius <= 1e6F && shape.friction >= 0 && shape.friction <= 1e9F,
               "a disc that nobody has");
    }
}

void check_walls(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    demand(!discs.walls.empty() && discs.walls[0].live == 0, "a wall of the null handle");
    for (const std::uint32_t slot : discs.free_walls)
        demand(slot > 0 && slot < discs.walls.size() && discs.walls[slot].live == 0,
               "a free wall that is taken");
    for (const WallSegment& segment : discs.segments) {
        const Vec2<double> along = segment.to - segment.from;
        const double length2 = dot(along, along);
        demand(length2 >= 1e-12 && std::isfinite(length2) && std::isfinite(segment.from.x) &&
                   std::isfinite(segment.from.y) && segment.friction >= 0 && segment.friction <= 1e9F,
               "a wall that is none");
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
               frame.strips >= 1 && frame.strips <= 4 * static_cast<std::int64_t>(discs.shapes.size()) + 65 &&
               std::isfinite(frame.origin.x) && std::isfinite(frame.origin.y),
           "strips that nobody made");
    for (std::size_t row = 0; row < discs.found_at.size(); ++row) {
        for (const DiscAnchor& anchor : {discs.found_at[row], discs.anchors[row]}) {
            if (anchor.skin == INFINITY) continue;
            demand(row < planar.size() && is_planar_disc(scene, planar.slot[row]) && anchor.skin >= 0 &&
                       std::isfinite(anchor.x) && std::isfinite(anchor.y),
                   "an anchor of no disc");
        }
    }
}

/// No two lanes of a block may share a moving body, nor two bands that are solved at the same time.
void check_blocks(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    std::vector<std::size_t> first_band(planar.size(), 0), block_of(planar.size(), 0);
    std::size_t number = 0;
    const auto take = [&](std::int32_t offset, std::size_t band) {
        constexpr std::int32_t a_row = offsets_a_row(BodyKind::planar);
        demand(offset > 0 && offset % a_row == 0 && static_cast<std::size_t>(offset / a_row) < planar.size(),
               "a contact of no disc");
        const auto row = static_cast<std::size_t>(offset / a_row);
        demand(is_planar_disc(scene, planar.slot[row]), "a contact of no disc");
        demand(block_of[row] != number, "two contacts of a block on one disc");
        block_of[row] = number;
        if (band == 0) return;
        if (first_band[row] == 0) first_band[row] = band;
        demand(band - first_band[row] <= 1, "a disc in bands that are apart");
    };
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        for (std::size_t c = 0; c < disc_class_count; ++c) {
            const DiscBlocks& blocks = discs.bands[band].blocks[c];
            demand(blocks.count >= 0, "fewer blocks than none");
            for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
                ++number;
                demand(blocks.lanes[block] > 0 && blocks.lanes[block] <= block_lanes, "a block of no lanes");
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    const std::int32_t a = blocks.bodies[block].a[lane], b = blocks.bodies[block].b[lane];
                    if (lane >= blocks.lanes[block]) {
                        demand(a == 0 && b == 0, "padding that is a body");
                        continue;
                    }
                    take(b, band);
                    if (!is_wall(static_cast<DiscClass>(c))) {
                        take(a, band);
                        continue;
                    }
                    constexpr std::int32_t a_row = offsets_a_row(BodyKind::fixed);
                    demand(a > 0 && a % a_row == 0 && static_cast<std::size_t>(a / a_row) < fixed.size(),
                           "a wall on no body");
                    const WallTouch& touch = blocks.touches[block_lanes * block + lane];
                    demand(touch.segment < discs.segments.size() && std::abs(touch.side) == 1,
                           "a touch of no wall");
                }
            }
        }
    }
}

}  // namespace

void SceneArchive::check_discs(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    check_shapes(scene);
    check_walls(scene);
    demand(discs.age >= 0, "a search of no time");
    // After a change, blocks may name bodies and walls that are gone: the next step searches anew before it uses them.
    if (discs.is_stale) return;
    check_anchors(scene);
    demand(discs.wall_ends.size() == 2 * discs.segments.size(), "walls that were not searched for");
    check_blocks(scene);
}

}  // namespace motley
