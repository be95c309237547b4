// Colouring and placing. Constraints that persist keep their colour; the rest take the first that is free.
#include "layout/layout.h"

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

#include "stores/array.h"
#include "stores/disc_store.h"
#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// The size of a core's second level cache, bytes. Bodies that fit it arrive in time without prefetching, which is a
/// quarter of a small kernel's instructions: without it a sweep of 10,000 people is 1.4 times as fast, and one of a
/// million 0.8 times.
std::int64_t second_level_cache()
{
    constexpr std::int64_t usual = 1 << 20;
#ifdef _SC_LEVEL2_CACHE_SIZE
    static const std::int64_t said = sysconf(_SC_LEVEL2_CACHE_SIZE);
    return said > 0 ? said : usual;
#else
    return usual;
#endif
}

/// What a sweep reads of a body: velocity and displacement, and the inertia of a rigid body.
std::int64_t swept_bytes(BodyKind kind)
{
    return kind == BodyKind::rigid ? 96 : 32;
}

/// The slot of a body that sleeps, if none that is awake has a part in a contact; else 0.
std::uint32_t sleeper_of(const BodyStore& bodies, const Placement& placement)
{
    std::uint32_t sleeper = 0;
    for (const BodyRow body : {placement.a, placement.b}) {
        if (body.kind() == BodyKind::fixed) continue;
        if (!bodies.is_asleep(body)) return 0;
        sleeper = bodies.rows(body.kind()).slot[body.row()];
    }
    return sleeper;
}

}  // namespace

void Layout::begin(SceneCore& scene, std::size_t contact_count, const FigureUse& use)
{
    const bool plants_trees = !std::exchange(use_, use).has_trees_of(use);
    JointStores& joints = *scene.joints;
    if (!joints.version || joints.version != joint_version_ || plants_trees) {
        // The old layout is marked invalid until all of the new one is made, because an allocation may fail in
        // between.
        const std::shared_ptr<const char> before = std::exchange(joint_version_, nullptr);
        const bool may_follow = before && !joints.version && joints.changes.since == before && !plants_trees;
        cut_.reset();
        has_placements_ = false;
        if (!may_follow || !joint_lanes_.follow(scene, joint_masks_)) place_joints(scene);
        joints.close_changes();
        joint_version_ = joints.version;
    }
    for (std::size_t kind = 0; kind < body_kind_count; ++kind) {
        const std::size_t rows = scene.bodies.rows(static_cast<BodyKind>(kind)).size();
        grow_to(start_along_[kind], rows);
        if (scene.bodies.damped > 0 && static_cast<BodyKind>(kind) != BodyKind::fixed)
            grow_to(decay_[kind], 4 * static_cast<std::size_t>(quads_of(static_cast<BodyKind>(kind))) * rows);
    }
    joint_intake_.grow(scene.bodies);
    figures.make_room(contact_count);
    joint_masks_.grow(scene.bodies);
    if (contact_count > 0) masks_ = joint_masks_;
    grow_to(uncoloured_, contact_count);
    contacts.begin({intake.placements.data(), contact_count}, intake.patches.are_wanted());
}

void Layout::place_joints(SceneCore& scene)
{
    joint_masks_.reset(scene.bodies);
    joint_intake_.take(scene, use_.limits_exactly, joint_masks_);
    groups.find(joint_intake_);
    figures.find(joint_intake_.joints(), joint_intake_.sets(), scene.bodies, kernels_, use_.exact,
                 joint_placements_);
    joints_.begin(joint_placements_, false);
    for (std::int64_t chunk = 0; chunk < joints_.chunk_count(); ++chunk) joints_.count(chunk);
    joints_.open(kernels_, true, true);
    for (std::int64_t chunk = 0; chunk < joints_.chunk_count(); ++chunk) joints_.fill(chunk);
    figures.bind(joints_, kernels_);
    joint_lanes_.start_over(*scene.joints);
    has_placements_ = true;
}

std::span<const Placement> Layout::joint_placements()
{
    if (!std::exchange(has_placements_, true)) {
        joint_placements_.clear();
        joints_.for_each_block([&](int constraint_class, std::uint8_t colour, std::int32_t block,
                                   const BlockBodies&, const BlockConstraints&, int lanes) {
            for (int lane = 0; lane < lanes; ++lane)
                joint_placements_.push_back(
                    joints_.placement_in({constraint_class, block, static_cast<std::uint8_t>(lane), colour}));
        });
    }
    return joint_placements_;
}

