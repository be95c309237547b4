// Stability of light bodies that bear heavy loads.
//
// A substep h that applies the joint forces f of its beginning throughout swings light taut links of mass M wider each
// time, once h^2 K exceeds about 4 M with the geometric stiffness K = -d(J^T f)/dx, however exactly it holds the
// joints. So the velocity v' at the end of the substep is solved with the forces in the poses of its end,
// (M + h^2 K) v' = M v + ... (M. Tournier and others, Stable Constrained Dynamics, 2015; S. Andrews and others,
// Geometric Stiffness for Real-time Constrained Multibody Dynamics, 2017.)
//
// K is symmetric except for a part that the constraint's own forces make up for, and is used by its eigenvectors over
// scaled velocities: each one whose eigenvalue is above what an explicit substep follows anyway becomes a soft row with
// one impulse. When everything rotates as a whole, so do the forces, and there must be no resistance. So the rows see
// velocities relative to a common spin, an artificial body with nearly no inertia: it takes nearly no angular momentum,
// and rotation as a whole is not slowed down.
#include "direct_rows.h"
#include "symmetric_modes.h"
#include "world_rows.h"

namespace motley::reference {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;
using Eigen::Index;

/// The h^2 K / M of each joint that is left to the explicit substep.
constexpr double bearable = 0.25;
/// Inertia of a common spin as a share of the stiffness of its rows. A smaller one would be lost in rounding. The
/// angular momentum that it takes from islands that float is given back (hold_locks.cpp).
constexpr double lightness = 1e-4;

}  // namespace

/// -h d(J^T lambda)/dx of a joint over the velocities of its bodies, symmetrised.
World::PairMatrix World::stiffness_of(const Joint& joint, double h) const
{
    const bool in_plane = is_planar_pair(joint.a, joint.b);
    const auto pushes = [&](const Body& a, const Body& b) {
        const double travelled =
            joint.travelled + joint.model->travel(start_[static_cast<std::size_t>(joint.a)],
                                                  start_[static_cast<std::size_t>(joint.b)], a, b);
        const std::vector<Block> blocks = joint.model->blocks(a, b, in_plane, travelled);
        Vector12 sum = Vector12::Zero();
        for (std::size_t i = 0; i < blocks.size(); ++i)
            sum += blocks[i].jacobian.transpose() * joint.impulses[i];
        return sum;
    };
    const Body here[2] = {bodies[static_cast<std::size_t>(joint.a)],
                          bodies[static_cast<std::size_t>(joint.b)]};
    PairMatrix stiffness = PairMatrix::Zero();
    const Vector12 now = pushes(here[0], here[1]);
    if (now.isZero()) return stiffness;
    constexpr double small = 1e-6;  // m or rad: half of the digits of a double are left
    for (Index k = 0; k < 12; ++k) {
        if (here[k / 6].motion != BodyMotion::dynamic_body) continue;
        Body moved[2] = {here[0], here[1]};
        moved[k / 6].advance(Vector6::Unit(k % 6), small);
        stiffness.col(k) = -h / small * (pushes(moved[0], moved[1]) - now);
    }
    return 0.5 * (stiffness + stiffness.transpose());
}

std::vector<World::StiffRow> World::find_stiff_rows(const Islands& islands, double h) const
{
    std::vector<StiffRow> rows;
    for (const Joint& joint : joints) {
        if (joint.model->keeps_rows_of_start() || joint.impulses.empty()) continue;
        const Body* const here[2] = {&bodies[static_cast<std::size_t>(joint.a)],
                                     &bodies[static_cast<std::size_t>(joint.b)]};
        const PairMatrix stiffness = stiffness_of(joint, h);
        if (stiffness.isZero(0) || !stiffness.allFinite()) continue;
        // v = S y for both bodies.
        PairMatrix scale = PairMatrix::Zero();
        for (Index end = 0; end < 2; ++end) {
            const Scale of_body(*here[end]);
            scale.block<3, 3>(6 * end, 6 * end) = of_body.linear.asDiagonal();
            scale.block<3, 3>(6 * end + 3, 6 * end + 3) = of_body.angular;
        }
        const PairMatrix half_scaled = stiffness.lazyProduct(scale);
        const PairMatrix scaled = scale.transpose().lazyProduct(half_scaled);
        if (scaled.cwiseAbs().rowwise().sum().maxCoeff() < bearable) continue;
        const SymmetricModes<PairMatrix> modes(scaled);
        for (Index mode = 0; mode < 12; ++mode) {
            const double stiff = modes.values(mode);
            if (!(stiff > bearable)) continue;
            const bool moves_a = here[0]->motion == BodyMotion::dynamic_body;
            const Vector12 row = stiffness * (scale * modes.vectors.col(mode)) / stiff;
            // Speed along the row for a common spin about the centre of a, or of b where a is fixed.
            const Eigen::Vector3d centre = here[moves_a ? 0 : 1]->position;
            Eigen::Vector3d turn = Eigen::Vector3d::Zero();
            for (Index end = 0; end < 2; ++end) {
                if (here[end]->motion != BodyMotion::dynamic_body) continue;
                const Eigen::Vector3d from = here[end]->position - centre;
                turn += from.cross(row.segment<3>(6 * end)) + row.segment<3>(6 * end + 3);
            }
            rows.push_back({joint.a, joint.b,
                            islands.of_body[static_cast<std::size_t>(moves_a ? joint.a : joint.b)],
                            stiff - bearable, row.transpose(), turn});
        }
    }
    return rows;
}

void World::stiffen(Assembly& assembly, const std::vector<StiffRow>& rows, bool sees_velocities) const
{
    std::vector<double> inertia(bodies.size(), 0);  // of a common spin, by island
    for (const StiffRow& row : rows)
        inertia[static_cast<std::size_t>(row.island)] += lightness * row.stiffness * row.turn.squaredNorm();
    std::vector<int> spins(bodies.size(), -1);
    for (const StiffRow& row : rows) {
        const auto island = static_cast<std::size_t>(row.island);
        const std::size_t at = assembly.open(row.a, row.b, 1);
        const Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
        assembly.fill(at, 0, row.jacobian, sees_velocities ? speed(row.a, row.b, row.jacobian) : none,
                      -unbounded, unbounded, none);
        RowGroup& group = assembly.group(at);
        group.softness.setConstant(1, 1, 1 / row.stiffness);
        if (inertia[island] == 0) continue;
        if (spins[island] < 0) spins[island] = assembly.add_spin(inertia[island]);
        group.bodies[2] = spins[island];
        group.jacobian[2].setZero(1, 6);
        group.jacobian[2].rightCols<3>() =
            -row.turn.transpose() * assembly.scale(static_cast<std::size_t>(spins[island])).angular;
    }
}

}  // namespace motley::reference
