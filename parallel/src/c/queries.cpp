// Queries of the C interface.
#include "motley/c/queries.h"

#include "motley/core/contact_events.h"
#include "motley/core/crowd_index.h"
#include "motley/core/wall_index.h"
#include "rings.h"

struct motley_crowd_index {
    motley::CrowdIndex index;
};
struct motley_wall_index {
    motley::WallIndex index;
};
struct motley_contact_events {
    motley::ContactEvents events;
};

namespace motley::c {

template <>
struct Mirror<motley_near_person, NearPerson> : Pair<motley_near_person, NearPerson> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(body), MOTLEY_FIELD(distance));
};
template <>
struct Mirror<motley_wall_hit, WallHit> : Pair<motley_wall_hit, WallHit> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(wall), MOTLEY_FIELD(fraction));
};
template <>
struct Mirror<motley_contact_pair, ContactPair> : Pair<motley_contact_pair, ContactPair> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(a), MOTLEY_FIELD(b), MOTLEY_FIELD(wall));
};

namespace {

template <class Handle>
void make(Handle** to, const char* name)
{
    Handle*& handle = need(to, name);
    handle = new Handle;
}

const CrowdIndex& people_of(const motley_crowd_index* index)
{
    return need(index, "index").index;
}
const WallIndex& walls_of(const motley_wall_index* index)
{
    return need(index, "index").index;
}
const ContactEvents& events_of(const motley_contact_events* events)
{
    return need(events, "events").events;
}

/// Gives what `ask` finds. Its list is kept for the next question of this thread, so that warm ones allocate nothing.
template <class Cpp, class C, class Ask>
void give_found(std::size_t capacity, C* found, std::size_t* count, const Ask& ask)
{
    thread_local std::vector<Cpp> all;
    give_list(capacity, found, "found", count, [&] {
        ask(all);
        return std::span<const Cpp>(all);
    });
}

}  // namespace
}  // namespace motley::c

using namespace motley;
using namespace motley::c;

motley_status motley_crowd_index_create(motley_crowd_index** index)
{
    return call(__func__, [&] { make(index, "index"); });
}

void motley_crowd_index_destroy(motley_crowd_index* index)
{
    delete index;
}

motley_status motley_crowd_index_build(motley_crowd_index* index, const motley_scene* scene)
{
    return call(__func__, [&] { need(index, "index").index.build(scene_of(scene)); });
}

motley_status motley_crowd_index_is_current(const motley_crowd_index* index, const motley_scene* scene,
                                            motley_bool* current)
{
    return call(__func__, [&] { need(current, "current") = people_of(index).is_current(scene_of(scene)); });
}

motley_status motley_crowd_index_size(const motley_crowd_index* index, size_t* size)
{
    return call(__func__, [&] { need(size, "size") = people_of(index).size(); });
}

motley_status motley_crowd_index_centres_within(const motley_crowd_index* index, motley_vec2d point,
                                                double radius, size_t capacity, motley_body_id* found,
                                                size_t* count)
{
    return call(__func__, [&] {
        give_found<BodyId>(capacity, found, count, [&](std::vector<BodyId>& all) {
            people_of(index).centres_within(as<Vec2<double>>(point), radius, all);
        });
    });
}

motley_status motley_crowd_index_discs_within(const motley_crowd_index* index, motley_vec2d point,
                                              double radius, size_t capacity, motley_body_id* found,
                                              size_t* count)
{
    return call(__func__, [&] {
        give_found<BodyId>(capacity, found, count, [&](std::vector<BodyId>& all) {
            people_of(index).discs_within(as<Vec2<double>>(point), radius, all);
        });
    });
}

motley_status motley_crowd_index_nearest(const motley_crowd_index* index, motley_vec2d point, double furthest,
                                         size_t capacity, motley_near_person* found, size_t* count)
{
    return call(__func__, [&] {
        give_found<NearPerson>(capacity, found, count, [&](std::vector<NearPerson>& all) {
            people_of(index).nearest(as<Vec2<double>>(point), capacity, all, furthest);
        });
    });
}

motley_status motley_crowd_index_inside(const motley_crowd_index* index, size_t ring_count,
                                        const motley_ring* rings, size_t capacity, motley_body_id* found,
                                        size_t* count)
{
    return call(__func__, [&] {
        const Polygon area = polygon_of(rings, ring_count);
        give_found<BodyId>(capacity, found, count,
                           [&](std::vector<BodyId>& all) { people_of(index).inside(area, all); });
    });
}

motley_status motley_wall_index_create(motley_wall_index** index)
{
    return call(__func__, [&] { make(index, "index"); });
}

void motley_wall_index_destroy(motley_wall_index* index)
{
    delete index;
}

motley_status motley_wall_index_build(motley_wall_index* index, const motley_scene* scene)
{
    return call(__func__, [&] { need(index, "index").index.build(scene_of(scene)); });
}

motley_status motley_wall_index_is_current(const motley_wall_index* index, const motley_scene* scene,
                                           motley_bool* current)
{
    return call(__func__, [&] { need(current, "current") = walls_of(index).is_current(scene_of(scene)); });
}

motley_status motley_wall_index_size(const motley_wall_index* index, size_t* size)
{
    return call(__func__, [&] { need(size, "size") = walls_of(index).size(); });
}

motley_status motley_wall_index_first_hit(const motley_wall_index* index, motley_vec2d from, motley_vec2d to,
                                          uint32_t mask, motley_bool* is_hit, motley_wall_hit* hit)
{
    return call(__func__, [&] {
        need(is_hit, "is_hit");
        const auto found = walls_of(index).first_hit(as<Vec2<double>>(from), as<Vec2<double>>(to), mask);
        *is_hit = found.has_value() ? 1 : 0;
        if (found && hit != nullptr) *hit = as<motley_wall_hit>(*found);
    });
}

motley_status motley_contact_events_create(motley_contact_events** events)
{
    return call(__func__, [&] { make(events, "events"); });
}

void motley_contact_events_destroy(motley_contact_events* events)
{
    delete events;
}

motley_status motley_contact_events_update(motley_contact_events* events, const motley_scene* scene)
{
    return call(__func__, [&] { need(events, "events").events.update(scene_of(scene)); });
}

motley_status motley_contact_events_began(const motley_contact_events* events,
                                          const motley_contact_pair** pairs, size_t* count)
{
    return call(__func__, [&] { give_view(events_of(events).began(), pairs, "pairs", count); });
}

motley_status motley_contact_events_ended(const motley_contact_events* events,
                                          const motley_contact_pair** pairs, size_t* count)
{
    return call(__func__, [&] { give_view(events_of(events).ended(), pairs, "pairs", count); });
}

motley_status motley_contact_events_pushing(const motley_contact_events* events, size_t* count)
{
    return call(__func__, [&] { need(count, "count") = events_of(events).pushing(); });
}

motley_status motley_contact_events_clear(motley_contact_events* events)
{
    return call(__func__, [&] { need(events, "events").events.clear(); });
}
