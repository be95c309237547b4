// A bundle: as many constraints of a block as the instruction set computes at once. This file says where its lanes
// are in memory, and loads and stores tables, poses and bodies. Nothing here depends on the type of the constraint.
// What runs outside the sweeps, or rarely within them, is called, so that all types share one copy of it: see
// bundle_kernels.cpp. Included inside an anonymous namespace, after kernel_bodies.h.
#pragma once

inline constexpr Isa isa_here = Isa::MOTLEY_ISA;

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
    gather_quads<isa_here>(table, stride, index, buffer.quads, buffer.fields);
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
    scatter_finite_quads<isa_here>(buffer.fields, buffer.quads, table, stride, index, count, present);
}

// ---- poses when a step begins -----------------------------------------------------------------------------------

/// Position minus point, subtracted in double and narrowed to float one lane at a time.
template <class Point>
Vec3<Lanes> from_points(const BodyArrays& arrays, const std::int32_t* offsets, const Point& point_of)
{
    alignas(64) float x[Lanes_width], y[Lanes_width], z[Lanes_width];
    for (int lane = 0; lane < Lanes_width; ++lane) {
        const Vec3<PoseReal>& at = arrays.pose[row_of(arrays, offsets[lane])].position;
        const Vec3<double>& point = point_of(lane);
        x[lane] = static_cast<float>(static_cast<double>(at.x) - point.x);
        y[lane] = static_cast<float>(static_cast<double>(at.y) - point.y);
        z[lane] = static_cast<float>(static_cast<double>(at.z) - point.z);
    }
    return {load_lanes(x), load_lanes(y), load_lanes(z)};
}

/// x_b - x_a.
inline Vec3<Lanes> between_bodies(const BodyArrays& a, const std::int32_t* offsets_a, const BodyArrays& b,
                                  const std::int32_t* offsets_b)
{
    alignas(64) float fields[3][Lanes_width];
    find_between<isa_here>(a, offsets_a, b, offsets_b, fields[0]);
    return {load_lanes(fields[0]), load_lanes(fields[1]), load_lanes(fields[2])};
}

template <BodyKind kind>
Orientation<Lanes, kind> load_orientation(const BodyArrays& arrays, const std::int32_t* offsets)
{
    if constexpr (kind == BodyKind::particle) {
        return {};
    } else {
        alignas(64) float fields[4][Lanes_width];
        if constexpr (kind == BodyKind::planar) {
            load_yaws<isa_here>(arrays, offsets, fields[0]);
            return {load_lanes(fields[0])};
        } else {
            load_rotations<isa_here>(arrays, offsets, fields[0]);
            return {
                {load_lanes(fields[0]), load_lanes(fields[1]), load_lanes(fields[2]), load_lanes(fields[3])}};
        }
    }
}
template <>
inline Orientation<Lanes, any_kind> load_orientation(const BodyArrays& arrays, const std::int32_t* offsets)
{
    const Lanes zero(0);
    Orientation<Lanes, any_kind> any{arrays.kind, zero, {zero, zero, zero, zero}};
    if (any.own_kind == BodyKind::planar) {
        any.yaw = load_orientation<BodyKind::planar>(arrays, offsets).yaw;
    } else if (any.own_kind != BodyKind::particle) {
        any.rotation = load_orientation<BodyKind::rigid>(arrays, offsets).rotation;
    }
    return any;
}

// ---- what is rare in a sweep -----------------------------------------------------------------------------------

/// Calls store(the body's fields), as one of its own kind, unless the body cannot move. A fixed body may be computed as one of
/// another kind.
template <BodyKind kind, class Store>
void if_it_moves(const BodyArrays& arrays, const Body<kind>& body, const Store& store)
{
    if (!arrays.can_move) return;
    if constexpr (kind == any_kind) {
        look_at<Kinds::all>(body, [&](const auto& own) { store(reinterpret_cast<const float*>(&own)); });
    } else {
        store(reinterpret_cast<const float*>(&body));
    }
}
template <BodyKind kind>
void store_inertia(const BodyArrays& arrays, const std::int32_t* offsets, const Body<kind>& body, int count)
{
    if_it_moves<kind>(arrays, body, [&](const float* fields) {
        store_inertia_of<isa_here>(arrays, offsets, fields, count);
    });
}
template <BodyKind kind>
void store_displaced(const BodyArrays& arrays, const std::int32_t* offsets, const Body<kind>& body, int count)
{
    if_it_moves<kind>(arrays, body, [&](const float* fields) {
        store_displaced_of<isa_here>(arrays, offsets, fields, count);
    });
}
