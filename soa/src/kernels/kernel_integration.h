// The integration of bodies, one row per lane. Included inside an anonymous namespace, after kernel_tumble.h.
#pragma once

// ---- v += h a ----------------------------------------------------------------------------------------

inline void accelerate(const KernelContext& context, const BodyArrays& arrays, const std::int32_t* offsets,
                       Body<BodyKind::particle>& body)
{
    Lanes a[4];
    load_quads(arrays.acceleration, offset_floats, offsets, a);
    const Lanes h(context.step.substep);
    const Vec3<float>& g = context.step.gravity;
    body.linear = body.linear + h * Vec3<Lanes>{a[0] + Lanes(g.x), a[1] + Lanes(g.y), a[2] + Lanes(g.z)};
}
inline void accelerate(const KernelContext& context, const BodyArrays& arrays, const std::int32_t* offsets,
                       Body<BodyKind::planar>& body)
{
    Lanes a[4];
    load_quads(arrays.acceleration, offset_floats, offsets, a);
    const Lanes h(context.step.substep);
    body.linear = body.linear +
                  h * Vec2<Lanes>{a[0] + Lanes(context.step.gravity.x), a[1] + Lanes(context.step.gravity.y)};
    body.yaw_rate = body.yaw_rate + h * a[2];
}
/// `a` and `t` are acceleration and torque: three components and an unused one each.
inline void accelerate(const StepConstants& step, const Lanes (&a)[4], const Lanes (&t)[4],
                       Body<BodyKind::rigid>& body)
{
    const Lanes h(step.substep);
    const Vec3<float>& g = step.gravity;
    body.linear = body.linear + h * Vec3<Lanes>{a[0] + Lanes(g.x), a[1] + Lanes(g.y), a[2] + Lanes(g.z)};
    body.angular = body.angular + h * (body.inverse_inertia * Vec3<Lanes>{t[0], t[1], t[2]});
}
inline void accelerate(const KernelContext& context, const BodyArrays& arrays, const std::int32_t* offsets,
                       Body<BodyKind::rigid>& body)
{
    Lanes a[4], t[4];
    load_quads(arrays.acceleration, offset_floats, offsets, a);
    load_quads(arrays.acceleration + 4, offset_floats, offsets, t);
    accelerate(context.step, a, t, body);
}

/// v = v / (1 + h c) with the damping c, after the acceleration by forces: see BodyDefinition::linear_damping.
inline void damp(const BodyArrays& arrays, const std::int32_t* offsets, Body<BodyKind::particle>& body)
{
    Lanes k[4];
    load_quads(arrays.decay, offset_floats, offsets, k);
    body.linear = {k[0] * body.linear.x, k[1] * body.linear.y, k[2] * body.linear.z};
}
inline void damp(const BodyArrays& arrays, const std::int32_t* offsets, Body<BodyKind::planar>& body)
{
    Lanes k[4];
    load_quads(arrays.decay, offset_floats, offsets, k);
    body.linear = {k[0] * body.linear.x, k[1] * body.linear.y};
    body.yaw_rate = k[2] * body.yaw_rate;
}
inline void damp(const BodyArrays& arrays, const std::int32_t* offsets, Body<BodyKind::rigid>& body)
{
    Lanes k[4], turns[4];
    load_quads(arrays.decay, offset_floats, offsets, k);
    load_quads(arrays.decay + 4, offset_floats, offsets, turns);
    body.linear = {k[0] * body.linear.x, k[1] * body.linear.y, k[2] * body.linear.z};
    body.angular = {turns[0] * body.angular.x, turns[1] * body.angular.y, turns[2] * body.angular.z};
}

/// Where the rows of a bundle begin. They are consecutive or listed; lanes from `count` on are the null row.
template <BodyKind kind>
struct RowIndex {
    std::int32_t offsets[Lanes_width];
    int count;
    /// The compiler turns these into one address plus constants.
    explicit RowIndex(std::int32_t first) : count(Lanes_width)
    {
        for (int lane = 0; lane < Lanes_width; ++lane) offsets[lane] = (first + lane) * offsets_a_row(kind);
    }
    RowIndex(std::int32_t first, int how_many) : count(how_many)
    {
        for (int lane = 0; lane < Lanes_width; ++lane)
            offsets[lane] = lane < count ? (first + lane) * offsets_a_row(kind) : 0;
    }
    RowIndex(const BodyRow* rows, int how_many) : count(how_many)
    {
        for (int lane = 0; lane < Lanes_width; ++lane)
            offsets[lane] =
                lane < count ? static_cast<std::int32_t>(rows[lane].row()) * offsets_a_row(kind) : 0;
    }
};

/// Calls work(RowIndex) for all rows from `begin` to `end` - 1, a bundle at a time, and rest(RowIndex) for the last bundle if it is
/// not whole: what `work` inlines, `rest` had better call.
template <BodyKind kind, class Work, class Rest>
[[gnu::always_inline]] inline void for_each_rows(std::int32_t begin, std::int32_t end, const Work& work,
                                                 const Rest& rest)
{
    std::int32_t first = begin;
    for (; end - first >= Lanes_width; first += Lanes_width) work(RowIndex<kind>(first));
    if (first < end) rest(RowIndex<kind>(first, end - first));
}

