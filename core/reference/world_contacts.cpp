// Contacts in the reference: those of the list, and the points of manifolds.
#include <algorithm>

#include "as_eigen.h"
#include "symmetric_modes.h"
#include "world_rows.h"

namespace motley::reference {

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

World::ContactRow World::begin_contact(const ContactPoint& point, double h, double warm)
{
    const Contact& c = point.contact;
    const Eigen::Vector3d n = eigen(c.normal), arm_a = eigen(c.arm_a), arm_b = eigen(c.arm_b);
    ContactRow row;
    row.point = &point;
    row.normal = direction_jacobian(n, arm_a, arm_b);
    row.approach = speed(point.a, point.b, row.normal)(0);
    const ContactResult before = memory_.contains(c.key) ? memory_.at(c.key) : ContactResult{};
    row.impulse = warm * before.normal;
    row.most = h * point.surface.most_force;
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
    row.surface_speed = row.tangents.middleCols<3>(6) * eigen(point.surface.velocity);
    return row;
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
        const Eigen::MatrixXd k = response(
            row.tangents,
            pair_inverse_mass(of[static_cast<std::size_t>(point.a)], of[static_cast<std::size_t>(point.b)]));
        const Eigen::Index rows = row.friction.size();
        const double most = SymmetricModes<Eigen::MatrixXd>(k).values.maxCoeff();
        const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(rows, rows);
        // Once the bodies have turned far, the largest response is used along both tangents.
        Eigen::MatrixXd inverse = effective_mass_along(point, row.tangents);
        if (&of == &bodies && rows > 1) inverse = identity / most;
        const Eigen::VectorXd free =
            row.friction - inverse * (speed(point.a, point.b, row.tangents) - row.surface_speed);
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
    const double impulse = std::clamp(std::min(wanted, most), 0.0, row.most);
    apply(point.a, point.b, row.normal, Eigen::VectorXd::Constant(1, impulse - row.impulse));
    row.impulse = impulse;
    row.peak = std::max(row.peak, impulse);
    // What the contact, pressing less, cannot hold any more is taken back.
    shorten(row);
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
        move += pair_inverse_mass(a, b) * (block.jacobian.transpose() * lambda);
    }
    a.displace(move.head<6>());
    b.displace(move.tail<6>());
}

void World::project(std::vector<ContactRow>& contacts, double h, const SolverSettings& settings)
{
    const auto move = [&](int a, int b, const Jacobian& jacobian, const Eigen::VectorXd& push) {
        Body& body_a = bodies[static_cast<std::size_t>(a)];
        Body& body_b = bodies[static_cast<std::size_t>(b)];
        const Eigen::Matrix<double, 12, 1> change =
            pair_inverse_mass(body_a, body_b) * (jacobian.transpose() * push);
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
        const double wanted = -effective_mass_along(*row.point, row.normal)(0, 0) *
                              static_cast<double>(settings.baumgarte) * std::max(deep, -0.2);
        const double push = std::min(wanted, h * row.most);
        move(row.point->a, row.point->b, row.normal, Eigen::VectorXd::Constant(1, push));
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
            const double impulse = std::clamp(
                row.impulse - effective_mass_along(*row.point, row.normal)(0, 0) * leaving, 0.0, row.most);
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

}  // namespace motley::reference
