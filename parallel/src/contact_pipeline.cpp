// See contact_pipeline.h.
#include "contact_pipeline.h"

namespace motley {

std::string ContactPipeline::take_in(SceneCore& scene, std::span<const Contact> contacts,
                                     BadContacts bad_contacts)
{
    check_and_match(scene, contacts);
    std::string error = layout_.intake.first_error(scene, contacts);
    if (error.empty() || bad_contacts == BadContacts::skip) look_up_unmatched(scene.contacts);
    return error;
}

std::string ContactPipeline::lay_out(SceneCore& scene, std::span<const Contact> contacts,
                                     const Wanted& wanted)
{
    layout_.begin(scene, contacts.size(), wanted.figures);
    colour_and_verify_keys(scene);
    if (scene.contacts.has_repeated_key()) return ContactIntake::repeated_key(contacts);
    sort_into_blocks(wanted.adds_up);
    layout_.cut(scene, contacts, wanted.tells_apart);
    return {};
}

/// Checks each contact, and matches it with the contact at about the same place of the last list.
void ContactPipeline::check_and_match(SceneCore& scene, std::span<const Contact> contacts)
{
    layout_.intake.begin(scene, contacts.size());
    runner_.run(scene.contacts.part_count(),
                [&](std::int64_t part) { layout_.intake.check_and_match(scene, contacts, part); });
}

/// Matches by key the contacts that are at another place than in the last list.
void ContactPipeline::look_up_unmatched(ContactCache& cache)
{
    const std::int64_t parts = cache.part_count();
    runner_.run(parts, [&](std::int64_t part) { cache.find_lost(part); });
    cache.open_table();
    runner_.run(parts, [&](std::int64_t part) { cache.enter_lost(part); });
    runner_.run(parts, [&](std::int64_t part) { layout_.intake.look_up(cache, part); });
}

/// One thread colours the contacts; the others meanwhile look for repeated keys.
void ContactPipeline::colour_and_verify_keys(SceneCore& scene)
{
    ContactCache& cache = scene.contacts;
    runner_.run(1 + cache.part_count(), [&](std::int64_t chunk) {
        if (chunk == 0) {
            layout_.colour_contacts(scene.bodies, cache);
        } else {
            cache.verify(chunk - 1);
        }
    });
}

void ContactPipeline::sort_into_blocks(bool adds_up)
{
    BatchSet& contacts = layout_.contacts;
    runner_.run(contacts.chunk_count(), [&](std::int64_t chunk) { layout_.count_contacts(chunk); });
    contacts.open(layout_.kernels(), adds_up, false);
    runner_.run(contacts.chunk_count(), [&](std::int64_t chunk) { contacts.fill(chunk); });
}

}  // namespace motley
