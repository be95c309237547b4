// The integration of bodies, one row per lane. Included inside an anonymous namespace, after kernel_bodies.h.
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

/// Whether a body precesses too fast to be rotated in one piece: the square of its turn in radians is above 0.01. Its
/// energy would grow by z^4 / 4 in each, with z the turn of w in the body's frame.
inline auto precesses(const Lanes& turn_squared, const Lanes& spread)
{
    return (turn_squared > Lanes(0.01F)) & (spread > Lanes(0.1F));
}

/// Replaces the rotation of `to` in the lanes of the mask.
template <class Mask>
void replace_rotation(Body<BodyKind::rigid>& to, const Mask& mask, const Body<BodyKind::rigid>& from)
{
    const auto replace = [&](auto& into, const auto& by) {
        for (int k = 0; k < fields_of<std::remove_cvref_t<decltype(into)>>; ++k) {
            Lanes& field = reinterpret_cast<Lanes*>(&into)[k];
            field = select(mask, reinterpret_cast<const Lanes*>(&by)[k], field);
        }
    };
    replace(to.delta_rotation, from.delta_rotation);
    replace(to.angular, from.angular);
    replace(to.inverse_inertia, from.inverse_inertia);
}

/// Rotates a body in sixteen pieces, all with the same angular momentum.
inline void rotate_in_pieces(Body<BodyKind::rigid>& body, const Sym3<Lanes>& start, const Lanes& h)
{
    constexpr int pieces = 16;
    const Lanes piece = Lanes(1.0F / pieces) * h;
    const Vec3<Lanes> momentum = inverse(body.inverse_inertia) * body.angular;
    Quat<Lanes>& q = body.delta_rotation;
    for (int k = 0; k < pieces; ++k) {
        const Quat<Lanes> half_way = rotation_by(Lanes(0.5F) * piece * body.angular) * q;
        q = normalised(rotation_by(piece * (rotate_tensor(half_way, start) * momentum)) * q);
        body.inverse_inertia = rotate_tensor(q, start);
        body.angular = body.inverse_inertia * momentum;
    }
}

/// Rotates again what Tumble cannot rotate well: `body` is `before` after Tumble, `start` is I^-1 when the step began,
/// and `offsets` says where the body is in `arrays`.
///
/// A body with joints keeps I and w where a response would more than double. Sweeps divide by the responses that rows had
/// when they were made: when the substep began, or, of manifolds, when the step began. Where a response has become c times
/// as high since, a sweep leaves 1 - c of the speed that it should take away, and above c = 2 that is more than there was:
/// relaxation, or the next substep, throws the body. The change is looked at half way through the substep, where it is
/// about a quarter of that at the end: beyond `most_change`, responses double. Any other body that precesses() is rotated
/// in pieces. Contacts are told when a body has turned far, and find their responses anew.
inline void rotate_again(Body<BodyKind::rigid>& body, const Body<BodyKind::rigid>& before,
                         const Sym3<Lanes>& start, const Lanes& h, const BodyArrays& arrays,
                         const std::int32_t* offsets)
{
    const Vec3<Lanes>& w = before.angular;
    const Sym3<Lanes> inertia = inverse(before.inverse_inertia);
    const Sym3<Lanes> half_way =
        rotate_tensor(rotation_by(Lanes(0.5F) * h * w) * before.delta_rotation, start);
    const Lanes turn_squared = h * h * dot(w, w), one(1);
    const Lanes in_substep = change_of_inertia(inertia, half_way);
    const Lanes in_step = change_of_inertia(inverse(start), half_way);
    const auto fast =
        precesses(turn_squared, spread_of(inertia, before.inverse_inertia)) & (turn_squared < one);
    if (!any(maximum(in_substep, in_step) > Lanes(most_change)) && !any(fast)) return;
    alignas(64) float has_joints[Lanes_width], has_start_rows[Lanes_width];  // 1 or 0
    for (int lane = 0; lane < Lanes_width; ++lane) {
        const std::uint32_t mask = arrays.joint_colours[offsets[lane] / offsets_a_row(BodyKind::rigid)];
        has_joints[lane] = mask != 0 ? 1.0F : 0.0F;
        has_start_rows[lane] = (mask & start_rows_bit) != 0 ? 1.0F : 0.0F;
    }
    const Lanes jointed = load_lanes(has_joints), from_start = load_lanes(has_start_rows);
    Body<BodyKind::rigid> kept = before;
    kept.delta_rotation = normalised(rotation_by(h * w) * before.delta_rotation);
    const Lanes most = maximum(jointed * in_substep, from_start * in_step);
    replace_rotation(body, most > Lanes(most_change), kept);
    const auto in_pieces = fast & (Lanes(most_change) > most);
    if (!any(in_pieces)) return;
    Body<BodyKind::rigid> fine = before;
    rotate_in_pieces(fine, start, h);
    replace_rotation(body, in_pieces, fine);
}

