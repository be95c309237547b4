// See wall_index.h.
#include "motley/core/wall_index.h"

#include <algorithm>

#include "queries/box_tree.h"
#include "queries/curve_order.h"
#include "queries/line_of_sight.h"
#include "scene/body_checks.h"
#include "scene/scene_core.h"
#include "scene/wall_ends.h"
#include "stores/array.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// A straight piece of a wall.
struct Piece {
    Vec2<double> middle, from, to;  ///< m, world
    WallId wall;
    std::uint32_t category;
};

}  // namespace

/// The pieces in the order of a curve, and a tree over them.
struct WallIndexCore {
    Array<Piece> pieces;
    BoxTree tree;
    Array<Piece> listed;  ///< in the order of the scene: room for the next build
    Array<Vec2<double>> ends;
    CurveOrder order;
};
template class Boxed<WallIndexCore>;

WallIndex::WallIndex() = default;

void WallIndex::build(const Scene& scene)
{
    WallIndexCore& index = *core_;
    const SceneCore& core = core_of(scene);
    const Array<WallSegment>& segments = core.discs.segments;
    index.pieces.clear();
    index.tree.clear();
    index.listed.clear();
    make_room_for(index.listed, segments.size());
    make_room_for(index.pieces, segments.size());
    index.order.make_room(index.listed.capacity());
    index.tree.make_room(index.listed.capacity());
    find_wall_ends(core, index.ends);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Vec2<double> from = index.ends[2 * i], to = index.ends[2 * i + 1];
        const std::uint32_t slot = segments[i].wall;
        index.listed.push_back(
            {0.5 * (from + to), from, to, {slot, core.discs.walls[slot].generation}, segments[i].category});
    }
    const auto count = static_cast<std::uint32_t>(index.listed.size());
    index.order.find({count > 0 ? &index.listed[0].middle : nullptr, count, sizeof(Piece)});
    for (std::uint32_t i = 0; i < count; ++i) index.pieces.push_back(index.listed[index.order[i]]);
    index.tree.build(count, [&](std::uint32_t i) {
        Box box;
        box.include(index.pieces[i].from);
        box.include(index.pieces[i].to);
        return box;
    });
}

bool WallIndex::is_current(const Scene& scene) const
{
    const DiscStore& discs = core_of(scene).discs;
    if (discs.segments.size() != core_->listed.size()) return false;
    Array<Vec2<double>> ends;
    find_wall_ends(core_of(scene), ends);
    for (std::size_t i = 0; i < discs.segments.size(); ++i) {
        const Piece& was = core_->listed[i];
        const WallSegment& segment = discs.segments[i];
        const WallId wall{segment.wall, discs.walls[segment.wall].generation};
        const Vec2<double> from = ends[2 * i] - was.from, to = ends[2 * i + 1] - was.to;
        if (was.wall != wall || was.category != segment.category || dot(from, from) + dot(to, to) != 0)
            return false;
    }
    return true;
}

std::size_t WallIndex::size() const
{
    return core_->pieces.size();
}

std::optional<WallHit> WallIndex::first_hit(const Vec2<double>& from, const Vec2<double>& to,
                                            std::uint32_t mask) const
{
    check_position("first_hit.from", {from.x, from.y, 0});
    check_position("first_hit.to", {to.x, to.y, 0});
    const LineOfSight line{from, to};
    WallHit first{{}, no_meeting};
    // A box may begin a little after what it holds, by rounding.
    const auto bound = [&] { return std::min(first.fraction + 1e-9, 1.0); };
    const auto measure = [&](const Box& box) { return line.enters(box); };
    core_->tree.visit_nearest(measure, bound, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const Piece& piece = core_->pieces[i];
            if ((piece.category & mask) == 0) continue;
            const double fraction = line.meets(piece.from, piece.to);
            if (fraction < first.fraction ||
                (fraction == first.fraction && fraction < no_meeting && piece.wall.slot < first.wall.slot))
                first = {piece.wall, fraction};
        }
    });
    return first.fraction < no_meeting ? std::optional(first) : std::nullopt;
}

bool WallIndex::is_free(const Vec2<double>& from, const Vec2<double>& to, std::uint32_t mask) const
{
    check_position("is_free.from", {from.x, from.y, 0});
    check_position("is_free.to", {to.x, to.y, 0});
    const LineOfSight line{from, to};
    const auto judge = [&](const Box& box, std::uint32_t) {
        return line.enters(box) < no_meeting ? BoxShare::some : BoxShare::none;
    };
    return core_->tree.visit(judge, [&](std::uint32_t begin, std::uint32_t end, bool) {
        return std::none_of(
            core_->pieces.begin() + begin, core_->pieces.begin() + end, [&](const Piece& piece) {
                return (piece.category & mask) != 0 && line.meets(piece.from, piece.to) < no_meeting;
            });
    });
}

}  // namespace motley
