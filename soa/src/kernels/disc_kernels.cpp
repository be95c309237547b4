// The kernels of contacts of discs, for one instruction set: see constraint_kernels.cpp.
#include "kernels/kernel_prelude.h"
#include "maths/disc_contact.h"

namespace motley {
namespace {

#include MOTLEY_LANES
#include "kernels/kernel_rows.h"

#include "kernels/kernel_bodies.h"

#include "kernels/kernel_bundle.h"

#include "kernels/kernel_blocks.h"

#include "kernels/kernel_sweeps.h"

#include "kernels/kernel_rare.h"

#include "kernels/kernel_discs.h"

template <class Type, BodyKind a>
void enter(ConstraintKernels& kernels)
{
    SweepKernels<Type, a, BodyKind::planar>::enter(kernels);
    kernels.solve = DiscSweeps<Type, a>::solve;
    kernels.relax = DiscSweeps<Type, a>::relax;
    kernels.project = RareKernels<Type, a, BodyKind::planar>::project;
}

}  // namespace

template <>
void enter_disc_kernels<Isa::MOTLEY_ISA>(DiscKernels& discs)
{
    enter<SmoothDiscContact, BodyKind::planar>(discs.of(DiscClass::smooth_pair));
    enter<RoughDiscContact, BodyKind::planar>(discs.of(DiscClass::rough_pair));
    enter<SmoothDiscContact, BodyKind::fixed>(discs.of(DiscClass::smooth_wall));
    enter<RoughDiscContact, BodyKind::fixed>(discs.of(DiscClass::rough_wall));
    discs.prepare_smooth = prepare_pairs<SmoothDiscContact>;
    discs.prepare_rough = prepare_pairs<RoughDiscContact>;
}

}  // namespace motley
