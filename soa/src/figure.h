// Figures: bodies tied together by joints, and copies of them solved in lockstep, a copy a lane.
//
// A crowd repeats the same figure. Joints k of sixteen copies share one block as any sixteen constraints of one type and
// colour may, so a figure's block is nothing but a list of ordinary blocks. What it adds is where the bodies are: taken
// into lanes once a step, where every joint finds them with plain loads, while all substeps run in cache. The order of
// what touches a body is that of the colours, so the bits are those of ordinary sweeps.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "block.h"

namespace motley {

/// A body of a block of copies in lanes: fields of sixteen floats in line, the fields of LaneBody first.
struct CopyBody {
    static constexpr int inverse_inertia = 14;  ///< field, six: of LaneBody
    static constexpr int acceleration = 20;     ///< field, three; and three of torque
    static constexpr int start_inertia = 26;    ///< field, six
    static constexpr int floats = 32 * block_lanes;
};

/// The locks between a body and what it hangs on, all of them solved at once with those of the other bodies: a node of
/// the tree over which J M^-1 J^T is factored without fill.
struct FigureNode {
    int body;         ///< that hangs
    int parent;       ///< body that it hangs on, moving or fixed; -1 for a root that floats
    int parent_node;  ///< that body's node; -1 where it is fixed or none
    int rows;         ///< of all its locks together, 0 to 6
    /// Where its numbers begin in FigureBlock::system, floats.
    std::int64_t jacobian;  ///< EqualityRows; once factored, what kernel_tree_rows.h keeps of them
    std::int64_t response;  ///< M'^-1 J^T, six floats a row
    std::int64_t factor;    ///< of K = J M'^-1 J^T
    std::int64_t target;    ///< K^-1 of what the rows lack; a float a row
    std::int64_t change;    ///< of the body's velocity, six
    std::int64_t mass;      ///< M', of the body and all that hangs on it: lower triangle
    std::int64_t force;     ///< on the body, of what hangs on it, six
    std::int64_t kept;      ///< the body's velocity while responses are tried, six
    std::int64_t pull;      ///< what stiffened locks take from its spin at the first solve, three
    // What is done with once the node is factored, and lies where something else will lie then:
    std::int64_t tension;  ///< at `target`: lambda of the last substep times its length, N s2; a float a row
    std::int64_t pivots;   ///< at `change`: of M, six
    std::int64_t mass_factor;  ///< at `mass`, which it takes the place of: of M'
    struct Lock {
        int joint;  ///< of the shape
        int first_row, rows;
        bool locks_point;  ///< its first three rows are a point's, along x, y and z
        bool reversed;     ///< the hanging body is the joint's body a: errors and impulses change sign
    };
    std::vector<Lock> locks;
    /// By one lock, whose first three rows are a point's, along x, y and z; the others only turn.
    [[nodiscard]] bool hangs_by_point() const { return locks.size() == 1 && locks.front().locks_point; }
    static constexpr int row_floats = 10 * block_lanes;  ///< of an EqualityRow
};

/// A lock that closes a loop: solved exactly as well, by what the tree answers to it.
struct FigureClosure {
    int joint;  ///< of the shape
    int first_row, rows;
};

/// What copies have in common.
struct FigureShape {
    struct Joint {
        int type;
        BodyKind kind_a, kind_b;
        std::uint8_t colour;
        int a, b;          ///< bodies of the figure
        int equalities;    ///< rows that may be solved exactly; 0 for limits, motors, springs
        bool locks_point;  ///< the first three of them are a point's
        bool in_tree = false;
    };
    std::vector<BodyKind> bodies;
    std::vector<Joint> joints;  ///< by colour
    std::vector<FigureNode>
        nodes;  ///< what hangs before what it hangs on; empty unless locks are solved exactly
    std::vector<FigureClosure> closures;
    int closure_rows = 0;
    std::int64_t closure_jacobian = 0, closure_factor = 0, closure_target = 0;  ///< as those of a node
    std::int64_t closure_alone =
        0;  ///< at closure_target, until it is factored: J M^-1 J^T of a row's two bodies alone
    std::int64_t system_floats = 0;

    [[nodiscard]] bool has_tree() const { return !nodes.empty(); }
    [[nodiscard]] bool has_joints_beside_tree() const
    {
        return std::any_of(joints.begin(), joints.end(), [](const Joint& joint) { return !joint.in_tree; });
    }
};

/// Makes the tree of all locks of a shape, and the closures of its loops. False, and neither, when the loops are too many.
bool build_tree(FigureShape& shape);

/// Up to sixteen copies.
struct FigureBlock {
    const FigureShape* shape = nullptr;
    int count = 0;
    const std::int32_t* offsets =
        nullptr;              ///< offset_of sixteen a body of the shape; of padding lanes the null row
    float* bodies = nullptr;  ///< CopyBody::floats a body
    float* system = nullptr;  ///< of the tree
    struct Joint {
        const ConstraintKernels* kernels;
        BlockStreams streams;
        std::int32_t block;
    };
    const Joint* joints = nullptr;  ///< as those of the shape

    [[nodiscard]] float* body(int index) const
    {
        return bodies + static_cast<std::int64_t>(index) * CopyBody::floats;
    }
};

}  // namespace motley
