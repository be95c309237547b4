// The whole step in double, with explicit J and M^-1, one constraint after another in the order in which they are
// given. The lanes must agree with it up to the rounding of floats.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "maths/contact_surface.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/settings.h"
#include "motley/reference/direct_result.h"
#include "motley/reference/joint.h"

namespace motley::reference {

/// A contact of one step between bodies by index.
struct ContactPoint {
    int a = 0, b = 0;
    Contact contact;                   ///< the host's numbers; its handles are not read
    ContactSurface<double> surface{};  ///< of body a
};

class Assembly;

class World {
  public:
    std::vector<Body> bodies;
    std::vector<Joint> joints;  ///< solved in this order, before the contacts

    /// One step. Contacts are solved in the order of the list.
    void step(double dt, const SolverSettings& asked, const std::vector<ContactPoint>& contacts);

    /// One step in which all rows of a substep are solved at once, to a residual near the rounding of doubles: the
    /// result that a sequential method approaches with the number of its iterations. Constraints are rigid, with the
    /// drift correction of the settings: baumgarte, or a position solve of all rows at once. Redundant rows get the
    /// impulses of least norm, contradictory ones are solved in the least squares sense. Restitution comes after the
    /// substeps, contact by contact, as in step(). Joints under heavy loads are stabilised (geometric_stiffness.cpp),
    /// and with baumgarte the positions of locks are corrected at the end of each substep (hold_locks.cpp). The search
    /// starts from the impulses of the step before.
    DirectResult step_directly(double dt, const SolverSettings& asked,
                               const std::vector<ContactPoint>& contacts);

    /// The impulse of a contact on b, N s: along the normal, and perpendicular to it.
    struct ContactResult {
        double normal = 0;
        Eigen::Vector3d friction = Eigen::Vector3d::Zero();
    };
    using ContactResults = std::map<std::uint64_t, ContactResult>;  ///< by key
    /// In the last step's last substep, and in all its substeps together.
    [[nodiscard]] const ContactResults& last_substep_results() const { return memory_; }
    [[nodiscard]] const ContactResults& step_results() const { return step_results_; }

    /// Takes over the contact impulses, by key, of another world's step with substeps of `last_substep` s. Joints carry
    /// their impulses themselves.
    void recall(double last_substep, ContactResults contacts)
    {
        last_substep_ = last_substep;
        memory_ = std::move(contacts);
    }

  private:
    struct Soft {
        double rate, mass_scale, impulse_scale;
    };
    struct BlockRow;
    struct ContactRow;
    ContactResults memory_, step_results_;
    double last_substep_ = 0;
    std::vector<Body> start_;  ///< the bodies when the step began

    static Soft softness(double hertz, double damping_ratio, double h);
    /// The frequency, Hz, of the stiffest spring that this substep, or the last one if it was longer, can follow.
    [[nodiscard]] double stiffest(double h) const { return 0.25 / std::max(h, last_substep_); }
    [[nodiscard]] bool moves(int i) const
    {
        return bodies[static_cast<std::size_t>(i)].motion == BodyMotion::dynamic_body;
    }
    [[nodiscard]] bool is_planar_pair(int a, int b) const;
    void apply(int a, int b, const Jacobian& jacobian, const Eigen::VectorXd& impulse);
    void apply(Joint& joint, const Jacobian& jacobian, const Eigen::VectorXd& impulse);
    void add_up(std::vector<ContactRow>& contacts);
    [[nodiscard]] Eigen::VectorXd speed(int a, int b, const Jacobian& jacobian) const;

