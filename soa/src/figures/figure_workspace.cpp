// Hands out pointers into a workspace, in the order in which a step uses what they point at.
#include "figures/figure_workspace.h"

#include <algorithm>
#include <utility>

#include "stores/growth.h"

namespace motley {
namespace {

std::int64_t body_floats(std::size_t bodies)
{
    return static_cast<std::int64_t>(bodies) * CopyBody::floats;
}

std::int64_t lane_floats(const ConstraintKernels& kernels)
{
    return std::int64_t{kernels.row_floats + kernels.substep_floats + kernels.impulse_floats +
                        kernels.sum_floats} *
           block_lanes;
}

/// Of a block of contacts of any type, and a fixed body of its own.
std::int64_t contact_floats(const ContactTables& tables)
{
    std::int64_t most = 0;
    for (int type = 0; type < contact_type_count; ++type) {
        const int constraint_class = class_of(type, BodyKind::fixed, BodyKind::rigid);
        most = std::max(most, lane_floats(tables.kernels[static_cast<std::size_t>(constraint_class)]));
    }
    return most + CopyBody::floats;
}

}  // namespace

void FigureWorkspace::make_room(const Figures& figures, const ContactTables& tables)
{
    contacts_taken_ = {};
    std::int64_t most_floats = 0;
    std::size_t most_bodies = 0;
    const FigureShape* last = nullptr;
    for (const FigureBlock& block : figures.blocks()) {
        if (std::exchange(last, block.shape) == block.shape) continue;  // same shape again
        const std::size_t joints = block.shape->joints.size();
        std::int64_t floats = body_floats(block.shape->bodies.size()) + block.shape->system_floats;
        for (std::size_t i = 0; i < joints; ++i) floats += lane_floats(*block.joints[i].kernels);
        most_floats = std::max(most_floats, floats);
        most_bodies = std::max(most_bodies, block.shape->bodies.size());
        if (joints_.size() < joints) joints_.resize(joints);
    }
    const std::size_t contacts = figures.most_contacts();
    if (contacts > 0) {
        sorted_.make_room(contacts, most_bodies);
        grow_to(contacts_, contacts);
        most_floats += static_cast<std::int64_t>(contacts) * contact_floats(tables);
    }
    if (floats_.size() < static_cast<std::size_t>(most_floats))
        floats_.resize(with_room_to_grow(static_cast<std::size_t>(most_floats)));
}

FigureBlock FigureWorkspace::take_in(const Figures& figures, std::size_t which, const ContactTables& tables)
{
    const FigureBlock& block = figures.blocks()[which];
    const std::span<const std::uint32_t> contacts = figures.contacts_of(which);
    float* end = floats_.data();
    const auto take = [&](std::int64_t floats) { return std::exchange(end, end + floats); };
    FigureBlock here = block;
    if (!contacts.empty()) {
        sorted_.sort(block, contacts, tables.placements, figures.places());
        here.fixed_offsets = sorted_.fixed_offsets();
        here.fixed_count = sorted_.fixed_count();
    }
    const std::size_t bodies = block.shape->bodies.size();
    here.bodies = take(body_floats(bodies + static_cast<std::size_t>(here.fixed_count)));
    here.system = take(block.shape->system_floats);
    const auto take_lanes = [&](const ConstraintKernels& kernels, BlockStreams streams, bool adds_up) {
        streams.rows = take(std::int64_t{kernels.row_floats} * block_lanes);
        streams.substep_rows = take(std::int64_t{kernels.substep_floats} * block_lanes);
        streams.impulses = take(std::int64_t{kernels.impulse_floats} * block_lanes);
        streams.sums = adds_up ? take(std::int64_t{kernels.sum_floats} * block_lanes) : nullptr;
        return streams;
    };
    here.joints = joints_.data();
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        const auto [kernels, streams, index] = block.joints[i];
        joints_[i] = {kernels,
                      take_lanes(*kernels,
                                 {.kind_a = streams.kind_a,
                                  .kind_b = streams.kind_b,
                                  .bodies = streams.bodies + index,
                                  .counts = streams.counts + index,
                                  .constraints = streams.constraints + index},
                                 true),
                      0};
    }
    if (contacts.empty()) return here;
    std::size_t count = 0;
    for (const CopyContacts::Slot& slot : sorted_.slots()) {
        const int constraint_class = class_of(slot.type, BodyKind::rigid, BodyKind::fixed);
        const ConstraintKernels& kernels = tables.kernels[static_cast<std::size_t>(constraint_class)];
        const float* const present = sorted_.present(slot);
        contacts_taken_.add_blocks(kernels, 1, std::count(present, present + block_lanes, 1.0F));
        const int fixed = static_cast<int>(bodies) + slot.fixed;
        contacts_[count++] = {{&kernels,
                               take_lanes(kernels,
                                          {.kind_a = BodyKind::rigid,
                                           .kind_b = BodyKind::fixed,
                                           .bodies = sorted_.bodies(slot),
                                           .counts = sorted_.count(slot),
                                           .constraints = sorted_.constraints(slot),
                                           .present = present},
                                          tables.adds_up),
                               0},
                              slot.type,
                              slot.colour,
                              slot.body,
                              fixed};
    }
    here.contacts = {contacts_.data(), count};
    return here;
}

}  // namespace motley
