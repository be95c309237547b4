// Bodies in and out of lanes, and their integration. Included inside an anonymous namespace, after Lanes.
// The build inlines everything here: a call that stays a call would pass sixteen-lane vectors through memory.
// What a kernel does not use of a loaded body is never fetched: the compiler drops loads without a reader.

template <BodyKind kind>
using Body = LaneBody<Lanes, kind>;

[[gnu::always_inline]] inline Body<BodyKind::particle> load_body(const BodyArrays& arrays,
                                                                 const std::int32_t* rows,
                                                                 Body<BodyKind::particle>*)
{
    Lanes v[4], d[4];
    load_quads(arrays.velocity, 4, rows, v);
    load_quads(arrays.delta, 4, rows, d);
    return {{v[0], v[1], v[2]}, v[3], {d[0], d[1], d[2]}};
}

[[gnu::always_inline]] inline Body<BodyKind::planar> load_body(const BodyArrays& arrays,
                                                               const std::int32_t* rows,
                                                               Body<BodyKind::planar>*)
{
    Lanes v[4], d[4];
    load_quads(arrays.velocity, 4, rows, v);
    load_quads(arrays.delta, 4, rows, d);
    return {{v[0], v[1]}, v[2], v[3], {d[0], d[1]}, d[2], d[3]};
}

[[gnu::always_inline]] inline Sym3<Lanes> load_tensor(const float* tensors, const std::int32_t* rows)
{
    Lanes i[4], j[4];
    load_quads(tensors, 8, rows, i);
    load_quads(tensors + 4, 8, rows, j);
    return {i[0], i[1], i[2], i[3], j[0], j[1]};
}

[[gnu::always_inline]] inline Body<BodyKind::rigid> load_body(const BodyArrays& arrays,
                                                              const std::int32_t* rows,
                                                              Body<BodyKind::rigid>*)
{
    Lanes v[4], w[4], d[4], q[4];
    load_quads(arrays.velocity, 8, rows, v);
    load_quads(arrays.velocity + 4, 8, rows, w);
    load_quads(arrays.delta, 8, rows, d);
    load_quads(arrays.delta + 4, 8, rows, q);
    return {{v[0], v[1], v[2]},       v[3],
            {w[0], w[1], w[2]},       {d[0], d[1], d[2]},
            {q[0], q[1], q[2], q[3]}, load_tensor(arrays.world_inverse_inertia, rows)};
}

[[gnu::always_inline]] inline Body<BodyKind::fixed> load_body(const BodyArrays& arrays,
                                                              const std::int32_t* rows,
                                                              Body<BodyKind::fixed>*)
{
    Lanes v[4], w[4], d[4], q[4];
    load_quads(arrays.velocity, 8, rows, v);
    load_quads(arrays.velocity + 4, 8, rows, w);
    load_quads(arrays.delta, 8, rows, d);
    load_quads(arrays.delta + 4, 8, rows, q);
    return {{v[0], v[1], v[2]}, {w[0], w[1], w[2]}, {d[0], d[1], d[2]}, {q[0], q[1], q[2], q[3]}};
}

[[gnu::always_inline]] inline void store_velocity(const BodyArrays& arrays, const std::int32_t* rows,
                                                  const Body<BodyKind::particle>& body, int count)
{
    store_quads(arrays.velocity, 4, rows, {body.linear.x, body.linear.y, body.linear.z, body.inverse_mass},
                count);
}
[[gnu::always_inline]] inline void store_velocity(const BodyArrays& arrays, const std::int32_t* rows,
                                                  const Body<BodyKind::planar>& body, int count)
{
    store_quads(arrays.velocity, 4, rows, {body.linear.x, body.linear.y, body.yaw_rate, body.inverse_mass},
                count);
}
[[gnu::always_inline]] inline void store_velocity(const BodyArrays& arrays, const std::int32_t* rows,
                                                  const Body<BodyKind::rigid>& body, int count)
{
    store_quads(arrays.velocity, 8, rows, {body.linear.x, body.linear.y, body.linear.z, body.inverse_mass},
                count);
    store_quads(arrays.velocity + 4, 8, rows, {body.angular.x, body.angular.y, body.angular.z, Lanes(0)},
                count);
}
/// What cannot be moved is read by lanes and never written.
[[gnu::always_inline]] inline void store_velocity(const BodyArrays&, const std::int32_t*,
                                                  const Body<BodyKind::fixed>&, int)
{
}

