// What a solve of the tree does to limits, motors, springs and rotors that act: their impulses, the speeds of rotors, and the speeds
// that their rows still have to reach. Included inside an anonymous namespace, after kernel_tree_rows.h and before
// kernel_trees.h.
#pragma once

/// `solves`: a solve of the step. `corrects`: one in exceeding copies only (FigureShape::exceeding). `answers`: the response of
/// the tree to an impulse while everything else is at rest. `tries`: finds impulses, at FigureNode::target, and applies none.
enum class TreeSweep { solves, corrects, answers, tries };

/// `now` in exceeding copies, `before` in the others.
template <class Value>
Value where_exceeding(const FigureBlock& figure, int lane, const Value& now, const Value& before)
{
    return select(load_lanes(figure.system + figure.shape->exceeding + lane) > Lanes(0), now, before);
}

/// The row of a limit, motor, spring or rotor that acts, in lanes.
struct ActingLanes {
    const FigureBlock& figure;
    const FigureNode& node;
    const FigureNode::Active& active;
    int row, lane;

    [[nodiscard]] float* of_row(std::int64_t array) const
    {
        return figure.system + array + row * block_lanes + lane;
    }
    /// Where the speed is that the row has to reach, with the sign of the node.
    [[nodiscard]] float* goal() const
    {
        return figure.system + node.speed_left(row, figure.rows_of(node)) + lane;
    }
    /// The same value with the sign of the joint in place of the node's, or the other way round.
    [[nodiscard]] Lanes turned(const Lanes& value) const { return active.reversed ? -value : value; }
    /// Impulse `i` of the joint: see ConstraintTraits::active_row.
    [[nodiscard]] float* impulse(int i) const
    {
        return figure.joints[active.joint].impulses() + i * block_lanes + lane;
    }
};

/// The law of a spring's row is J v + give lambda = speed with the whole lambda: what it has pushed is taken from the speed. A
/// rotor has the law J v + lambda / I = w with its present speed w; both together have
///
///   J v + give_of_all lambda = (what is left for the spring + give I w) / (1 + give I).
inline void set_goal(const ActingLanes& acting, const Lanes& by)
{
    const Lanes left =
        load_lanes(acting.of_row(acting.node.speed)) - load_lanes(acting.of_row(acting.node.given));
    if (!acting.active.has_rotor) return store_lanes(acting.turned(left), acting.goal());
    const Lanes speed = load_lanes(acting.impulse(RotorImpulse::speed));
    const Lanes weight =
        load_lanes(acting.of_row(acting.node.spring_give)) * load_lanes(acting.of_row(acting.node.rotor));
    const Lanes of_both = (left + weight * speed) / (Lanes(1) + weight);
    store_lanes(acting.turned(select(is_rotor_alone(by), speed, of_both)), acting.goal());
}

/// Gives a rotor of inertia I the speed that its row has after a solve with the impulse lambda. Returns what the rest of the row
/// has pushed: all of lambda but -I times the change of that speed.
inline Lanes turn_rotor(const ActingLanes& acting, const Lanes& by, const Lanes& lambda, const Lanes& rate,
                        TreeSweep sweep)
{
    const Lanes error = load_lanes(acting.figure.system + acting.node.error_of(acting.row) + acting.lane);
    const Lanes reached = acting.turned(load_lanes(acting.goal()) - rate * error -
                                        load_lanes(acting.of_row(acting.node.give)) * lambda);
    float* const change = acting.impulse(RotorImpulse::change);
    float* const speed = acting.impulse(RotorImpulse::speed);
    // In lanes without a rotor, and in copies that are not to be corrected, all stays: x + -0 is x for every x.
    const Lanes rotor = load_lanes(acting.of_row(acting.node.rotor)), none(-0.0F);
    Lanes more = select(rotor > Lanes(0), reached - load_lanes(speed), none);
    if (sweep == TreeSweep::corrects) more = where_exceeding(acting.figure, acting.lane, more, none);
    store_lanes(load_lanes(change) + more, change);
    store_lanes(load_lanes(speed) + more, speed);
    return select(by > Lanes(ActsBy::rotor), acting.turned(lambda) + rotor * more, none);
}

/// Adds what limits, motors and springs have just pushed to their impulses, which are in the order of ActsBy, and which
/// add_up() adds to the sum of the step.
[[gnu::noinline]] inline void add_to_impulses(const FigureBlock& figure, const FigureNode& node,
                                              const Lanes* lambda, const Lanes& rate, TreeSweep sweep,
                                              int lane)
{
    figure.for_each_acting(node, [&](const FigureNode::Active& active, int row, const float* acts_by) {
        const ActingLanes acting{figure, node, active, row, lane};
        const Lanes by = load_lanes(acts_by + lane);
        const Lanes pushed =
            active.has_rotor ? turn_rotor(acting, by, lambda[row], rate, sweep) : acting.turned(lambda[row]);
        const int impulses = figure.joints[active.joint].kernels->active_impulses;
        for (int i = 0; i < impulses; ++i) {
            const Lanes own(ActsBy::limit + static_cast<float>(i));
            float* const impulse = acting.impulse(i);
            const Lanes before = load_lanes(impulse);
            store_lanes(select(own > by, before, select(by > own, before, before + pushed)), impulse);
        }
        float* const given = acting.of_row(node.given);
        store_lanes(load_lanes(given) + load_lanes(acting.of_row(node.spring_give)) * pushed, given);
        if (!active.has_rotor) set_goal(acting, by);
    });
}

/// Before a solve, because the last one and sweeps have changed the speeds of rotors.
[[gnu::noinline]] inline void follow_rotors(const FigureBlock& figure, const FigureNode& node, int lane)
{
    figure.for_each_acting(node, [&](const FigureNode::Active& active, int row, const float* by) {
        if (active.has_rotor) set_goal({figure, node, active, row, lane}, load_lanes(by + lane));
    });
}
