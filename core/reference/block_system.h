// A sparse system of 6 x 6 blocks: factored once, solved often.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace motley::reference {

/// LU factorisation of a matrix with a symmetric pattern of blocks. Nodes are eliminated in the order of minimum degree
/// (Tinney and Walker 1967). Pivots are chosen within a diagonal block, not among blocks.
class BlockSystem {
  public:
    using Block = Eigen::Matrix<double, 6, 6>;

    /// Lays out the blocks: the diagonal, those of the pairs, and those that elimination fills in. Pairs may repeat.
    /// The diagonal blocks of nodes from `first_waiting` on may be singular until a neighbour is eliminated, so these
    /// nodes are not eliminated before that.
    void lay_out(int nodes, int first_waiting, const std::vector<std::pair<int, int>>& pairs);
    /// Makes the matrix the identity.
    void reset();
    /// The block of row `a` and column `b`, which must be in the layout. To be written before factor().
    Block& at(int a, int b);
    /// False where a diagonal block has become singular.
    bool factor();
    /// Solves in place; `x` has six numbers a node.
    void solve(Eigen::VectorXd& x) const;

  private:
    /// The two blocks of a pair: in `lower_` the one in the column of the node that is eliminated first, in `upper_`
    /// the one in its row.
    struct Beside {
        int node;  ///< the one eliminated later
        int block;
    };
    std::vector<int> order_, place_;
    std::vector<std::vector<Beside>> beside_;  ///< of each node, those eliminated after it, sorted by node
    std::vector<Block, Eigen::aligned_allocator<Block>> diagonal_, lower_, upper_;

    [[nodiscard]] int block_of(int first, int later) const;
};

}  // namespace motley::reference