/// Rotates a body by its angular velocity at the middle of the substep, and carries its angular momentum L = I w
/// through the rotation (I: inertia, w: angular velocity): afterwards w = I^-1 L with the rotated inertia. So L is
/// kept to rounding, the rotation is right to second order, and a tumbling body cannot gain energy without bound. A
/// body that turns by more than a radian per substep, which no substep can follow, or that has no inverse inertia
/// keeps w instead, and with it its energy.
///
/// Its functions are called in the order in which they are written here; the body changes in the last one. Each waits for what the
/// one before computes. So several bodies are taken through each of them together where there are many: that takes 0.9 of the time
/// of a step of chains.
class Tumble {
  public:
    /// `h` is the substep, s.
    void begin(const Body<BodyKind::rigid>& body, const Lanes& h)
    {
        const Sym3<Lanes> inertia = inverse(body.inverse_inertia);
        turn_squared_ = h * h * dot(body.angular, body.angular);
        momentum_ = inertia * body.angular;
        spread_ = spread_of(inertia, body.inverse_inertia);
    }
    void turn_half_way(const Body<BodyKind::rigid>& body, const Lanes& h)
    {
        rotation_ = rotation_by(Lanes(0.5F) * h * body.angular) * body.delta_rotation;
    }
    /// `start` is I^-1 when the step began.
    void find_speed(const Body<BodyKind::rigid>& body, const Sym3<Lanes>& start)
    {
        speed_ = speed_with(rotate_tensor(rotation_, start), body);
    }
    void turn(const Body<BodyKind::rigid>& body, const Lanes& h)
    {
        rotation_ = normalised(rotation_by(h * speed_) * body.delta_rotation);
    }
    /// Returns whether a lane may want rotate_again() or tell_contacts().
    [[nodiscard]] bool end(Body<BodyKind::rigid>& body, const Sym3<Lanes>& start) const
    {
        const Sym3<Lanes> inverse_inertia = rotate_tensor(rotation_, start);
        body.angular = speed_with(inverse_inertia, body);
        body.inverse_inertia = inverse_inertia;
        body.delta_rotation = rotation_;
        const Lanes at_most =
            maximum(Lanes(4) * squared_half_sine(body), Lanes(0.25F) * turn_squared_) * spread_;
        // A little less than most_change: change_at_most(), which then decides, is rounded differently.
        return any(at_most > Lanes(0.9F * most_change)) || any(precesses(turn_squared_, spread_));
    }

  private:
    Lanes turn_squared_, spread_;
    Vec3<Lanes> momentum_, speed_;
    Quat<Lanes> rotation_;  ///< since the step began: half way through the substep, and then after it

    [[nodiscard]] Vec3<Lanes> speed_with(const Sym3<Lanes>& inverse_inertia,
                                         const Body<BodyKind::rigid>& before) const
    {
        const auto turns = (trace(before.inverse_inertia) > Lanes(0)) & (turn_squared_ < Lanes(1));
        const Vec3<Lanes>&speed = before.angular, w = inverse_inertia * momentum_;
        return {select(turns, w.x, speed.x), select(turns, w.y, speed.y), select(turns, w.z, speed.z)};
    }
};

/// Takes bodies through all parts but the last. for_each(work) calls work(Tumble, body, start) for each of them, where start() is
/// I^-1 when the step began.
template <class ForEach>
[[gnu::always_inline]] inline void begin_to_tumble(const ForEach& for_each, const Lanes& h)
{
    using Mover = Body<BodyKind::rigid>;
    for_each([&](Tumble& tumble, const Mover& body, const auto&) { tumble.begin(body, h); });
    for_each([&](Tumble& tumble, const Mover& body, const auto&) { tumble.turn_half_way(body, h); });
    for_each([&](Tumble& tumble, const Mover& body, const auto& start) { tumble.find_speed(body, start()); });
    for_each([&](Tumble& tumble, const Mover& body, const auto&) { tumble.turn(body, h); });
}
/// How many bundles of bodies are taken through the parts together.
constexpr int tumbling_together = 4;

/// rotate_again() for bodies whose state before is that of the arrays. It takes little, so that the call is small where it is
/// inlined.
[[gnu::noinline, gnu::cold]] inline void rotate_rows_again(Body<BodyKind::rigid>& body,
                                                           const BodyArrays& arrays,
                                                           const std::int32_t* offsets, float h)
{
    rotate_again(body, load_body(arrays, offsets, static_cast<Body<BodyKind::rigid>*>(nullptr)),
                 load_tensor(arrays.start_inverse_inertia, offsets), Lanes(h), arrays, offsets);
    tell_contacts(body, arrays);
}

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

/// Integrates positions and, with `runs_on`, the velocities of the next substep, of as many bundles of rigid bodies as index_of()
/// has numbers for.
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
