// The kernels of a constraint type and pair of body kinds, over blocks: gather, maths, scatter, written once
// for every type, every pair and every instruction set. Included inside an anonymous namespace, after
// kernel_copies.h.

/// Entries of a table of structs, an entry a lane, turned into a struct of lanes.
template <class Struct>
Struct gather_struct(const float* table, std::int64_t stride, const std::int32_t* index)
{
    constexpr int quads = (fields_of<Struct> + 3) / 4;
    Lanes padded[quads][4];
    for (int q = 0; q < quads; ++q) load_quads(table + 4 * q, stride, index, padded[q]);
    Struct result;
    Lanes* fields = reinterpret_cast<Lanes*>(&result);
    for (int i = 0; i < fields_of<Struct>; ++i) fields[i] = padded[i / 4][i % 4];
    return result;
}
template <class Struct>
void scatter_struct(const Struct& value, float* table, std::int64_t stride, const std::int32_t* index,
                    int count)
{
    constexpr int quads = (fields_of<Struct> + 3) / 4;
    Lanes padded[quads][4];
    const Lanes* fields = reinterpret_cast<const Lanes*>(&value);
    for (int i = 0; i < 4 * quads; ++i) padded[i / 4][i % 4] = i < fields_of<Struct> ? fields[i] : Lanes(0);
    for (int q = 0; q < quads; ++q) store_quads(table + 4 * q, stride, index, padded[q], count);
}

/// x - point, narrowed a lane at a time.
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

/// Impulses that are not finite are forgotten: a contained body must not poison the step that revives it.
template <class Struct>
Struct only_finite(Struct value)
{
    Lanes* fields = reinterpret_cast<Lanes*>(&value);
    for (int i = 0; i < fields_of<Struct>; ++i) {
        fields[i] = select(absolute(fields[i]) < Lanes(1e30F), fields[i], Lanes(0));
    }
    return value;
}

// ---- where bodies are when a step begins: subtracted as they are kept, and narrowed, a body at a time -------

/// Four numbers of a pose in line, in one register where there is one so wide.
using PoseQuad [[gnu::vector_size(4 * sizeof(PoseReal)), gnu::aligned(sizeof(PoseReal)), gnu::may_alias]] =
    PoseReal;
using FloatQuad [[gnu::vector_size(4 * sizeof(float)), gnu::may_alias]] = float;

inline const PoseQuad& quad_at(const PoseReal& first)
{
    return *reinterpret_cast<const PoseQuad*>(&first);
}

/// quad_of(lane) of every lane, narrowed: out[i] holds number i of each.
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
Vec3<Lanes> between_bodies(const BodyArrays& a, const std::int32_t* offsets_a, const BodyArrays& b,
                           const std::int32_t* offsets_b)
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

