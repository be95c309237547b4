// Corrects the positions of locks at the end of a substep.
//
// The rows of the beginning of a substep move bodies along tangents, so a rotation by an angle violates a lock by about
// half of the square of the angle. So positions are moved along M^-1 J^T, by Newton's method, until C is what these
// rows imply, C + h J v', with C of the beginning, the substep h and the new velocity v'. Velocities that stay the same
// while levers rotate change the angular momentum; islands that float get it back as a common spin.
#include <cmath>
#include <numeric>

#include "direct_rows.h"
#include "symmetric_modes.h"
#include "world_rows.h"

namespace motley::reference {
namespace {

/// Sums of squared errors of an island, m2 or rad2: Newton's method ends below `nearest`, and has failed above
/// `held_to`.
constexpr double nearest = 1e-26, held_to = 1e-12;

/// The angular momentum of an island about the origin, and its inertia against a common spin.
struct Spin {
    double mass = 0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< sum of m x
    Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the origin
    bool in_plane = false;

    void add(const Body& body)
    {
        const Eigen::Vector3d x = body.position, v = body.velocity.head<3>();
        mass += body.mass;
        moment += body.mass * x;
        angular_momentum += body.mass * x.cross(v);
        inertia -= body.mass * skew(x) * skew(x);
        if (body.model == BodyModel::particle) return;
        in_plane = in_plane || body.model == BodyModel::planar;
        const Eigen::Matrix3d r = body.orientation.toRotationMatrix();
        const Eigen::Matrix3d turned = r * body.inertia * r.transpose();
        angular_momentum += turned * body.velocity.tail<3>();
        inertia += turned;
    }
    /// The common spin about the centre of mass that has this angular momentum.
    [[nodiscard]] Eigen::Vector3d spin_of(const Eigen::Vector3d& wanted) const
    {
        const Eigen::Vector3d middle = moment / mass;
        const Eigen::Matrix3d about_middle = inertia + mass * skew(middle) * skew(middle);
        if (in_plane) return {0, 0, about_middle(2, 2) > 0 ? wanted.z() / about_middle(2, 2) : 0};
        return symmetric_pseudo_inverse(about_middle) * wanted;
    }
};

std::vector<Spin> spins_of(const std::vector<Body>& bodies, const std::vector<int>& island_of)
{
    std::vector<Spin> all(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (island_of[i] >= 0) all[static_cast<std::size_t>(island_of[i])].add(bodies[i]);
    }
    return all;
}

}  // namespace

World::Islands World::find_islands(const std::vector<ContactRow>& contacts) const
{
    std::vector<int> leader(bodies.size());
    std::iota(leader.begin(), leader.end(), 0);
    const auto find = [&](int i) {
        while (leader[static_cast<std::size_t>(i)] != i)
            i = leader[static_cast<std::size_t>(i)] =
                leader[static_cast<std::size_t>(leader[static_cast<std::size_t>(i)])];
        return i;
    };
    const auto for_each_pair = [&](const auto& work) {
        for (const Joint& joint : joints) work(joint.a, joint.b);
        for (const ContactRow& row : contacts) work(row.point->a, row.point->b);
    };
    for_each_pair([&](int a, int b) {
        if (moves(a) && moves(b)) leader[static_cast<std::size_t>(find(a))] = find(b);
    });
    Islands islands{std::vector<int>(bodies.size(), -1), std::vector<bool>(bodies.size(), true)};
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (moves(static_cast<int>(i))) islands.of_body[i] = find(static_cast<int>(i));
    }
    for_each_pair([&](int a, int b) {
        if (moves(a) != moves(b)) islands.floats[static_cast<std::size_t>(find(moves(a) ? a : b))] = false;
    });
    for (const Joint& joint : joints) {
        if (joint.model->acts_from_world() && moves(joint.a))
            islands.floats[static_cast<std::size_t>(find(joint.a))] = false;
    }
    return islands;
}

std::vector<World::Hold> World::find_holds(double h) const
{
    std::vector<Hold> holds;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Joint& joint = joints[i];
        if (joint.model->keeps_rows_of_start()) continue;
        const std::vector<Block> blocks = blocks_of(joint);
        for (std::size_t k = 0; k < blocks.size(); ++k) {
            const Block& block = blocks[k];
            // Springs and motors are forces, not positions; a limit is held while it has an impulse.
            const bool bears = block.kind == Block::Kind::limit && joint.impulses[k](0) != 0;
            if (block.is_spring() || !(block.kind == Block::Kind::equality || bears)) continue;
            holds.push_back(
                {i, k, block.side, block.error + h * block.side * speed(joint.a, joint.b, block.jacobian)});
        }
    }
    return holds;
}

