// See shape_pipeline.h.
#include "shape_pipeline.h"

#include <algorithm>
#include <functional>

#include "stores/array.h"
#include "stores/growth.h"

namespace motley {

std::span<const Contact> ShapePipeline::join(SceneCore& scene, std::span<const Contact> hosts, float dt)
{
    all_.clear();
    surfaces_.clear();
    hosts_ = 0;
    if (!scene.shapes.is_in_use()) return hosts;
    find_pairs(scene, static_cast<double>(dt));
    contacts_.open(scene, pairs_, static_cast<double>(dt));
    runner_.run(contacts_.chunk_count(), [&](std::int64_t chunk) { contacts_.list(scene, pairs_, chunk); });
    all_.assign(hosts.begin(), hosts.end());
    hosts_ = hosts.size();
    contacts_.append_to(all_);
    keep_room(all_);
    find_surfaces(scene);
    if (scene.shapes.contacts.capacity() < found()) scene.shapes.contacts.reserve(with_room_to_grow(found()));
    if (scene.shapes.walls_met.capacity() < found())
        scene.shapes.walls_met.reserve(with_room_to_grow(found()));
    return all_;
}

void ShapePipeline::find_pairs(SceneCore& scene, double dt)
{
    pairs_.open(scene, dt);
    runner_.run(pairs_.chunk_count(), [&](std::int64_t chunk) { pairs_.place(scene, chunk); });
    runner_.run(pairs_.disc_chunk_count(), [&](std::int64_t chunk) { pairs_.place_discs(scene, chunk); });
    pairs_.find_fastest();
    if (pairs_.are_current(scene)) return;
    pairs_.begin(scene);
    runner_.run(pairs_.disc_chunk_count(), [&](std::int64_t chunk) { pairs_.anchor_discs(scene, chunk); });
    runner_.run(std::max(pairs_.chunk_count(), pairs_.disc_chunk_count()),
                [&](std::int64_t chunk) { pairs_.find(scene, chunk); });
    pairs_.collect(scene);
}

void ShapePipeline::find_surfaces(const SceneCore& scene)
{
    const Array<WallSegment>& segments = scene.discs.segments;
    if (std::none_of(segments.begin(), segments.end(), std::mem_fn(&WallSegment::has_own_surface))) return;
    surfaces_.assign(found(), {});
    const std::span<const Contact> own = std::span(all_).subspan(hosts_);
    for (std::size_t first = 0, end = 0; first < own.size(); first = end) {
        // The points at which one capsule touches a segment share what it can bear.
        float touching = 0;
        for (end = first; end < own.size() && are_of_one_pair(own[first].key, own[end].key); ++end)
            touching += own[end].separation <= static_cast<float>(step_slack) ? 1.0F : 0.0F;
        const std::int64_t segment = segment_of(own[first].key);
        if (segment < 0) continue;
        ContactSurface<float> surface =
            ShapeContacts::surface_of(scene, pairs_, static_cast<std::size_t>(segment));
        surface.most_force /= std::max(1.0F, touching);
        std::fill(surfaces_.begin() + static_cast<std::ptrdiff_t>(first),
                  surfaces_.begin() + static_cast<std::ptrdiff_t>(end), surface);
    }
    keep_room(surfaces_);
}

std::string ShapePipeline::wrong_key(const SceneCore& scene, std::span<const Contact> hosts)
{
    if (!scene.shapes.is_in_use()) return {};
    for (std::size_t i = 0; i < hosts.size(); ++i) {
        if (hosts[i].key < found_key) continue;
        return "contacts[" + std::to_string(i) + "].key is " + std::to_string(hosts[i].key) +
               "; expected below 2^63 in a scene with capsules";
    }
    return {};
}

void ShapePipeline::remember(SceneCore& scene) const
{
    scene.shapes.contacts.assign(all_.begin() + static_cast<std::ptrdiff_t>(hosts_), all_.end());
    scene.shapes.walls_met.clear();
    for (const Contact& contact : scene.shapes.contacts) {
        const std::int64_t segment = segment_of(contact.key);
        WallMet met;
        if (segment >= 0)
            met = ShapeContacts::wall_met(scene, pairs_, static_cast<std::size_t>(segment), contact);
        scene.shapes.walls_met.push_back(met);
    }
}

}  // namespace motley
