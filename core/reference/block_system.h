// A sparse system of 6 x 6 blocks: factored once, solved often.
#pragma once

#include <Eigen/Dense>
#include <utility>
#include <vector>

namespace motley::reference {

/// LU of a matrix whose blocks lie symmetrically, its nodes eliminated in the order of least degree (Tinney and Walker
/// 1967). Pivots are chosen inside of a diagonal block, not among blocks.
class BlockSystem {
  public:
    using Block = Eigen::Matrix<double, 6, 6>;

    /// Lays out the blocks: the diagonal, those of the pairs and what elimination fills in. Pairs may repeat. The nodes from
    /// `first_waiting` on have a diagonal that may be singular until one of their neighbours is eliminated, and wait for that.
    void lay_out(int nodes, int first_waiting, const std::vector<std::pair<int, int>>& pairs);
    /// Makes the matrix the identity.
    void reset();
    /// The block of row `a` and column `b`; one of the layout, before factor().
    Block& at(int a, int b);
    /// False where a diagonal block has become singular.
    bool factor();
    /// Solves in place; `x` has six numbers a node.
    void solve(Eigen::VectorXd& x) const;

  private:
    /// Two blocks beside the diagonal: in `lower_` the one of the column of the node eliminated first, in `upper_` that of its row.
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