/// Applies forces, gravity and damping and, where Replay says so, the velocity change by constraints in the last substep.
template <BodyKind kind>
void change_velocity(const KernelContext& context, const BodyArrays& arrays, const RowIndex<kind>& index,
                     Body<kind>& body)
{
    const Body<kind> before = body;
    accelerate(context, arrays, index.offsets, body);
    if (arrays.decay != nullptr) damp(arrays, index.offsets, body);
    // A row without inverse mass is the null row, unused, or a contained body: not even gravity moves it.
    const auto moves = body.inverse_mass > Lanes(0);
    for_each_component(body, before, [&](Lanes& now, const Lanes& then) { now = select(moves, now, then); });
    if (context.replay == Replay::nothing) return;
    const Body<kind> unpushed = body;
    BodyArrays arrays_unpushed = arrays;
    arrays_unpushed.velocity = arrays.unpushed;
    if (context.replay == Replay::last_substep) {
        Body<kind> change = before;
        for_each_component(change,
                           load_body(arrays_unpushed, index.offsets, static_cast<Body<kind>*>(nullptr)),
                           [](Lanes& now, const Lanes& then) { now = now - then; });
        for_each_component(body, change, [](Lanes& now, const Lanes& pushed) { now = now + pushed; });
    }
    store_velocity(arrays_unpushed, index.offsets, unpushed, index.count);
}

/// The products v . a and a . a of velocity v and acceleration a: see flew_freely.
struct Along {
    Lanes v_a, a_a;
};
template <BodyKind kind>
Along along_acceleration(const KernelContext& context, const BodyArrays& arrays, const RowIndex<kind>& index)
{
    const Vec3<float>& g = context.step.gravity;
    Lanes v[4], a[4];
    load_quads(arrays.velocity, offset_floats, index.offsets, v);
    load_quads(arrays.acceleration, offset_floats, index.offsets, a);
    Vec3<Lanes> velocity{v[0], v[1], v[2]};
    Vec3<Lanes> acceleration{a[0] + Lanes(g.x), a[1] + Lanes(g.y), a[2] + Lanes(g.z)};
    if constexpr (kind == BodyKind::planar) velocity.z = acceleration.z = Lanes(0);
    return {dot(velocity, acceleration), dot(acceleration, acceleration)};
}

/// v . a as a step begins, for flew_freely. Infinite for damped bodies, which do not fly on a parabola.
template <BodyKind kind>
Lanes start_along(const KernelContext& context, const BodyArrays& arrays, const RowIndex<kind>& index)
{
    const Lanes v_a = along_acceleration<kind>(context, arrays, index).v_a;
    if (arrays.decay == nullptr) return v_a;
    Lanes k[4];
    load_quads(arrays.decay, offset_floats, index.offsets, k);
    return select(k[3] > Lanes(0), v_a, Lanes(__builtin_inff()));
}

template <BodyKind kind, bool begins>
[[gnu::always_inline]] inline void speed_up(const KernelContext& context, const RowIndex<kind>& index)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    Body<kind> body = load_body(arrays, index.offsets, static_cast<Body<kind>*>(nullptr));
    alignas(64) float start[Lanes_width];
    if constexpr (begins) store_lanes(start_along<kind>(context, arrays, index), start);
    change_velocity(context, arrays, index, body);
    store_velocity(arrays, index.offsets, body, index.count);
    if constexpr (begins) {
        // Stored last, because the compiler must assume that this store changes what change_velocity() loads. A
        // whole bundle is one store.
        float* to = arrays.start_along + index.offsets[0] / offsets_a_row(kind);
        if (index.count == Lanes_width) {
            for (int lane = 0; lane < Lanes_width; ++lane) to[lane] = start[lane];
        } else {
            for (int lane = 0; lane < index.count; ++lane) to[lane] = start[lane];
        }
    }
}
template <BodyKind kind, bool begins>
[[gnu::noinline]] void speed_up_some(const KernelContext& context, const RowIndex<kind>& index)
{
    speed_up<kind, begins>(context, index);
}
template <BodyKind kind, bool begins>
void integrate_velocities(const KernelContext& context, std::int32_t begin, std::int32_t end)
{
    for_each_rows<kind>(
        begin, end, [&](const RowIndex<kind>& index) { speed_up<kind, begins>(context, index); },
        [&](const RowIndex<kind>& index) { speed_up_some<kind, begins>(context, index); });
}

// ---- x += h v ----------------------------------------------------------------------------------------

/// Integrates positions of bodies that are not rigid.
template <BodyKind kind>
void advance(Body<kind>& body, float h)
{
    body.delta = body.delta + Lanes(h) * body.linear;
    if constexpr (kind == BodyKind::planar) body.delta_yaw = body.delta_yaw + Lanes(h) * body.yaw_rate;
    if constexpr (kind == BodyKind::fixed)
        body.delta_rotation = normalised(rotation_by(Lanes(h) * body.angular) * body.delta_rotation);
}

