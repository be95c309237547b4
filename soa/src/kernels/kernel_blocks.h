// Blocks of constraints of a type and a pair of body kinds: what they hold, and a loop over their bundles. The kernels over them
// are in kernel_sweeps.h, kernel_once.h, kernel_rare.h and kernel_exact_rows.h: gather, maths, scatter, written once for every
// type, every pair and every instruction set. Included inside an anonymous namespace, after kernel_bundle.h.
#pragma once

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
struct ConstraintBlocks {
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

    /// Prefetches the bodies of the next block, if bodies exceed the core's cache.
    [[gnu::always_inline]] static void prefetch(bool with_delta, const KernelContext& context,
                                                const BlockStreams& streams, std::int32_t block,
                                                std::int32_t end)
    {
        if (context.bodies_are_far && block + 1 < end)
            prefetch_bodies(context, streams, block + 1, with_delta);
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

    static void clear(float* sum)
    {
        for (int i = 0; i < fields_of<Sum>; ++i) store_lanes(Lanes(0), sum + i * block_lanes);
    }

    /// Whether blocks of copies of a figure have such constraints: kernels for these find the bodies in lanes.
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
};
