// Everything of figures that is compiled once an instruction set. The including file sets the namespace and Lanes up;
// see figure_kernels_avx2.cpp. No include guard: included once by each.

inline constexpr int Lanes_width = static_cast<int>(sizeof(Lanes) / sizeof(float));

#include "kernel_rows.h"

#include "kernel_bodies.h"

#include "kernel_copies.h"

#include "kernel_trees.h"

#include "kernel_closures.h"

inline void enter_figure_kernels(FigureKernels& kernels)
{
    kernels = {load_copies,
               store_copies,
               load_copy_velocities,
               store_copy_velocities,
               integrate_copy_velocities,
               integrate_copy_positions,
               factor_trees,
               solve_trees};
}
