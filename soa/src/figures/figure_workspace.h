// The memory in which a worker solves figures. A block that is alone (see Figures) needs its bodies in lanes, its
// tree and the rows of its joints only while it is solved. They are kept here, in the same few hundred kilobytes for
// every block, which stay in the core's second level cache; memory of each block's own would stream through it.
#pragma once

#include <span>

#include "figures/copy_contacts.h"
#include "figures/figures.h"
#include "stores/array.h"

namespace motley {

/// The contacts of a step, as a workspace reads them.
struct ContactTables {
    std::span<const Placement> placements;
    std::span<const ConstraintKernels> kernels;  ///< by class_of
    bool adds_up = false;                        ///< several substeps
};

class FigureWorkspace {
  public:
    /// Before a step: makes space for the largest of the blocks and the most contacts of one. Allocates only when these are
    /// larger than all before.
    void make_room(const Figures& figures, const ContactTables& tables);
    /// The block with its pointers into this memory, and with its contacts; valid until the next take_in().
    [[nodiscard]] FigureBlock take_in(const Figures& figures, std::size_t block, const ContactTables& tables);

    /// The contacts that were taken in since the last make_room().
    [[nodiscard]] const BatchSet::Count& contacts_taken() const { return contacts_taken_; }

  private:
    BatchSet::Count contacts_taken_;
    AlignedVector<float> floats_;
    Array<FigureBlock::Joint> joints_;
    CopyContacts sorted_;
    Array<FigureBlock::Contact> contacts_;
};

}  // namespace motley
