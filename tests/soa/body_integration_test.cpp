// The kernels that integrate particles and planar bodies have the bits of the scalar ones, for every number that can be in a row:
// signed zeros, denormals, bodies without mass, what is infinite or no number, damped bodies, and ranges that begin and end anywhere.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "kernels/kernel_table.h"
#include "motley/soa/isa.h"
#include "stores/aligned_vector.h"

namespace motley {
namespace {

constexpr std::int32_t row_count = 512;

/// Rows of one kind, of a quad each.
struct Rows {
    using Floats = AlignedVector<float>;
    Floats velocity, delta, unpushed, acceleration, decay, start_along;
    bool is_damped;

    Rows(std::mt19937& random, BodyKind kind, bool damped)
        : velocity(std::size_t{4} * row_count, 0),
          delta(velocity),
          unpushed(velocity),
          acceleration(velocity),
          decay(velocity),
          start_along(row_count, 0),
          is_damped(damped)
    {
        constexpr float infinite = std::numeric_limits<float>::infinity();
        const std::array<float, 6> special{0.0F, -0.0F, 1e-40F, -infinite, std::nanf(""), 3e38F};
        std::uniform_real_distribution<float> any(-5, 5);
        std::uniform_int_distribution<int> choice(0, 11);
        const auto number = [&] {
            const int i = choice(random);
            return i < static_cast<int>(special.size()) ? special[static_cast<std::size_t>(i)] : any(random);
        };
        for (std::size_t at = 0; at < velocity.size(); at += 4) {
            for (std::size_t i = 0; i < 3; ++i) {
                velocity[at + i] = number();
                delta[at + i] = number();
                unpushed[at + i] = number();
                acceleration[at + i] = number();
                decay[at + i] = 0.9F;
            }
            // Of a body that moves, or of one that does not.
            velocity[at + 3] = unpushed[at + 3] = at / 4 % 5 == 0 ? 0.0F : std::abs(any(random));
            if (kind == BodyKind::planar) delta[at + 3] = std::abs(any(random));
        }
    }
    void put_into(BodyArrays& arrays, BodyKind kind)
    {
        arrays.kind = kind;
        arrays.velocity = velocity.data();
        arrays.delta = delta.data();
        arrays.unpushed = unpushed.data();
        arrays.acceleration = acceleration.data();
        arrays.decay = is_damped ? decay.data() : nullptr;
        arrays.start_along = start_along.data();
        arrays.size = row_count;
        arrays.can_move = true;
    }
    /// The bits of all that a kernel writes. Of what is no number all bits are one, because which of two such operands an operation
    /// keeps is the compiler's choice.
    [[nodiscard]] std::vector<std::uint32_t> bits() const
    {
        std::vector<std::uint32_t> all;
        for (const Floats* floats : {&velocity, &delta, &unpushed, &start_along}) {
            for (const float x : *floats)
                all.push_back(std::isnan(x) ? UINT32_MAX : std::bit_cast<std::uint32_t>(x));
        }
        return all;
    }
};

TEST(BodyIntegration, OfQuadsHasTheBitsOfTheScalarKernels)
{
    using Move = BodyKernels::Move BodyKernels::*;
    const std::array<Move, 4> moves{&BodyKernels::begin_velocities, &BodyKernels::integrate_velocities,
                                    &BodyKernels::integrate_positions, &BodyKernels::integrate_on};
    const std::array<std::array<std::int32_t, 2>, 5> ranges{{{0, 512}, {16, 48}, {0, 37}, {3, 5}, {21, 463}}};
    for (const Isa isa : available_isas()) {
        for (const BodyKind kind : {BodyKind::particle, BodyKind::planar}) {
            for (const Replay replay : {Replay::nothing, Replay::next_time, Replay::last_substep}) {
                for (const bool damped : {false, true}) {
                    for (const std::array<std::int32_t, 2>& range : ranges) {
                        for (std::size_t move = 0; move < moves.size(); ++move) {
                            const auto run = [&](Isa with) {
                                std::mt19937 random(7);
                                Rows rows(random, kind, damped);
                                KernelContext context;
                                context.step.substep = 1.0F / 240;
                                context.step.gravity = {-0.0F, -9.81F, 2};
                                context.replay = replay;
                                const auto k = static_cast<std::size_t>(kind);
                                rows.put_into(context.bodies[k], kind);
                                (kernel_table(with).bodies[k].*moves[move])(context, range[0], range[1]);
                                return rows.bits();
                            };
                            ASSERT_EQ(run(isa), run(Isa::scalar))
                                << isa_name(isa) << ", kind " << static_cast<int>(kind) << ", replay "
                                << static_cast<int>(replay) << ", damped " << damped << ", rows " << range[0]
                                << " to " << range[1] << ", kernel " << move;
                        }
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace motley
