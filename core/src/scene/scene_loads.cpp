// The loads that contacts put on bodies, in bulk.
#include <cstdint>
#include <string>

#include "motley/core/invalid_input.h"
#include "scene/disc_impulses.h"
#include "stores/array.h"

namespace motley {

void SceneCore::require_list_of_last_step(std::span<const Contact> list, const char* what) const
{
    const ContactList& last = contacts.current();
    bool same = list.size() == listed_contacts();
    for (std::size_t i = 0; same && i < list.size(); ++i) same = last.entries[i].key == list[i].key;
    if (!same) refuse(what, "another list", "the list of the last step");
}

void Scene::read_loads(std::span<const BodyId> bodies, std::span<const Contact> contacts,
                       StridedSpan<BodyLoad> loads, StridedSpan<const float> circumferences) const
{
    if (loads.size() != bodies.size())
        refuse("read_loads.loads.size()", static_cast<double>(loads.size()), "the size of bodies");
    if (!circumferences.empty() && circumferences.size() != bodies.size()) {
        refuse("read_loads.circumferences.size()", static_cast<double>(circumferences.size()),
               "0 or the size of bodies");
    }
    for (std::size_t i = 0; i < circumferences.size(); ++i) {
        if (!(circumferences[i] > 0 && circumferences[i] <= 1e9F)) {
            refuse("read_loads.circumferences[" + std::to_string(i) + "]", circumferences[i],
                   "above 0, to 1e9 (m)");
        }
    }
    core_->require_alive(bodies, "read_loads.bodies");
    core_->require_list_of_last_step(contacts, "read_loads.contacts");
    Array<Borne> borne(core_->bodies.slot_count());
    const auto bear_all = [&](std::span<const Contact> list, std::span<const ContactImpulse> impulses) {
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto normal = static_cast<double>(impulses[i].normal);
            const Vec3<double> on_b =
                normal * convert<double>(list[i].normal) + convert<double>(impulses[i].friction);
            const auto bear = [&](BodyId body, const Vec3<double>& push) {
                if (!core_->bodies.is_alive(body)) return;  // removed since
                Borne& all = borne[body.slot];
                all.normal += normal;
                all.largest = std::max(all.largest, normal);
                all.net = all.net + push;
            };
            bear(list[i].body_a, -on_b);
            bear(list[i].body_b, on_b);
        }
    };
    bear_all(contacts, contact_impulses());
    bear_all(core_->shapes.contacts, core_->shape_impulses());
    core_->bear_disc_impulses(borne);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        loads[i] = core_->load_of(borne[bodies[i].slot], circumferences.empty() ? 0 : circumferences[i]);
}

void SceneCore::bear_disc_impulses(std::span<Borne> borne) const
{
    for_each_disc_impulse([&](const DiscImpulse& contact) {
        const Vec3<double> on_b{contact.on_b().x, contact.on_b().y, 0};
        const auto bear = [&](std::uint32_t slot, const Vec3<double>& push) {
            Borne& all = borne[slot];
            all.normal += contact.along;
            all.largest = std::max(all.largest, contact.along);
            all.net = all.net + push;
        };
        bear(contact.slot_a, -on_b);
        bear(contact.slot_b, on_b);
    });
}

BodyLoad SceneCore::load_of(const Borne& borne, float circumference) const
{
    const double per_second = last_step > 0 ? 1 / static_cast<double>(last_step) : 0;
    const double force = per_second * borne.normal;
    return {static_cast<float>(force), static_cast<float>(per_second * borne.largest),
            convert<float>(per_second * borne.net),
            circumference > 0 ? static_cast<float>(force / static_cast<double>(circumference)) : 0};
}

}  // namespace motley
