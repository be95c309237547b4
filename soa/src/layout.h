// How a scene is laid out for lanes in one step: coloured, in blocks, with pointers to everything a kernel
// needs.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "batches.h"
#include "contact_intake.h"
#include "motley/core/scene.h"
#include "motley/core/step_report.h"

namespace motley {

/// Lives as long as its solver; buffers are kept from step to step. What persists of a result (colours,
/// impulses) lives in the scene.
class Layout {
  public:
    explicit Layout(const KernelTable& kernels) : kernels_(kernels) {}

    /// First the host's contacts are taken in, in ranges and perhaps on several threads...
    ContactIntake intake;
    /// ...then everything is coloured and placed, in order, by one thread.
    void build(Scene& scene, std::span<const Contact> contacts);

    /// The step's numbers and the rows of the bodies.
    KernelContext context;
    void point_at(Scene& scene, const StepConstants& step);

    [[nodiscard]] const std::vector<SweepChunk>& sweeps(int colour) const
    {
        return sweeps_[static_cast<std::size_t>(colour)];
    }
    [[nodiscard]] const std::vector<TransferChunk>& transfers() const { return transfers_; }
    [[nodiscard]] const ConstraintData& data(int type) const { return data_[static_cast<std::size_t>(type)]; }
    [[nodiscard]] const KernelTable& kernels() const { return kernels_; }
    /// True when M^-1 J^T of no constraint turns within the step: contacts alone, and no rigid body, whose
    /// inertia turns with it.
    [[nodiscard]] bool has_constant_responses() const
    {
        return joints_.is_empty() &&
               context.bodies[static_cast<int>(BodyKind::rigid)].size == 1;  // the null row
    }
    /// Fills the counts of a report.
    void report(StepReport& report) const;

  private:
    const KernelTable& kernels_;
    BatchSet joints_, contacts_;
    std::shared_ptr<const char> joint_version_;
    ColourMasks joint_masks_, masks_;
    std::array<std::vector<SweepChunk>, parallel_colours + 1> sweeps_;
    std::vector<TransferChunk> transfers_;
    std::array<ConstraintData, constraint_type_count> data_;

    void place_joints(Scene& scene);
    void place_contacts(Scene& scene, std::size_t count);
    void point_at_data(Scene& scene, std::span<const Contact> contacts);
};

}  // namespace motley
