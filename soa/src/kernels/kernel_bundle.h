// A bundle: as many constraints of a block as the instruction set computes at once. This file says where its lanes
// are in memory, and loads and stores tables, poses and bodies. Nothing here depends on the type of the constraint.
// Functions that run outside the sweeps, or rarely within them, are not inlined, so that all types share one copy.
// Included inside an anonymous namespace, after kernel_bodies.h.
#pragma once

/// Where the velocities of one side (body a or b) are stored: in the rows of the bodies, or in a row that nothing
/// reads. A joint's kernel for rigid bodies also serves fixed ones, whose rows have the same shape and no inverse
/// mass. Many constraints share a fixed body, on several threads, so its row is never written. There is no branch,
/// because compilers move arithmetic behind it and its operands into memory, which costs a fifth of a sweep.
struct VelocitiesOut {
    float* rows;
    const std::int32_t* offsets;
};
/// A row that is written in place of a fixed body and never read.
struct Nowhere {
    alignas(64) float row[8];
    static constexpr std::int32_t offsets[block_lanes] = {};
};

/// One bundle of a block: its bodies, and where its lanes lie in the streams.
template <BodyKind kind_a, BodyKind kind_b>
struct ConstraintBundle {
    const BodyArrays& arrays_a;
    const BodyArrays& arrays_b;
    const std::int32_t* offsets_a;
    const std::int32_t* offsets_b;
    const std::int32_t* constraint;
    float* row;
    float* substep;
    float* impulse;
    float* sum;  ///< null where nothing is summed
    int count;   ///< lanes of this bundle that are not padding
    int lane;    ///< of the block, at which the bundle begins
    [[nodiscard]] Body<kind_a> load_a() const
    {
        return load_body(arrays_a, offsets_a, static_cast<Body<kind_a>*>(nullptr));
    }
    [[nodiscard]] Body<kind_b> load_b() const
    {
        return load_body(arrays_b, offsets_b, static_cast<Body<kind_b>*>(nullptr));
    }
    VelocitiesOut out_a, out_b;
    void store_velocities(const Body<kind_a>& a, const Body<kind_b>& b) const
    {
        // One branch for both bodies: no value has to survive the call that stores a bundle with padding.
        if (count >= Lanes_width) [[likely]] {
            store_velocity(out_a.rows, out_a.offsets, a, Lanes_width);
            store_velocity(out_b.rows, out_b.offsets, b, Lanes_width);
        } else {
            store_velocity(out_a.rows, out_a.offsets, a, count);
            store_velocity(out_b.rows, out_b.offsets, b, count);
        }
    }
};

// ---- tables, one entry per lane ---------------------------------------------------------------------------------

/// Loads the first `quads` quads (four floats each) of one table entry per lane, as fields of Lanes_width consecutive
/// floats.
[[gnu::noinline]] inline void gather_quads(const float* table, std::int64_t stride, const std::int32_t* index,
                                           int quads, float* fields)
{
    for (int q = 0; q < quads; ++q) {
        Lanes quad[4];
        load_quads(table + 4 * q, stride, index, quad);
        for (int i = 0; i < 4; ++i) store_lanes(quad[i], fields + (4 * q + i) * Lanes_width);
    }
}
/// The reverse. Impulses that are not finite are stored as 0: a contained body must not spoil the step that revives
/// it. Given `present`, only lanes in which it is above 0 are stored.
[[gnu::noinline]] inline void scatter_finite_quads(const float* fields, int quads, float* table,
                                                   std::int64_t stride, const std::int32_t* index, int count,
                                                   const float* present)
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

/// Space for a struct of lanes as whole quads.
template <class Struct>
struct QuadBuffer {
    static constexpr int quads = (fields_of<Struct> + 3) / 4;
    alignas(64) float fields[4 * quads * Lanes_width];
};
/// Entries of a table of structs, turned into a struct of lanes.
template <class Struct>
Struct gather_struct(const float* table, std::int64_t stride, const std::int32_t* index)
{
    QuadBuffer<Struct> buffer;
    gather_quads(table, stride, index, buffer.quads, buffer.fields);
    Struct result;
    Lanes* fields = reinterpret_cast<Lanes*>(&result);
    for (int i = 0; i < fields_of<Struct>; ++i) fields[i] = load_lanes(buffer.fields + i * Lanes_width);
    return result;
}
template <class Struct>
void scatter_finite(const Struct& value, float* table, std::int64_t stride, const std::int32_t* index,
                    int count, const float* present = nullptr)
{
    QuadBuffer<Struct> buffer;
    const Lanes* fields = reinterpret_cast<const Lanes*>(&value);
    for (int i = 0; i < 4 * buffer.quads; ++i) {
        store_lanes(i < fields_of<Struct> ? fields[i] : Lanes(0), buffer.fields + i * Lanes_width);
    }
    scatter_finite_quads(buffer.fields, buffer.quads, table, stride, index, count, present);
}

// ---- positions when a step begins: subtracted in the precision of poses, then narrowed, one body at a time -------

/// Position minus point, narrowed to float one lane at a time.
template <BodyKind kind, class Point>
Vec3<Lanes> from_points(const BodyArrays& arrays, const std::int32_t* offsets, const Point& point_of)
{
    alignas(64) float x[Lanes_width], y[Lanes_width], z[Lanes_width];
    for (int lane = 0; lane < Lanes_width; ++lane) {
        const Vec3<PoseReal>& at = arrays.pose[offsets[lane] / offsets_a_row(kind)].position;
        const Vec3<double>& point = point_of(lane);
        x[lane] = static_cast<float>(static_cast<double>(at.x) - point.x);
        y[lane] = static_cast<float>(static_cast<double>(at.y) - point.y);
        z[lane] = static_cast<float>(static_cast<double>(at.z) - point.z);
    }
    return {load_lanes(x), load_lanes(y), load_lanes(z)};
}

