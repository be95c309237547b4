// The kernels that only some settings or definitions need. Included inside an anonymous namespace, after kernel_blocks.h.
#pragma once

template <class Type, BodyKind kind_a, BodyKind kind_b>
struct RareKernels : ConstraintBlocks<Type, kind_a, kind_b> {
    using Blocks = ConstraintBlocks<Type, kind_a, kind_b>;
    using Blocks::for_each_bundle, Blocks::has_copies, Blocks::prefetch, Blocks::renew_responses,
        Blocks::renew_responses_of_copies, Blocks::store_copy;
    using typename Blocks::A, typename Blocks::B, typename Blocks::Bundle, typename Blocks::Impulse,
        typename Blocks::Row;

    /// Adds the geometric stiffness of the joint's force to the inertia of both bodies.
    static void stiffen_both(const KernelContext& context, const Bundle& bundle, A& a, B& b)
    {
        const Lanes h(context.step.substep);
        const Tension<Lanes> tension =
            Type::template tension<Lanes>(load_row<Row>(bundle.row), load_row<Impulse>(bundle.impulse));
        motley::stiffen(a, tension.arm_a, tension.push_a, h);
        motley::stiffen(b, tension.arm_b, tension.push_b, h);
    }
    static void stiffen(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                        std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                stiffen_both(context, bundle, a, b);
                store_inertia(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
                store_inertia(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
            });
        }
    }
    static void stiffen_copies(const KernelContext& context, const BlockStreams& streams, std::int32_t block,
                               float* body_a, float* body_b)
    {
        for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
            A a = load_row<A>(body_a + bundle.lane);
            B b = load_row<B>(body_b + bundle.lane);
            stiffen_both(context, bundle, a, b);
            store_copy_inertia(a, body_a + bundle.lane);
            store_copy_inertia(b, body_b + bundle.lane);
        });
    }

    /// Calls work(bundle, a, b) for each bundle of these blocks, with responses that are those of where the bodies are.
    template <class Work>
    [[gnu::always_inline]] static void for_each_pair(const KernelContext& context,
                                                     const BlockStreams& streams, std::int32_t begin,
                                                     std::int32_t end, const Work& work)
    {
        renew_responses(context, streams, begin, end);
        for (std::int32_t block = begin; block < end; ++block) {
            prefetch(true, context, streams, block, end);
            for_each_bundle(context, streams, block, [&](const Bundle& bundle) {
                A a = bundle.load_a();
                B b = bundle.load_b();
                work(bundle, a, b);
            });
        }
    }

    static void restitute(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                          std::int32_t end)
    {
        for_each_pair(context, streams, begin, end, [&](const Bundle& bundle, A& a, B& b) {
            auto impulse = load_row<Impulse>(bundle.impulse);
            Type::template restitute<Lanes>(context.step, load_row<Row>(bundle.row), impulse, a, b);
            store_row(impulse, bundle.impulse);
            bundle.store_velocities(a, b);
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

    static void project(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                        std::int32_t end)
    {
        for_each_pair(context, streams, begin, end, [&](const Bundle& bundle, A& a, B& b) {
            Type::template project<Lanes>(context.step, load_row<Row>(bundle.row), a, b);
            store_displaced(bundle.arrays_a, bundle.offsets_a, a, bundle.count);
            store_displaced(bundle.arrays_b, bundle.offsets_b, b, bundle.count);
        });
    }

    static void enter(ConstraintKernels& kernels)
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
        kernels.project = project;
    }
};
