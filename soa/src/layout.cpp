// Colouring and placing. Constraints that persist keep their colour; the rest take the first that is free.
#include "layout.h"

#include <cstddef>

namespace motley {

void Layout::build(Scene& scene, std::span<const Contact> contacts)
{
    if (!scene.joints().version || scene.joints().version != joint_version_) {
        place_joints(scene);
        if (!scene.joints().version) scene.joints().version = std::make_shared<const char>('\0');
        joint_version_ = scene.joints().version;
    }
    place_contacts(scene, contacts.size());
    for (auto& chunks : sweeps_) chunks.clear();
    transfers_.clear();
    joints_.cut(kernels_, sweeps_, transfers_);
    contacts_.cut(kernels_, sweeps_, transfers_);
    point_at_data(scene, contacts);
}

void Layout::place_joints(Scene& scene)
{
    const BodyStore& bodies = scene.bodies();
    joints_.clear();
    joint_masks_.reset(bodies);
    scene.joints().for_each([&](auto& store, int) {
        for (std::size_t i = 0; i < store.size(); ++i) {
            if (store.colours[i] == no_colour) continue;
            joint_masks_.try_take(bodies.row_of(store.definitions[i].body_a),
                                  bodies.row_of(store.definitions[i].body_b), store.colours[i]);
        }
    });
    scene.joints().for_each([&](auto& store, int type) {
        for (std::size_t i = 0; i < store.size(); ++i) {
            const BodyRow a = bodies.row_of(store.definitions[i].body_a);
            const BodyRow b = bodies.row_of(store.definitions[i].body_b);
            if (store.colours[i] == no_colour) store.colours[i] = joint_masks_.take_first(a, b);
            joints_.place(contact_type_count + type, a, b, static_cast<std::int32_t>(i), store.colours[i]);
        }
    });
}

void Layout::place_contacts(Scene& scene, std::size_t count)
{
    masks_.copy(joint_masks_, scene.bodies());
    ContactList& list = scene.contact_cache().staged();
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t kept = intake.kept_colours[i];
        // A joint added since may have taken the colour; then the contact looks for another below. One in the
        // overflow looks again too: the crowd around its hub may have thinned.
        const bool keeps = kept < overflow_colour && masks_.try_take(intake.a[i], intake.b[i], kept);
        list.colours[i] = keeps ? kept : no_colour;
    }
    contacts_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (list.colours[i] == no_colour) list.colours[i] = masks_.take_first(intake.a[i], intake.b[i]);
        contacts_.place(intake.types[i], intake.a[i], intake.b[i], static_cast<std::int32_t>(i),
                        list.colours[i]);
    }
}

void Layout::point_at_data(Scene& scene, std::span<const Contact> contacts)
{
    static_assert(sizeof(Contact) % sizeof(float) == 0);
    static_assert(offsetof(Contact, restitution) - offsetof(Contact, normal) == 11 * sizeof(float),
                  "the numbers of a contact are three quads in line");
    ConstraintData contact;
    if (!contacts.empty()) {
        contact.parameters = &contacts[0].normal.x;
        contact.parameter_stride = sizeof(Contact) / sizeof(float);
        contact.memory_in = &scene.contact_cache().current().impulses[0].normal;
        contact.memory_index = intake.memory_index.data();
        contact.memory_out = &scene.contact_cache().staged().impulses[1].normal;
        contact.memory_stride = sizeof(ContactImpulse) / sizeof(float);
    }
    for (int type = 0; type < contact_type_count; ++type) data_[static_cast<std::size_t>(type)] = contact;
    scene.joints().for_each([&](auto& store, int type) {
        using Store = std::remove_cvref_t<decltype(store)>;
        ConstraintData& data = data_[static_cast<std::size_t>(contact_type_count + type)];
        data.parameters = store.parameters.data();
        data.parameter_stride = quad_floats<typename Store::Parameters>;
        data.memory_in = store.memory.data();
        data.memory_out = store.memory.data();
        data.memory_stride = quad_floats<typename Store::Memory>;
    });
}

void Layout::point_at(Scene& scene, const StepConstants& step)
{
    context.step = step;
    for (int kind = 0; kind < body_kind_count; ++kind) {
        BodyRows& rows = scene.bodies().rows(static_cast<BodyKind>(kind));
        context.bodies[kind] = {rows.velocity.data(),
                                rows.delta.data(),
                                rows.unpushed.data(),
                                rows.acceleration.data(),
                                rows.world_inverse_inertia.data(),
                                rows.start_inverse_inertia.data(),
                                rows.pose.data(),
                                rows.orientation.data(),
                                static_cast<std::int32_t>(rows.size())};
    }
}

void Layout::report(StepReport& report) const
{
    const BatchSet::Count joints = joints_.count(kernels_), contacts = contacts_.count(kernels_);
    report.joints = joints.constraints;
    report.contacts = contacts.constraints;
    report.blocks = joints.blocks + contacts.blocks;
    report.overflow = joints.overflow + contacts.overflow;
    const auto constraints = static_cast<double>(joints.constraints + contacts.constraints);
    if (constraints > 0) {
        report.lane_occupancy = constraints / (block_lanes * static_cast<double>(report.blocks));
        report.bytes_per_constraint = (joints.streamed_bytes + contacts.streamed_bytes) / constraints;
    }
    report.colours = 0;
    for (int colour = 0; colour < parallel_colours; ++colour) {
        if (!sweeps_[static_cast<std::size_t>(colour)].empty()) ++report.colours;
    }
}

}  // namespace motley
