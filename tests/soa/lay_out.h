// A step up to the blocks, by one thread, as Solver::step does it.
#pragma once

#include <gtest/gtest.h>

#include "layout.h"

namespace motley::testing {

inline void lay_out(Layout& layout, Scene& scene, std::span<const Contact> contacts)
{
    const auto run = [](std::int64_t count, const auto& chunk) {
        for (std::int64_t i = 0; i < count; ++i) chunk(i);
    };
    ASSERT_EQ(layout.intake.take_in(scene, contacts, false, run), "");
    ContactCache& cache = scene.contact_cache();
    layout.begin(scene, contacts.size(), {});
    layout.colour_contacts(scene.bodies(), cache.staged());
    run(cache.part_count(), [&](std::int64_t part) { cache.verify(part); });
    ASSERT_FALSE(cache.has_repeated_key());
    run(layout.contacts.chunk_count(), [&](std::int64_t chunk) { layout.count_contacts(chunk); });
    layout.contacts.open(layout.kernels(), true);
    run(layout.contacts.chunk_count(), [&](std::int64_t chunk) { layout.contacts.fill(chunk); });
    layout.cut(scene, contacts, false);
    cache.accept_staged();
}

}  // namespace motley::testing
