// The kernels that every substep runs. Included inside an anonymous namespace, after kernel_blocks.h.
#pragma once

template <class Type, BodyKind kind_a, BodyKind kind_b>
struct SweepKernels : ConstraintBlocks<Type, kind_a, kind_b> {
    using Blocks = ConstraintBlocks<Type, kind_a, kind_b>;
    using Blocks::for_each_bundle, Blocks::has_copies, Blocks::has_substep_row, Blocks::prefetch,
        Blocks::renew_responses, Blocks::renew_responses_of_copies, Blocks::sees_delta_once,
        Blocks::store_copy;
    using typename Blocks::A, typename Blocks::B, typename Blocks::Bundle, typename Blocks::Impulse,
        typename Blocks::Row, typename Blocks::Substep, typename Blocks::Sum, typename Blocks::Swept;

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
                const Sum summand = SweepKernels::summand(bundle);
                auto sum = load_row<Sum>(bundle.sum);
                const Lanes* more = reinterpret_cast<const Lanes*>(&summand);
                Lanes* fields = reinterpret_cast<Lanes*>(&sum);
                for (int i = 0; i < fields_of<Sum>; ++i) fields[i] = fields[i] + more[i];
                store_row(sum, bundle.sum);
            });
        }
    }

    // ---- the same for blocks of copies ----

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

    static void enter(ConstraintKernels& kernels)
    {
        static_assert(fields_of<Impulse> <= most_impulse_floats);
        if constexpr (has_copies) {
            kernels.warm_start_copies = warm_start_copies;
            kernels.solve_copies = solve_copies;
            kernels.relax_copies = relax_copies;
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
};