    [[nodiscard]] std::vector<Block> blocks_of(const Joint& joint) const;
    [[nodiscard]] Soft contact_softness(int a, int b, double h, const SolverSettings& settings) const;
    void begin_step();
    void find_rows(Joint& joint, double h, const SolverSettings& settings, std::vector<BlockRow>& rows) const;
    void begin_joint(Joint& joint, double h, const SolverSettings& settings, std::vector<BlockRow>& rows);
    [[nodiscard]] Eigen::MatrixXd mass_of(const Joint& joint, const Block& block) const;
    void aim(BlockRow& row, const Eigen::VectorXd& error, double h, const SolverSettings& settings) const;
    void solve_block(BlockRow& row, double h, const SolverSettings& settings, bool relax);
    void carry_arms(std::span<BlockRow> rows, double h) const;
    void solve_blocks(std::vector<BlockRow>& rows, double h, const SolverSettings& settings, bool relax);
    void shorten(Joint& joint, const Block& block, std::size_t index, double push);
    void shorten(ContactRow& row);
    [[nodiscard]] Eigen::Matrix<double, 12, 1> moved_since_start(int a, int b) const;
    ContactRow begin_contact(const ContactPoint& point, double h, double warm);
    void solve_contact(ContactRow& row, double h, const SolverSettings& settings, bool relax);
    [[nodiscard]] const std::vector<Body>& bodies_of_response(const ContactPoint& point) const;
    [[nodiscard]] Eigen::MatrixXd effective_mass_along(const ContactPoint& point, const Jacobian& rows) const;
    [[nodiscard]] double separation(const ContactRow& row) const;
    void project_contacts(const Joint& joint, const SolverSettings& settings);
    void project(std::vector<ContactRow>& contacts, double h, const SolverSettings& settings);
    [[nodiscard]] double opening_speed(int a, int b, const Jacobian& normal, double approach, double now,
                                       double restitution, const SolverSettings& settings) const;
    [[nodiscard]] Vector6 free_acceleration(int i, const SolverSettings& settings) const;
    void finish_contacts(std::vector<ContactRow>& contacts, const SolverSettings& settings);
    void land_free_groups(double h, double dt, const SolverSettings& settings);
    void end_step(double h);
    /// Islands of bodies that joints and contacts connect.
    struct Islands {
        std::vector<int> of_body;  ///< -1 for static and kinematic bodies
        std::vector<bool> floats;  ///< by island: whether nothing connects it to these or to the world
    };
    using PairMatrix = Eigen::Matrix<double, 12, 12>;
    /// A direction in which the geometric stiffness of a joint is high for the mass that it moves.
    struct StiffRow {
        int a, b, island;
        double stiffness;      ///< h^2 K / M beyond what an explicit substep follows
        Jacobian jacobian;     ///< one row
        Eigen::Vector3d turn;  ///< its speed for a common spin of both bodies
    };
    [[nodiscard]] Islands find_islands(const std::vector<ContactRow>& contacts) const;
    DirectResult solve_substep_directly(double h, const SolverSettings& settings,
                                        std::vector<ContactRow>& contacts,
                                        const std::vector<StiffRow>& stiff);
    [[nodiscard]] PairMatrix stiffness_of(const Joint& joint, double h) const;
    [[nodiscard]] std::vector<StiffRow> find_stiff_rows(const Islands& islands, double h) const;
    /// Adds stiff rows to a problem of velocities or of positions.
    void stiffen(Assembly& assembly, const std::vector<StiffRow>& rows, bool sees_velocities) const;
    /// The C that a lock must have at the end of a substep.
    struct Hold {
        std::size_t joint, block;
        double side;
        Eigen::VectorXd target;
    };
    [[nodiscard]] std::vector<Hold> find_holds(double h) const;
    /// Moves bodies until locks have that C. Returns for each island whether they do.
    std::vector<bool> hold_locks(const std::vector<Hold>& holds, const Islands& islands, double h,
                                 bool stiff);
    /// The angular momentum of each island about the origin.
    [[nodiscard]] std::vector<Eigen::Vector3d> angular_momenta(const Islands& islands) const;
    /// Adds the angular momentum `lost` to each island that floats and is held, as a common spin.
    void give_back(const Islands& islands, const std::vector<bool>& held,
                   const std::vector<Eigen::Vector3d>& lost);
    [[nodiscard]] double position_error() const;
    void project_directly(const std::vector<ContactRow>& contacts, double h, const SolverSettings& settings);
};

}  // namespace motley::reference
