// The table of extremes. To add a case: a function in extremes/ that runs it and returns its figure, and its line here.
#include "commands/extremes.h"

#include <fmt/format.h>

#include "commands/extremes/contacts.h"
#include "commands/extremes/geometry.h"
#include "commands/extremes/loads.h"
#include "commands/extremes/masses.h"
#include "commands/extremes/motions.h"
#include "commands/extremes/numbers.h"

namespace motley::bench {
namespace {

constexpr std::array<double, extreme_way_count> all(double bound)
{
    return {bound, bound, bound, bound, bound};
}

// The bounds are in this order: soft_step, exact, baumgarte, projection, direct.
constexpr ExtremeCase cases[] = {
    {"tip of 1e-6 kg",
     "hanging, pushed at 3 m/s: whips, and holds",
     "L",
     {0.05, 5e-3, 0.05, 0.05, 1e-6},
     light_tip<6>},
    {"tip of 1e-4 kg", "likewise", "L", {0.05, 5e-3, 0.05, 0.05, 1e-6}, light_tip<4>},
    {"load of 1e2 kg, hanging",
     "what a locked joint gives under a weight",
     "L",
     {1e-6, 1e-6, no_claim, no_claim, 1e-9},
     hanging_load<2>},
    {"load of 1e3 kg, hanging", "likewise", "L", {1e-6, 1e-6, no_claim, no_claim, 1e-9}, hanging_load<3>},
    {"load of 1e6 kg, hanging", "likewise", "L", {1e-6, 1e-6, no_claim, no_claim, 1e-9}, hanging_load<6>},
    {"load of 1e3 kg, from level",
     "light links whip round",
     "L",
     {1e-3, 1e-3, no_claim, no_claim, 1e-3},
     level_load},
    {"arm of limits under 1e4 kg",
     "level, eight links of 1 kg: limits hold as locks do",
     "L",
     {1e-6, 1e-6, no_claim, no_claim, 1e-9},
     limits_of_an_arm},
    {"chain of 1,000 links",
     "its own weight, 9,810 N at the top",
     "L",
     {no_claim, 1e-3, no_claim, no_claim, 1e-6},
     long_chain},
    {"needle on a lever of 10 m", "inertia 1 : 1e4, solved as a block", "L", all(1e-3), needle_on_a_lever},
    {"plate on a lever of 10 m",
     "inertia 1 : 1e6 of m L^2; soft: its spin leans on 1e-6 kg; Baumgarte: keeps the drift of five substeps",
     "L",
     {5e-3, 1e-3, 2e-3, 1e-3, 1e-3},
     plate_on_a_lever},
    {"tumbling about the middle axis", "nobody pushes: energy must not grow in 60 s", "%", all(0.1),
     tumbling},
    {"spin of 1e4 rad/s", "no more energy than before, though a step turns it 166 rad", "%", all(0.1),
     fast_spin},
    {"steps of 0.5 s",
     "implicit locks must not gain energy, of what falls",
     "x",
     {no_claim, 1.0, 1.0, 1.0, 1.0},
     coarse_steps},
    {"steps of 1/30 s and 1/3000 s in turn",
     "cached impulses scale with the step",
     "%",
     {1.0, 1.0, no_claim, 1.0, 1.0},
     alternating_steps},
    {"steps of 1e-6 s", "as steps of 1e-3 s", "%", all(2.0), tiny_steps},
    {"1e7 m from the origin", "doubles resolve 2e-9 m there: separation as at home", "m", all(1e-3),
     far_away},
    {"10 km/s", "floats resolve 1e-3 m/s there", "m", all(0.05), fast_travel},
    {"rod of 1 m between coincident points",
     "an axis is made up; it opens",
     "m",
     {1e-3, 1e-3, 1e-3, 1e-3, 1e-3},
     no_distance},
    {"coincident bodies in contact", "they part at the push-out speed at most", "x", all(1.1),
     coincident_contact},
    {"locked rotation half a turn off", "found within 2 s from pi - 1e-3", "rad", all(1e-2), half_a_turn_off},
    {"one joint ten times",
     "the velocities of one",
     "m/s",
     {1e-4, 1e-4, 1e-4, 1e-4, 1e-5},
     same_joint_ten_times},
    {"two contradictory welds", "1 m apart: the body stays between", "m", all(0.6), contradictory_welds},
    {"loop of four hinges", "redundant rows", "m", {5e-3, 1e-3, 5e-2, 5e-3, 1e-3}, loop_of_four<0>},
    {"loop of four hinges round 1 t",
     "likewise",
     "m",
     {1e-3, 1e-3, no_claim, no_claim, 1e-3},
     loop_of_four<3>},
    {"loop of four hinges round 1e6 kg",
     "likewise",
     "m",
     {no_claim, no_claim, no_claim, no_claim, 1e-3},
     loop_of_four<6>},
    {"door on two hinges of one axis", "likewise", "m", {5e-3, 1e-3, 5e-2, 5e-3, 1e-3}, door},
    {"q and -q in mid-swing", "the same pose, the same way", "m", all(1e-6), other_hemisphere},
    {"axes that start parallel", "square is a quarter turn away, nobody knows which: no kick", "rad/s",
     all(20), parallel_axes},
    {"slide from 0 to 0", "a fixed joint", "m", {1e-3, 1e-3, 1e-2, 1e-3, 1e-3}, closed_range},
    {"limit hit at 200 m/s", "energy must not grow", "%", all(1.0), limits_at_speed},
    {"1e6 N for one step on 1 kg",
     "whole again within 2 s",
     "L",
     {no_claim, no_claim, no_claim, 0.2, 0.2},
     a_blow},
    {"overlap of 2 m", "nobody is thrown faster than the push-out speed", "x", all(1.1), deep_overlap},
    {"1 t on a ball of 1 kg",
     "10 s: sinks, in radii; soft: by 2 F / (m w^2) of each contact",
     "r",
     {1.4, 1e-2, no_claim, no_claim, 1e-2},
     heavy_on_light<3>},
    {"1e6 kg on a ball of 1 kg",
     "likewise",
     "r",
     {no_claim, 1e-2, no_claim, no_claim, 1e-2},
     heavy_on_light<6>},
    {"every contact twice, a micrometre apart", "a cube rests on them, and does not start to spin", "rad/s",
     all(1e-3), twin_points},
    {"friction 0", "slides as if it fell sideways", "%", all(0.1), no_friction},
    {"1e-12 N on 1 kg", "F t / m after 2,400 additions of floats", "x", all(1.5e-4), whisper},
    {"friction 1e6", "sticks: m crept in 10 s, a second", "m/s", all(1e-3), huge_friction},
    {"an hour without weight", "nothing moves what rests", "m", all(1e-6), weightless_hour},
    {"spring of 1e-3 Hz", "never farther than it began, 0.5 m", "m", all(0.501), spring_of<-3>},
    {"spring of 1e6 Hz", "likewise: stiffer than a step can follow", "m", all(0.501), spring_of<6>},
    {"tower of 200 balls",
     "5 s: the top sinks, in radii",
     "r",
     {no_claim, 0.1, no_claim, no_claim, 0.1},
     tower},
    {"10,000 bounces with restitution 1", "energy at each top stays (1,000 bounces of direct)", "%", all(1.0),
     bounces},
    {"hub of 100,000 joints",
     "ordered tail: momentum is kept; ten sweeps round the hub 3,000,000 times",
     "x",
     {1e-4, 1e-4, no_claim, no_claim, 1e-4},
     hub},
    {"denormals everywhere", "stay nothing", "J", all(1e-30), denormals},
    {"10,000 joints and bodies come and go a step", "nobody is lost; the rest holds", "m", all(5e-3), churn},
    {"a contact that remembers the other side", "as one that remembers nothing", "m/s", all(1e-3),
     reversed_cache},
    {"a hinge turned 10,000 times", "its axes stay together", "rad", all(1e-3), many_turns},
    {"nothing, static bodies, one body", "each is stepped", "not", all(0), next_to_nothing},
    {"two static bodies, a body with itself", "refused", "not refused", all(0), both_static},
};

}  // namespace

const char* name_of(ExtremeWay way)
{
    static constexpr const char* names[] = {"soft_step", "exact", "Baumgarte", "projection", "direct"};
    return names[static_cast<int>(way)];
}

SolverSettings settings_of(ExtremeWay way)
{
    SolverSettings settings;
    settings.exact_joints = settings.exact_limits = settings.exact_contacts = way == ExtremeWay::exact;
    if (way == ExtremeWay::direct) {
        settings.method = Method::direct;
        settings.drift_correction = DriftCorrection::projection;
    }
    if (way == ExtremeWay::baumgarte || way == ExtremeWay::projection) {
        settings.method = Method::sequential_impulse;
        settings.iterations = 10;
        settings.drift_correction =
            way == ExtremeWay::baumgarte ? DriftCorrection::baumgarte : DriftCorrection::projection;
    }
    return settings;
}

std::span<const ExtremeCase> extreme_cases()
{
    return cases;
}

int print_extremes(const SolverOptions& options)
{
    int beyond = 0;
    fmt::print("figures; * beyond its bound, - no claim. Bounds in brackets where a claim is made\n{:<40}",
               "");
    for (int way = 0; way < extreme_way_count; ++way)
        fmt::print("{:>24}", name_of(static_cast<ExtremeWay>(way)));
    fmt::print("\n");
    for (const ExtremeCase& extreme : cases) {
        fmt::print("{:<40}", extreme.name);
        for (int way = 0; way < extreme_way_count; ++way) {
            const double figure = extreme.figure({static_cast<ExtremeWay>(way), options});
            const double bound = extreme.bound[static_cast<std::size_t>(way)];
            const bool is_beyond = !(figure <= bound);
            beyond += is_beyond ? 1 : 0;
            fmt::print("{:>24}", bound == no_claim ? fmt::format("{:.2g} -", figure)
                                                   : fmt::format("{:.2g} [{:.2g}]{}", figure, bound,
                                                                 is_beyond ? "*" : " "));
        }
        fmt::print("  {}: {}\n", extreme.unit, extreme.must);
    }
    fmt::print("{} figures beyond their bounds\n", beyond);
    return beyond;
}

}  // namespace motley::bench
