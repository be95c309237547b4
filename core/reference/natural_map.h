// The natural map of a group of rows and its derivative: lambda - P(lambda - scale w), with P the projection to bounds and cones,
// is zero at the solution (P. Alart, A. Curnier 1991). E, F, D and s are those of semismooth_newton.cpp.
#pragma once

#include <array>
#include <cstdint>

#include "complementarity.h"

namespace motley::reference {

/// Which piece of the natural map a row is on: between its bounds, at one of them, or on the edge of its cone.
enum class Where : std::uint8_t { inside, low, high, slides };
/// Rows of a group, with what a Newton step knows of them.
struct MappedGroup {
    RowGroup* group = nullptr;
    std::array<int, RowGroup::most_bodies> bodies{-1, -1, -1};
    int node = -1;                                 ///< of a joint that stays in the system
    RowGroup::Rows<1> offset{}, share{}, scale{};  ///< scale: 1 / K_ii; 0 of a row that cannot move
    RowGroup::Rows<1> w{}, map{}, step{}, start{}, best{};
    RowGroup::Square e{}, f{}, law{};  ///< law: D
    RowGroup::Rows<1> drive{};         ///< s
    std::array<Where, RowGroup::most_rows> where{};
};

/// The radius of a cone at these impulses of its group.
double radius(const Cone& cone, const RowGroup::Rows<1>& lambda);
/// Computes `map` and `where` from the present impulses and `w`.
void find_map(MappedGroup& unit);
/// Computes E and F of a group, an element of the generalised derivative; of a contact D and s, and then `e` is the inverse of E.
void linearise(MappedGroup& unit, double epsilon);
/// A sweep of projected Gauss-Seidel over the rows and cones of a group. `change`: y, which follows the impulses.
void sweep_group(MappedGroup& unit, Eigen::VectorXd& change);

}  // namespace motley::reference
