// Which figures are solved on their own in a step, and with which contacts.
#include <algorithm>
#include <utility>

#include "figures/figures.h"
#include "stores/growth.h"

namespace motley {

void Figures::make_room(std::size_t contacts)
{
    if (!is_empty()) grow_to(contacts_, contacts);
}

bool Figures::take_contacts(std::span<Placement> contacts, bool may_be_alone)
{
    if (is_empty()) return false;
    std::swap(alone_, was_alone_);
    alone_.assign(blocks_.size(), may_be_alone ? 1 : 0);
    std::fill(end_of_contacts_.begin(), end_of_contacts_.end(), 0U);
    most_contacts_ = 0;
    if (may_be_alone) {
        for (const Placement& contact : contacts) {
            if (contact.is_left_out()) continue;
            const std::int32_t standing = stands_on(contact);
            if (standing != none && contact.colour != overflow_colour) {
                ++end_of_contacts_[static_cast<std::size_t>(standing)];
                continue;
            }
            for (const BodyRow body : {contact.a, contact.b}) {
                const std::int32_t block = body.kind() == BodyKind::rigid ? block_of(body.row()) : none;
                if (block != none) alone_[static_cast<std::size_t>(block)] = 0;
            }
        }
        // First the number of contacts, then where a block's begin, and at last where they end.
        std::uint32_t taken = 0;
        for (std::size_t block = 0; block < blocks_.size(); ++block) {
            const std::uint32_t count = alone_[block] != 0 ? end_of_contacts_[block] : 0;
            most_contacts_ = std::max<std::size_t>(most_contacts_, count);
            end_of_contacts_[block] = taken;
            taken += count;
        }
        for (std::uint32_t i = 0; taken > 0 && i < contacts.size(); ++i) {
            if (contacts[i].is_left_out()) continue;
            const std::int32_t standing = stands_on(contacts[i]);
            if (standing == none || alone_[static_cast<std::size_t>(standing)] == 0) continue;
            contacts[i].in_figure = true;
            contacts_[end_of_contacts_[static_cast<std::size_t>(standing)]++] = i;
        }
    }
    if (alone_ == was_alone_) return false;
    list_lone_blocks();
    return true;
}

void Figures::list_lone_blocks()
{
    lone_.clear();
    touched_trees_.clear();
    lone_joints_ = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        const FigureShape& shape = *blocks_[i].shape;
        const bool alone = alone_[i] != 0;
        if (alone) {
            lone_.push_back(static_cast<std::int32_t>(i));
            lone_joints_ += blocks_[i].count * static_cast<std::int64_t>(shape.joints.size());
        } else if (shape.has_tree()) {
            touched_trees_.push_back(static_cast<std::int32_t>(i));
        }
        for (std::size_t joint = 0; joint < shape.joints.size(); ++joint)
            *skipped_[i][joint] = alone                         ? BatchSet::skip_altogether
                                  : shape.joints[joint].in_tree ? BatchSet::skip_sweeps
                                                                : BatchSet::skip_nothing;
    }
}

}  // namespace motley
