// The step of the reference, written to be read rather than to be fast.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "as_eigen.h"
#include "world_rows.h"

namespace motley::reference {
namespace {

/// A bounded impulse after a step that would lead to `free`. Where that is too long, the step has the same stride in
/// every direction of the force and is then shortened: it converges only where the force points against the speed that
/// remains (see bounded_impulse.h). `to_force` maps impulses to what is bounded, whose response is k; `most` is at
/// least k's largest eigenvalue.
Eigen::VectorXd bounded(const Eigen::VectorXd& held, const Eigen::VectorXd& free,
                        const Eigen::MatrixXd& to_force, const Eigen::MatrixXd& k, double most, double bound)
{
    if ((to_force * free).norm() <= bound) return free;
    Eigen::VectorXd next = held;
    if (most > 0) {
        const Eigen::VectorXd stride = k * (to_force * (free - held)) / most;
        next += to_force.completeOrthogonalDecomposition().pseudoInverse() * stride;
    }
    const double size = (to_force * next).norm();
    if (size > bound) next *= bound / size;
    return next;
}

std::size_t contacts_of(const std::vector<Block>& blocks)
{
    return static_cast<std::size_t>(std::count_if(
        blocks.begin(), blocks.end(), [](const Block& b) { return b.kind == Block::Kind::contact; }));
}

}  // namespace

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
        pair_inverse_mass(body_a, body_b) * jacobian.transpose() * impulse;
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

std::vector<Block> World::blocks_of(const Joint& joint) const
{
    const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
    const bool in_plane = is_planar_pair(joint.a, joint.b);
    if (!joint.model->keeps_rows_of_start()) {
        const double travelled =
            joint.travelled + joint.model->travel(start_[a], start_[b], bodies[a], bodies[b]);
        return joint.model->blocks(bodies[a], bodies[b], in_plane, travelled);
    }
    std::vector<Block> blocks = joint.model->blocks(start_[a], start_[b], in_plane, joint.travelled);
    for (Block& block : blocks) {
        if (block.kind == Block::Kind::contact)
            block.error += block.jacobian * moved_since_start(joint.a, joint.b);
    }
    return blocks;
}

Eigen::MatrixXd World::mass_of(const Joint& joint, const Block& block) const
{
    const std::vector<Body>& then = joint.model->keeps_rows_of_start() ? start_ : bodies;
    return effective_mass(block.jacobian, then[static_cast<std::size_t>(joint.a)],
                          then[static_cast<std::size_t>(joint.b)]);
}

void World::find_rows(Joint& joint, double h, const SolverSettings& settings,
                      std::vector<BlockRow>& rows) const
{
    std::vector<Block> blocks = blocks_of(joint);
    joint.impulses.resize(blocks.size());
    const std::size_t contacts = contacts_of(blocks);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const double most = h * blocks[i].most;
        BlockRow row{&joint, i, std::move(blocks[i]), {}, {}, {}, {}, {}, {}, {}, most, contacts};
        const Eigen::VectorXd& error = row.block.error;
        aim(row, error, h, settings);
        if (row.impulse().size() != error.size()) row.impulse() = 0 * error;
        rows.push_back(std::move(row));
    }
}

void World::begin_joint(Joint& joint, double h, const SolverSettings& settings, std::vector<BlockRow>& rows)
{
    const std::size_t first = rows.size();
    find_rows(joint, h, settings, rows);
    const std::vector<Body>& then = joint.model->keeps_rows_of_start() ? start_ : bodies;
    const Eigen::Matrix<double, 12, 12> inverse_mass =
        pair_inverse_mass(then[static_cast<std::size_t>(joint.a)], then[static_cast<std::size_t>(joint.b)]);
    for (std::size_t i = first; i < rows.size(); ++i) {
        BlockRow& row = rows[i];
        const Block& block = row.block;
        row.mass = mass_of(joint, block);
        if (block.armature > 0) row.mass(0, 0) += block.armature;
        row.to_force = to_force_of(block);
        if (block.bounds_torque) {
            row.response = inverse_mass.block<3, 3>(3, 3) + inverse_mass.block<3, 3>(9, 9);
        } else {
            row.response = block.jacobian * inverse_mass * block.jacobian.transpose();
            if (block.armature > 0) row.response(0, 0) = 1 / row.mass(0, 0);
        }
        apply(joint, block.jacobian, row.impulse());
        // The rotor begins with the change that it had in the last substep, and the bodies with what they gave for it.
        if (block.armature > 0 && i == first) {
            apply(joint, block.jacobian, Eigen::VectorXd::Constant(1, -block.armature * joint.rotor_change));
            joint.rotor_start = joint.rotor_speed;
            joint.rotor_speed += joint.rotor_change;
        }
    }
}

