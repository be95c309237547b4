// What the kernels of all constraint types call, for one instruction set: see kernel_entries.h.
#include "kernels/kernel_prelude.h"

namespace motley {
namespace {

#include MOTLEY_LANES
#include "kernels/kernel_rows.h"

#include "kernels/kernel_bodies.h"

const PoseQuad& quad_at(const PoseReal& first)
{
    return *reinterpret_cast<const PoseQuad*>(&first);
}

/// quad_of(lane) of every lane, narrowed to float: number i of each is field i.
template <class QuadOf>
void narrow_quads(const QuadOf& quad_of, int fields, float* out)
{
    alignas(64) float narrow[Lanes_width][4];
    std::int32_t index[Lanes_width];
    for (int lane = 0; lane < Lanes_width; ++lane) {
        *reinterpret_cast<FloatQuad*>(narrow[lane]) = __builtin_convertvector(quad_of(lane), FloatQuad);
        index[lane] = lane;
    }
    Lanes quad[4];
    load_quads(narrow[0], 4, index, quad);
    for (int i = 0; i < fields; ++i) store_lanes(quad[i], out + i * Lanes_width);
}

/// `turns` rounded to the nearest whole number, halves away from 0. From 2^52 on every double is whole already, and
/// from 2^63 on none can be converted: a yaw so large (of a file, or of a body that spins beyond all measure) and NaN
/// give 2^52, which leaves them to be contained.
double nearest_whole(double turns)
{
    constexpr double most = 4503599627370496;
    const double within = turns > -most ? (turns < most ? turns : most) : -most;
    return static_cast<double>(static_cast<long long>(within < 0 ? within - 0.5 : within + 0.5));
}

template <BodyKind kind>
void displace_rows(const BodyArrays& arrays, const std::int32_t* offsets, const float* fields, int count)
{
    auto body = *reinterpret_cast<const Body<kind>*>(fields);
    if constexpr (kind == BodyKind::rigid) {
        Lanes q[4];
        load_quads(arrays.delta + 4, offset_floats, offsets, q);
        const Quat<Lanes> turn = body.delta_rotation * Quat<Lanes>{-q[0], -q[1], -q[2], q[3]};
        body.inverse_inertia = rotate_tensor(turn, body.inverse_inertia);
        tell_contacts(body, arrays);
        const Vec3<Lanes> w = rotate(turn, body.angular);
        store_quads(arrays.velocity + 4, offset_floats, offsets, {w.x, w.y, w.z, Lanes(0)}, count);
    }
    store_delta(arrays, offsets, body, count);
}

}  // namespace

template <>
void gather_quads<Isa::MOTLEY_ISA>(const float* table, std::int64_t stride, const std::int32_t* index,
                                   int quads, float* fields)
{
    for (int q = 0; q < quads; ++q) {
        Lanes quad[4];
        load_quads(table + 4 * q, stride, index, quad);
        for (int i = 0; i < 4; ++i) store_lanes(quad[i], fields + (4 * q + i) * Lanes_width);
    }
}

template <>
void scatter_finite_quads<Isa::MOTLEY_ISA>(const float* fields, int quads, float* table, std::int64_t stride,
                                           const std::int32_t* index, int count, const float* present)
{
    for (int q = 0; q < quads; ++q) {
        Lanes quad[4];
        for (int i = 0; i < 4; ++i) {
            const Lanes value = load_lanes(fields + (4 * q + i) * Lanes_width);
            quad[i] = select(absolute(value) < Lanes(1e30F), value, Lanes(0));
        }
        if (present == nullptr) {
            store_quads(table + 4 * q, stride, index, quad, count);
            continue;
        }
        alignas(64) float lanes[4][Lanes_width];
        for (int i = 0; i < 4; ++i) store_lanes(quad[i], lanes[i]);
        for (int lane = 0; lane < std::min(count, Lanes_width); ++lane) {
            if (!(present[lane] > 0)) continue;
            for (int i = 0; i < 4; ++i) table[4 * q + stride * index[lane] + i] = lanes[i][lane];
        }
    }
}

template <>
void find_between<Isa::MOTLEY_ISA>(const BodyArrays& a, const std::int32_t* offsets_a, const BodyArrays& b,
                                   const std::int32_t* offsets_b, float* between)
{
    static_assert(sizeof(BodyPose) == sizeof(PoseQuad));
    const auto place = [](const BodyArrays& arrays, std::int32_t offset) {
        return quad_at(arrays.pose[row_of(arrays, offset)].position.x);
    };
    narrow_quads([&](int lane) { return place(b, offsets_b[lane]) - place(a, offsets_a[lane]); }, 3, between);
}

template <>
void load_yaws<Isa::MOTLEY_ISA>(const BodyArrays& arrays, const std::int32_t* offsets, float* yaws)
{
    for (int lane = 0; lane < Lanes_width; ++lane) {
        const auto angle = static_cast<double>(arrays.pose[row_of(arrays, offsets[lane])].yaw);
        yaws[lane] =
            static_cast<float>(angle - nearest_whole(angle * 0.15915494309189535) * 6.283185307179586);
    }
}

template <>
void load_rotations<Isa::MOTLEY_ISA>(const BodyArrays& arrays, const std::int32_t* offsets, float* rotations)
{
    static_assert(sizeof(Quat<PoseReal>) == sizeof(PoseQuad));
    narrow_quads([&](int lane) { return quad_at(arrays.orientation[row_of(arrays, offsets[lane])].x); }, 4,
                 rotations);
}

template <>
void store_inertia_of<Isa::MOTLEY_ISA>(const BodyArrays& arrays, const std::int32_t* offsets,
                                       const float* fields, int count)
{
    if (arrays.kind == BodyKind::planar)
        store_delta(arrays, offsets, *reinterpret_cast<const Body<BodyKind::planar>*>(fields), count);
    if (arrays.kind == BodyKind::rigid) {
        const auto& body = *reinterpret_cast<const Body<BodyKind::rigid>*>(fields);
        for (float* tensors : {arrays.world_inverse_inertia, arrays.start_inverse_inertia})
            store_tensor(tensors, offsets, body.inverse_inertia, count);
    }
}

template <>
void store_displaced_of<Isa::MOTLEY_ISA>(const BodyArrays& arrays, const std::int32_t* offsets,
                                         const float* fields, int count)
{
    if (arrays.kind == BodyKind::particle) displace_rows<BodyKind::particle>(arrays, offsets, fields, count);
    if (arrays.kind == BodyKind::planar) displace_rows<BodyKind::planar>(arrays, offsets, fields, count);
    if (arrays.kind == BodyKind::rigid) displace_rows<BodyKind::rigid>(arrays, offsets, fields, count);
}

template <>
void load_block<Isa::MOTLEY_ISA>(const KernelContext& context, const BlockStreams& streams,
                                 std::int64_t block, BlockCopies& bodies)
{
    const auto load = [&](BodyKind kind, const std::int32_t* offsets, float* lanes) {
        const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
        for (int lane = 0; lane < streams.counts[block]; lane += Lanes_width)
            store_row(load_body(arrays, offsets + lane, static_cast<Body<BodyKind::rigid>*>(nullptr)),
                      lanes + lane);
    };
    static_assert(fields_of<Body<BodyKind::rigid>> <= most_body_floats);
    load(streams.kind_a, streams.bodies[block].a, bodies.a);
    load(streams.kind_b, streams.bodies[block].b, bodies.b);
}

template <>
void store_block_velocities<Isa::MOTLEY_ISA>(const KernelContext& context, const BlockStreams& streams,
                                             std::int64_t block, const BlockCopies& bodies)
{
    const int count = streams.counts[block];
    const auto store = [&](BodyKind kind, const std::int32_t* offsets, const float* lanes) {
        const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
        if (!arrays.can_move) return;
        for (int lane = 0; lane < count; lane += Lanes_width)
            store_velocity(arrays, offsets + lane, load_row<Body<BodyKind::rigid>>(lanes + lane),
                           count - lane);
    };
    store(streams.kind_a, streams.bodies[block].a, bodies.a);
    store(streams.kind_b, streams.bodies[block].b, bodies.b);
}

}  // namespace motley
