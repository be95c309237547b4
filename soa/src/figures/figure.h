// Figures: sets of bodies connected by joints, whose copies are solved in lockstep, one copy per lane.
//
// A crowd repeats the same figure. Joint k of sixteen copies shares one block, as any sixteen constraints of one type
// and colour may, so a figure's block is only a list of ordinary blocks. In addition, its bodies are loaded into
// lanes once a step, where every joint reads them with plain loads, and all substeps run in cache. Constraints touch
// a body in the order of their colours, so the bits are those of ordinary sweeps.
//
// Contacts with bodies that cannot move, such as a floor, are solved in the same step: a block of contacts is of one
// body of the figure and one colour, again one copy per lane. Lanes of copies without such a contact are masked.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "layout/block.h"
#include "maths/equality_row.h"
#include "stores/array.h"

namespace motley {

/// A body of a block of copies in lanes: fields of sixteen consecutive floats, the fields of LaneBody first.
struct CopyBody {
    static constexpr int inverse_inertia = 14;  ///< first of six fields, part of LaneBody
    static constexpr int acceleration = 20;     ///< first of three fields, followed by three of torque
    static constexpr int start_inertia = 26;    ///< first of six fields
    static constexpr int floats = 32 * block_lanes;
};

/// A node of a figure's tree: a child body and all locks between it and its parent body, and the limits, motors and springs
/// between these two that may act. Those of all nodes are solved at once, by factoring J M^-1 J^T along the tree without fill
/// (J: their Jacobian, M: mass matrix).
struct FigureNode {
    int body;             ///< the child body
    int parent;           ///< the parent body, moving or fixed; -1 for a root that floats
    int parent_node;      ///< the parent body's node; -1 if the parent is fixed or there is none
    int point_tree = -1;  ///< of FigureShape::point_trees; -1 for a node of none
    int rows;             ///< of all its locks together, 0 to 6
    int most_rows;        ///< with those of its limits and motors, at most 6
    /// Where its arrays begin in FigureBlock::system, in floats. M' is the mass matrix of the child body and
    /// everything below it in the tree (articulated inertia).
    std::int64_t jacobian;  ///< EqualityRows; once factored, the form that kernel_tree_rows.h keeps
    std::int64_t response;  ///< M'^-1 J^T, six floats per row
    std::int64_t factor;    ///< factors of K = J M'^-1 J^T
    std::int64_t target;    ///< K^-1 times the right-hand side of the rows; one float per row
    std::int64_t change;    ///< of the child body's velocity, six
    std::int64_t mass;      ///< M': lower triangle
    std::int64_t force;     ///< on the child body, from the nodes below it, six
    std::int64_t kept;      ///< copy of the velocity while responses of closures are computed, six
    std::int64_t pull;      ///< angular impulse of stiffened locks, applied at the first solve, three
    std::int64_t place;     ///< of the body, from its tree's root: place_bodies(). Of point trees only; three
    std::int64_t taken;     ///< impulse of what has let go, applied by the next solve, six
    std::int64_t in_use;    ///< see FigureBlock::rows_of() and for_each_acting(), one
    std::int64_t acts_by;   ///< ActsBy of its limits, motors and springs, one of each
    std::int64_t give;      ///< ActingRow::give_of_all(), one per row; 0 of locks
    std::int64_t spring_give;  ///< ActingRow::give, one per row. At `give` in figures without rotors
    std::int64_t rotor;        ///< ActingRow::rotor, one per row. Of figures with rotors only
    std::int64_t given;  ///< ActingRow::given, and give times what the spring has pushed since; one per row
    std::int64_t speed;  ///< EqualityRow::speed as act() found it; one per row
    std::int64_t least, most;  ///< of ActingRow, one per row
    std::int64_t tension;  ///< lambda of the last substep times its length, N s2; one per row of the locks
    // Arrays that share memory with another one, because they are not needed at the same time:
    std::int64_t pivots;       ///< at `change`: pivots of the body's own M, six
    std::int64_t mass_factor;  ///< at `mass`, which it overwrites: factors of M'
    std::int64_t strain;       ///< at `force`: above 0 where tension may swing the body, one
    struct Lock {
        int joint;  ///< of the shape
        int first_row, rows;
        bool locks_point;  ///< its first three rows hold a point on a point, along x, y and z
        bool reversed;     ///< the child body is the joint's body a: errors and impulses change sign
    };
    Array<Lock> locks;
    /// A limit, a motor or a spring. Sweeps decide whether it acts, and then the tree finds how much it pushes.
    struct Active {
        int joint;      ///< of the shape
        bool reversed;  ///< as of a lock
        bool has_rotor;
    };
    Array<Active> actives;
    /// Whether the node has a single lock, whose first three rows hold a point on a point along x, y and z, and whose
    /// other rows, and those of limits and motors, are purely angular.
    [[nodiscard]] bool hangs_by_point() const { return locks.size() == 1 && locks.front().locks_point; }
    /// A lock that holds a point on a point; null if there is none.
    [[nodiscard]] const Lock* point_lock() const
    {
        const auto lock =
            std::find_if(locks.begin(), locks.end(), [](const Lock& l) { return l.locks_point; });
        return lock == locks.end() ? nullptr : &*lock;
    }
    /// Where the arms of the point of hangs_by_point() are, once the tree is factored: see PointRows::keep.
    [[nodiscard]] std::int64_t arm_of_child() const { return jacobian; }
    [[nodiscard]] std::int64_t arm_of_parent() const { return jacobian + std::int64_t{3} * block_lanes; }
    static constexpr int row_floats = 11 * block_lanes;  ///< of an EqualityRow
    /// Where the speed that a limit, motor or spring still has to reach is, once the tree is factored: in an EqualityRow, or
    /// where PointRows::keep puts it. `rows_in_use`: how many rows the node has now.
    [[nodiscard]] std::int64_t speed_left(int row, int rows_in_use) const
    {
        const int of_points = 6 + rows_in_use + 3 * (rows_in_use - 3) + (row - 3);
        return jacobian + (hangs_by_point() ? std::int64_t{of_points} * block_lanes
                                            : std::int64_t{row} * row_floats + 10 * block_lanes);
    }
    /// Likewise, where its error is.
    [[nodiscard]] std::int64_t error_of(int row) const
    {
        return jacobian + (hangs_by_point() ? std::int64_t{6 + row} * block_lanes
                                            : std::int64_t{row} * row_floats + 9 * block_lanes);
    }
};

/// A tree whose bodies are held together at points, and that floats or hangs from a fixed body at a point.
struct PointTree {
    int begin, end;      ///< its nodes; the last one is its root
    std::int64_t rigid;  ///< where it is as one rigid body in FigureBlock::system: kernel_rigid_trees.h
    static constexpr int floats = 15;
};

/// A lock that closes a loop of the figure. It is solved exactly too, from the tree's response to it
/// (kernel_closures.h).
struct FigureClosure {
    int joint;  ///< of the shape
    int first_row, rows;
};

/// A joint that the tree does not solve, between two bodies that the tree holds together at a point.
struct JointAtPoint {
    int joint;  ///< of the shape
    /// Where the point's lever arms on the joint's bodies begin in FigureBlock::system, once the tree is factored.
    std::int64_t arm_a, arm_b;
};

/// What the copies of a figure have in common.
struct FigureShape {
    struct Joint {
        int type;
        BodyKind kind_a, kind_b;
        std::uint8_t colour;
        int a, b;          ///< bodies of the figure
        int equalities;    ///< rows that may be solved exactly; 0 for limits, motors, springs
        bool locks_point;  ///< the first three of them hold a point on a point
        ActiveRow active_row;
        bool has_rotor;
        bool in_tree = false;
    };
    Array<BodyKind> bodies;
    Array<Joint> joints;             ///< by colour
    Array<std::uint32_t> signature;  ///< these in numbers: figures with equal ones are copies
    Array<FigureNode> nodes;         ///< children before parents; empty unless locks are solved exactly
    Array<PointTree> point_trees;
    Array<JointAtPoint> joints_at_points;
    bool has_actives = false;  ///< a node has limits, motors, springs or rotors
    bool has_rotors = false;   ///< a node has rotors
    /// In which copies something has pushed harder than it may, or pulls much harder than in the last substep: one.
    std::int64_t exceeding = 0;
    Array<FigureClosure> closures;
    int closure_rows = 0;
    std::int64_t closure_jacobian = 0, closure_factor = 0, closure_target = 0;  ///< like those of a node
    std::int64_t closure_alone =
        0;  ///< at closure_target, until factored: J M^-1 J^T of a row's two bodies alone
    std::int64_t system_floats = 0;

