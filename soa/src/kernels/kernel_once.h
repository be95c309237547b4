// The kernels that run when a step begins and when it ends. Included inside an anonymous namespace, after kernel_blocks.h.
#pragma once

template <class Type, BodyKind kind_a, BodyKind kind_b>
struct OnceKernels : ConstraintBlocks<Type, kind_a, kind_b> {
    using Blocks = ConstraintBlocks<Type, kind_a, kind_b>;
    using Blocks::clear, Blocks::for_each_bundle, Blocks::may_be_exchanged, Blocks::order_of;
    using typename Blocks::A, typename Blocks::B, typename Blocks::Bundle, typename Blocks::Impulse,
        typename Blocks::Memory, typename Blocks::Parameters, typename Blocks::Row, typename Blocks::Sum;

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

    static void enter(ConstraintKernels& kernels)
    {
        kernels.prepare = prepare;
        kernels.store = store;
    }
};