/// Softness and bias of a block with this error, for sweeps and for relaxation.
void World::aim(BlockRow& row, const Eigen::VectorXd& error, double h, const SolverSettings& settings) const
{
    const Block& block = row.block;
    const bool contact = block.kind == Block::Kind::contact;
    const bool soft_step = settings.method == Method::soft_step;
    const double beta =
        settings.drift_correction == DriftCorrection::baumgarte ? static_cast<double>(settings.baumgarte) : 0;
    const Soft rigid{0, 1, 0};
    row.relax_soft = rigid;
    if (block.kind == Block::Kind::motor) {
        row.soft = rigid;
    } else if (block.stiffness > 0 || block.damping > 0) {
        // lambda = -h (k (C + h v) + c v), solved for v with v = v_free + K lambda.
        const double resistance = block.damping + h * block.stiffness, give = 1 / (h * resistance);
        const double mass = mass_of(*row.joint, block)(0, 0) + block.armature, k = mass > 0 ? 1 / mass : 0;
        row.soft = row.relax_soft = {block.stiffness / resistance, k / (k + give), give / (k + give)};
    } else if (block.hertz > 0) {
        row.soft = row.relax_soft = softness(block.hertz, block.damping_ratio, h);
    } else if (contact) {
        row.soft = contact_softness(row.joint->a, row.joint->b, h, settings);
    } else {
        row.soft = soft_step ? softness(std::min(static_cast<double>(settings.joint_hertz), stiffest(h)),
                                        settings.joint_damping_ratio, h)
                             : Soft{beta / h, 1, 0};
    }
    row.bias = row.soft.rate * error;
    row.relax_bias = row.relax_soft.rate * error;
    if (block.is_one_sided()) {
        const double slop = contact && !soft_step ? static_cast<double>(settings.penetration_slop) : 0;
        if (error(0) > 0) {  // room: it may close by that much within the substep
            row.soft = rigid;
            row.bias = row.relax_bias = error / h;
        } else {
            row.bias(0) = row.soft.rate * std::min(error(0) + slop, 0.0);
        }
    }
    if (block.speed.size() > 0) {
        row.bias -= block.speed;
        row.relax_bias -= block.speed;
    }
}

void World::solve_block(BlockRow& row, double h, const SolverSettings& settings, bool relax)
{
    Joint& joint = *row.joint;
    // The separation of contacts is computed anew, because positions may have moved since.
    if (row.block.kind == Block::Kind::contact) aim(row, blocks_of(joint)[row.index].error, h, settings);
    const Soft& soft = relax ? row.relax_soft : row.soft;
    const Eigen::VectorXd& bias = relax ? row.relax_bias : row.bias;
    const Eigen::VectorXd held = row.impulse();
    const double side = row.block.side;
    // A rotor that is geared to the row takes its share of an impulse along it, and of what others changed of its
    // speed.
    const double rotor = row.block.armature, to_bodies = rotor > 0 ? 1 - rotor / row.mass(0, 0) : 1;
    if (rotor > 0) {
        const Eigen::VectorXd excess =
            speed(joint.a, joint.b, row.block.jacobian).array() - joint.rotor_speed;
        apply(joint, row.block.jacobian, -rotor * to_bodies * excess);
    }
    Eigen::VectorXd wanted =
        held - soft.mass_scale * row.mass * (speed(joint.a, joint.b, row.block.jacobian) + side * bias) -
        soft.impulse_scale * held;
    if (row.block.is_one_sided()) {
        const double there = row.mass(0, 0) * side * speed(joint.a, joint.b, row.block.jacobian)(0);
        const double most =
            side * held(0) - there + row.mass(0, 0) * static_cast<double>(settings.push_out_speed);
        wanted(0) = side * std::clamp(side * wanted(0), 0.0, std::max(most, 0.0));
    }
    if (std::isfinite(row.bound())) {
        wanted = bounded(held, wanted, row.to_force, row.response,
                         row.response.cwiseAbs().rowwise().sum().maxCoeff(), row.bound());
    }
    apply(joint, row.block.jacobian, to_bodies * (wanted - held));
    if (rotor > 0) {
        joint.rotor_speed = speed(joint.a, joint.b, row.block.jacobian)(0);
        joint.rotor_change = joint.rotor_speed - joint.rotor_start;
    }
    row.impulse() = wanted;
    double& peak = row.joint->peaks[row.index];
    peak = std::max(peak, wanted(0));
}

