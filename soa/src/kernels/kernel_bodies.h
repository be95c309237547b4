// Loads bodies into lanes and stores them. Included inside an anonymous namespace, after Lanes. The build inlines
// everything here: a call that is not inlined would pass sixteen-lane vectors through memory. Fields of a loaded body
// that a kernel does not use are never fetched: the compiler drops loads without a reader.
#pragma once

template <BodyKind kind>
using Body = LaneBody<Lanes, kind>;

/// Four consecutive numbers of a pose, in one register where there is one that wide.
using PoseQuad [[gnu::vector_size(4 * sizeof(PoseReal)), gnu::aligned(sizeof(PoseReal)), gnu::may_alias]] =
    PoseReal;
using FloatQuad [[gnu::vector_size(4 * sizeof(float)), gnu::may_alias]] = float;

/// The row of a body from its offset.
inline std::int32_t row_of(const BodyArrays& arrays, std::int32_t offset)
{
    constexpr std::int32_t in_plane = offsets_a_row(BodyKind::planar),
                           in_space = offsets_a_row(BodyKind::rigid);
    static_assert(in_plane == offsets_a_row(BodyKind::particle) &&
                  in_space == offsets_a_row(BodyKind::fixed));
    return arrays.kind <= BodyKind::planar ? offset / in_plane : offset / in_space;
}

/// The same pointer, of which the compiler does not know that it has read from it before: it then reads offsets again
/// rather than keep sixteen of them, for which there are no registers.
[[gnu::always_inline]] inline const std::int32_t* read_again(const std::int32_t* offsets)
{
    asm("" : "+r"(offsets));
    return offsets;
}

[[gnu::always_inline]] inline Body<BodyKind::particle> load_body(const BodyArrays& arrays,
                                                                 const std::int32_t* offsets,
                                                                 Body<BodyKind::particle>*)
{
    Lanes v[4], d[4];
    load_quads(arrays.velocity, offset_floats, offsets, v);
    load_quads(arrays.delta, offset_floats, offsets, d);
    return {{v[0], v[1], v[2]}, v[3], {d[0], d[1], d[2]}};
}

[[gnu::always_inline]] inline Body<BodyKind::planar> load_body(const BodyArrays& arrays,
                                                               const std::int32_t* offsets,
                                                               Body<BodyKind::planar>*)
{
    Lanes v[4], d[4];
    load_quads(arrays.velocity, offset_floats, offsets, v);
    load_quads(arrays.delta, offset_floats, read_again(offsets), d);
    return {{v[0], v[1]}, v[2], v[3], {d[0], d[1]}, d[2], d[3]};
}

[[gnu::always_inline]] inline Sym3<Lanes> load_tensor(const float* tensors, const std::int32_t* offsets)
{
    Lanes i[4], j[4];
    load_quads(tensors, offset_floats, offsets, i);
    load_quads(tensors + 4, offset_floats, offsets, j);
    return {i[0], i[1], i[2], i[3], j[0], j[1]};
}

[[gnu::always_inline]] inline Body<BodyKind::rigid> load_body(const BodyArrays& arrays,
                                                              const std::int32_t* offsets,
                                                              Body<BodyKind::rigid>*)
{
    Lanes v[4], w[4], d[4], q[4];
    load_quads(arrays.velocity, offset_floats, offsets, v);
    load_quads(arrays.velocity + 4, offset_floats, offsets, w);
    load_quads(arrays.delta, offset_floats, offsets, d);
    load_quads(arrays.delta + 4, offset_floats, offsets, q);
    return {{v[0], v[1], v[2]},       v[3],
            {w[0], w[1], w[2]},       {d[0], d[1], d[2]},
            {q[0], q[1], q[2], q[3]}, load_tensor(arrays.world_inverse_inertia, offsets)};
}

