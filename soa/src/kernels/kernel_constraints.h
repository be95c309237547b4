// The kernels of a constraint type and pair of body kinds, over blocks: gather, maths, scatter, written once
// for every type, every pair and every instruction set. Included inside an anonymous namespace, after
// kernel_bundle.h.
#pragma once

// ---- the kernels -------------------------------------------------------------------------------------------

/// The part of a row that a sweep reads: the member `in_sweep` if the type has one; else the whole row, or nothing of
/// it if there is a substep row.
struct NothingInSweep {};
template <bool has_substep_row, class Row>
const auto& swept(const Row& row)
{
    if constexpr (requires { row.in_sweep; }) {
        return row.in_sweep;
    } else if constexpr (!has_substep_row) {
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
    static constexpr bool has_substep_row = !std::is_empty_v<Substep>;
    using Swept = std::remove_cvref_t<decltype(swept<has_substep_row>(std::declval<Row>()))>;
    /// A substep row is made from the bodies' displacements; types without one read these in each sweep.
    static constexpr bool sees_delta_once = has_substep_row;
    /// What is summed over substeps: impulses for contacts, whose rows are the same in all substeps; wrenches for
    /// joints, whose rows rotate.
    using Sum = std::conditional_t<Type::is_contact, Impulse, Wrench<Lanes>>;
    static constexpr int row_stride = fields_of<Row> * block_lanes;
    static constexpr int substep_stride = fields_of<Substep> * block_lanes;
    static constexpr int impulse_stride = fields_of<Impulse> * block_lanes;
    static constexpr int sum_stride = fields_of<Sum> * block_lanes;

    using Bundle = ConstraintBundle<kind_a, kind_b>;

    /// See VelocitiesOut. Contacts have a kernel of their own for fixed bodies.
    template <BodyKind kind>
    [[gnu::always_inline]] static VelocitiesOut velocities_out(const BodyArrays& arrays,
                                                               const std::int32_t* offsets, Nowhere& nowhere)
    {
        constexpr bool may_be_fixed = kind == BodyKind::rigid && !Type::is_contact;
        const bool moves = !may_be_fixed || arrays.can_move;
        return {moves ? arrays.velocity : nowhere.row, moves ? offsets : nowhere.offsets};
    }

    template <class Work>
    [[gnu::always_inline]] static void for_each_bundle(const KernelContext& context,
                                                       const BlockStreams& streams, std::int64_t block,
                                                       const Work& work)
    {
        for_each_bundle(context, streams, block, streams.counts[block], work);
    }
    template <class Work>
    [[gnu::always_inline]] static void for_each_bundle(const KernelContext& context,
                                                       const BlockStreams& streams, std::int64_t block,
                                                       int count, const Work& work)
    {
        const BlockBodies& bodies = streams.bodies[block];
        const BodyArrays& arrays_a = context.bodies[static_cast<int>(streams.kind_a)];
        const BodyArrays& arrays_b = context.bodies[static_cast<int>(streams.kind_b)];
        Nowhere nowhere;
        for (int lane = 0; lane < count; lane += Lanes_width) {
            work(Bundle{arrays_a, arrays_b, bodies.a + lane, bodies.b + lane,
                        streams.constraints == nullptr ? nullptr : streams.constraints[block].lane + lane,
                        streams.rows + block * row_stride + lane,
                        // An empty stream is null, and no offset is added to it.
                        substep_stride == 0 ? nullptr : streams.substep_rows + block * substep_stride + lane,
                        streams.impulses + block * impulse_stride + lane,
                        streams.sums == nullptr ? nullptr : streams.sums + block * sum_stride + lane,
                        count - lane, lane, velocities_out<kind_a>(arrays_a, bodies.a + lane, nowhere),
                        velocities_out<kind_b>(arrays_b, bodies.b + lane, nowhere)});
        }
    }

    /// Contacts of bodies of different kinds are computed in the order of the kinds, which need not be the host's.
    static constexpr bool may_be_exchanged = Type::is_contact && kind_a != kind_b;
    /// -1 in lanes whose body a is body b of the host, else 1.
    static Lanes order_of(const ConstraintData& data, const Bundle& bundle)
    {
        alignas(64) float order[Lanes_width];
        for (int lane = 0; lane < Lanes_width; ++lane)
            order[lane] = data.exchanged[bundle.constraint[lane]] != 0 ? -1.0F : 1.0F;
        return load_lanes(order);
    }

    /// What a type may ask when a step begins: see StepStart.
    struct Start {
        const KernelContext& context;
        const ConstraintData& data;
        const Bundle& bundle;

        [[nodiscard]] const StepConstants& step() const { return context.step; }
        [[nodiscard]] JointPose<Lanes, kind_a, kind_b> pose() const
        {
            return {between_bodies(bundle.arrays_a, bundle.offsets_a, bundle.arrays_b, bundle.offsets_b),
                    load_orientation<kind_a>(bundle.arrays_a, bundle.offsets_a),
                    load_orientation<kind_b>(bundle.arrays_b, bundle.offsets_b)};
        }
        [[nodiscard]] FromWorldPoints<Lanes> from_world_points() const
        {
            const auto points = [&](int lane) -> const WorldPoints& {
                return data.world_points[bundle.constraint[lane]];
            };
            return {from_points(bundle.arrays_a, bundle.offsets_a,
                                [&](int lane) -> const Vec3<double>& { return points(lane).a; }),
                    from_points(bundle.arrays_b, bundle.offsets_b,
                                [&](int lane) -> const Vec3<double>& { return points(lane).b; })};
        }
        [[nodiscard]] Vec3<Lanes> acceleration(const A& a, const B& b) const
        {
            return free_acceleration(context.step, bundle.arrays_b, bundle.offsets_b, b) -
                   free_acceleration(context.step, bundle.arrays_a, bundle.offsets_a, a);
        }
        [[nodiscard]] ContactSurface<Lanes> surface() const
        {
            ContactSurface<Lanes> surface;
            if (data.surfaces == nullptr) return surface;
            alignas(64) float fields[4][Lanes_width];
            for (int lane = 0; lane < Lanes_width; ++lane) {
                const std::int32_t i = bundle.constraint[lane] - data.first_surface;
                const ContactSurface<float> own = i < 0 ? ContactSurface<float>{} : data.surfaces[i];
                fields[0][lane] = own.velocity.x;
                fields[1][lane] = own.velocity.y;
                fields[2][lane] = own.velocity.z;
                fields[3][lane] = own.most_force;
            }
            surface.velocity = {load_lanes(fields[0]), load_lanes(fields[1]), load_lanes(fields[2])};
            if constexpr (may_be_exchanged) surface.velocity = order_of(data, bundle) * surface.velocity;
            surface.most_force = load_lanes(fields[3]);
            return surface;
        }
    };

    /// The bodies at the end of a step, each loaded when a type asks for it.
    struct End {
        const Bundle& bundle;
        [[nodiscard]] A a() const { return bundle.load_a(); }
        [[nodiscard]] B b() const { return bundle.load_b(); }
    };

    static void prepare(const KernelContext& context, const BlockStreams& streams, const ConstraintData& data,
                        std::int32_t begin, std::int32_t end)
    {
        static_assert(ConstraintType<Type, Start, End, Lanes, kind_a, kind_b>, "see constraint_type.h");
        for (std::int32_t block = begin; block < end; ++block) {
            // Padding too, as far as a sweep reads it.
            const int count = (streams.counts[block] + context.width - 1) & -context.width;
            for_each_bundle(context, streams, block, count, [&](const Bundle& bundle) {
                auto parameters =
                    gather_struct<Parameters>(data.parameters, data.parameter_stride, bundle.constraint);
                std::int32_t entry[Lanes_width];
                for (int lane = 0; lane < Lanes_width; ++lane) {
                    const std::int32_t c = bundle.constraint[lane];
                    entry[lane] = data.memory_index ? data.memory_index[c] : c;
                }
                auto memory = gather_struct<Memory>(data.memory_in, data.memory_stride, entry);
                if constexpr (may_be_exchanged) {
                    const Lanes order = order_of(data, bundle);
                    Type::put_in_order(order, parameters);
                    Type::put_in_order(order, memory);
                }
                const A a = bundle.load_a();
                const B b = bundle.load_b();
                const Start start{context, data, bundle};
                Impulse impulse;
                const Row row = Type::prepare(start, parameters, memory, a, b, impulse);
                store_row(row, bundle.row);
                store_row(impulse, bundle.impulse);
                if constexpr (Type::pulls_at_arms) note_overload(context, row, impulse, a, b);
                if (bundle.sum != nullptr) clear(bundle.sum);
            });
        }
    }

    static void note_overload(const KernelContext& context, const Row& row, const Impulse& impulse,
                              const A& a, const B& b)
    {
        const Tension<Lanes> tension = Type::template tension<Lanes>(row, impulse);
        const Lanes h(context.step.substep);
        alignas(64) float beyond[Lanes_width];
        store_lanes(unbearable_tension(a, tension.arm_a, tension.push_a, h) +
                        unbearable_tension(b, tension.arm_b, tension.push_b, h),
                    beyond);
        for (const float k : beyond) {
            if (k > 0 && context.overloaded != nullptr)
                context.overloaded->store(true, std::memory_order_relaxed);
        }
    }
    static void stiffen(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                        std::int32_t end)
    {
        const Lanes h(context.step.substep);
        for (std::int32_t block = begin; block < end; ++block) {
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                const Tension<Lanes> tension = Type::template tension<Lanes>(
                    load_row<Row>(bundle.row), load_row<Impulse>(bundle.impulse));
                A a = bundle.load_a();
                B b = bundle.load_b();
                motley::stiffen(a, tension.arm_a, tension.push_a, h);
                motley::stiffen(b, tension.arm_b, tension.push_b, h);
                store_inertia(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_inertia(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }

    /// Keeps as much of the impulses as the bodies bear: see torque.h. Hardly any joint has more than the lightest body of
    /// the scene bears, so that is looked at first, and only then the joint's own bodies, which load_bodies() returns.
    template <class LoadBodies>
    [[gnu::always_inline]] static void bound_warm_start(const KernelContext& context, const Bundle& bundle,
                                                        const LoadBodies& load_bodies)
    {
        if constexpr (Type::has_torque) {
            const Lanes torque =
                Type::template torque<Lanes>(load_row<Row>(bundle.row), load_row<Impulse>(bundle.impulse));
            if (any(Lanes(context.step.substep * context.largest_response) * torque > Lanes(2))) [[unlikely]]
                keep_share(context, bundle, torque, load_bodies);
        }
    }
    template <class LoadBodies>
    [[gnu::noinline, gnu::cold]] static void keep_share(const KernelContext& context, const Bundle& bundle,
                                                        const Lanes& torque, const LoadBodies& load_bodies)
    {
        const auto [a, b] = load_bodies();
        auto impulse = load_row<Impulse>(bundle.impulse);
        Type::scale(impulse, bearable_share(a, b, torque, Lanes(context.step.substep)));
        store_row(impulse, bundle.impulse);
    }

    /// Makes the substep row, and applies the impulses of the last substep.
    [[gnu::always_inline]] static void begin_substep(const Bundle& bundle, A& a, B& b)
    {
        const auto row = load_row<Row>(bundle.row);
        const auto impulse = load_row<Impulse>(bundle.impulse);
        Substep substep;
        Type::template prepare_substep<Lanes>(row, impulse, substep, a, b);
        Type::template warm_start<Lanes>(row, substep, impulse, a, b);
        store_row(substep, bundle.substep);
    }

    static void warm_start(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                           std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch(sees_delta_once, context, streams, block, end);
            if constexpr (has_copies && !Type::is_contact) {
                // In place of a second copy of the maths, which is the largest of a joint.
                BlockCopies bodies;
                load_block<isa_here>(context, streams, block, bodies);
                warm_start_copies(context, streams, block, bodies.a, bodies.b);
                store_block_velocities<isa_here>(context, streams, block, bodies);
            } else {
                for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                    bound_warm_start(context, bundle, [&] {
                        return std::pair{bundle.load_a(), bundle.load_b()};
                    });
                    A a = bundle.load_a();
                    B b = bundle.load_b();
                    begin_substep(bundle, a, b);
                    bundle.store_velocities(a, b);
                });
            }
        }
    }

    /// Prefetches the bodies of the next block, if bodies exceed the core's cache.
    [[gnu::always_inline]] static void prefetch(bool with_delta, const KernelContext& context,
                                                const BlockStreams& streams, std::int32_t block,
                                                std::int32_t end)
    {
        if (context.bodies_are_far && block + 1 < end)
            prefetch_bodies(context, streams, block + 1, with_delta);
    }

    static void solve(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                      std::int32_t end)
    {
        sweep(context, context.step, streams, begin, end);
    }
    static void relax(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                      std::int32_t end)
    {
        sweep(context, context.relaxing, streams, begin, end);
    }
    /// Whether rows have responses that a body's turn may change within a step.
    static constexpr bool may_renew =
        Type::is_contact && (kind_a == BodyKind::rigid || kind_b == BodyKind::rigid);
    static bool has_turned_far(const KernelContext& context)
    {
        return context.turned_far != nullptr && context.turned_far->load(std::memory_order_relaxed);
    }
    /// Before a sweep: finds responses anew, if a body has turned far.
    [[gnu::always_inline]] static void renew_responses(const KernelContext& context,
                                                       const BlockStreams& streams, std::int32_t begin,
                                                       std::int32_t end)
    {
        if constexpr (may_renew) {
            if (has_turned_far(context)) [[unlikely]]
                renew_rows(context, streams, begin, end);
        }
    }
    [[gnu::noinline, gnu::cold]] static void renew_rows(const KernelContext& context,
                                                        const BlockStreams& streams, std::int32_t begin,
                                                        std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                renew_row(bundle, bundle.load_a(), bundle.load_b());
            });
        }
    }
    static void renew_row(const Bundle& bundle, const A& a, const B& b)
    {
        auto row = load_row<Row>(bundle.row);
        Type::template renew_response<Lanes>(row, a, b);
        store_row(row, bundle.row);
    }

    /// Shared by solve and relax: a copy for each would make the kernels half as large again.
    [[gnu::noinline]] static void sweep(const KernelContext& context, const StepConstants& step,
                                        const BlockStreams& streams, std::int32_t begin, std::int32_t end)
    {
        renew_responses(context, streams, begin, end);
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch(!sees_delta_once, context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                auto impulse = load_row<Impulse>(bundle.impulse);
                const auto row = load_row<Row>(bundle.row);
                Type::template solve<Lanes>(step, swept<has_substep_row>(row),
                                            load_row<Substep>(bundle.substep), impulse, a, b);
                store_row(impulse, bundle.impulse);
                bundle.store_velocities(a, b);
            });
        }
    }

    static void restitute(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                          std::int32_t end)
    {
        renew_responses(context, streams, begin, end);
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch(true, context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                auto impulse = load_row<Impulse>(bundle.impulse);
                Type::template restitute<Lanes>(context.step, load_row<Row>(bundle.row), impulse, a, b);
                store_row(impulse, bundle.impulse);
                bundle.store_velocities(a, b);
            });
        }
    }

    static void project(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                        std::int32_t end)
    {
        renew_responses(context, streams, begin, end);
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch(true, context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                Type::template project<Lanes>(context.step, load_row<Row>(bundle.row), a, b);
                store_displaced(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_displaced(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }

    static void clear(float* sum)
    {
        for (int i = 0; i < fields_of<Sum>; ++i) store_lanes(Lanes(0), sum + i * block_lanes);
    }

    /// What a substep adds to the sum.
    static Sum summand(const Bundle& bundle)
    {
        const auto impulse = load_row<Impulse>(bundle.impulse);
        if constexpr (Type::is_contact) {
            return impulse;
        } else {
            return Type::template wrench<Lanes>(load_row<Row>(bundle.row), load_row<Substep>(bundle.substep),
                                                impulse);
        }
    }

    static void add_up(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                       std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                const Sum summand = Kernels::summand(bundle);
                auto sum = load_row<Sum>(bundle.sum);
                const Lanes* more = reinterpret_cast<const Lanes*>(&summand);
                Lanes* fields = reinterpret_cast<Lanes*>(&sum);
                for (int i = 0; i < fields_of<Sum>; ++i) fields[i] = fields[i] + more[i];
                store_row(sum, bundle.sum);
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
                const End bodies{bundle};
                const Memory memory = Type::template remember<Lanes>(row, impulse, bodies);
                if constexpr (Type::is_contact) {
                    const float* present = streams.present == nullptr
                                               ? nullptr
                                               : streams.present + block * block_lanes + bundle.lane;
                    [[maybe_unused]] Lanes order;
                    if constexpr (may_be_exchanged) order = order_of(data, bundle);
                    const auto put = [&](Memory kept, float* table, std::int64_t stride) {
                        if constexpr (may_be_exchanged) Type::put_in_order(order, kept);
                        scatter_finite(kept, table, stride, bundle.constraint, bundle.count, present);
                    };
                    put(memory, data.memory_out, data.memory_stride);
                    put(bundle.sum == nullptr
                            ? memory
                            : Type::template remember<Lanes>(row, load_row<Sum>(bundle.sum), bodies),
                        data.step_out, data.step_stride);
                } else {
                    scatter_finite(memory, data.memory_out, data.memory_stride, bundle.constraint,
                                   bundle.count);
                    scatter_finite(load_row<Sum>(bundle.sum), data.step_out, data.step_stride,
                                   bundle.constraint, bundle.count);
                }
            });
        }
    }

    // ---- the same for blocks of copies ----
    static constexpr bool has_copies =
        kind_a == BodyKind::rigid &&
        (Type::is_contact ? kind_b == BodyKind::fixed : !Type::has_restitution && kind_b == BodyKind::rigid);

    /// Stores the velocity of a body; of a contact only in lanes that have one.
    template <BodyKind kind>
    [[gnu::always_inline]] static void store_copy(const BlockStreams& streams, std::int64_t block,
                                                  const Bundle& bundle, Body<kind> body, float* lanes)
    {
        if constexpr (kind == BodyKind::rigid) {
            if constexpr (Type::is_contact) {
                const auto present =
                    load_lanes(streams.present + block * block_lanes + bundle.lane) > Lanes(0);
                for_each_component(body, load_row<Body<kind>>(lanes), [&](Lanes& now, const Lanes& before) {
                    now = select(present, now, before);
                });
            }
            store_copy_velocity(body, lanes);
        }
    }

    static void stiffen_copies(const KernelContext& context, const BlockStreams& streams, std::int32_t block,
                               float* body_a, float* body_b)
    {
        const Lanes h(context.step.substep);
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            const Tension<Lanes> tension =
                Type::template tension<Lanes>(load_row<Row>(bundle.row), load_row<Impulse>(bundle.impulse));
            A a = load_row<A>(body_a + bundle.lane);
            B b = load_row<B>(body_b + bundle.lane);
            motley::stiffen(a, tension.arm_a, tension.push_a, h);
            motley::stiffen(b, tension.arm_b, tension.push_b, h);
            store_copy_inertia(a, body_a + bundle.lane);
            store_copy_inertia(b, body_b + bundle.lane);
        });
    }

    [[gnu::noinline]] static void warm_start_copies(const KernelContext& context, const BlockStreams& streams,
                                                    std::int32_t block, float* body_a, float* body_b)
    {
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            bound_warm_start(context, bundle, [&] {
                return std::pair{load_copy<kind_a>(body_a + bundle.lane),
                                 load_copy<kind_b>(body_b + bundle.lane)};
            });
            A a = load_copy<kind_a>(body_a + bundle.lane);
            B b = load_copy<kind_b>(body_b + bundle.lane);
            begin_substep(bundle, a, b);
            store_copy(streams, block, bundle, a, body_a + bundle.lane);
            store_copy(streams, block, bundle, b, body_b + bundle.lane);
        });
    }

    static void solve_copies(const KernelContext& context, const BlockStreams& streams, std::int32_t block,
                             float* body_a, float* body_b)
    {
        sweep_copies(context, context.step, streams, block, body_a, body_b);
    }
    static void relax_copies(const KernelContext& context, const BlockStreams& streams, std::int32_t block,
                             float* body_a, float* body_b)
    {
        sweep_copies(context, context.relaxing, streams, block, body_a, body_b);
    }
    [[gnu::always_inline]] static void renew_responses_of_copies(const KernelContext& context,
                                                                 const BlockStreams& streams,
                                                                 std::int32_t block, const float* body_a,
                                                                 const float* body_b)
    {
        if constexpr (may_renew) {
            if (has_turned_far(context)) [[unlikely]]
                renew_rows_of_copies(context, streams, block, body_a, body_b);
        }
    }
    [[gnu::noinline, gnu::cold]] static void renew_rows_of_copies(const KernelContext& context,
                                                                  const BlockStreams& streams,
                                                                  std::int32_t block, const float* body_a,
                                                                  const float* body_b)
    {
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            renew_row(bundle, load_copy<kind_a>(body_a + bundle.lane),
                      load_copy<kind_b>(body_b + bundle.lane));
        });
    }
    [[gnu::noinline]] static void sweep_copies(const KernelContext& context, const StepConstants& step,
                                               const BlockStreams& streams, std::int32_t block, float* body_a,
                                               float* body_b)
    {
        renew_responses_of_copies(context, streams, block, body_a, body_b);
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            A a = load_copy<kind_a>(body_a + bundle.lane);
            B b = load_copy<kind_b>(body_b + bundle.lane);
            auto impulse = load_row<Impulse>(bundle.impulse);
            const auto row = load_row<Row>(bundle.row);
            Type::template solve<Lanes>(step, swept<has_substep_row>(row), load_row<Substep>(bundle.substep),
                                        impulse, a, b);
            store_row(impulse, bundle.impulse);
            store_copy(streams, block, bundle, a, body_a + bundle.lane);
            store_copy(streams, block, bundle, b, body_b + bundle.lane);
        });
    }

    static void restitute_copies(const KernelContext& context, const BlockStreams& streams,
                                 std::int32_t block, float* body_a, float* body_b)
    {
        renew_responses_of_copies(context, streams, block, body_a, body_b);
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            A a = load_copy<kind_a>(body_a + bundle.lane);
            B b = load_copy<kind_b>(body_b + bundle.lane);
            auto impulse = load_row<Impulse>(bundle.impulse);
            Type::template restitute<Lanes>(context.step, load_row<Row>(bundle.row), impulse, a, b);
            store_row(impulse, bundle.impulse);
            store_copy(streams, block, bundle, a, body_a + bundle.lane);
            store_copy(streams, block, bundle, b, body_b + bundle.lane);
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

    static void act(const KernelContext& context, const BlockStreams& streams, std::int32_t block,
                    const float* body_a, const float* body_b, float* row, float* by,
                    const ConstraintKernels::SoftLanes& soft, float* taken_a, float* taken_b,
                    const float* only)
    {
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            const int lane = bundle.lane;
            const auto before = load_row<Impulse>(bundle.impulse);
            auto impulse = before;
            auto substep = load_row<Substep>(bundle.substep);
            ActingRow<Lanes> acting =
                Type::template act<Lanes>(context.step, load_row<Row>(bundle.row), substep, impulse,
                                          load_row<A>(body_a + lane), load_row<B>(body_b + lane));
            if (only != nullptr) {
                const auto changes = load_lanes(only + lane) > Lanes(0);
                keep_where_not(changes, before, impulse);
                acting.by = select(changes, acting.by, load_lanes(by + lane));
                acting.taken_back = select(changes, acting.taken_back, Lanes(0));
                acting.given = select(changes, acting.given, load_lanes(soft.given + lane));
            }
            const auto has_mass = substep.effective_mass > Lanes(0);
            substep.effective_mass = select(has_mass, substep.effective_mass, acting.effective_mass);
            leave_to_tree(substep, acting.by);
            store_row(impulse, bundle.impulse);
            store_row(substep, bundle.substep);
            const EqualityRow<Lanes>& whole = acting.row;
            const Lanes none(0);
            const Lanes share = select(acting.by > none, Lanes(1), none);
            const auto by_motor = acting.by > Lanes(ActsBy::limit);
            const Lanes speed = select(by_motor, whole.speed, none);
            store_row(EqualityRow<Lanes>{share * whole.linear, share * whole.lever_a, share * whole.lever_b,
                                         select(by_motor, none, share * whole.error), speed - acting.given},
                      row + lane);
            store_lanes(acting.by, by + lane);
            store_lanes(acting.give, soft.give + lane);
            store_lanes(acting.given, soft.given + lane);
            store_lanes(speed, soft.speed + lane);
            const auto take = [&](float* from, const Lanes& push, const Vec3<Lanes>& lever) {
                if (from == nullptr) return;
                float* const linear = from + lane;
                float* const angular = linear + 3 * block_lanes;
                store_row(load_row<Vec3<Lanes>>(linear) + push * whole.linear, linear);
                store_row(load_row<Vec3<Lanes>>(angular) + push * lever, angular);
            };
            take(taken_a, -acting.taken_back, whole.lever_a);
            take(taken_b, acting.taken_back, whole.lever_b);
        });
    }
    /// Without an effective mass, sweeps change neither the limit nor the motor. A spring that acts leaves them to the sweeps.
    static void leave_to_tree(Substep& substep, const Lanes& by)
    {
        const Lanes none(0);
        const auto by_spring = by > Lanes(ActsBy::motor);
        substep.effective_mass =
            select(by > none, select(by_spring, substep.effective_mass, none), substep.effective_mass);
        if constexpr (Type::has_motor) {
            substep.spring_effective_mass = select(by_spring, none, substep.spring_effective_mass);
            substep.spring_kept = select(by_spring, none, substep.spring_kept);
        }
    }
    template <class Mask, class Fields>
    static void keep_where_not(const Mask& changes, const Fields& before, Fields& now)
    {
        const Lanes* const from = reinterpret_cast<const Lanes*>(&before);
        Lanes* const to = reinterpret_cast<Lanes*>(&now);
        for (int i = 0; i < fields_of<Fields>; ++i) to[i] = select(changes, to[i], from[i]);
    }

    static void exceeds(const BlockStreams& streams, std::int32_t block, const float* by, float* exceeding)
    {
        const int count = streams.counts[block];
        const auto at = [&](float* stream, int floats) {
            return stream + std::int64_t{block} * floats * block_lanes;
        };
        for (int lane = 0; lane < count; lane += Lanes_width) {
            const Lanes now = Type::template exceeds<Lanes>(
                load_row<Row>(at(streams.rows, fields_of<Row>) + lane),
                load_row<Impulse>(at(streams.impulses, fields_of<Impulse>) + lane), load_lanes(by + lane));
            store_lanes(maximum(now, load_lanes(exceeding + lane)), exceeding + lane);
        }
    }

    static void set_aside(const BlockStreams& streams, std::int32_t block, const float* by)
    {
        const int count = streams.counts[block];
        for (int lane = 0; lane < count; lane += Lanes_width) {
            float* const at = streams.substep_rows + static_cast<std::int64_t>(block) * substep_stride + lane;
            auto substep = load_row<Substep>(at);
            leave_to_tree(substep, load_lanes(by + lane));
            store_row(substep, at);
        }
    }

    static void lengthen_steps(const BlockStreams& streams, std::int32_t block, const float* body_a,
                               const float* body_b, const float* arm_a, const float* arm_b)
    {
        const int count = streams.counts[block];
        for (int lane = 0; lane < count; lane += Lanes_width) {
            float* const at = streams.substep_rows + static_cast<std::int64_t>(block) * substep_stride + lane;
            auto substep = load_row<Substep>(at);
            Type::template lengthen_step<Lanes>(
                substep, load_row<A>(body_a + lane), load_row<Vec3<Lanes>>(arm_a + lane),
                load_row<B>(body_b + lane), load_row<Vec3<Lanes>>(arm_b + lane));
            store_row(substep, at);
        }
    }

    /// Enters what every substep runs.
    static void enter_swept(ConstraintKernels& kernels)
    {
        static_assert(fields_of<Impulse> <= most_impulse_floats);
        if constexpr (has_copies) {
            kernels.warm_start_copies = warm_start_copies;
            kernels.solve_copies = solve_copies;
            kernels.relax_copies = relax_copies;
            if constexpr (Type::equality_count > 0) {
                kernels.equality_rows = equality_rows;
                kernels.equality_count = Type::equality_count;
            }
            if constexpr (Type::turns_about_points) kernels.lengthen_steps = lengthen_steps;
        }
        kernels.warm_start = warm_start;
        kernels.solve = solve;
        kernels.relax = relax;
        kernels.add_up = add_up;
        kernels.row_floats = fields_of<Row>;
        kernels.swept_floats = fields_of<Swept> + fields_of<Substep>;
        kernels.substep_floats = fields_of<Substep>;
        kernels.impulse_floats = fields_of<Impulse>;
        kernels.sum_floats = fields_of<Sum>;
    }

    /// Enters what runs at the start and at the end of a step.
    static void enter_once(ConstraintKernels& kernels)
    {
        kernels.prepare = prepare;
        kernels.store = store;
    }

    /// Enters what only some settings or definitions need.
    static void enter_rare(ConstraintKernels& kernels)
    {
        if constexpr (Type::has_restitution) {
            kernels.restitute = restitute;
            if constexpr (has_copies) kernels.restitute_copies = restitute_copies;
        }
        // Few bodies are under such loads, so one scalar copy of this serves every instruction set.
        if constexpr (Type::pulls_at_arms && Lanes_width == 1) {
            kernels.stiffen = stiffen;
            if constexpr (has_copies) kernels.stiffen_copies = stiffen_copies;
        }
        if constexpr (has_copies && Type::active_row != ActiveRow::none) {
            kernels.act = act;
            kernels.set_aside = set_aside;
            if constexpr (Type::has_motor) kernels.exceeds = exceeds;
            kernels.active_impulses = Type::has_motor ? 3 : 1;
        }
        kernels.project = project;
    }
};
