// The end of a step: adds deltas to poses, sixteen consecutive rows at a time. Included inside an anonymous
// namespace, after kernel_bodies.h. Operations on poses are written as loops over lanes, which the compiler turns
// into as many doubles at once as the instruction set has. The bits are those of BodyStore::commit, which handles the
// rows that are refused here.
#pragma once

/// Whether `count` consecutive floats are all finite.
inline bool all_finite(const float* values, int count)
{
    std::uint32_t bad = 0;
    for (int i = 0; i < count; ++i) bad |= std::uint32_t{!(values[i] - values[i] == 0)};
    return bad == 0;
}

/// Whether all sixteen rows are moving bodies with a finite state. Unused rows and contained bodies have no inverse
/// mass.
template <BodyKind kind>
bool can_commit(const float* velocity, const float* delta)
{
    constexpr int floats = 4 * quads_of(kind);
    std::uint32_t still = 0;
    for (int lane = 0; lane < block_lanes; ++lane) still |= std::uint32_t{!(velocity[floats * lane + 3] > 0)};
    return still == 0 && all_finite(velocity, floats * block_lanes) &&
           all_finite(delta, floats * block_lanes);
}

/// Sixteen quaternions, component by component.
template <class Real>
struct Turns {
    alignas(64) Real x[block_lanes], y[block_lanes], z[block_lanes], w[block_lanes];
};

/// orientation = delta * orientation, normalised, and the same narrowed to float.
inline void turn(const float* delta, Quat<PoseReal>* orientation, Turns<float>& narrowed)
{
    Turns<PoseReal> turned;
    for (int lane = 0; lane < block_lanes; ++lane) {
        const float* by = delta + 8 * lane + 4;
        const Quat<PoseReal> q =
            normalised(normalised(Quat<PoseReal>{by[0], by[1], by[2], by[3]} * orientation[lane]));
        turned.x[lane] = q.x;
        turned.y[lane] = q.y;
        turned.z[lane] = q.z;
        turned.w[lane] = q.w;
    }
    for (int lane = 0; lane < block_lanes; ++lane) {
        orientation[lane] = {turned.x[lane], turned.y[lane], turned.z[lane], turned.w[lane]};
        narrowed.x[lane] = static_cast<float>(turned.x[lane]);
        narrowed.y[lane] = static_cast<float>(turned.y[lane]);
        narrowed.z[lane] = static_cast<float>(turned.z[lane]);
        narrowed.w[lane] = static_cast<float>(turned.w[lane]);
    }
}

/// Rotates the world inverse inertia to the new orientation.
inline void turn_inertia(const BodyArrays& arrays, std::int32_t first, const Turns<float>& turns)
{
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        const RowIndex<BodyKind::rigid> index(first + lane);
        // Six consecutive floats: the first four and, overlapping them, the last four.
        static_assert(sizeof(Sym3<float>) == 6 * sizeof(float));
        std::int32_t row[Lanes_width];
        for (int i = 0; i < Lanes_width; ++i) row[i] = first + lane + i;
        Lanes low[4], high[4];
        load_quads(&arrays.inverse_inertia->xx, 6, row, low);
        load_quads(&arrays.inverse_inertia->xz, 6, row, high);
        const Sym3<Lanes> body{low[0], low[1], low[2], low[3], high[2], high[3]};
        const Sym3<Lanes> world =
            rotate_tensor(Quat<Lanes>{load_lanes(turns.x + lane), load_lanes(turns.y + lane),
                                      load_lanes(turns.z + lane), load_lanes(turns.w + lane)},
                          body);
        for (float* tensors : {arrays.world_inverse_inertia, arrays.start_inverse_inertia}) {
            store_tensor(tensors, index.offsets, world, index.count);
        }
    }
}

/// How far sixteen bodies must be moved back after free flight, in m per m/s2 of acceleration (s2): see Flight.
/// `first` is a multiple of sixteen.
template <BodyKind kind>
void find_excess(const KernelContext& context, const BodyArrays& arrays, std::int32_t first,
                 float (&excess)[block_lanes])
{
    const Lanes of_flight(context.step.flight_excess), seconds(context.step.seconds);
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        const RowIndex<kind> index(first + lane);
        const Along along = along_acceleration<kind>(context, arrays, index);
        const Lanes start = load_lanes(arrays.start_along + first + lane);
        const auto is_free = flew_freely(start, along.v_a, seconds * along.a_a);
        store_lanes(select(is_free, of_flight, Lanes(0)), excess + lane);
    }
    for (int lane = 0; lane < block_lanes; ++lane)
        excess[lane] = arrays.is_jointed[first + lane] != 0 ? 0 : excess[lane];
}

template <BodyKind kind>
bool commit(const KernelContext& context, std::int32_t first)
{
    constexpr std::int64_t floats = std::int64_t{4} * quads_of(kind);
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    float* delta = arrays.delta + floats * first;
    if (!can_commit<kind>(arrays.velocity + floats * first, delta)) return false;
    BodyPose* pose = arrays.pose + first;
    alignas(64) float excess[block_lanes];
    find_excess<kind>(context, arrays, first, excess);
    constexpr bool turns_in_plane = kind == BodyKind::planar;
    const Vec3<float>& g = context.step.gravity;
    const FloatQuad gravity{g.x, g.y, turns_in_plane ? 0 : g.z, 0};
    // A planar body does not move along z, and the others have no yaw. Adding -0 there leaves every number as it is,
    // even -0.
    const PoseQuad nothing{-PoseReal(0), -PoseReal(0), -PoseReal(0), -PoseReal(0)};
    static_assert(sizeof(BodyPose) == sizeof(PoseQuad));
    for (int lane = 0; lane < block_lanes; ++lane) {
        const FloatQuad moved = *reinterpret_cast<const FloatQuad*>(delta + floats * lane);
        const FloatQuad a =
            *reinterpret_cast<const FloatQuad*>(arrays.acceleration + floats * (first + lane));
        const FloatQuad back = excess[lane] * (a + gravity);
        const PoseQuad by =
            __builtin_convertvector(moved, PoseQuad) - __builtin_convertvector(back, PoseQuad);
        auto& to = *reinterpret_cast<PoseQuad*>(&pose[lane].position.x);
        if constexpr (turns_in_plane) {
            to += __builtin_shufflevector(by, nothing, 0, 1, 4, 2);
        } else {
            to += __builtin_shufflevector(by, nothing, 0, 1, 2, 4);
        }
    }
    if constexpr (kind == BodyKind::rigid) {
        Turns<float> turns;
        turn(delta, arrays.orientation + first, turns);
        turn_inertia(arrays, first, turns);
    }
    for (int lane = 0; lane < block_lanes; ++lane) {
        float* d = delta + floats * lane;
        d[0] = d[1] = d[2] = 0;
        if constexpr (kind == BodyKind::rigid) {
            d[4] = d[5] = d[6] = 0;
            d[7] = 1;
        }
    }
    return true;
}