std::vector<Eigen::Vector3d> World::angular_momenta(const Islands& islands) const
{
    const std::vector<Spin> spins = spins_of(bodies, islands.of_body);
    std::vector<Eigen::Vector3d> all;
    all.reserve(spins.size());
    for (const Spin& spin : spins) all.push_back(spin.angular_momentum);
    return all;
}

void World::give_back(const Islands& islands, const std::vector<bool>& held,
                      const std::vector<Eigen::Vector3d>& lost)
{
    const std::vector<Spin> spins = spins_of(bodies, islands.of_body);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (islands.of_body[i] < 0) continue;
        const auto island = static_cast<std::size_t>(islands.of_body[i]);
        if (!islands.floats[island] || !held[island] || lost[island].isZero()) continue;
        const Eigen::Vector3d spin = spins[island].spin_of(lost[island]);
        Body& body = bodies[i];
        body.velocity.head<3>() += spin.cross(body.position - spins[island].moment / spins[island].mass);
        if (body.model != BodyModel::particle) body.velocity.tail<3>() += spin;
    }
}

std::vector<bool> World::hold_locks(const std::vector<Hold>& holds, const Islands& islands, double h,
                                    bool stiff)
{
    const auto island_of = [&](const Hold& hold) {
        const Joint& joint = joints[hold.joint];
        const int island = islands.of_body[static_cast<std::size_t>(joint.a)];
        return island >= 0 ? island : islands.of_body[static_cast<std::size_t>(joint.b)];
    };
    // Each island goes on while its error decreases, and returns to the poses with its least error.
    std::vector<Body> best = bodies;
    std::vector<double> least(bodies.size(), unbounded);
    std::vector<bool> goes_on(bodies.size(), true);
    for (int round = 0; round < 12; ++round) {
        std::vector<double> squares(bodies.size(), 0);
        struct Left {
            const Hold* hold;
            Block block;
            Eigen::VectorXd error;
        };
        std::vector<Left> all;
        for (const Hold& hold : holds) {
            const int island = island_of(hold);
            if (island < 0 || !goes_on[static_cast<std::size_t>(island)]) continue;
            Block block = blocks_of(joints[hold.joint])[hold.block];
            if (block.side != hold.side ||
                (block.kind == Block::Kind::limit && block.error(0) > hold.target(0)))
                continue;
            const Eigen::VectorXd error = block.error - hold.target;
            squares[static_cast<std::size_t>(island)] += error.squaredNorm();
            all.push_back({&hold, std::move(block), error});
        }
        bool any = false;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            if (islands.of_body[i] < 0) continue;
            const auto island = static_cast<std::size_t>(islands.of_body[i]);
            if (goes_on[island] && squares[island] < least[island]) best[i] = bodies[i];
        }
        for (std::size_t island = 0; island < bodies.size(); ++island) {
            if (!goes_on[island]) continue;
            goes_on[island] = squares[island] < least[island] && squares[island] > nearest;
            least[island] = std::fmin(least[island], squares[island]);
            any = any || goes_on[island];
        }
        if (!any) break;
        Assembly assembly(bodies);
        for (const Left& left : all) {
            if (!goes_on[static_cast<std::size_t>(island_of(*left.hold))]) continue;
            const Joint& joint = joints[left.hold->joint];
            const Eigen::Index rows = left.error.size();
            assembly.fill(assembly.open(joint.a, joint.b, rows), 0, left.block.jacobian,
                          left.block.side * left.error, -unbounded, unbounded, Eigen::VectorXd::Zero(rows));
        }
        // Nearly straight taut light links must not buckle to meet the targets: joints under load keep their stiffness.
        if (stiff) stiffen(assembly, find_stiff_rows(islands, h), false);
        const Solution solution = assembly.solve();
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            if (islands.of_body[i] >= 0 && goes_on[static_cast<std::size_t>(islands.of_body[i])])
                bodies[i].advance(assembly.change(solution, i), 1);
        }
    }
    std::vector<bool> held(bodies.size());
    for (std::size_t island = 0; island < bodies.size(); ++island) held[island] = least[island] < held_to;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (islands.of_body[i] >= 0) bodies[i] = best[i];
    }
    return held;
}

}  // namespace motley::reference