[[gnu::always_inline]] inline void store_delta(const BodyArrays& arrays, const std::int32_t* rows,
                                               const Body<BodyKind::particle>& body, int count)
{
    store_quads(arrays.delta, 4, rows, {body.delta.x, body.delta.y, body.delta.z, Lanes(0)}, count);
}
[[gnu::always_inline]] inline void store_delta(const BodyArrays& arrays, const std::int32_t* rows,
                                               const Body<BodyKind::planar>& body, int count)
{
    store_quads(arrays.delta, 4, rows, {body.delta.x, body.delta.y, body.delta_yaw, body.inverse_inertia},
                count);
}
[[gnu::always_inline]] inline void store_delta(const BodyArrays& arrays, const std::int32_t* rows,
                                               const Body<BodyKind::rigid>& body, int count)
{
    const Quat<Lanes>& q = body.delta_rotation;
    store_quads(arrays.delta, 8, rows, {body.delta.x, body.delta.y, body.delta.z, Lanes(0)}, count);
    store_quads(arrays.delta + 4, 8, rows, {q.x, q.y, q.z, q.w}, count);
    // A turned body has turned inertia.
    const Sym3<Lanes> i = rotate_tensor(q, load_tensor(arrays.start_inverse_inertia, rows));
    store_quads(arrays.world_inverse_inertia, 8, rows, {i.xx, i.xy, i.xz, i.yy}, count);
    store_quads(arrays.world_inverse_inertia + 4, 8, rows, {i.yz, i.zz, Lanes(0), Lanes(0)}, count);
}
[[gnu::always_inline]] inline void store_delta(const BodyArrays&, const std::int32_t*,
                                               const Body<BodyKind::fixed>&, int)
{
}

/// The same of a body that is in lanes already: fields of sixteen floats in line.
[[gnu::always_inline]] inline void store_copy_velocity(const Body<BodyKind::rigid>& body, float* lanes)
{
    store_row(body.linear, lanes);
    store_row(body.angular, lanes + 4 * block_lanes);
}
/// What cannot be moved is never written.
[[gnu::always_inline]] inline void store_copy_velocity(const Body<BodyKind::fixed>&, float*) {}

/// Asks for the rows of a whole block. Fixed bodies are few and stay in cache.
template <BodyKind kind>
void prefetch_bodies(const BodyArrays& arrays, const std::int32_t* rows)
{
    if constexpr (kind != BodyKind::fixed) {
        for (int lane = 0; lane < block_lanes; ++lane) {
            __builtin_prefetch(arrays.velocity + std::int64_t{4} * quads_of(kind) * rows[lane]);
            __builtin_prefetch(arrays.delta + std::int64_t{4} * quads_of(kind) * rows[lane]);
        }
    }
}

// ---- v += h a
// -----------------------------------------------------------------------------------------------

/// Solves I (w' - w) + h w' x (I w') = 0 by one Newton step from w: implicit, so it cannot pump energy into a
/// tumbling body as the explicit gyroscopic term does. (E. Catto, Numerical Methods, GDC 2015)
inline Vec3<Lanes> gyrate(const Sym3<Lanes>& inertia, const Vec3<Lanes>& w, const Lanes& h)
{
    const Vec3<Lanes> l = inertia * w;
    const Vec3<Lanes> f = h * cross(w, l);
    // Columns of I + h ([w]x I - [I w]x).
    const Vec3<Lanes> ix{inertia.xx, inertia.xy, inertia.xz}, iy{inertia.xy, inertia.yy, inertia.yz};
    const Vec3<Lanes> iz{inertia.xz, inertia.yz, inertia.zz};
    const Lanes zero(0);
    const Vec3<Lanes> cx = ix + h * (cross(w, ix) - Vec3<Lanes>{zero, l.z, -l.y});
    const Vec3<Lanes> cy = iy + h * (cross(w, iy) - Vec3<Lanes>{-l.z, zero, l.x});
    const Vec3<Lanes> cz = iz + h * (cross(w, iz) - Vec3<Lanes>{l.y, -l.x, zero});
    // Cramer's rule on columns scaled by the inertia's size, so that small bodies do not underflow.
    const Lanes scale = inverse_or_zero(inertia.xx + inertia.yy + inertia.zz);
    const Vec3<Lanes> x = scale * cx, y = scale * cy, z = scale * cz, r = scale * f;
    const Vec3<Lanes> yz = cross(y, z);
    const Lanes d = inverse_or_zero(dot(x, yz));
    return w - Vec3<Lanes>{d * dot(r, yz), d * dot(x, cross(r, z)), d * dot(x, cross(y, r))};
}

inline void accelerate(const KernelContext& context, const BodyArrays& arrays, const std::int32_t* rows,
                       Body<BodyKind::particle>& body)
{
    Lanes a[4];
    load_quads(arrays.acceleration, 4, rows, a);
    const Lanes h(context.step.substep);
    const Vec3<float>& g = context.step.gravity;
    body.linear = body.linear + h * Vec3<Lanes>{a[0] + Lanes(g.x), a[1] + Lanes(g.y), a[2] + Lanes(g.z)};
}
inline void accelerate(const KernelContext& context, const BodyArrays& arrays, const std::int32_t* rows,
                       Body<BodyKind::planar>& body)
{
    Lanes a[4];
    load_quads(arrays.acceleration, 4, rows, a);
    const Lanes h(context.step.substep);
    body.linear = body.linear +
                  h * Vec2<Lanes>{a[0] + Lanes(context.step.gravity.x), a[1] + Lanes(context.step.gravity.y)};
    body.yaw_rate = body.yaw_rate + h * a[2];
}
/// `a` and `t`: acceleration and torque, three and a spare each.
inline void accelerate(const StepConstants& step, const Lanes (&a)[4], const Lanes (&t)[4],
                       Body<BodyKind::rigid>& body)
{
    const Lanes h(step.substep);
    const Vec3<float>& g = step.gravity;
    body.linear = body.linear + h * Vec3<Lanes>{a[0] + Lanes(g.x), a[1] + Lanes(g.y), a[2] + Lanes(g.z)};
    const Vec3<Lanes> turned = gyrate(inverse(body.inverse_inertia), body.angular, h);
    body.angular = turned + h * (body.inverse_inertia * Vec3<Lanes>{t[0], t[1], t[2]});
}
inline void accelerate(const KernelContext& context, const BodyArrays& arrays, const std::int32_t* rows,
                       Body<BodyKind::rigid>& body)
{
    Lanes a[4], t[4];
    load_quads(arrays.acceleration, 8, rows, a);
    load_quads(arrays.acceleration + 4, 8, rows, t);
    accelerate(context.step, a, t, body);
}