void World::solve_blocks(std::vector<BlockRow>& rows, double h, const SolverSettings& settings, bool relax)
{
    for (std::size_t i = 0; i < rows.size(); ++i) {
        solve_block(rows[i], h, settings, relax);
        // After the last contact of a joint: what its contacts, pressing less, cannot hold any more is taken back.
        Joint& joint = *rows[i].joint;
        if (rows[i].index + 1 < joint.impulses.size()) continue;
        const double push = push_of(joint, rows[i].joint_contacts);
        for (std::size_t k = i - rows[i].index; k < i; ++k)
            shorten(joint, rows[k].block, rows[k].index, push);
    }
}

/// Shortens the impulses of a block to what the joint's contacts, which push with `push` N s together, can hold. Does nothing to
/// blocks that contacts do not bound.
void World::shorten(Joint& joint, const Block& block, std::size_t index, double push)
{
    Eigen::VectorXd& held = joint.impulses[index];
    const double size = (to_force_of(block) * held).norm(), bound = block.most_per_contact * push;
    if (block.most_per_contact < 0 || size <= bound) return;
    const Eigen::VectorXd shorter = bound / size * held;
    apply(joint, block.jacobian, shorter - held);
    held = shorter;
}
/// Shortens the friction of a contact to what its normal impulse can hold.
void World::shorten(ContactRow& row)
{
    const double size = row.friction.norm(),
                 bound = static_cast<double>(row.point->contact.friction) * row.impulse;
    if (size <= bound) return;
    const Eigen::VectorXd shorter = bound / size * row.friction;
    apply(row.point->a, row.point->b, row.tangents, shorter - row.friction);
    row.friction = shorter;
}