[[gnu::always_inline]] inline Body<BodyKind::fixed> load_body(const BodyArrays& arrays,
                                                              const std::int32_t* offsets,
                                                              Body<BodyKind::fixed>*)
{
    Lanes v[4], w[4], d[4], q[4];
    load_quads(arrays.velocity, offset_floats, offsets, v);
    load_quads(arrays.velocity + 4, offset_floats, offsets, w);
    load_quads(arrays.delta, offset_floats, offsets, d);
    load_quads(arrays.delta + 4, offset_floats, offsets, q);
    return {{v[0], v[1], v[2]}, {w[0], w[1], w[2]}, {d[0], d[1], d[2]}, {q[0], q[1], q[2], q[3]}};
}

/// Not inlined, as all that depends on the kind while a kernel runs: few constraints are of such pairs.
[[gnu::noinline]] inline Body<any_kind> load_body(const BodyArrays& arrays, const std::int32_t* offsets,
                                                  Body<any_kind>*)
{
    return with_kind<Kinds::all>(arrays.kind, [&](auto kind) {
        return as_any(load_body(arrays, offsets, static_cast<Body<kind()>*>(nullptr)));
    });
}

[[gnu::always_inline]] inline void store_velocity(float* rows, const std::int32_t* offsets,
                                                  const Body<BodyKind::particle>& body, int count)
{
    store_quads(rows, offset_floats, offsets,
                {body.linear.x, body.linear.y, body.linear.z, body.inverse_mass}, count);
}
[[gnu::always_inline]] inline void store_velocity(float* rows, const std::int32_t* offsets,
                                                  const Body<BodyKind::planar>& body, int count)
{
    store_quads(rows, offset_floats, offsets,
                {body.linear.x, body.linear.y, body.yaw_rate, body.inverse_mass}, count);
}
[[gnu::always_inline]] inline void store_velocity(float* rows, const std::int32_t* offsets,
                                                  const Body<BodyKind::rigid>& body, int count)
{
    store_quads(rows, offset_floats, offsets,
                {body.linear.x, body.linear.y, body.linear.z, body.inverse_mass}, count);
    store_quads(rows + 4, offset_floats, offsets, {body.angular.x, body.angular.y, body.angular.z, Lanes(0)},
                count);
}
/// Fixed bodies are read by many constraints and never written.
[[gnu::always_inline]] inline void store_velocity(float*, const std::int32_t*, const Body<BodyKind::fixed>&,
                                                  int)
{
}
[[gnu::noinline]] inline void store_velocity(float* rows, const std::int32_t* offsets,
                                             const Body<any_kind>& any, int count)
{
    look_at<Kinds::all>(any, [&](const auto& body) { store_velocity(rows, offsets, body, count); });
}
template <class Body>
[[gnu::always_inline]] inline void store_velocity(const BodyArrays& arrays, const std::int32_t* offsets,
                                                  const Body& body, int count)
{
    store_velocity(arrays.velocity, offsets, body, count);
}

[[gnu::always_inline]] inline void store_tensor(float* tensors, const std::int32_t* offsets,
                                                const Sym3<Lanes>& i, int count)
{
    store_quads(tensors, offset_floats, offsets, {i.xx, i.xy, i.xz, i.yy}, count);
    store_quads(tensors + 4, offset_floats, offsets, {i.yz, i.zz, Lanes(0), Lanes(0)}, count);
}

/// Stores the displacement, and the inertia that rotates with it.
[[gnu::always_inline]] inline void store_delta(const BodyArrays& arrays, const std::int32_t* offsets,
                                               const Body<BodyKind::particle>& body, int count)
{
    store_quads(arrays.delta, offset_floats, offsets, {body.delta.x, body.delta.y, body.delta.z, Lanes(0)},
                count);
}
[[gnu::always_inline]] inline void store_delta(const BodyArrays& arrays, const std::int32_t* offsets,
                                               const Body<BodyKind::planar>& body, int count)
{
    store_quads(arrays.delta, offset_floats, offsets,
                {body.delta.x, body.delta.y, body.delta_yaw, body.inverse_inertia}, count);
}
[[gnu::always_inline]] inline void store_delta(const BodyArrays& arrays, const std::int32_t* offsets,
                                               const Body<BodyKind::rigid>& body, int count)
{
    const Quat<Lanes>& q = body.delta_rotation;
    store_quads(arrays.delta, offset_floats, offsets, {body.delta.x, body.delta.y, body.delta.z, Lanes(0)},
                count);
    store_quads(arrays.delta + 4, offset_floats, offsets, {q.x, q.y, q.z, q.w}, count);
    store_tensor(arrays.world_inverse_inertia, offsets, body.inverse_inertia, count);
}
[[gnu::always_inline]] inline void store_delta(const BodyArrays&, const std::int32_t*,
                                               const Body<BodyKind::fixed>&, int)
{
}