/// What forces and gravity make of a body's velocity a second, m/s2; nothing of what cannot move.
template <BodyKind kind>
Vec3<Lanes> free_acceleration(const StepConstants& step, const BodyArrays& arrays, const std::int32_t* rows,
                              const Body<kind>& body)
{
    const Lanes zero(0);
    if constexpr (kind == BodyKind::fixed) {
        return {zero, zero, zero};
    } else {
        Lanes a[4];
        load_quads(arrays.acceleration, 4 * quads_of(kind), rows, a);
        const auto moves = body.inverse_mass > zero;
        const Vec3<float>& g = step.gravity;
        const Lanes z = kind == BodyKind::planar ? zero : a[2] + Lanes(g.z);
        return {select(moves, a[0] + Lanes(g.x), zero), select(moves, a[1] + Lanes(g.y), zero),
                select(moves, z, zero)};
    }
}

/// The consecutive rows first ... first + width - 1 as an index; past `end`, the null row.
struct RowIndex {
    std::int32_t rows[Lanes_width];
    int count;
    RowIndex(std::int32_t first, std::int32_t end)
    {
        count = end - first < Lanes_width ? end - first : Lanes_width;
        for (int lane = 0; lane < Lanes_width; ++lane) rows[lane] = lane < count ? first + lane : 0;
    }
};

/// Calls change(component, of `from`) for each component of velocity.
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

template <BodyKind kind, bool replay>
void integrate_velocities(const KernelContext& context, std::int32_t begin, std::int32_t end)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    BodyArrays unpushed = arrays;
    unpushed.velocity = arrays.unpushed;
    for (std::int32_t first = begin; first < end; first += Lanes_width) {
        const RowIndex index(first, end);
        Body<kind> body = load_body(arrays, index.rows, static_cast<Body<kind>*>(nullptr));
        const Body<kind> before = body;
        accelerate(context, arrays, index.rows, body);
        // A body without inverse mass is a null, free or contained row: it must not even fall.
        const auto moves = body.inverse_mass > Lanes(0);
        for_each_component(body, before,
                           [&](Lanes& now, const Lanes& then) { now = select(moves, now, then); });
        const Body<kind> pushed_off = body;
        if constexpr (replay) {
            Body<kind> change = before;
            for_each_component(change, load_body(unpushed, index.rows, static_cast<Body<kind>*>(nullptr)),
                               [](Lanes& now, const Lanes& then) { now = now - then; });
            for_each_component(body, change, [](Lanes& now, const Lanes& pushed) { now = now + pushed; });
        }
        store_velocity(arrays, index.rows, body, index.count);
        store_velocity(unpushed, index.rows, pushed_off, index.count);
    }
}

// ---- x += h v
// -----------------------------------------------------------------------------------------------

template <BodyKind kind>
void advance(Body<kind>& body, const Lanes& h)
{
    body.delta = body.delta + h * body.linear;
    if constexpr (kind == BodyKind::planar) body.delta_yaw = body.delta_yaw + h * body.yaw_rate;
    if constexpr (kind == BodyKind::rigid || kind == BodyKind::fixed) {
        body.delta_rotation = normalised(rotation_by(h * body.angular) * body.delta_rotation);
    }
}

template <BodyKind kind>
void integrate_positions(const KernelContext& context, std::int32_t begin, std::int32_t end)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    const Lanes h(context.step.substep);
    for (std::int32_t first = begin; first < end; first += Lanes_width) {
        const RowIndex index(first, end);
        Body<kind> body = load_body(arrays, index.rows, static_cast<Body<kind>*>(nullptr));
        advance(body, h);
        if constexpr (kind == BodyKind::fixed) {
            const Quat<Lanes>& q = body.delta_rotation;
            store_quads(arrays.delta, 8, index.rows, {body.delta.x, body.delta.y, body.delta.z, Lanes(0)},
                        index.count);
            store_quads(arrays.delta + 4, 8, index.rows, {q.x, q.y, q.z, q.w}, index.count);
        } else {
            store_delta(arrays, index.rows, body, index.count);
        }
    }
}
