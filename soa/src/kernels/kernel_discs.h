// What contacts of discs, in blocks that are kept from step to step, do in their own way: the start of a step, and sweeps.
// Included inside an anonymous namespace, after kernel_blocks.h.
#pragma once

/// Rows of pairs from the poses of their discs; the impulses to start from; and sums of zero.
template <class Type>
void prepare_pairs(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                   std::int32_t end)
{
    using Blocks = ConstraintBlocks<Type, BodyKind::planar, BodyKind::planar>;
    using Row = typename Blocks::Row;
    using Impulse = typename Blocks::Impulse;
    const BodyPose* const poses = context.bodies[static_cast<int>(BodyKind::planar)].pose;
    const Lanes warm(context.step.warm_start_scale);
    constexpr std::int32_t a_row = offsets_a_row(BodyKind::planar);
    for (std::int32_t block = begin; block < end; ++block) {
        Blocks::for_each_bundle(context, streams, block, [&](const typename Blocks::Bundle& bundle) {
            alignas(64) float x[Lanes_width], y[Lanes_width];
            for (int lane = 0; lane < Lanes_width; ++lane) {
                const Vec3<PoseReal>& a = poses[bundle.offsets_a[lane] / a_row].position;
                const Vec3<PoseReal>& b = poses[bundle.offsets_b[lane] / a_row].position;
                x[lane] = static_cast<float>(b.x - a.x);
                y[lane] = static_cast<float>(b.y - a.y);
            }
            auto row = load_row<Row>(bundle.row);
            Type::template place_pair<Lanes>({load_lanes(x), load_lanes(y)}, row);
            store_row(row, bundle.row);
            auto impulse = load_row<Impulse>(bundle.impulse);
            Lanes* fields = reinterpret_cast<Lanes*>(&impulse);
            for (int i = 0; i < fields_of<Impulse>; ++i) fields[i] = warm * fields[i];
            store_row(impulse, bundle.impulse);
            Blocks::clear(bundle.sum);
        });
    }
}

/// Sweeps of a class, with or without measuring separations first.
template <class Type, BodyKind kind_a>
struct DiscSweeps {
    using Own = ConstraintBlocks<Type, kind_a, BodyKind::planar>;
    using Row = typename Own::Row;

    static void solve(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                      std::int32_t end)
    {
        if (context.discs_are_measured) {
            sweep<false>(context, context.step, streams, begin, end);
        } else {
            sweep<true>(context, context.step, streams, begin, end);
        }
    }
    static void relax(const KernelContext& context, const BlockStreams& streams, std::int32_t begin,
                      std::int32_t end)
    {
        sweep<true>(context, context.relaxing, streams, begin, end);
    }

  private:
    template <bool measures>
    [[gnu::noinline]] static void sweep(const KernelContext& context, const StepConstants& step,
                                        const BlockStreams& streams, std::int32_t begin, std::int32_t end)
    {
        for (std::int32_t block = begin; block < end; ++block) {
            Own::for_each_bundle(context, streams, block, [&](const typename Own::Bundle& bundle) {
                auto a = bundle.load_a();
                auto b = bundle.load_b();
                auto impulse = load_row<typename Own::Impulse>(bundle.impulse);
                auto row = load_row<Row>(bundle.row);
                if constexpr (measures) {
                    Type::template measure<Lanes>(row, a, b);
                    const auto field = &row.in_sweep.separation - reinterpret_cast<const Lanes*>(&row);
                    store_lanes(row.in_sweep.separation, bundle.row + field * block_lanes);
                }
                Type::template solve<Lanes>(step, row.in_sweep, typename Own::Substep{}, impulse, a, b);
                store_row(impulse, bundle.impulse);
                bundle.store_velocities(a, b);
            });
        }
    }
};
