// The kernels that integrate bodies, by row and as copies of figures, and that measure what sweeps change, for one
// instruction set: see constraint_kernels.cpp.
#include "kernels/kernel_prelude.h"

namespace motley {
namespace {

#include MOTLEY_LANES
#include "kernels/kernel_rows.h"

#include "kernels/kernel_bodies.h"

#include "kernels/kernel_tumble.h"

#include "kernels/kernel_integration.h"

#include "kernels/kernel_quad_integration.h"

#include "kernels/kernel_commit.h"

#include "kernels/kernel_copies.h"

#include "kernels/kernel_watch.h"

template <BodyKind kind>
void enter_integration(BodyKernels& kernels)
{
#ifndef MOTLEY_SCALAR_LANES
    if constexpr (quads_of(kind) == 1) {
        kernels.integrate_velocities = integrate_velocity_quads<kind>;
        kernels.integrate_positions = integrate_position_quads<kind>;
    } else
#endif
    {
        if constexpr (kind != BodyKind::fixed)
            kernels.integrate_velocities = integrate_velocities<kind, false>;
        kernels.integrate_positions = integrate_positions<kind, false>;
    }
}

template <BodyKind kind>
void enter_body(BodyKernels& kernels)
{
    enter_integration<kind>(kernels);
    if constexpr (kind != BodyKind::fixed) {
        kernels.begin_velocities = integrate_velocities<kind, true>;
        kernels.integrate_listed = integrate_listed<kind>;
        kernels.commit = commit<kind>;
        kernels.bring_back = bring_back<kind>;
    }
    kernels.integrate_on = integrate_positions<kind, true>;
    kernels.keep = keep_bodies<kind>;
    kernels.find_energy = find_energy<kind>;
    static_assert(fields_of<Body<kind>> <= most_body_floats);
}

}  // namespace

template <>
void enter_body_kernels<Isa::MOTLEY_ISA>(BodyKernels* kinds, FigureKernels& figures)
{
    enter_body<BodyKind::particle>(kinds[static_cast<int>(BodyKind::particle)]);
    enter_body<BodyKind::planar>(kinds[static_cast<int>(BodyKind::planar)]);
    enter_body<BodyKind::rigid>(kinds[static_cast<int>(BodyKind::rigid)]);
    enter_body<BodyKind::fixed>(kinds[static_cast<int>(BodyKind::fixed)]);
    figures.load = load_copies;
    figures.store = store_copies;
    figures.load_velocities = load_copy_velocities;
    figures.store_velocities = store_copy_velocities;
    figures.integrate_velocities = integrate_copy_velocities;
    figures.integrate_positions = integrate_copy_positions;
}

}  // namespace motley
