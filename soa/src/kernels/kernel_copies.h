// The bodies of a block of copies: loads them into lanes, stores them, and integrates them there. Included inside an
// anonymous namespace, after kernel_bodies.h.
#pragma once

using Mover = Body<BodyKind::rigid>;

/// Calls work(body's kind, its lanes, its rows, how many lanes are not padding) for each body and bundle. A fixed
/// body has the lanes of a rigid one, without inverse mass.
template <class Work>
void for_each_copy(const FigureBlock& figure, const Work& work)
{
    const auto visit = [&](BodyKind kind, int index, const std::int32_t* offsets) {
        for (int lane = 0; lane < figure.count; lane += Lanes_width)
            work(kind, figure.body(index) + lane, offsets + lane, figure.count - lane);
    };
    const auto of_shape = static_cast<int>(figure.shape->bodies.size());
    for (int i = 0; i < of_shape; ++i)
        visit(figure.shape->bodies[static_cast<std::size_t>(i)], i, figure.offsets + i * block_lanes);
    for (int i = 0; i < figure.fixed_count; ++i)
        visit(BodyKind::fixed, of_shape + i, figure.fixed_offsets + i * block_lanes);
}
template <class Work>
void for_each_moving_copy(const FigureBlock& figure, const Work& work)
{
    for_each_copy(figure, [&](BodyKind kind, float* body, const std::int32_t* offsets, int count) {
        if (kind == BodyKind::rigid) work(body, offsets, count);
    });
}

inline const FigureNode& node_of(const FigureBlock& figure, int node)
{
    return figure.shape->nodes[static_cast<std::size_t>(node)];
}
/// The child body of a node.
inline Mover body_of(const FigureBlock& figure, const FigureNode& node, int lane)
{
    return load_row<Mover>(figure.body(node.body) + lane);
}

inline void load_field_quads(const float* fields, Lanes (&out)[4])
{
    for (int i = 0; i < 3; ++i) out[i] = load_lanes(fields + i * block_lanes);
    out[3] = Lanes(0);
}

inline void load_copies(const KernelContext& context, const FigureBlock& figure)
{
    for_each_copy(figure, [&](BodyKind kind, float* body, const std::int32_t* offsets, int) {
        const BodyArrays& arrays = context.bodies[static_cast<int>(kind)];
        const Mover loaded = load_body(arrays, offsets, static_cast<Mover*>(nullptr));
        store_row(loaded, body);
        Lanes a[4], t[4];
        load_quads(arrays.acceleration, offset_floats, offsets, a);
        load_quads(arrays.acceleration + 4, offset_floats, offsets, t);
        float* acceleration = body + CopyBody::acceleration * block_lanes;
        store_row(Vec3<Lanes>{a[0], a[1], a[2]}, acceleration);
        store_row(Vec3<Lanes>{t[0], t[1], t[2]}, acceleration + 3 * block_lanes);
        // Figures are loaded when a step begins: nothing has rotated yet.
        store_row(loaded.inverse_inertia, body + CopyBody::start_inertia * block_lanes);
    });
}

inline void store_copies(const KernelContext& context, const FigureBlock& figure)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(BodyKind::rigid)];
    for_each_moving_copy(figure, [&](const float* body, const std::int32_t* offsets, int count) {
        const Mover mover = load_row<Mover>(body);
        store_velocity(arrays, offsets, mover, count);
        store_delta(arrays, offsets, mover, count);
    });
}

inline void load_copy_velocities(const KernelContext& context, const FigureBlock& figure)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(BodyKind::rigid)];
    for_each_moving_copy(figure, [&](float* body, const std::int32_t* offsets, int) {
        store_copy_velocity(load_body(arrays, offsets, static_cast<Mover*>(nullptr)), body);
    });
}

inline void store_copy_velocities(const KernelContext& context, const FigureBlock& figure)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(BodyKind::rigid)];
    for_each_moving_copy(figure, [&](const float* body, const std::int32_t* offsets, int count) {
        store_velocity(arrays, offsets, load_row<Mover>(body), count);
    });
}

inline void integrate_copy_velocities(const KernelContext& context, const FigureBlock& figure)
{
    const BodyArrays& arrays = context.bodies[static_cast<int>(BodyKind::rigid)];
    for_each_moving_copy(figure, [&](float* lanes, const std::int32_t* offsets, int) {
        Mover body = load_row<Mover>(lanes);
        const Mover before = body;
        Lanes a[4], t[4];
        load_field_quads(lanes + CopyBody::acceleration * block_lanes, a);
        load_field_quads(lanes + (CopyBody::acceleration + 3) * block_lanes, t);
        accelerate(context.step, a, t, body);
        if (arrays.decay != nullptr) damp(arrays, offsets, body);
        const auto moves = body.inverse_mass > Lanes(0);
        for_each_component(body, before,
                           [&](Lanes& now, const Lanes& then) { now = select(moves, now, then); });
        store_copy_velocity(body, lanes);
    });
}

/// rotate_again() for copies whose state before is that of `lanes`.
[[gnu::noinline, gnu::cold]] inline void rotate_copies_again(Mover& body, const BodyArrays& arrays,
                                                             const std::int32_t* offsets, const float* lanes,
                                                             float h)
{
    rotate_again(body, load_row<Mover>(lanes),
                 load_row<Sym3<Lanes>>(lanes + CopyBody::start_inertia * block_lanes), Lanes(h), arrays,
                 offsets);
    tell_contacts(body, arrays);
}

/// A body of a block of copies, and where it is in the arrays of its kind.
struct TurningCopy {
    float* lanes;
    const std::int32_t* offsets;
    Tumble tumble;
};

/// Integrates the positions of a few bodies together: see Tumble. Not inlined, because integrate_copy_positions() would have four
/// copies of it.
[[gnu::noinline]] inline void turn_together(const KernelContext& context, TurningCopy* bodies, int count)
{
    const Lanes h(context.step.substep);
    const auto for_each = [&](const auto& work) {
        for (int i = 0; i < count; ++i) work(bodies[i], load_row<Mover>(bodies[i].lanes));
    };
    const auto start_of = [](const TurningCopy& body) {
        return load_row<Sym3<Lanes>>(body.lanes + CopyBody::start_inertia * block_lanes);
    };
    begin_to_tumble(
        [&](const auto& work) {
            for_each([&](TurningCopy& body, const Mover& mover) {
                work(body.tumble, mover, [&] { return start_of(body); });
            });
        },
        h);
    for_each([&](const TurningCopy& body, Mover mover) {
        mover.delta = mover.delta + h * mover.linear;
        // Never again for fixed bodies, whose offsets are not of these arrays: without inertia they have no spread.
        if (body.tumble.end(mover, start_of(body))) [[unlikely]]
            rotate_copies_again(mover, context.bodies[static_cast<int>(BodyKind::rigid)], body.offsets,
                                body.lanes, context.step.substep);
        store_row(mover, body.lanes);
    });
}

inline void integrate_copy_positions(const KernelContext& context, const FigureBlock& figure)
{
    TurningCopy bodies[tumbling_together];
    int count = 0;
    for_each_copy(figure, [&](BodyKind, float* lanes, const std::int32_t* offsets, int) {
        bodies[count].lanes = lanes;
        bodies[count].offsets = offsets;
        if (++count < tumbling_together) return;
        turn_together(context, bodies, count);
        count = 0;
    });
    turn_together(context, bodies, count);
}
