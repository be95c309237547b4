// Light bodies between heavy ones: where sweeps do not converge, and where float is too coarse to solve exactly.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "layout/joint_intake.h"
#include "motley/core/ids.h"

namespace motley {

/// The inverse masses, 1/kg, of the lightest and the heaviest of some bodies.
struct MassSpan {
    float of_heaviest = std::numeric_limits<float>::infinity(), of_lightest = 0;
    void note(float inverse_mass)
    {
        of_heaviest = std::min(of_heaviest, inverse_mass);
        of_lightest = std::max(of_lightest, inverse_mass);
    }
    [[nodiscard]] bool is_wider_than(float ratio) const { return of_lightest > ratio * of_heaviest; }
};

/// A body with two locks or more, in a figure without a fixed body and with a body more than a million times as heavy; {} if there
/// is none. The mass that its joints see is made of both, and a float keeps hardly a digit of the light one
/// (light_between_heavy_test.cpp).
[[nodiscard]] BodyId light_between_heavy(std::span<const JointCandidate* const> joints,
                                         const BodyStore& bodies);

/// Whether a rotor is more than `ratio` times as heavy as the two bodies that it turns (ConstraintTraits::rotor_load). Sweeps solve
/// it by these two alone and then give the other bodies of the figure energy: ExactRotors.GiveNoEnergyWhateverTheyTurn in
/// motley_parallel_tests prints how much.
[[nodiscard]] bool turns_heavy_rotor(std::span<const JointCandidate* const> joints, float ratio);

/// Whether locks hang a heavy body on a light one: some body has, behind one of its locks, a body more than `ratio` times
/// as heavy as itself, and behind another one also such a body, or a fixed one. A sweep passes only about 1 / ratio of
/// such a load on. Loops of locks are cut open where a search of the bodies closes them.
[[nodiscard]] bool bears_heavy_load(std::span<const JointCandidate* const> joints, const BodyStore& bodies,
                                    float ratio);

}  // namespace motley
