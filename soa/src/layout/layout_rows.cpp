// Which rows of bodies a step visits: those that are awake, in no lone figure, and in no patch.
#include <algorithm>

#include "layout/layout.h"
#include "stores/array.h"

namespace motley {
namespace {

/// Bodies per range: a few microseconds of streaming.
constexpr std::int32_t rows_per_range = 512;

}  // namespace

/// Notes which bodies are awake. Returns whether they are those of the last call.
bool Layout::note_awake(const BodyStore& bodies)
{
    bool same = true;
    for (std::size_t kind = 0; kind < body_kind_count; ++kind) {
        const BodyRows& rows = bodies.rows(static_cast<BodyKind>(kind));
        const bool may_skip = bodies.sleepers > 0 && static_cast<BodyKind>(kind) != BodyKind::fixed;
        Array<std::uint16_t>& noted = awake_[kind];
        same = same && noted.size() == rows.awake.size();
        noted.resize(rows.awake.size());
        for (std::size_t group = 0; group < noted.size(); ++group) {
            const std::uint16_t now = may_skip ? rows.awake[group] : std::uint16_t{0xFFFF};
            same = same && noted[group] == now;
            noted[group] = now;
        }
    }
    return same;
}

void Layout::list_rows(const SceneCore& scene)
{
    for (int kind = 0; kind < body_kind_count; ++kind) {
        Array<RowRange>& ranges = rows_[static_cast<std::size_t>(kind)];
        const auto size = static_cast<std::int32_t>(scene.bodies.rows(static_cast<BodyKind>(kind)).size());
        const bool has_lone = static_cast<BodyKind>(kind) == BodyKind::rigid && !figures.lone().empty();
        ranges.clear();
        if (size == 1) continue;  // the null row alone
        if (intake.patches.are_wanted())
            beside_[static_cast<std::size_t>(kind)].resize(static_cast<std::size_t>(size));
        const auto add = [&](std::int32_t first, std::int32_t last) {
            for_each_even_piece<block_lanes>(first, last, rows_per_range,
                                             [&](std::int32_t begin, std::int32_t end) {
                                                 ranges.push_back({begin, end});
                                             });
        };
        constexpr auto a_group = static_cast<std::int32_t>(BodyRows::rows_per_group);
        const Array<std::uint16_t>& awake = awake_[static_cast<std::size_t>(kind)];
        // Whole groups fill lanes, but where lone figures leave gaps, sleepers need not fill these.
        if (has_lone) {
            swept_.resize(awake.size());
            for (std::size_t group = 0; group < awake.size(); ++group)
                swept_[group] = static_cast<std::uint16_t>(awake[group] & ~figures.alone_in(group));
        }
        const Array<std::uint16_t>& swept = has_lone ? swept_ : awake;
        // Room for as many ranges as those who sleep may ever leave, so that it is not sought when they do: at most every
        // second of the least runs, and of those longer than a range four pieces more than ranges.
        const std::int32_t least_run = has_lone ? 1 : a_group;
        ranges.reserve(static_cast<std::size_t>(size / (2 * least_run) + 5 * (size / rows_per_range) + 6));
        for_each_run(
            0, static_cast<std::int32_t>(swept.size()),
            [&](std::int32_t group) { return swept[static_cast<std::size_t>(group)] != 0; },
            [&](std::int32_t first, std::int32_t last) {
                const std::int32_t first_row = first * a_group, last_row = std::min(last * a_group, size);
                if (!has_lone) return add(first_row, last_row);
                for_each_run(
                    first_row, last_row,
                    [&](std::int32_t row) {
                        return (swept[static_cast<std::size_t>(row / a_group)] >> row % a_group & 1) != 0;
                    },
                    add);
            });
    }
}

void Layout::list_beside_patches(BodyKind kind, std::int64_t i)
{
    RowRange& range = rows_[static_cast<std::size_t>(kind)][static_cast<std::size_t>(i)];
    BodyRow* const first = beside_[static_cast<std::size_t>(kind)].data() + range.begin;
    BodyRow* last = first;
    for (std::int32_t row = range.begin; row < range.end; ++row) {
        *last = BodyRow(kind, static_cast<std::uint32_t>(row));
        last += intake.patches.lists(*last) ? 0 : 1;
    }
    range.beside = static_cast<std::int32_t>(last - first);
}

std::span<const BodyRow> Layout::beside_patches(BodyKind kind, std::int64_t i) const
{
    const RowRange& range = rows(static_cast<int>(kind))[static_cast<std::size_t>(i)];
    return {beside_[static_cast<std::size_t>(kind)].data() + range.begin,
            static_cast<std::size_t>(range.beside)};
}

}  // namespace motley