    [[nodiscard]] bool has_tree() const { return !nodes.empty(); }
    [[nodiscard]] bool has_joints_beside_tree() const
    {
        return std::any_of(joints.begin(), joints.end(), [](const Joint& joint) { return !joint.in_tree; });
    }
};

/// Whether a tree may leave rotors to the sweeps: those between two bodies that no lock of the tree joins, or that six rows of it
/// join already. Beside exact locks sweeps throw a light body that turns a heavier rotor.
enum class RotorsBesideTree { allowed, refused };

/// Builds the tree of all locks of a shape and the closures of its loops. Returns false and builds neither when there
/// are no locks, too many rows of closures, or refused rotors beside it.
bool build_tree(FigureShape& shape, RotorsBesideTree rotors);
/// How many locks a shape, for which build_tree() has found too many closures, may lose and still have too many, whichever
/// locks its tree took then. Below 0 when that cannot be told from the pairs of bodies that are locked to each other.
std::int64_t spare_loops_of(const FigureShape& shape);

/// A block of up to sixteen copies.
struct FigureBlock {
    const FigureShape* shape = nullptr;
    int count = 0;
    const std::int32_t* offsets =
        nullptr;              ///< offset_of, sixteen per body of the shape; in padding lanes the null row
    float* bodies = nullptr;  ///< CopyBody::floats per body
    float* system = nullptr;  ///< the arrays of the tree
    struct Joint {
        const ConstraintKernels* kernels;
        BlockStreams streams;
        std::int32_t block;
        [[nodiscard]] std::int64_t impulse_floats() const
        {
            return std::int64_t{kernels->impulse_floats} * block_lanes;
        }
        [[nodiscard]] float* impulses() const { return streams.impulses + block * impulse_floats(); }
    };
    const Joint* joints = nullptr;  ///< in the order of those of the shape
    struct Contact {
        Joint lanes;
        std::uint8_t type, colour;
        int a, b;  ///< bodies; the fixed one is counted on from those of the shape
    };
    std::span<const Contact> contacts;            ///< by colour
    const std::int32_t* fixed_offsets = nullptr;  ///< of the bodies that contacts touch, like `offsets`
    int fixed_count = 0;

    /// How many rows of a node are solved now: those of its locks, and of its limits and motors that act in any copy.
    [[nodiscard]] int rows_of(const FigureNode& node) const { return static_cast<int>(system[node.in_use]); }
    /// Calls work(limit, motor or spring, its row, its ActsBy in lanes) for each that acts in any copy.
    template <class Work>
    void for_each_acting(const FigureNode& node, const Work& work) const
    {
        float* by = system + node.acts_by;
        const float* row = system + node.in_use;
        for (const FigureNode::Active& active : node.actives) {
            if (*++row > 0) work(active, static_cast<int>(*row), by);
            by += block_lanes;
        }
    }
    [[nodiscard]] float* body(int index) const
    {
        return bodies + static_cast<std::int64_t>(index) * CopyBody::floats;
    }
};

}  // namespace motley