/// Four consecutive numbers of a pose, in one register where there is one that wide.
using PoseQuad [[gnu::vector_size(4 * sizeof(PoseReal)), gnu::aligned(sizeof(PoseReal)), gnu::may_alias]] =
    PoseReal;
using FloatQuad [[gnu::vector_size(4 * sizeof(float)), gnu::may_alias]] = float;

inline const PoseQuad& quad_at(const PoseReal& first)
{
    return *reinterpret_cast<const PoseQuad*>(&first);
}

/// quad_of(lane) of every lane, narrowed to float: out[i] holds number i of each.
template <class QuadOf>
[[gnu::always_inline]] inline void narrow_quads(const QuadOf& quad_of, Lanes (&out)[4])
{
    alignas(64) float narrow[Lanes_width][4];
    std::int32_t index[Lanes_width];
    for (int lane = 0; lane < Lanes_width; ++lane) {
        *reinterpret_cast<FloatQuad*>(narrow[lane]) = __builtin_convertvector(quad_of(lane), FloatQuad);
        index[lane] = lane;
    }
    load_quads(narrow[0], 4, index, out);
}

template <BodyKind kind_a, BodyKind kind_b>
[[gnu::noinline]] Vec3<Lanes> between_bodies(const BodyArrays& a, const std::int32_t* offsets_a,
                                             const BodyArrays& b, const std::int32_t* offsets_b)
{
    static_assert(sizeof(BodyPose) == sizeof(PoseQuad));
    Lanes between[4];
    narrow_quads(
        [&](int lane) {
            return quad_at(b.pose[offsets_b[lane] / offsets_a_row(kind_b)].position.x) -
                   quad_at(a.pose[offsets_a[lane] / offsets_a_row(kind_a)].position.x);
        },
        between);
    return {between[0], between[1], between[2]};
}

/// `turns` rounded to the nearest whole number, halves away from 0. From 2^52 on every double is whole already, and
/// from 2^63 on none can be converted: a yaw so large (of a file, or of a body that spins beyond all measure) and NaN
/// give 2^52, which leaves them to be contained.
[[gnu::always_inline]] inline double nearest_whole(double turns)
{
    constexpr double most = 4503599627370496;
    const double within = turns > -most ? (turns < most ? turns : most) : -most;
    return static_cast<double>(static_cast<long long>(within < 0 ? within - 0.5 : within + 0.5));
}

template <BodyKind kind>
[[gnu::noinline]] Orientation<Lanes, kind> load_orientation(const BodyArrays& arrays,
                                                            const std::int32_t* offsets)
{
    if constexpr (kind == BodyKind::particle) {
        return {};
    } else if constexpr (kind == BodyKind::planar) {
        alignas(64) float yaw[Lanes_width];
        for (int lane = 0; lane < Lanes_width; ++lane) {
            const auto angle = static_cast<double>(arrays.pose[offsets[lane] / offsets_a_row(kind)].yaw);
            yaw[lane] =
                static_cast<float>(angle - nearest_whole(angle * 0.15915494309189535) * 6.283185307179586);
        }
        return {load_lanes(yaw)};
    } else {
        static_assert(sizeof(Quat<PoseReal>) == sizeof(PoseQuad));
        Lanes q[4];
        narrow_quads(
            [&](int lane) { return quad_at(arrays.orientation[offsets[lane] / offsets_a_row(kind)].x); }, q);
        return {{q[0], q[1], q[2], q[3]}};
    }
}

// ---- what is rare in a sweep -----------------------------------------------------------------------------------

/// Prefetches the bodies of a block, which are scattered in memory. Its streams are consecutive: the hardware
/// prefetches them.
template <BodyKind kind_a, BodyKind kind_b, bool delta>
[[gnu::noinline]] void prefetch_bodies_of(const BodyArrays& a, const BodyArrays& b, const BlockBodies& bodies)
{
    prefetch_bodies<kind_a, delta>(a, bodies.a);
    prefetch_bodies<kind_b, delta>(b, bodies.b);
}

/// Stores a changed inertia for this step. Runs when the step begins, so nothing has rotated yet and both tensors are
/// equal.
template <BodyKind kind>
[[gnu::noinline]] void store_inertia(const BodyArrays& arrays, const std::int32_t* offsets,
                                     const Body<kind>& body, int count)
{
    if (!arrays.can_move) return;
    if constexpr (kind == BodyKind::planar) store_delta(arrays, offsets, body, count);
    if constexpr (kind == BodyKind::rigid) {
        for (float* tensors : {arrays.world_inverse_inertia, arrays.start_inverse_inertia})
            store_tensor(tensors, offsets, body.inverse_inertia, count);
    }
}

/// Stores the result of a position solve. Inertia and angular velocity rotate with the body, so that moving it takes no
/// energy from it and gives it none, and so that an inertia that rotate_again() kept stays close to that of the rows.
template <BodyKind kind>
[[gnu::noinline]] void store_displaced(const BodyArrays& arrays, const std::int32_t* offsets,
                                       const Body<kind>& displaced, int count)
{
    if (!arrays.can_move) return;
    Body<kind> body = displaced;
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