/// Calls change(component of `body`, component of `other`) for each component of velocity.
template <class Body, class Change>
void for_each_component(Body& body, const Body& other, const Change& change)
{
    change(body.linear.x, other.linear.x);
    change(body.linear.y, other.linear.y);
    if constexpr (Body::kind != BodyKind::planar) change(body.linear.z, other.linear.z);
    if constexpr (Body::kind == BodyKind::planar) change(body.yaw_rate, other.yaw_rate);
    if constexpr (Body::kind == BodyKind::rigid) {
        change(body.angular.x, other.angular.x);
        change(body.angular.y, other.angular.y);
        change(body.angular.z, other.angular.z);
    }
}

/// Loads a body that is kept in lanes. A fixed one is kept with the fields of a rigid one.
template <BodyKind kind>
[[gnu::always_inline]] inline Body<kind> load_copy(const float* lanes)
{
    if constexpr (kind == BodyKind::fixed) {
        const auto body = load_row<Body<BodyKind::rigid>>(lanes);
        return {body.linear, body.angular, body.delta, body.delta_rotation};
    } else {
        return load_row<Body<kind>>(lanes);
    }
}
/// Stores the velocity of a body that is kept in lanes, as fields of sixteen consecutive floats.
[[gnu::always_inline]] inline void store_copy_velocity(const Body<BodyKind::rigid>& body, float* lanes)
{
    store_row(body.linear, lanes);
    store_row(body.angular, lanes + 4 * block_lanes);
}
[[gnu::always_inline]] inline void store_copy_inertia(const Body<BodyKind::rigid>& body, float* lanes)
{
    store_row(body.inverse_inertia, lanes + CopyBody::inverse_inertia * block_lanes);
    store_row(body.inverse_inertia, lanes + CopyBody::start_inertia * block_lanes);
}
/// The acceleration of a body by forces and gravity, m/s2; 0 for a body that cannot move.
template <BodyKind kind>
Vec3<Lanes> free_acceleration(const StepConstants& step, const BodyArrays& arrays,
                              const std::int32_t* offsets, const Body<kind>& body)
{
    const Lanes zero(0);
    if constexpr (kind == any_kind) {
        return look_at<Kinds::all>(
            body, [&](const auto& own) { return free_acceleration(step, arrays, offsets, own); });
    } else if constexpr (kind == BodyKind::fixed) {
        return {zero, zero, zero};
    } else {
        Lanes a[4];
        load_quads(arrays.acceleration, offset_floats, offsets, a);
        const auto moves = body.inverse_mass > zero;
        const Vec3<float>& g = step.gravity;
        const Lanes z = kind == BodyKind::planar ? zero : a[2] + Lanes(g.z);
        return {select(moves, a[0] + Lanes(g.x), zero), select(moves, a[1] + Lanes(g.y), zero),
                select(moves, z, zero)};
    }
}

/// After a body has turned: says so where it may have changed the responses of contacts.
inline void tell_contacts(const Body<BodyKind::rigid>& body, const BodyArrays& arrays)
{
    if (arrays.turned_far == nullptr || arrays.turned_far->load(std::memory_order_relaxed)) return;
    if (any(change_at_most(body) > Lanes(most_change)))
        arrays.turned_far->store(true, std::memory_order_relaxed);
}
