// The integration of particles and planar bodies that are not damped. Their velocity and displacement are a quad each, of which
// every number changes by itself: so quads are computed as they lie in memory, several bodies in a register, without the transposes
// of kernel_integration.h, whose bits these are. Included inside an anonymous namespace, after that file.
#pragma once

#ifndef MOTLEY_SCALAR_LANES
/// The quad {x, y, z, w} as often as a register holds it.
inline Lanes repeated(float x, float y, float z, float w)
{
    alignas(64) float quads[Lanes_width];
    for (int i = 0; i < Lanes_width; i += 4) {
        quads[i] = x;
        quads[i + 1] = y;
        quads[i + 2] = z;
        quads[i + 3] = w;
    }
    return load_lanes(quads);
}

/// Calls work(place) for each register of quads of the rows from `begin` to `end` - 1, `place` in floats, and rest(RowIndex) for
/// rows at either end that fill none.
template <BodyKind kind, class Work, class Rest>
[[gnu::always_inline]] inline void for_each_register(std::int32_t begin, std::int32_t end, const Work& work,
                                                     const Rest& rest)
{
    static_assert(quads_of(kind) == 1);
    constexpr std::int32_t rows = Lanes_width / 4;
    const std::int32_t first = std::min((begin + rows - 1) / rows * rows, end), last = end / rows * rows;
    if (begin < first) rest(RowIndex<kind>(begin, first - begin));
    for (std::int32_t row = first; row < last; row += rows) work(std::int64_t{4} * row);
    if (std::max(first, last) < end) rest(RowIndex<kind>(std::max(first, last), end - std::max(first, last)));
}

/// As integrate_velocities<kind, false>.
template <BodyKind kind>
void integrate_velocity_quads(const KernelContext& context, std::int32_t begin, std::int32_t end)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    if (arrays.decay != nullptr) return integrate_velocities<kind, false>(context, begin, end);
    const Vec3<float>& g = context.step.gravity;
    // The sum of any number and -0 is that number, also of -0. The last number of an acceleration is 0, so that the inverse mass,
    // the last one of a velocity, stays.
    const Lanes gravity = repeated(g.x, g.y, kind == BodyKind::planar ? -0.0F : g.z, -0.0F),
                h(context.step.substep);
    for_each_register<kind>(
        begin, end,
        [&](std::int64_t place) {
            const Lanes before = load_lanes(arrays.velocity + place);
            const Lanes pulled = before + h * (load_lanes(arrays.acceleration + place) + gravity);
            Lanes now = select(last_of_each_quad(before) > Lanes(0), pulled, before);
            if (context.replay != Replay::nothing) {
                const Lanes unpushed = now;
                if (context.replay == Replay::last_substep)
                    now = now + (before - load_lanes(arrays.unpushed + place));
                store_lanes(unpushed, arrays.unpushed + place);
            }
            store_lanes(now, arrays.velocity + place);
        },
        [&](const RowIndex<kind>& index) { speed_up_some<kind, false>(context, index); });
}

/// As integrate_positions<kind, false>.
template <BodyKind kind>
void integrate_position_quads(const KernelContext& context, std::int32_t begin, std::int32_t end)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    // The last number of a displacement, the inverse inertia of a planar body, stays.
    const float h = context.step.substep;
    const Lanes times = repeated(h, h, h, 0);
    for_each_register<kind>(
        begin, end,
        [&](std::int64_t place) {
            store_lanes(load_lanes(arrays.delta + place) + times * load_lanes(arrays.velocity + place),
                        arrays.delta + place);
        },
        [&](const RowIndex<kind>& index) { move_some_on<kind>(context, index); });
}
#endif