/// Stores bodies that have moved, with `runs_on` with their velocities of the next substep.
template <BodyKind kind, bool runs_on>
[[gnu::always_inline]] inline void store_moved(const KernelContext& context, const RowIndex<kind>& index,
                                               Body<kind>& body)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
    if constexpr (kind == BodyKind::fixed) {
        const Quat<Lanes>& q = body.delta_rotation;
        store_quads(arrays.delta, offset_floats, index.offsets,
                    {body.delta.x, body.delta.y, body.delta.z, Lanes(0)}, index.count);
        store_quads(arrays.delta + 4, offset_floats, index.offsets, {q.x, q.y, q.z, q.w}, index.count);
    } else {
        store_delta(arrays, index.offsets, body, index.count);
        if constexpr (runs_on) change_velocity(context, arrays, index, body);
        if constexpr (runs_on || kind == BodyKind::rigid)
            store_velocity(arrays, index.offsets, body, index.count);
    }
}

/// Integrates positions and, with `runs_on`, the velocities of the next substep, of `bundles` bundles of rigid bodies together: see
/// Tumble. There are at most tumbling_together; index_of(i) is the RowIndex of bundle i.
template <bool runs_on, class IndexOf>
[[gnu::always_inline]] inline void move_rigid_on(const KernelContext& context, int bundles,
                                                 const IndexOf& index_of)
{
    struct Turning {
        Body<BodyKind::rigid> body;
        Tumble tumble;
    };
    Turning rows[tumbling_together];
    const BodyArrays& arrays = context.bodies[static_cast<int>(BodyKind::rigid)];
    const Lanes h(context.step.substep);
    const auto for_each = [&](const auto& work) {
        for (int i = 0; i < bundles; ++i) work(rows[i], index_of(i));
    };
    for_each([&](Turning& row, const auto& index) {
        row.body = load_body(arrays, index.offsets, static_cast<Body<BodyKind::rigid>*>(nullptr));
    });
    const auto start_of = [&](const auto& index) {
        return load_tensor(arrays.start_inverse_inertia, index.offsets);
    };
    begin_to_tumble(
        [&](const auto& work) {
            for_each([&](Turning& row, const auto& index) {
                work(row.tumble, row.body, [&] { return start_of(index); });
            });
        },
        h);
    for_each([&](Turning& row, const auto& index) {
        Body<BodyKind::rigid>& body = row.body;
        body.delta = body.delta + h * body.linear;
        if (row.tumble.end(body, start_of(index))) [[unlikely]]
            rotate_rows_again(body, arrays, index.offsets, context.step.substep);
        store_moved<BodyKind::rigid, runs_on>(context, index, body);
    });
}

template <BodyKind kind, bool runs_on>
[[gnu::always_inline]] inline void move_on(const KernelContext& context, const RowIndex<kind>& index)
{
    if constexpr (kind == BodyKind::rigid) {
        move_rigid_on<runs_on>(context, 1, [&](int) { return index; });
    } else {
        Body<kind> body = load_body(context.bodies[static_cast<int>(kind)], index.offsets,
                                    static_cast<Body<kind>*>(nullptr));
        advance(body, context.step.substep);
        store_moved<kind, runs_on>(context, index, body);
    }
}

template <BodyKind kind>
[[gnu::noinline]] void move_some_on(const KernelContext& context, const RowIndex<kind>& index)
{
    move_on<kind, false>(context, index);
}

template <BodyKind kind, bool runs_on>
void integrate_positions(const KernelContext& context, std::int32_t begin, std::int32_t end)
{
    const auto move_rest = [&](const RowIndex<kind>& index) {
        move_some_on<kind>(context, index);
        if constexpr (runs_on && kind != BodyKind::fixed) speed_up_some<kind, false>(context, index);
    };
    if constexpr (kind == BodyKind::rigid) {
        for (int bundles = 0; end - begin >= Lanes_width; begin += bundles * Lanes_width) {
            bundles = std::min((end - begin) / Lanes_width, tumbling_together);
            move_rigid_on<runs_on>(context, bundles,
                                   [&](int i) { return RowIndex<kind>(begin + i * Lanes_width); });
        }
        if (begin < end) move_rest(RowIndex<kind>(begin, end - begin));
    } else {
        for_each_rows<kind>(
            begin, end, [&](const RowIndex<kind>& index) { move_on<kind, runs_on>(context, index); },
            move_rest);
    }
}

template <BodyKind kind>
void integrate_listed(const KernelContext& context, const BodyRow* rows, std::int32_t count)
{
    for (std::int32_t first = 0; first < count; first += Lanes_width)
        move_some_on<kind>(
            context, RowIndex<kind>(rows + first, count - first < Lanes_width ? count - first : Lanes_width));
}
