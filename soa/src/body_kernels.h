// What moves bodies and figures, compiled once an instruction set. The including file sets the namespace and Lanes up;
// see body_kernels_avx2.cpp. No include guard: included once by each.

inline constexpr int Lanes_width = static_cast<int>(sizeof(Lanes) / sizeof(float));

#include "kernel_rows.h"

#include "kernel_bodies.h"

#include "kernel_integration.h"

#include "kernel_commit.h"

#include "kernel_copies.h"

#include "kernel_tree_rows.h"
#include "kernel_trees.h"

#include "kernel_closures.h"

template <BodyKind kind>
void enter_body(BodyKernels& kernels)
{
    if constexpr (kind != BodyKind::fixed) {
        kernels.integrate_velocities = integrate_velocities<kind>;
        kernels.integrate_listed = integrate_listed<kind>;
        kernels.commit = commit<kind>;
    }
    kernels.integrate_positions = integrate_positions<kind, false>;
    kernels.integrate_on = integrate_positions<kind, true>;
}

inline void enter_body_kernels(KernelTable& table)
{
    enter_body<BodyKind::particle>(table.bodies[static_cast<int>(BodyKind::particle)]);
    enter_body<BodyKind::planar>(table.bodies[static_cast<int>(BodyKind::planar)]);
    enter_body<BodyKind::rigid>(table.bodies[static_cast<int>(BodyKind::rigid)]);
    enter_body<BodyKind::fixed>(table.bodies[static_cast<int>(BodyKind::fixed)]);
    table.figures = {load_copies,
                     store_copies,
                     load_copy_velocities,
                     store_copy_velocities,
                     integrate_copy_velocities,
                     integrate_copy_positions,
                     factor_trees,
                     solve_trees};
}