void Layout::colour_contacts(const BodyStore& bodies, ContactCache& cache)
{
    ContactList& list = cache.staged();
    list.has_sleepers = bodies.sleepers > 0;
    const std::span<Placement> placements(intake.placements.data(), list.count);
    std::size_t uncoloured = 0;
    for (std::uint32_t i = 0; i < placements.size(); ++i) {
        Placement& placement = placements[i];
        if (placement.is_bad || bodies.is_contained(placement.a) || bodies.is_contained(placement.b)) {
            placement.colour = left_out_colour;
            list.colours[i] = no_colour;
            list.impulses[i + 1] = list.step_impulses[i] = {};
            if (list.has_sleepers) list.sleepers[i] = 0;
            continue;
        }
        if (list.has_sleepers) {
            list.sleepers[i] = sleeper_of(bodies, placement);
            if (list.sleepers[i] != 0) {
                keep_impulses(cache, i);
                continue;
            }
        }
        // A joint added since may have taken the colour; then the contact gets another one below. So does one in the
        // overflow: its hub may have fewer constraints by now.
        const bool keeps =
            placement.colour < overflow_colour && masks_.try_take(placement.a, placement.b, placement.colour);
        if (!keeps) uncoloured_[uncoloured++] = i;
        list.colours[i] = placement.colour;
    }
    for (std::size_t k = 0; k < uncoloured; ++k) {
        const std::uint32_t i = uncoloured_[k];
        list.colours[i] = placements[i].colour = masks_.take_first(placements[i].a, placements[i].b);
    }
    if (figures.take_contacts(placements, use_.in_lockstep)) cut_.reset();
}

/// A contact that rests keeps its colour for when it wakes, and the force that it bore.
void Layout::keep_impulses(ContactCache& cache, std::uint32_t i)
{
    ContactList& list = cache.staged();
    list.colours[i] = std::exchange(intake.placements[i].colour, left_out_colour);
    const auto before = static_cast<std::size_t>(intake.memory_index[i]);
    const auto scaled = [](float by, const ContactImpulse& impulse) {
        return ContactImpulse{by * impulse.normal, by * impulse.friction};
    };
    list.impulses[i + 1] = scaled(kept.substep, cache.current().impulses[before]);
    list.step_impulses[i] =
        before == 0 ? ContactImpulse{} : scaled(kept.step, cache.current().step_impulses[before - 1]);
}

void Layout::count_contacts(std::int64_t chunk)
{
    if (intake.patches.are_wanted()) intake.fill_patch(chunk, figures);
    contacts.count(chunk);
}

void Layout::cut(SceneCore& scene, std::span<const Contact> list, bool tells_apart)
{
    point_at_data(scene, list);
    // Without blocks of contacts, and with the joints and lone figures of the step before, the chunks are still valid.
    Cut wanted{{}, use_.in_lockstep, tells_apart};
    for (int kind = 0; kind < body_kind_count; ++kind)
        wanted.rows[static_cast<std::size_t>(kind)] = scene.bodies.rows(static_cast<BodyKind>(kind)).size();
    const bool same_awake = note_awake(scene.bodies);
    const bool may_keep = !contacts.has_blocks() && !intake.patches.are_wanted();
    if (may_keep && cut_ == wanted && same_awake) return;
    cut_.reset();
    sweeps_.clear();
    transfers_.parts.clear();
    transfers_.tiles.clear();
    list_rows(scene);
    joints_.cut(kernels_, tells_apart, sweeps_, transfers_);
    contacts.cut(kernels_, tells_apart, sweeps_, transfers_);
    if (may_keep) cut_ = wanted;
}

void Layout::list_discs(SceneCore& scene, bool tells_apart)
{
    disc_chunks_.clear();
    disc_bands_.clear();
    std::size_t all_blocks = 0;
    for (std::size_t band = 0; band < scene.discs.band_count; ++band) {
        const auto first = static_cast<std::int32_t>(disc_chunks_.size());
        for (std::size_t c = 0; c < disc_class_count; ++c) {
            DiscBlocks& blocks = scene.discs.bands[band].blocks[c];
            if (blocks.count == 0) continue;
            const BodyKind kind_a = is_wall(static_cast<DiscClass>(c)) ? BodyKind::fixed : BodyKind::planar;
            SweepChunk chunk{};
            chunk.kernels = &kernels_.discs.classes[c];
            chunk.streams.kind_a = chunk.kind_a = kind_a;
            chunk.streams.kind_b = chunk.kind_b = BodyKind::planar;
            chunk.streams.bodies = blocks.bodies.data();
            chunk.streams.counts = blocks.lanes.data();
            chunk.streams.rows = blocks.rows.data();
            chunk.streams.impulses = blocks.impulses.data();
            chunk.streams.sums = blocks.sums.data();
            chunk.end = blocks.count;
            disc_chunks_.push_back(chunk);
            all_blocks += static_cast<std::size_t>(blocks.count);
        }
        disc_bands_.push_back({first, static_cast<std::int32_t>(disc_chunks_.size())});
    }
    if (!tells_apart) return;
    disc_marks_.make_room(all_blocks);
    std::size_t before = 0;
    for (SweepChunk& chunk : disc_chunks_) {
        disc_marks_.mark(chunk, before);
        before += static_cast<std::size_t>(chunk.end);
    }
}

