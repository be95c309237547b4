// The kernels of constraints, compiled once an instruction set. The including file sets the namespace and Lanes up;
// see kernels_avx2.cpp. No include guard: included once by each.

inline constexpr int Lanes_width = static_cast<int>(sizeof(Lanes) / sizeof(float));

#include "kernel_rows.h"

#include "kernel_bodies.h"

#include "kernel_constraints.h"

template <class Type, BodyKind a, BodyKind b>
void enter_pair(KernelTable& table, int type)
{
    // Two bodies that cannot move need no constraint, a particle has no axes to lock, and the scene refuses both.
    constexpr bool moves = a != BodyKind::fixed || b != BodyKind::fixed;
    constexpr bool has_particle = a == BodyKind::particle || b == BodyKind::particle;
    if constexpr (moves && !(has_particle && requires { Type::needs_bodies_that_turn; })) {
        Kernels<Type, a, b>::enter(table.constraints[class_of(type, a, b)]);
    }
}

template <class Type, BodyKind a>
void enter_partners(KernelTable& table, int type)
{
    enter_pair<Type, a, BodyKind::particle>(table, type);
    enter_pair<Type, a, BodyKind::planar>(table, type);
    enter_pair<Type, a, BodyKind::rigid>(table, type);
    enter_pair<Type, a, BodyKind::fixed>(table, type);
}

template <class Type>
void enter_type(KernelTable& table, int type)
{
    enter_partners<Type, BodyKind::particle>(table, type);
    enter_partners<Type, BodyKind::planar>(table, type);
    enter_partners<Type, BodyKind::rigid>(table, type);
    enter_partners<Type, BodyKind::fixed>(table, type);
}

template <class... Types>
void enter_types(KernelTable& table, int first, TypeList<Types...>)
{
    (enter_type<Types>(table, first++), ...);
}

/// Fills a table that was made elsewhere: the constructor of a table made here would be a weak function compiled for
/// this instruction set.
inline void enter_kernels(KernelTable& table)
{
    enter_types(table, 0, ContactTypes{});
    enter_types(table, contact_type_count, JointTypes{});
}
