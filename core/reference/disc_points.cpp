// See disc_points.h.
#include "disc_points.h"

#include <set>

#include "as_eigen.h"
#include "stores/disc_fields.h"

namespace motley::reference {
namespace {

/// Calls work(class, blocks, block, lane) for each contact that is solved.
template <class Discs, class Work>
void for_each_contact(Discs& discs, const Work& work)
{
    for_each_solved_blocks(discs, [&](auto c, auto& blocks) {
        for_each_lane(blocks, [&](std::size_t block, std::size_t lane) { work(c, blocks, block, lane); });
    });
}

Vec3<float> in_space(const Vec2<float>& v)
{
    return {v.x, v.y, 0};
}
/// The direction of friction.
Eigen::Vector3d tangent_of(const Vec2<float>& normal)
{
    return {-static_cast<double>(normal.y), static_cast<double>(normal.x), 0};
}

template <DiscClass c>
Contact contact_of(const typename DiscFieldsOf<c>::Row& row)
{
    const auto& sweep = row.in_sweep;
    Contact contact;
    contact.normal = in_space(sweep.normal);
    contact.separation = row.start_separation;
    // Without friction the force passes through the centres of the discs, wherever it acts along the normal.
    if constexpr (is_wall(c)) contact.arm_a = in_space(sweep.arm_a);
    if constexpr (is_rough(c)) {
        contact.friction = sweep.friction;
        if constexpr (!is_wall(c)) contact.arm_a = in_space(sweep.arm_a * sweep.normal);
        contact.arm_b = in_space(-sweep.arm_b * sweep.normal);
    }
    return contact;
}

}  // namespace

void DiscPoints::list(const SceneCore& scene, std::span<const int> index_of_slot,
                      std::vector<ContactPoint>& points, World::ContactResults& recalled)
{
    std::set<std::uint64_t> taken;
    for (const ContactPoint& point : points) taken.insert(point.contact.key);
    std::uint64_t next_key = 0;
    for_each_contact(scene.discs, [&](auto c, const DiscBlocks& blocks, std::size_t block, std::size_t lane) {
        using Fields = DiscFieldsOf<c.value>;
        keys_.push_back(no_key);
        if constexpr (is_wall(c.value)) {
            if (blocks.touches[block_lanes * block + lane].side == WallTouch::passing) return;
        }
        while (taken.contains(next_key)) ++next_key;
        const std::uint64_t key = keys_.back() = next_key++;
        const auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
        const auto bore = load_lane<typename Fields::Impulse>(blocks.impulses.data(), block, lane);
        const BlockBodies& bodies = blocks.bodies[block];
        const auto index_of = [&](BodyKind kind, std::int32_t offset) {
            return index_of_slot[scene.bodies.rows(kind).slot[row_at(kind, offset).row()]];
        };
        ContactPoint point{index_of(Fields::kind_a, bodies.a[lane]),
                           index_of(BodyKind::planar, bodies.b[lane]), contact_of<c.value>(row)};
        point.contact.key = key;
        if constexpr (is_wall(c.value)) {
            point.surface.most_force = static_cast<double>(row.in_sweep.most_force);
            if constexpr (is_rough(c.value)) {
                const Eigen::Vector3d belt =
                    static_cast<double>(row.in_sweep.surface_speed) * tangent_of(row.in_sweep.normal);
                point.surface.velocity = {belt.x(), belt.y(), 0};
            }
        }
        points.push_back(point);
        World::ContactResult& result = recalled[key];
        result = {static_cast<double>(bore.normal)};
        if constexpr (is_rough(c.value))
            result.friction = static_cast<double>(bore.tangent) * tangent_of(row.in_sweep.normal);
    });
}

void DiscPoints::store(const World& world, DiscStore& discs) const
{
    auto key = keys_.begin();
    for_each_contact(discs, [&](auto c, DiscBlocks& blocks, std::size_t block, std::size_t lane) {
        using Fields = DiscFieldsOf<c.value>;
        const auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
        const std::uint64_t of = *key++;
        const auto put = [&](const World::ContactResults& results, AlignedVector<float>& stream) {
            typename Fields::Impulse impulse{};
            if (const auto found = results.find(of); found != results.end() && of != no_key) {
                impulse.normal = narrow(found->second.normal);
                if constexpr (is_rough(c.value))
                    impulse.tangent = narrow(tangent_of(row.in_sweep.normal).dot(found->second.friction));
            }
            store_lane(impulse, stream.data(), block, lane);
        };
        put(world.last_substep_results(), blocks.impulses);
        put(world.step_results(), blocks.sums);
    });
}

}  // namespace motley::reference
