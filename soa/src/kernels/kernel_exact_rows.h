// The kernels that exact joints and limits need of a constraint: its rows, and what takes its sweeps' place. Included inside an
// anonymous namespace, after kernel_blocks.h.
#pragma once

template <class Type, BodyKind kind_a, BodyKind kind_b>
struct ExactRowKernels : ConstraintBlocks<Type, kind_a, kind_b> {
    using Blocks = ConstraintBlocks<Type, kind_a, kind_b>;
    using Blocks::for_each_bundle, Blocks::has_copies, Blocks::row_stride, Blocks::substep_stride;
    using typename Blocks::A, typename Blocks::B, typename Blocks::Bundle, typename Blocks::Impulse,
        typename Blocks::Row, typename Blocks::Substep;

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
            const Lanes none(0);
            Lanes speed = select(acting.by > Lanes(ActsBy::limit), acting.row.speed, none);
            Lanes give_of_all = acting.give_of_all();
            if (only != nullptr) {
                const auto changes = load_lanes(only + lane) > none;
                const auto keep = [&](Lanes& now, const float* at) {
                    now = select(changes, now, load_lanes(at + lane));
                };
                keep_where_not(changes, before, impulse);
                keep(acting.by, by);
                acting.taken_back = select(changes, acting.taken_back, none);
                keep(acting.given, soft.given);
                keep(speed, soft.speed);
                keep(give_of_all, soft.give_of_all);
                keep(acting.give, soft.give);
                keep(acting.least, soft.least);
                keep(acting.most, soft.most);
            }
            const auto has_mass = substep.effective_mass > none;
            substep.effective_mass = select(has_mass, substep.effective_mass, acting.effective_mass);
            leave_to_tree(substep, acting.by);
            store_row(impulse, bundle.impulse);
            store_row(substep, bundle.substep);
            const EqualityRow<Lanes>& whole = acting.row;
            const Lanes share = select(acting.by > none, Lanes(1), none);
            const Lanes by_limit = select(acting.by > Lanes(ActsBy::limit), none,
                                          select(acting.by > Lanes(ActsBy::rotor), Lanes(1), none));
            store_row(EqualityRow<Lanes>{share * whole.linear, share * whole.lever_a, share * whole.lever_b,
                                         by_limit * whole.error, speed - acting.given},
                      row + lane);
            store_lanes(acting.by, by + lane);
            store_lanes(give_of_all, soft.give_of_all + lane);
            store_lanes(acting.least, soft.least + lane);
            store_lanes(acting.most, soft.most + lane);
            if (soft.rotor != nullptr) {
                store_lanes(acting.give, soft.give + lane);
                store_lanes(acting.rotor, soft.rotor + lane);
            }
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
    /// Without an effective mass, sweeps change neither the limit nor the motor. A spring that acts leaves them to the sweeps, and
    /// so does a rotor alone.
    static void leave_to_tree(Substep& substep, const Lanes& by)
    {
        const Lanes none(0);
        const auto by_spring = by > Lanes(ActsBy::motor);
        substep.effective_mass =
            select(by > Lanes(ActsBy::rotor), select(by_spring, substep.effective_mass, none),
                   substep.effective_mass);
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

    /// Enters what exact joints read in every substep.
    static void enter_swept(ConstraintKernels& kernels)
    {
        if constexpr (has_copies) {
            if constexpr (Type::equality_count > 0) {
                kernels.equality_rows = equality_rows;
                kernels.equality_count = Type::equality_count;
            }
            if constexpr (Type::turns_about_points) kernels.lengthen_steps = lengthen_steps;
        }
    }
    /// Enters what exact limits read.
    static void enter_rare(ConstraintKernels& kernels)
    {
        if constexpr (has_copies && Type::active_row != ActiveRow::none) {
            kernels.act = act;
            kernels.set_aside = set_aside;
            kernels.active_impulses = Type::has_motor ? 3 : 1;
        }
    }
};
