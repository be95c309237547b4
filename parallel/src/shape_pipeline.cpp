// See shape_pipeline.h.
#include "shape_pipeline.h"

#include <algorithm>

#include "stores/growth.h"

namespace motley {

std::span<const Contact> ShapePipeline::join(SceneCore& scene, std::span<const Contact> hosts, float dt)
{
    all_.clear();
    hosts_ = 0;
    if (!scene.shapes.is_in_use()) return hosts;
    find_pairs(scene, static_cast<double>(dt));
    contacts_.open(scene, pairs_, static_cast<double>(dt));
    runner_.run(contacts_.chunk_count(), [&](std::int64_t chunk) { contacts_.list(scene, pairs_, chunk); });
    all_.assign(hosts.begin(), hosts.end());
    hosts_ = hosts.size();
    contacts_.append_to(all_);
    keep_room(all_);
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
    if (pairs_.are_current(scene)) return;
    pairs_.begin(scene);
    runner_.run(pairs_.disc_chunk_count(), [&](std::int64_t chunk) { pairs_.anchor_discs(scene, chunk); });
    runner_.run(std::max(pairs_.chunk_count(), pairs_.disc_chunk_count()),
                [&](std::int64_t chunk) { pairs_.find(scene, chunk); });
    pairs_.collect(scene);
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
        scene.shapes.walls_met.push_back(
            segment < 0 ? WallId{} : scene.discs.wall_of(static_cast<std::size_t>(segment)));
    }
}

}  // namespace motley
