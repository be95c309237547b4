// Checks contacts as they come in. Every contact gets a quick test of the ranges of its numbers. Only the first one
// that fails it is looked at again, to say which field, which value and what was expected.
#include "layout/contact_intake.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_set>

#include "motley/core/invalid_input.h"
#include "stores/growth.h"

namespace motley {
namespace {

constexpr float largest_arm = 1e9F;
constexpr float largest_friction = 1e9F;

bool within(float value, float low, float high)
{
    return value >= low && value <= high;
}

bool is_unit(const Vec3<float>& n)
{
    return within(dot(n, n), 0.998F, 1.002F);
}

/// Without branches and the same for every number, so that it is vectorized: contacts are nearly always good.
bool numbers_are_good(const Contact& c)
{
    constexpr int count = 12;
    static_assert(offsetof(Contact, restitution) - offsetof(Contact, normal) == (count - 1) * sizeof(float),
                  "the numbers of a contact lie in line");
    constexpr float n = 1.001F, far = largest_arm;
    static constexpr float lowest[count] = {-n, -n, -n, -far, -far, -far, -far, 0, -far, -far, -far, 0};
    static constexpr float highest[count] = {n, n, n, far, far, far, far, largest_friction, far, far, far, 1};
    const float* numbers = &c.normal.x;
    std::uint32_t bad = 0;
    for (int i = 0; i < count; ++i) {
        bad |= static_cast<std::uint32_t>(!(numbers[i] >= lowest[i])) |
               static_cast<std::uint32_t>(!(numbers[i] <= highest[i]));
    }
    return bad == 0 && is_unit(c.normal);
}

/// Distinguishes a body from a later one in the same slot.
std::uint32_t fingerprint(BodyId body)
{
    return body.slot ^ (body.generation * 0x9E3779B9U);
}

bool is_default(const ContactSurface<float>& surface)
{
    return dot(surface.velocity, surface.velocity) == 0 && surface.most_force == INFINITY;
}

bool is_planar(BodyRow a, BodyRow b)
{
    return (a.kind() == BodyKind::planar && (b.kind() == BodyKind::planar || b.kind() == BodyKind::fixed)) ||
           (a.kind() == BodyKind::fixed && b.kind() == BodyKind::planar);
}

}  // namespace

void ContactIntake::begin(SceneCore& scene, std::size_t count)
{
    grow_to(placements, count);
    grow_to(exchanged, count);
    grow_to(memory_index, count);
    count_ = count;
    patches.begin(scene.bodies, count);
    scene.contacts.begin(count);
    first_bad_.store(none, std::memory_order_relaxed);
    bad_contacts_.store(0, std::memory_order_relaxed);
    bounces_.store(false, std::memory_order_relaxed);
}

void ContactIntake::mark_bad(std::size_t index)
{
    bad_contacts_.fetch_add(1, std::memory_order_relaxed);
    std::size_t seen = first_bad_.load(std::memory_order_relaxed);
    while (index < seen && !first_bad_.compare_exchange_weak(seen, index, std::memory_order_relaxed)) {
    }
}

/// Fills in the rows of the bodies and the type. Returns whether the contact is good.
bool ContactIntake::place(const BodyStore& bodies, std::size_t index, const Contact& contact)
{
    if (!bodies.is_alive(contact.body_a) || !bodies.is_alive(contact.body_b)) return false;
    const BodyRow a = bodies.row_of(contact.body_a), b = bodies.row_of(contact.body_b);
    // Kernels are compiled for one order of two kinds.
    const bool in_order = a.kind() <= b.kind();
    exchanged[index] = in_order ? 0 : 1;
    // Field by field: copying a struct that was just made would wait for its stores.
    Placement& placement = placements[index];
    placement.a = in_order ? a : b;
    placement.b = in_order ? b : a;
    placement.in_patch = placement.in_figure = false;
    const bool has_own_surface =
        !surfaces.empty() && index >= first_surface() && !is_default(surfaces[index - first_surface()]);
    placement.type = static_cast<std::uint8_t>(contact.restitution != 0 || has_own_surface ? Touch::bouncing
                                               : contact.friction != 0                     ? Touch::rough
                                                                                           : Touch::smooth);
    return numbers_are_good(contact) && contact.body_a != contact.body_b &&
           !(a.kind() == BodyKind::fixed && b.kind() == BodyKind::fixed) &&
           !(is_planar(a, b) && contact.normal.z != 0);
}

/// Gives contact i the colour and the impulses of contact `before` of the last step, or none.
void ContactIntake::remember(ContactCache& cache, std::uint32_t i, std::uint32_t before)
{
    const ContactList& past = cache.current();
    const ContactList::Entry& entry = cache.staged().entries[i];
    const bool same_bodies = before != ContactCache::none && past.entries[before].body_a == entry.body_a &&
                             past.entries[before].body_b == entry.body_b;
    placements[i].colour = same_bodies ? past.colours[before] : no_colour;
    memory_index[i] = same_bodies ? static_cast<std::int32_t>(before) + 1 : 0;
}

void ContactIntake::check_and_match(SceneCore& scene, std::span<const Contact> contacts, std::int64_t part)
{
    ContactCache& cache = scene.contacts;
    ContactCache::Walk walk(cache, part);
    const auto [begin, end] = cache.part(part);
    bool bounces = false;
    for (std::uint32_t i = begin; i < end; ++i) {
        const Contact& contact = contacts[i];
        // Contacts are consecutive in memory; their bodies are scattered, so they are prefetched.
        constexpr std::uint32_t ahead = 8;
        if (i + ahead < end) {
            scene.bodies.prefetch(contacts[i + ahead].body_a);
            scene.bodies.prefetch(contacts[i + ahead].body_b);
        }
        placements[i].constraint = static_cast<std::int32_t>(i);
        placements[i].is_bad = !place(scene.bodies, i, contact);
        if (placements[i].is_bad) {
            mark_bad(i);
            // If it is skipped, it gets fixed bodies, and keeps its place in the list and its key.
            placements[i].a = placements[i].b = BodyRow(BodyKind::fixed, 0);
            placements[i].type = 0;
            placements[i].in_patch = placements[i].in_figure = false;
        } else {
            if (patches.are_wanted()) {
                patches.claim(placements[i].a, i);
                patches.claim(placements[i].b, i);
            }
            bounces = bounces || contact.restitution > 0;
        }
        ContactList::Entry& entry = cache.staged().entries[i];
        entry.key = contact.key;
        entry.body_a = fingerprint(contact.body_a);
        entry.body_b = fingerprint(contact.body_b);
        const std::uint32_t before = walk.find(i, contact.key);
        if (before != ContactCache::none) remember(cache, i, before);
    }
    if (bounces) bounces_.store(true, std::memory_order_relaxed);
}

/// Prefetches ahead, so that the table's cache misses overlap.
void ContactIntake::look_up(ContactCache& cache, std::int64_t part)
{
    constexpr std::size_t ahead = 12;
    const std::span<const std::uint32_t> missed = cache.missed(part);
    for (std::size_t k = 0; k < missed.size(); ++k) {
        if (k + ahead < missed.size()) cache.prefetch(missed[k + ahead]);
        remember(cache, missed[k], cache.trace(part, missed[k]));
    }
}

void ContactIntake::fill_patch(std::int64_t patch, const Figures& figures)
{
    const auto begin = static_cast<std::size_t>(patch) * Patches::contacts_a_patch;
    const std::size_t end = std::min(begin + Patches::contacts_a_patch, count_);
    Patches::Roll roll(patches, static_cast<std::size_t>(patch));
    for (std::size_t i = begin; i < end; ++i) {
        Placement& placement = placements[i];
        if (figures.stands_on(placement) != Figures::none) continue;
        const bool holds_a = roll.holds(placement.a), holds_b = roll.holds(placement.b);
        placement.in_patch = placement.colour < overflow_colour && holds_a && holds_b;
    }
}

namespace {

[[noreturn]] void refuse_contact(std::size_t index, std::string_view field, double value,
                                 std::string_view expected)
{
    refuse("contacts[" + std::to_string(index) + "]." + std::string(field), value, expected);
}

void check_body(const SceneCore& scene, std::size_t index, const char* field, BodyId body)
{
    if (scene.bodies.is_alive(body)) return;
    refuse("contacts[" + std::to_string(index) + "]." + field,
           body == BodyId{} ? std::string("the null handle")
                            : "slot " + std::to_string(body.slot) + ", not alive",
           "a body of this scene");
}

void check_arm(std::size_t index, const std::string& field, const Vec3<float>& arm)
{
    const float components[3] = {arm.x, arm.y, arm.z};
    const char* names[3] = {".x", ".y", ".z"};
    for (int i = 0; i < 3; ++i) {
        if (!within(components[i], -largest_arm, largest_arm)) {
            refuse_contact(index, field + names[i], components[i], "a finite value from -1e9 to 1e9 (m)");
        }
    }
}

}  // namespace

std::string ContactIntake::first_error(const SceneCore& scene, std::span<const Contact> contacts) const
{
    const std::size_t bad = first_bad_.load(std::memory_order_relaxed);
    if (bad == none) return {};
    const Contact& c = contacts[bad];
    try {
        check_body(scene, bad, "body_a", c.body_a);
        check_body(scene, bad, "body_b", c.body_b);
        if (!is_unit(c.normal)) {
            refuse_contact(bad, "normal", std::sqrt(static_cast<double>(dot(c.normal, c.normal))),
                           "a length of 1 +- 1e-3 (length shown)");
        }
        if (!within(c.separation, -largest_arm, largest_arm)) {
            refuse_contact(bad, "separation", c.separation, "a finite value from -1e9 to 1e9 (m)");
        }
        check_arm(bad, "arm_a", c.arm_a);
        check_arm(bad, "arm_b", c.arm_b);
        if (!within(c.friction, 0, largest_friction))
            refuse_contact(bad, "friction", c.friction, "a finite value from 0 to 1e9");
        if (!within(c.restitution, 0, 1)) refuse_contact(bad, "restitution", c.restitution, "0 to 1");
        if (c.body_a == c.body_b) {
            refuse("contacts[" + std::to_string(bad) + "].body_b", "the same body as body_a",
                   "two different bodies");
        }
        const BodyRow row_a = scene.bodies.row_of(c.body_a), row_b = scene.bodies.row_of(c.body_b);
        if (row_a.kind() == BodyKind::fixed && row_b.kind() == BodyKind::fixed) {
            refuse("contacts[" + std::to_string(bad) + "].body_b", "a second body that cannot move",
                   "at least one dynamic body");
        }
        if (is_planar(row_a, row_b) && c.normal.z != 0) {
            refuse_contact(bad, "normal.z", c.normal.z, "0 between planar bodies");
        }
    } catch (const InvalidInput& refusal) {
        return refusal.what();
    }
    return {};
}

std::string ContactIntake::repeated_key(std::span<const Contact> contacts)
{
    std::unordered_set<std::uint64_t> keys;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (keys.insert(contacts[i].key).second) continue;
        return "contacts[" + std::to_string(i) + "].key is " + std::to_string(contacts[i].key) +
               ", twice in the list; expected a key of its own";
    }
    return {};
}

}  // namespace motley