void Layout::point_at_data(SceneCore& scene, std::span<const Contact> list)
{
    static_assert(sizeof(Contact) % sizeof(float) == 0);
    static_assert(offsetof(Contact, restitution) - offsetof(Contact, normal) == 11 * sizeof(float),
                  "the numbers of a contact are three quads in line");
    ConstraintData contact;
    if (!list.empty()) {
        contact.parameters = &list[0].normal.x;
        contact.parameter_stride = sizeof(Contact) / sizeof(float);
        contact.memory_in = &scene.contacts.current().impulses[0].normal;
        contact.exchanged = intake.exchanged.data();
        contact.memory_index = intake.memory_index.data();
        contact.memory_out = &scene.contacts.staged().impulses[1].normal;
        contact.memory_stride = sizeof(ContactImpulse) / sizeof(float);
        contact.step_out = &scene.contacts.staged().step_impulses[0].normal;
        contact.step_stride = contact.memory_stride;
        if (!intake.surfaces.empty()) {
            contact.surfaces = intake.surfaces.data();
            contact.first_surface = static_cast<std::int32_t>(intake.first_surface());
        }
    }
    for (int type = 0; type < contact_type_count; ++type) data_[static_cast<std::size_t>(type)] = contact;
    scene.joints->for_each([&](auto& store, int type) {
        using Store = std::remove_cvref_t<decltype(store)>;
        ConstraintData& data = data_[static_cast<std::size_t>(contact_type_count + type)];
        data.parameters = store.parameters.data();
        data.parameter_stride = quad_floats<typename Store::Parameters>;
        data.memory_in = store.memory.data();
        data.memory_out = store.memory.data();
        data.memory_stride = quad_floats<typename Store::Memory>;
        data.step_out = store.wrenches.data();
        data.step_stride = Store::wrench_floats;
        data.world_points = store.world_points.data();
    });
}

void Layout::point_at(SceneCore& scene, const StepConstants& step)
{
    context.step = step;
    context.relaxing = relaxing(step);
    context.width = kernels_.width;
    std::int64_t swept = 0;
    for (int kind = 0; kind < body_kind_count; ++kind) {
        BodyRows& rows = scene.bodies.rows(static_cast<BodyKind>(kind));
        swept += swept_bytes(static_cast<BodyKind>(kind)) * static_cast<std::int64_t>(rows.size());
        const bool decays = scene.bodies.damped > 0 && static_cast<BodyKind>(kind) != BodyKind::fixed &&
                            find_decay(scene.bodies, static_cast<BodyKind>(kind), step.substep);
        context.bodies[kind] = {
            static_cast<BodyKind>(kind),
            rows.velocity.data(),
            rows.delta.data(),
            rows.unpushed.data(),
            start_along_[static_cast<std::size_t>(kind)].data(),
            joint_intake_.is_jointed(static_cast<BodyKind>(kind)).data(),
            static_cast<BodyKind>(kind) == BodyKind::rigid ? joint_masks_.of(BodyKind::rigid) : nullptr,
            &turned_far_,
            rows.acceleration.data(),
            decays ? decay_[static_cast<std::size_t>(kind)].data() : nullptr,
            rows.world_inverse_inertia.data(),
            rows.start_inverse_inertia.data(),
            rows.inverse_inertia.data(),
            rows.pose.data(),
            rows.orientation.data(),
            static_cast<std::int32_t>(rows.size()),
            static_cast<BodyKind>(kind) != BodyKind::fixed};
    }
    context.largest_response = scene.bodies.largest_response;
    context.bodies_are_far = swept > second_level_cache();
    overloaded_ = turned_far_ = false;
    context.overloaded = &overloaded_;
    context.turned_far = &turned_far_;
}

void Layout::report(StepReport& report, const BatchSet::Count& in_lockstep) const
{
    const BatchSet::Count joints = joints_.count(kernels_);
    BatchSet::Count touches = contacts.count(kernels_);
    touches += in_lockstep;
    for (const SweepChunk& chunk : disc_chunks_) {
        std::int64_t lanes = 0;
        for (std::int32_t block = 0; block < chunk.end; ++block) lanes += chunk.streams.counts[block];
        touches.add_blocks(*chunk.kernels, chunk.end, lanes);
        report.disc_contacts += lanes;
    }
    report.joints = joints.constraints;
    report.contacts = touches.constraints;
    report.blocks = joints.blocks + touches.blocks;
    report.overflow = joints.overflow + touches.overflow;
    report.joints_in_lockstep = figures.lone_joints();
    report.exact_joints_refused = figures.refused().joints;
    report.first_light_body = figures.refused().light_body;
    const auto constraints = static_cast<double>(joints.constraints + touches.constraints);
    if (constraints > 0) {
        report.lane_occupancy = constraints / (block_lanes * static_cast<double>(report.blocks));
        report.bytes_per_constraint = (joints.streamed_bytes + touches.streamed_bytes) / constraints;
    }
    report.colours = std::popcount(sweeps_.colours);
}

}  // namespace motley