template <BodyKind kind>
Orientation<Lanes, kind> load_orientation(const BodyArrays& arrays, const std::int32_t* offsets)
{
    if constexpr (kind == BodyKind::particle) {
        return {};
    } else if constexpr (kind == BodyKind::planar) {
        alignas(64) float yaw[Lanes_width];
        for (int lane = 0; lane < Lanes_width; ++lane) {
            const auto angle = static_cast<double>(arrays.pose[offsets[lane] / offsets_a_row(kind)].yaw);
            const double turns = angle * 0.15915494309189535;
            const auto whole =
                static_cast<double>(static_cast<long long>(turns < 0 ? turns - 0.5 : turns + 0.5));
            yaw[lane] = static_cast<float>(angle - whole * 6.283185307179586);
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

// ---- the kernels -------------------------------------------------------------------------------------------

/// The part of a row that a sweep reads: what the type has set apart; else all of it, unless there is a substep row.
struct NothingInSweep {};
template <bool recomputes, class Row>
const auto& swept(const Row& row)
{
    if constexpr (requires { row.in_sweep; }) {
        return row.in_sweep;
    } else if constexpr (!recomputes) {
        return row;
    } else {
        static constexpr NothingInSweep nothing;
        return nothing;
    }
}

template <class Type, BodyKind kind_a, BodyKind kind_b>
struct Kernels {
    using A = Body<kind_a>;
    using B = Body<kind_b>;
    using Row = typename Type::template Row<Lanes, kind_a, kind_b>;
    using Substep = typename Type::template SubstepRow<Lanes, kind_a, kind_b>;
    using Impulse = typename Type::template Impulse<Lanes, kind_a, kind_b>;
    using Parameters = typename Type::template Parameters<Lanes>;
    using Memory = typename Type::template Memory<Lanes>;
    using Swept = std::remove_cvref_t<decltype(swept<Type::recomputes_each_substep>(std::declval<Row>()))>;
    /// What is made anew each substep is made by its warm start from where the bodies are; others look in each sweep.
    static constexpr bool sees_delta_once = Type::recomputes_each_substep;
    static constexpr int row_stride = fields_of<Row> * block_lanes;
    static constexpr int substep_stride = fields_of<Substep> * block_lanes;
    static constexpr int impulse_stride = fields_of<Impulse> * block_lanes;
    static constexpr int residual_stride = fields_of<LaneResidual<Lanes>> * block_lanes;

    /// One bundle of a block: its bodies, and where its lanes lie in the streams.
    struct Bundle {
        const BodyArrays& arrays_a;
        const BodyArrays& arrays_b;
        const std::int32_t* offsets_a;
        const std::int32_t* offsets_b;
        const std::int32_t* constraint;
        float* row;
        float* substep;
        float* impulse;
        float* residual;
        int count;  ///< lanes of this bundle that are not padding
        int lane;   ///< of the block, where it begins
        [[nodiscard]] A load_a() const { return load_body(arrays_a, offsets_a, static_cast<A*>(nullptr)); }
        [[nodiscard]] B load_b() const { return load_body(arrays_b, offsets_b, static_cast<B*>(nullptr)); }
    };

    template <class Work>
    [[gnu::always_inline]] static void for_each_bundle(const KernelContext& context,
                                                       const BlockStreams& streams, std::int64_t block,
                                                       const Work& work)
    {
        const BlockBodies& bodies = streams.bodies[block];
        const int count = streams.counts[block];
        for (int lane = 0; lane < count; lane += Lanes_width) {
            work(Bundle{
                context.bodies[static_cast<int>(kind_a)], context.bodies[static_cast<int>(kind_b)],
                bodies.a + lane, bodies.b + lane, streams.constraints[block].lane + lane,
                streams.rows + block * row_stride + lane,
                // A stream of nothing is null, and stays so.
                substep_stride == 0 ? nullptr : streams.substep_rows + block * substep_stride + lane,
                streams.impulses + block * impulse_stride + lane,
                streams.residuals == nullptr ? nullptr : streams.residuals + block * residual_stride + lane,
                count - lane, lane});
        }
    }

    /// Of b beside a, by forces and gravity alone: what restitution asks.
    static Vec3<Lanes> parting_acceleration(const KernelContext& context, const Bundle& bundle, const A& a,
                                            const B& b)
    {
        return free_acceleration(context.step, bundle.arrays_b, bundle.offsets_b, b) -
               free_acceleration(context.step, bundle.arrays_a, bundle.offsets_a, a);
    }

    static void prepare(const KernelContext& context, const BlockStreams& streams, const ConstraintData& data,
                        std::int32_t begin, std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                const auto parameters =
                    gather_struct<Parameters>(data.parameters, data.parameter_stride, bundle.constraint);
                std::int32_t entry[Lanes_width];
                for (int lane = 0; lane < Lanes_width; ++lane) {
                    const std::int32_t c = bundle.constraint[lane];
                    entry[lane] = data.memory_index ? data.memory_index[c] : c;
                }
                const auto memory = gather_struct<Memory>(data.memory_in, data.memory_stride, entry);
                const A a = bundle.load_a();
                const B b = bundle.load_b();
                Impulse impulse;
                if constexpr (requires { typename Type::Definition; }) {
                    const JointPose<Lanes, kind_a, kind_b> pose{
                        between_bodies<kind_a, kind_b>(bundle.arrays_a, bundle.offsets_a, bundle.arrays_b,
                                                       bundle.offsets_b),
                        load_orientation<kind_a>(bundle.arrays_a, bundle.offsets_a),
                        load_orientation<kind_b>(bundle.arrays_b, bundle.offsets_b)};
                    if constexpr (requires { &Type::world_points; }) {
                        const auto points = [&](int lane) -> const WorldPoints& {
                            return data.world_points[bundle.constraint[lane]];
                        };
                        const WorldPose<Lanes, kind_a, kind_b> in_world{
                            pose,
                            from_points<kind_a>(
                                bundle.arrays_a, bundle.offsets_a,
                                [&](int lane) -> const Vec3<double>& { return points(lane).a; }),
                            from_points<kind_b>(
                                bundle.arrays_b, bundle.offsets_b,
                                [&](int lane) -> const Vec3<double>& { return points(lane).b; })};
                        store_row(Type::prepare(context.step, parameters, memory, in_world, a, b, impulse),
                                  bundle.row);
                    } else if constexpr (Type::has_restitution) {
                        store_row(
                            Type::prepare(context.step, parameters, memory,
                                          parting_acceleration(context, bundle, a, b), pose, a, b, impulse),
                            bundle.row);
                    } else {
                        store_row(Type::prepare(context.step, parameters, memory, pose, a, b, impulse),
                                  bundle.row);
                    }
                } else {
                    store_row(Type::prepare(context.step, parameters, memory,
                                            parting_acceleration(context, bundle, a, b), a, b, impulse),
                              bundle.row);
                }
                store_row(impulse, bundle.impulse);
            });
        }
    }

    static void warm_start(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                           std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch<sees_delta_once>(context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                Substep substep;
                Type::template warm_start<Lanes>(context.step, load_row<Row>(bundle.row), substep,
                                                 load_row<Impulse>(bundle.impulse), a, b);
                if constexpr (Type::recomputes_each_substep) store_row(substep, bundle.substep);
                store_velocity(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_velocity(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }

    /// Asks for the bodies of the next block, which lie anywhere, if they are far. Its streams lie in line: the
    /// hardware sees to them.
    template <bool delta>
    [[gnu::always_inline]] static void prefetch(const KernelContext& context, const BlockStreams& streams,
                                                std::int32_t block, std::int32_t end)
    {
        if (!context.bodies_are_far || block + 1 >= end) return;
        const BlockBodies& next = streams.bodies[block + 1];
        prefetch_bodies<kind_a, delta>(context.bodies[static_cast<int>(kind_a)], next.a);
        prefetch_bodies<kind_b, delta>(context.bodies[static_cast<int>(kind_b)], next.b);
    }

    /// Takes back what makes no difference; see rest.h.
    [[gnu::always_inline]] static void rest(const Bundle& bundle, const A& a_before, const B& b_before,
                                            Impulse& impulse, A& a, B& b)
    {
        const auto changes = makes_a_difference(a_before, a, b_before, b);
        auto held = load_row<Impulse>(bundle.impulse);
        const Lanes* before = reinterpret_cast<const Lanes*>(&held);
        Lanes* fields = reinterpret_cast<Lanes*>(&impulse);
        for (int i = 0; i < fields_of<Impulse>; ++i) fields[i] = select(changes, fields[i], before[i]);
        change_velocity_where(changes, a_before, a);
        change_velocity_where(changes, b_before, b);
    }

    template <bool relax>
    static void sweep(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                      std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch<!sees_delta_once>(context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                auto impulse = load_row<Impulse>(bundle.impulse);
                const auto row = load_row<Row>(bundle.row);
                Type::template solve<relax, Lanes>(context.step, swept<Type::recomputes_each_substep>(row),
                                                   load_row<Substep>(bundle.substep), impulse, a, b);
                // As below: before is loaded again.
                if (context.step.comes_to_rest) [[unlikely]]
                    rest(bundle, bundle.load_a(), bundle.load_b(), impulse, a, b);
                if (context.measure != Measure::nothing) [[unlikely]] {
                    // The bodies are loaded again: kept from above, they would cost every sweep registers.
                    store_row(residual_of(bundle.load_a(), a, bundle.load_b(), b), bundle.residual);
                    if (context.measure == Measure::without_solving) return;
                }
                store_row(impulse, bundle.impulse);
                store_velocity(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_velocity(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }

    // Cold is what runs at most once a step or on request: small code rather than inlined code, in minutes less to compile.
    [[gnu::cold]] static void restitute(const KernelContext& context, const BlockStreams& streams,
                                        std::int32_t begin, std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch<true>(context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                auto impulse = load_row<Impulse>(bundle.impulse);
                Type::template restitute<Lanes>(context.step, load_row<Row>(bundle.row), impulse, a, b);
                store_row(impulse, bundle.impulse);
                store_velocity(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_velocity(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }

    [[gnu::cold]] static void project(const KernelContext& context, const BlockStreams& streams,
                                      std::int32_t begin, std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch<true>(context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                Type::template project<Lanes>(context.step, load_row<Row>(bundle.row),
                                              load_row<Substep>(bundle.substep), a, b);
                turn_inertia(bundle.arrays_a, bundle.offsets_a, a);
                turn_inertia(bundle.arrays_b, bundle.offsets_b, b);
                store_delta(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_delta(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }

    static void store(const KernelContext& context, const BlockStreams& streams, const ConstraintData& data,
                      std::int32_t begin, std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                const auto row = load_row<Row>(bundle.row);
                const auto impulse = load_row<Impulse>(bundle.impulse);
                Memory memory;
                // Some remember how far their bodies have gone.
                if constexpr (requires(A a, B b) { Type::template remember<Lanes>(row, impulse, a, b); }) {
                    memory = Type::template remember<Lanes>(row, impulse, bundle.load_a(), bundle.load_b());
                } else {
                    memory = Type::template remember<Lanes>(row, impulse);
                }
                scatter_struct(only_finite(memory), data.memory_out, data.memory_stride, bundle.constraint,
                               bundle.count);
            });
        }
    }

    // ---- the same for blocks of copies ----
    static constexpr bool has_copies = !Type::has_restitution &&
                                       (kind_a == BodyKind::rigid || kind_a == BodyKind::fixed) &&
                                       (kind_b == BodyKind::rigid || kind_b == BodyKind::fixed);

    static void warm_start_copies(const KernelContext& context, const BlockStreams& streams,
                                  std::int32_t block, float* body_a, float* body_b)
    {
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            A a = load_row<A>(body_a + bundle.lane);
            B b = load_row<B>(body_b + bundle.lane);
            Substep substep;
            Type::template warm_start<Lanes>(context.step, load_row<Row>(bundle.row), substep,
                                             load_row<Impulse>(bundle.impulse), a, b);
            if constexpr (Type::recomputes_each_substep) store_row(substep, bundle.substep);
            store_copy_velocity(a, body_a + bundle.lane);
            store_copy_velocity(b, body_b + bundle.lane);
        });
    }

    template <bool relax>
    static void sweep_copies(const KernelContext& context, const BlockStreams& streams, std::int32_t block,
                             float* body_a, float* body_b)
    {
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            A a = load_row<A>(body_a + bundle.lane);
            B b = load_row<B>(body_b + bundle.lane);
            auto impulse = load_row<Impulse>(bundle.impulse);
            const auto row = load_row<Row>(bundle.row);
            Type::template solve<relax, Lanes>(context.step, swept<Type::recomputes_each_substep>(row),
                                               load_row<Substep>(bundle.substep), impulse, a, b);
            if (context.step.comes_to_rest) [[unlikely]]
                rest(bundle, load_row<A>(body_a + bundle.lane), load_row<B>(body_b + bundle.lane), impulse, a,
                     b);
            store_row(impulse, bundle.impulse);
            store_copy_velocity(a, body_a + bundle.lane);
            store_copy_velocity(b, body_b + bundle.lane);
        });
    }

    static void equality_rows(const BlockStreams& streams, std::int32_t block, const float* body_a,
                              const float* body_b, float* out)
    {
        const int count = streams.counts[block];
        for (int lane = 0; lane < count; lane += Lanes_width) {
            EqualityRow<Lanes> rows[Type::equality_count];
            Type::template equality_rows<Lanes>(
                load_row<Row>(streams.rows + static_cast<std::int64_t>(block) * row_stride + lane),
                load_row<A>(body_a + lane), load_row<B>(body_b + lane), rows);
            for (int i = 0; i < Type::equality_count; ++i)
                store_row(rows[i], out + i * fields_of<EqualityRow<Lanes>> * block_lanes + lane);
        }
    }

    static void enter(ConstraintKernels& kernels)
    {
        if constexpr (has_copies) {
            kernels.warm_start_copies = warm_start_copies;
            kernels.solve_copies = sweep_copies<false>;
            kernels.relax_copies = sweep_copies<true>;
            if constexpr (requires { Type::equality_count; }) {
                kernels.equality_rows = equality_rows;
                kernels.equality_count = Type::equality_count;
            }
        }
        kernels.prepare = prepare;
        kernels.warm_start = warm_start;
        kernels.solve = sweep<false>;
        kernels.relax = sweep<true>;
        if constexpr (Type::has_restitution) kernels.restitute = restitute;
        kernels.project = project;
        kernels.store = store;
        kernels.row_floats = fields_of<Row>;
        kernels.swept_floats = fields_of<Swept> + fields_of<Substep>;
        kernels.substep_floats = fields_of<Substep>;
        kernels.impulse_floats = fields_of<Impulse>;
    }
};
