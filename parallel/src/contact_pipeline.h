// The way of the contacts of a step: from the host's list to chunks of blocks that a sweep runs over. Each phase is one
// function here, in the order in which they run.
#pragma once

#include <span>
#include <string>

#include "layout.h"
#include "motley/core/settings.h"
#include "stage_runner.h"

namespace motley {

class ContactPipeline {
  public:
    ContactPipeline(StageRunner& runner, Layout& layout) : runner_(runner), layout_(layout) {}

    /// From the list to placements with last step's colours and impulses. Empty when all contacts are good, but for keys
    /// that come twice; else what is wrong with the first bad one. Unless bad ones are skipped, none is then taken in.
    std::string take_in(SceneCore& scene, std::span<const Contact> contacts, BadContacts bad_contacts);
    /// How the step wants its constraints laid out.
    struct Wanted {
        FigureUse figures;
        bool tells_apart = false;  ///< blocks have room for residuals and for how many sweeps they want
        bool adds_up = false;      ///< contacts have room for the sums of several substeps
    };
    /// From placements to chunks, joints included. What is wrong when a key came twice, or empty.
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
