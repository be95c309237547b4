// Bodies that nothing moves for a while, because they sleep or were contained: their rows have no inverse mass and inertia.
#include <algorithm>

#include "stores/body_store.h"

namespace motley {

void BodyStore::revive(BodyId body)
{
    contained[body.slot] = 0;
    --contained_count;
    thaw(body.slot);
}

void BodyStore::freeze(std::uint32_t slot)
{
    const BodyRow where = slots_[slot].row;
    BodyRows& r = rows(where.kind());
    const std::size_t quads = static_cast<std::size_t>(quads_of(where.kind()));
    const auto clear = [&](AlignedVector<float>& values) {
        std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(4 * quads * where.row()), 4 * quads, 0.0F);
    };
    clear(r.velocity);
    if (where.kind() == BodyKind::rigid) {
        clear(r.world_inverse_inertia);
        clear(r.start_inverse_inertia);
    }
    if (where.kind() == BodyKind::planar) r.delta[std::size_t{4} * where.row() + 3] = 0;
}

void BodyStore::thaw(std::uint32_t slot)
{
    const BodyRow where = slots_[slot].row;
    BodyRows& r = rows(where.kind());
    r.velocity[std::size_t{4} * static_cast<std::size_t>(quads_of(where.kind())) * where.row() + 3] =
        inverse_masses[slot];
    if (where.kind() == BodyKind::planar) r.delta[std::size_t{4} * where.row() + 3] = inverse_inertias[slot];
    if (where.kind() == BodyKind::rigid) refresh_world_inertia(where.row());
}

void BodyStore::fall_asleep(std::uint32_t slot)
{
    sleep[slot] = Sleep::asleep;
    ++sleepers;
    const BodyRow where = slots_[slot].row;
    rows(where.kind()).set_awake(where.row(), false);
    freeze(slot);
}

void BodyStore::wake(std::uint32_t slot)
{
    sleep[slot] = Sleep::awake;
    slow_for[slot] = 0;
    --sleepers;
    const BodyRow where = slots_[slot].row;
    rows(where.kind()).set_awake(where.row(), true);
    if (contained[slot] == 0) thaw(slot);
}

}  // namespace motley