World::Soft World::contact_softness(int a, int b, double h, const SolverSettings& settings) const
{
    const double beta =
        settings.drift_correction == DriftCorrection::baumgarte ? static_cast<double>(settings.baumgarte) : 0;
    if (settings.method != Method::soft_step) return {beta / h, 1, 0};
    const bool on_fixed = !moves(a) || !moves(b);
    const double hertz = settings.contact_hertz > 0 ? static_cast<double>(settings.contact_hertz)
                                                    : std::max(30.0, stiffest(h) / 2);
    return softness((on_fixed ? 2 : 1) * hertz, settings.contact_damping_ratio, h);
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

World::ContactRow World::begin_contact(const ContactPoint& point, double warm)
{
    const Contact& c = point.contact;
    const Eigen::Vector3d n = eigen(c.normal), arm_a = eigen(c.arm_a), arm_b = eigen(c.arm_b);
    ContactRow row;
    row.point = &point;
    row.normal = direction_jacobian(n, arm_a, arm_b);
    row.approach = speed(point.a, point.b, row.normal)(0);
    const ContactResult before = memory_.contains(c.key) ? memory_.at(c.key) : ContactResult{};
    row.impulse = warm * before.normal;
    // Any two directions perpendicular to n will do, because the cone is circular.
    const Eigen::Vector3d t1 =
        is_planar_pair(point.a, point.b) ? Eigen::Vector3d(-n.y(), n.x(), 0) : n.unitOrthogonal();
    if (is_planar_pair(point.a, point.b)) {
        row.tangents = direction_jacobian(t1, arm_a, arm_b);
        row.friction = Eigen::VectorXd::Constant(1, warm * t1.dot(before.friction));
    } else {
        const Eigen::Vector3d t2 = n.cross(t1);
        row.tangents.resize(2, 12);
        row.tangents << direction_jacobian(t1, arm_a, arm_b), direction_jacobian(t2, arm_a, arm_b);
        row.friction = warm * Eigen::Vector2d(t1.dot(before.friction), t2.dot(before.friction));
    }
    return row;
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

/// The bodies whose inertias give a contact its K: those of the step's beginning, until one of the two has turned so far that
/// its inertia may have changed by more than most_change; then the bodies as they are.
const std::vector<Body>& World::bodies_of_response(const ContactPoint& point) const
{
    for (const int end : {point.a, point.b}) {
        const Body& body = bodies[static_cast<std::size_t>(end)];
        if (body.motion != BodyMotion::dynamic_body || body.model != BodyModel::rigid) continue;
        const double spread = body.inertia.trace() * body.inertia.inverse().trace() - 9;
        const Eigen::Quaterniond turn =
            body.orientation * start_[static_cast<std::size_t>(end)].orientation.conjugate();
        if (4 * turn.vec().squaredNorm() * spread > most_change) return bodies;
    }
    return start_;
}

Eigen::MatrixXd World::effective_mass_along(const ContactPoint& point, const Jacobian& rows) const
{
    const std::vector<Body>& of = bodies_of_response(point);
    return effective_mass(rows, of[static_cast<std::size_t>(point.a)], of[static_cast<std::size_t>(point.b)]);
}

double World::separation(const ContactRow& row) const
{
    return static_cast<double>(row.point->contact.separation) +
           (row.normal * moved_since_start(row.point->a, row.point->b))(0);
}

void World::solve_contact(ContactRow& row, double h, const SolverSettings& settings, bool relax)
{
    const ContactPoint& point = *row.point;
    const double mu = static_cast<double>(point.contact.friction);
    if (mu > 0 || point.contact.restitution > 0) {
        const std::vector<Body>& of = bodies_of_response(point);
        const Eigen::MatrixXd k =
            row.tangents *
            pair_inverse_mass(of[static_cast<std::size_t>(point.a)], of[static_cast<std::size_t>(point.b)]) *
            row.tangents.transpose();
        const double most = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).eigenvalues().maxCoeff();
        const Eigen::Index rows = row.friction.size();
        const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(rows, rows);
        // Once the bodies have turned far, the largest response is used along both tangents.
        Eigen::MatrixXd inverse = effective_mass_along(point, row.tangents);
        if (&of == &bodies && rows > 1) inverse = identity / most;
        const Eigen::VectorXd free = row.friction - inverse * speed(point.a, point.b, row.tangents);
        const Eigen::VectorXd next = bounded(row.friction, free, identity, k, most, mu * row.impulse);
        apply(point.a, point.b, row.tangents, next - row.friction);
        row.friction = next;
    }
    const bool soft_step = settings.method == Method::soft_step;
    Soft soft = contact_softness(point.a, point.b, h, settings);
    const double slop = soft_step ? 0 : static_cast<double>(settings.penetration_slop);
    const double s = separation(row);
    double bias = soft.rate * std::min(s + slop, 0.0);
    if (s > 0) {
        soft = {0, 1, 0};
        bias = s / h;
    } else if (relax) {
        soft = {0, 1, 0};
        bias = 0;
    }
    const double opening = speed(point.a, point.b, row.normal)(0);
    const double normal_effective_mass = effective_mass_along(point, row.normal)(0, 0);
    const double wanted = row.impulse - normal_effective_mass * soft.mass_scale * (opening + bias) -
                          soft.impulse_scale * row.impulse;
    // The impulse with which the contact would open at push_out_speed.
    const double most =
        row.impulse - normal_effective_mass * (opening - static_cast<double>(settings.push_out_speed));
    const double impulse = std::max(std::min(wanted, most), 0.0);
    apply(point.a, point.b, row.normal, Eigen::VectorXd::Constant(1, impulse - row.impulse));
    row.impulse = impulse;
    row.peak = std::max(row.peak, impulse);
    // What the contact, pressing less, cannot hold any more is taken back.
    shorten(row);
}

/// Projects the points of a manifold one by one, each taking the displacements by those before it into account; the
/// bodies are moved at the end.
void World::project_contacts(const Joint& joint, const SolverSettings& settings)
{
    Body &a = bodies[static_cast<std::size_t>(joint.a)], &b = bodies[static_cast<std::size_t>(joint.b)];
    Eigen::Matrix<double, 12, 1> move = Eigen::Matrix<double, 12, 1>::Zero();
    for (const Block& block : blocks_of(joint)) {
        if (block.kind != Block::Kind::contact) continue;
        const double deep =
            std::clamp(block.error(0) + static_cast<double>(settings.penetration_slop), -0.2, 0.0);
        const double left = static_cast<double>(settings.baumgarte) * deep + (block.jacobian * move)(0);
        const double lambda = std::max(-mass_of(joint, block)(0, 0) * left, 0.0);
        move += pair_inverse_mass(a, b) * block.jacobian.transpose() * lambda;
    }
    a.displace(move.head<6>());
    b.displace(move.tail<6>());
}

void World::project(std::vector<ContactRow>& contacts, const SolverSettings& settings)
{
    const auto move = [&](int a, int b, const Jacobian& jacobian, const Eigen::VectorXd& push) {
        Body& body_a = bodies[static_cast<std::size_t>(a)];
        Body& body_b = bodies[static_cast<std::size_t>(b)];
        const Eigen::Matrix<double, 12, 1> change =
            pair_inverse_mass(body_a, body_b) * jacobian.transpose() * push;
        body_a.displace(change.head<6>());
        body_b.displace(change.tail<6>());
    };
    for (Joint& joint : joints) {
        project_contacts(joint, settings);
        const std::size_t count = joint.impulses.size();
        for (std::size_t i = 0; i < count; ++i) {
            const Block block = blocks_of(joint)[i];
            // Springs and motors are forces, not positions.
            if (block.is_spring() || block.kind == Block::Kind::motor || block.kind == Block::Kind::contact)
                continue;
            Eigen::VectorXd error = block.error;
            if (block.kind == Block::Kind::limit) error = block.side * error.cwiseMin(0.0);
            move(joint.a, joint.b, block.jacobian,
                 -effective_mass(block.jacobian, bodies[static_cast<std::size_t>(joint.a)],
                                 bodies[static_cast<std::size_t>(joint.b)]) *
                     error);
        }
    }
    for (ContactRow& row : contacts) {
        const double deep = std::min(separation(row) + static_cast<double>(settings.penetration_slop), 0.0);
        const double push = -effective_mass_along(*row.point, row.normal)(0, 0) *
                            static_cast<double>(settings.baumgarte) * std::max(deep, -0.2);
        move(row.point->a, row.point->b, row.normal, Eigen::VectorXd::Constant(1, push));
    }
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
    for (const ContactPoint& point : points) contacts.push_back(begin_contact(point, warm));

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
            for (int i = 0; i < settings.projections; ++i) project(contacts, settings);
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

void World::finish_contacts(std::vector<ContactRow>& contacts, const SolverSettings& settings)
{
    const double threshold = -static_cast<double>(settings.restitution_threshold);
    for (Joint& joint : joints) {
        const std::vector<Block> blocks = blocks_of(joint);
        // A face that lands flat hits with all its points at once, which takes a few rounds over the points.
        constexpr std::size_t rounds = 8;
        for (std::size_t k = 0; k < rounds * blocks.size(); ++k) {
            const std::size_t i = k % blocks.size();
            const Block& block = blocks[i];
            if (block.restitution == 0 || joint.approaches[i] >= threshold || joint.peaks[i] == 0) continue;
            const double opening = opening_speed(joint.a, joint.b, block.jacobian, joint.approaches[i],
                                                 block.error(0), block.restitution, settings);
            const double leaving = speed(joint.a, joint.b, block.jacobian)(0) - opening;
            double& held = joint.impulses[i](0);
            const double wanted = std::max(held - mass_of(joint, block)(0, 0) * leaving, 0.0);
            apply(joint, block.jacobian, Eigen::VectorXd::Constant(1, wanted - held));
            held = wanted;
        }
        const double push = push_of(joint, contacts_of(blocks));
        for (std::size_t i = 0; i < blocks.size(); ++i) shorten(joint, blocks[i], i, push);
    }
    memory_.clear();
    step_results_.clear();
    for (ContactRow& row : contacts) {
        const double e = static_cast<double>(row.point->contact.restitution);
        if (e > 0 && row.approach < threshold && row.peak > 0) {
            const int a = row.point->a, b = row.point->b;
            const double opening =
                opening_speed(a, b, row.normal, row.approach, separation(row), e, settings);
            const double leaving = speed(a, b, row.normal)(0) - opening;
            const double impulse =
                std::max(row.impulse - effective_mass_along(*row.point, row.normal)(0, 0) * leaving, 0.0);
            apply(a, b, row.normal, Eigen::VectorXd::Constant(1, impulse - row.impulse));
            row.step.normal += impulse - row.impulse;
            row.impulse = impulse;
            const Eigen::Vector3d before = row.force();
            shorten(row);
            row.step.friction += row.force() - before;
        }
        memory_[row.point->contact.key] = {row.impulse, row.force()};
        step_results_[row.point->contact.key] = row.step;
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
