// The step of the reference, written to be read rather than to be fast.
#include <algorithm>
#include <cmath>

#include "as_eigen.h"
#include "world_rows.h"

namespace motley::reference {

World::Soft World::softness(double hertz, double damping_ratio, double h)
{
    const double omega = 2 * EIGEN_PI * std::min(hertz, 0.25 / h);
    const double a1 = 2 * damping_ratio + h * omega, a2 = h * omega * a1, a3 = 1 / (1 + a2);
    return {omega / a1, a2 * a3, a3};
}

bool World::is_planar_pair(int a, int b) const
{
    const auto flat = [&](int i) {
        return moves(i) && bodies[static_cast<std::size_t>(i)].model == BodyModel::planar;
    };
    return (flat(a) && (flat(b) || !moves(b))) || (!moves(a) && flat(b));
}

void World::apply(int a, int b, const Jacobian& jacobian, const Eigen::VectorXd& impulse)
{
    Body& body_a = bodies[static_cast<std::size_t>(a)];
    Body& body_b = bodies[static_cast<std::size_t>(b)];
    const Eigen::Matrix<double, 12, 1> change =
        pair_inverse_mass(body_a, body_b) * (jacobian.transpose() * impulse);
    body_a.velocity += change.head<6>();
    body_b.velocity += change.tail<6>();
}

void World::apply(Joint& joint, const Jacobian& jacobian, const Eigen::VectorXd& impulse)
{
    apply(joint.a, joint.b, jacobian, impulse);
    joint.wrench += wrench_of(jacobian, impulse);
}

/// Adds up the impulses of contacts after a substep. Those of joints are added when they are applied, because their
/// rows change from substep to substep.
void World::add_up(std::vector<ContactRow>& contacts)
{
    for (ContactRow& row : contacts) {
        row.step.normal += row.impulse;
        row.step.friction += row.force();
    }
}

Eigen::VectorXd World::speed(int a, int b, const Jacobian& jacobian) const
{
    Eigen::Matrix<double, 12, 1> v;
    v << bodies[static_cast<std::size_t>(a)].velocity, bodies[static_cast<std::size_t>(b)].velocity;
    return jacobian * v;
}

/// Notes poses and the speeds along the blocks of joints when a step begins.
void World::begin_step()
{
    for (Body& body : bodies) {
        body.has_joints = false;
        body.rows_made_at.reset();
        body.inertia_kept_at.reset();
    }
    start_ = bodies;
    for (Joint& joint : joints) {
        for (const int end : {joint.a, joint.b}) {
            Body& body = bodies[static_cast<std::size_t>(end)];
            body.has_joints = true;
            if (joint.model->keeps_rows_of_start()) body.rows_made_at = body.orientation;
        }
        joint.wrench.setZero();
        joint.approaches.clear();
        const bool recalls = joint.impulses.empty() && !joint.memory.empty();
        for (const Block& block : blocks_of(joint)) {
            joint.approaches.push_back(speed(joint.a, joint.b, block.jacobian)(0));
            if (block.armature > 0) joint.rotor_speed = joint.approaches.back() - joint.rotor_lag;
            if (recalls) joint.impulses.emplace_back(Eigen::VectorXd::Zero(block.error.size()));
        }
        if (recalls) joint.model->recall(joint.memory, joint.impulses);
        joint.peaks.assign(joint.approaches.size(), 0);
    }
}

Eigen::Matrix<double, 12, 1> World::moved_since_start(int a, int b) const
{
    Eigen::Matrix<double, 12, 1> moved;
    const int ends[2] = {a, b};
    for (int end = 0; end < 2; ++end) {
        const Body& now = bodies[static_cast<std::size_t>(ends[end])];
        const Body& then = start_[static_cast<std::size_t>(ends[end])];
        Eigen::Quaterniond turn = now.orientation * then.orientation.conjugate();
        if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
        Eigen::Vector3d angle = 2 * turn.vec();
        // The rotation of a planar body is known exactly: the angle, not its sine.
        if (now.motion == BodyMotion::dynamic_body && now.model == BodyModel::planar) {
            angle = {0, 0, 2 * std::atan2(turn.z(), turn.w())};
        }
        moved.segment<3>(6 * end) = now.position - then.position;
        moved.segment<3>(6 * end + 3) = angle;
    }
    return moved;
}

void World::step(double dt, const SolverSettings& asked, const std::vector<ContactPoint>& points)
{
    const SolverSettings settings = asked.resolved();
    const double h = dt / settings.substeps;
    const double warm = settings.warm_start && last_substep_ > 0 ? std::min(1.0, h / last_substep_) : 0;
    const bool soft_step = settings.method == Method::soft_step;
    begin_step();
    for (Joint& joint : joints) {
        for (Eigen::VectorXd& impulse : joint.impulses) impulse *= warm;
        joint.rotor_change *= warm;
    }
    std::vector<ContactRow> contacts;
    for (const ContactPoint& point : points) contacts.push_back(begin_contact(point, h, warm));

    for (int substep = 0; substep < settings.substeps; ++substep) {
        for (Body& body : bodies) body.accelerate(eigen(settings.gravity), h);
        std::vector<BlockRow> rows;
        for (Joint& joint : joints) begin_joint(joint, h, settings, rows);
        for (ContactRow& row : contacts) {
            apply(row.point->a, row.point->b, row.normal, Eigen::VectorXd::Constant(1, row.impulse));
            apply(row.point->a, row.point->b, row.tangents, row.friction);
        }
        for (int i = 0; i < settings.iterations; ++i) {
            solve_blocks(rows, h, settings, false);
            for (ContactRow& row : contacts) solve_contact(row, h, settings, false);
        }
        for (Body& body : bodies) body.move_on(h, true);
        if (!soft_step && settings.drift_correction == DriftCorrection::projection) {
            for (int i = 0; i < settings.projections; ++i) project(contacts, h, settings);
        }
        for (int i = 0; soft_step && i < settings.relaxations; ++i) {
            solve_blocks(rows, h, settings, true);
            for (ContactRow& row : contacts) solve_contact(row, h, settings, true);
        }
        add_up(contacts);
    }
    finish_contacts(contacts, settings);
    end_step(h);
    land_free_groups(h, dt, settings);
}

/// The acceleration of a body by forces and gravity alone.
Vector6 World::free_acceleration(int i, const SolverSettings& settings) const
{
    Body body = bodies[static_cast<std::size_t>(i)];
    if (body.motion != BodyMotion::dynamic_body) return Vector6::Zero();
    body.velocity.setZero();
    body.linear_damping = body.angular_damping = 0;
    body.accelerate(eigen(settings.gravity), 1);
    return body.velocity;
}

/// Restitution: the speed at which a contact that is `now` m apart must open, from the energy of the flight before and
/// after the impact: free flight conserves v^2 / 2 - a x. See restitution.h.
double World::opening_speed(int a, int b, const Jacobian& normal, double approach, double now,
                            double restitution, const SolverSettings& settings) const
{
    const double along = normal.middleCols<3>(6).row(0) *
                         (free_acceleration(b, settings) - free_acceleration(a, settings)).head<3>();
    const double start = now - (normal * moved_since_start(a, b))(0), impact = std::min(start, 0.0);
    const double of_impact = std::max(approach * approach + 2 * along * (impact - start), 0.0);
    const double of_leaving = restitution * restitution * of_impact + 2 * along * (now - impact);
    return std::sqrt(std::max(of_leaving, 0.0));
}

/// Corrects free flight: v += h a, x += h v moves the centre of mass of a group of jointed bodies whose momentum only
/// forces, and no damping, have changed in the step by a h dt / 2 too far. Rotations are not corrected, except that of a single planar
/// body, which is integrated like a position.
void World::land_free_groups(double h, double dt, const SolverSettings& settings)
{
    const std::vector<int> group_of = find_islands({}).of_body;
    struct Group {
        double mass = 0;
        Eigen::Vector3d force = Eigen::Vector3d::Zero(), change = Eigen::Vector3d::Zero();  // of momentum
        bool has_joints = false, is_held = false, in_plane = false, is_damped = false;
    };
    std::vector<Group> groups(bodies.size());
    for (const Joint& joint : joints) {
        const int of = group_of[static_cast<std::size_t>(moves(joint.a) ? joint.a : joint.b)];
        if (of < 0) continue;
        Group& group = groups[static_cast<std::size_t>(of)];
        group.has_joints = true;
        if ((moves(joint.a) && moves(joint.b)) || joint.model->acts_from_world()) continue;
        for (const Block& block : blocks_of(joint)) {
            const bool is_lock = block.kind == Block::Kind::equality && !block.is_spring();
            group.is_held = group.is_held || (is_lock && !block.jacobian.middleCols<3>(6).isZero(0));
        }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (group_of[i] < 0) continue;
        Group& group = groups[static_cast<std::size_t>(group_of[i])];
        group.mass += bodies[i].mass;
        group.force += bodies[i].mass * free_acceleration(static_cast<int>(i), settings).head<3>();
        group.change += bodies[i].mass * (bodies[i].velocity - start_[i].velocity).head<3>();
        const bool in_plane = bodies[i].model == BodyModel::planar;
        group.in_plane = group.in_plane || in_plane;
        group.is_damped =
            group.is_damped || bodies[i].linear_damping > 0 || (in_plane && bodies[i].angular_damping > 0);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (group_of[i] < 0) continue;
        const Group& group = groups[static_cast<std::size_t>(group_of[i])];
        const Eigen::Vector3d in_space(1, 1, group.in_plane ? 0 : 1);
        const Eigen::Vector3d force = in_space.cwiseProduct(group.force),
                              change = in_space.cwiseProduct(group.change);
        // Impulses perpendicular to the force do not change how far it moves the group.
        const double by_force = dt * force.squaredNorm();
        if (group.is_held || group.is_damped || !(std::abs(change.dot(force) - by_force) < 1e-3 * by_force))
            continue;
        Vector6 back = Vector6::Zero();
        back.head<3>() = force / group.mass;
        if (group.in_plane && !group.has_joints)
            back(5) = free_acceleration(static_cast<int>(i), settings)(5);
        bodies[i].advance(back, -h * dt / 2);
    }
}

void World::end_step(double h)
{
    for (Joint& joint : joints) {
        const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
        for (const Block& block : blocks_of(joint)) {
            if (block.armature > 0)
                joint.rotor_lag = speed(joint.a, joint.b, block.jacobian)(0) - joint.rotor_speed;
        }
        joint.travelled += joint.model->travel(start_[a], start_[b], bodies[a], bodies[b]);
    }
    last_substep_ = h;
}

}  // namespace motley::reference
