// The path of the contacts of a step, from the host's list to chunks of blocks that a sweep runs over. Each phase is
// one function here, in the order in which they run.
#pragma once

#include <span>
#include <string>

#include "layout/layout.h"
#include "motley/core/settings.h"
#include "stage_runner.h"

namespace motley {

class ContactPipeline {
  public:
    ContactPipeline(StageRunner& runner, Layout& layout) : runner_(runner), layout_(layout) {}

    /// Makes placements from the list, with the colours and impulses of the last step. Returns what is wrong with the
    /// first bad contact, or empty; repeated keys are found only by lay_out(). Unless bad contacts are skipped, none
    /// is taken in if one is bad.
    std::string take_in(SceneCore& scene, std::span<const Contact> contacts, BadContacts bad_contacts);
    /// How the step wants its constraints laid out.
    struct Wanted {
        FigureUse figures;
        bool tells_apart = false;  ///< blocks have space for residuals and wanted numbers of sweeps
        bool adds_up = false;      ///< contacts have space for sums over several substeps
    };
    /// Makes chunks from the placements, joints included. Returns what is wrong when a key is repeated, or empty.
    std::string lay_out(SceneCore& scene, std::span<const Contact> contacts, const Wanted& wanted);

  private:
    StageRunner& runner_;
    Layout& layout_;

    void check_and_match(SceneCore& scene, std::span<const Contact> contacts);
    void look_up_unmatched(ContactCache& cache);
    void colour_and_verify_keys(SceneCore& scene);
    void sort_into_blocks(bool adds_up);
};

}  // namespace motley
