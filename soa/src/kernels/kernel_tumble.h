// The rotation of rigid bodies by a substep, one body per lane. Included inside an anonymous namespace, after kernel_bodies.h.
#pragma once

/// Whether a body precesses too fast to be rotated in one piece: the square of its turn in radians is above 0.01. Its
/// energy would grow by z^4 / 4 in each, with z the turn of w in the body's frame.
inline auto precesses(const Lanes& turn_squared, const Lanes& spread)
{
    return (turn_squared > Lanes(0.01F)) & (spread > Lanes(0.1F));
}

/// Replaces the rotation of `to` in the lanes of the mask.
template <class Mask>
void replace_rotation(Body<BodyKind::rigid>& to, const Mask& mask, const Body<BodyKind::rigid>& from)
{
    const auto replace = [&](auto& into, const auto& by) {
        for (int k = 0; k < fields_of<std::remove_cvref_t<decltype(into)>>; ++k) {
            Lanes& field = reinterpret_cast<Lanes*>(&into)[k];
            field = select(mask, reinterpret_cast<const Lanes*>(&by)[k], field);
        }
    };
    replace(to.delta_rotation, from.delta_rotation);
    replace(to.angular, from.angular);
    replace(to.inverse_inertia, from.inverse_inertia);
}

/// Rotates a body in sixteen pieces, all with the same angular momentum.
inline void rotate_in_pieces(Body<BodyKind::rigid>& body, const Sym3<Lanes>& start, const Lanes& h)
{
    constexpr int pieces = 16;
    const Lanes piece = Lanes(1.0F / pieces) * h;
    const Vec3<Lanes> momentum = inverse(body.inverse_inertia) * body.angular;
    Quat<Lanes>& q = body.delta_rotation;
    for (int k = 0; k < pieces; ++k) {
        const Quat<Lanes> half_way = rotation_by(Lanes(0.5F) * piece * body.angular) * q;
        q = normalised(rotation_by(piece * (rotate_tensor(half_way, start) * momentum)) * q);
        body.inverse_inertia = rotate_tensor(q, start);
        body.angular = body.inverse_inertia * momentum;
    }
}

/// Rotates again what Tumble cannot rotate well: `body` is `before` after Tumble, `start` is I^-1 when the step began,
/// and `offsets` says where the body is in `arrays`.
///
/// A body with joints keeps I and w where a response would more than double. Sweeps divide by the responses that rows had
/// when they were made: when the substep began, or, of manifolds, when the step began. Where a response has become c times
/// as high since, a sweep leaves 1 - c of the speed that it should take away, and above c = 2 that is more than there was:
/// relaxation, or the next substep, throws the body. The change is looked at half way through the substep, where it is
/// about a quarter of that at the end: beyond `most_change`, responses double. Any other body that precesses() is rotated
/// in pieces. Contacts are told when a body has turned far, and find their responses anew.
inline void rotate_again(Body<BodyKind::rigid>& body, const Body<BodyKind::rigid>& before,
                         const Sym3<Lanes>& start, const Lanes& h, const BodyArrays& arrays,
                         const std::int32_t* offsets)
{
    const Vec3<Lanes>& w = before.angular;
    const Sym3<Lanes> inertia = inverse(before.inverse_inertia);
    const Sym3<Lanes> half_way =
        rotate_tensor(rotation_by(Lanes(0.5F) * h * w) * before.delta_rotation, start);
    const Lanes turn_squared = h * h * dot(w, w), one(1);
    const Lanes in_substep = change_of_inertia(inertia, half_way);
    const Lanes in_step = change_of_inertia(inverse(start), half_way);
    const auto fast =
        precesses(turn_squared, spread_of(inertia, before.inverse_inertia)) & (turn_squared < one);
    if (!any(maximum(in_substep, in_step) > Lanes(most_change)) && !any(fast)) return;
    alignas(64) float has_joints[Lanes_width], has_start_rows[Lanes_width];  // 1 or 0
    for (int lane = 0; lane < Lanes_width; ++lane) {
        const std::uint32_t mask = arrays.joint_colours[offsets[lane] / offsets_a_row(BodyKind::rigid)];
        has_joints[lane] = mask != 0 ? 1.0F : 0.0F;
        has_start_rows[lane] = (mask & start_rows_bit) != 0 ? 1.0F : 0.0F;
    }
    const Lanes jointed = load_lanes(has_joints), from_start = load_lanes(has_start_rows);
    Body<BodyKind::rigid> kept = before;
    kept.delta_rotation = normalised(rotation_by(h * w) * before.delta_rotation);
    const Lanes most = maximum(jointed * in_substep, from_start * in_step);
    replace_rotation(body, most > Lanes(most_change), kept);
    const auto in_pieces = fast & (Lanes(most_change) > most);
    if (!any(in_pieces)) return;
    Body<BodyKind::rigid> fine = before;
    rotate_in_pieces(fine, start, h);
    replace_rotation(body, in_pieces, fine);
}

/// Rotates a body by its angular velocity at the middle of the substep, and carries its angular momentum L = I w
/// through the rotation (I: inertia, w: angular velocity): afterwards w = I^-1 L with the rotated inertia. So L is
/// kept to rounding, the rotation is right to second order, and a tumbling body cannot gain energy without bound. A
/// body that turns by more than a radian per substep, which no substep can follow, or that has no inverse inertia
/// keeps w instead, and with it its energy.
///
/// Its functions are called in the order in which they are written here; the body changes in the last one. Each is a chain of
/// operations that depends on the one before, so that a processor waits for one body at a time. Where there are many, several are
/// taken through each function together: a step of chains takes 0.9 of the time (tumbling_together).
class Tumble {
  public:
    /// `h` is the substep, s.
    void begin(const Body<BodyKind::rigid>& body, const Lanes& h)
    {
        const Sym3<Lanes> inertia = inverse(body.inverse_inertia);
        turn_squared_ = h * h * dot(body.angular, body.angular);
        momentum_ = inertia * body.angular;
        spread_ = spread_of(inertia, body.inverse_inertia);
    }
    void turn_half_way(const Body<BodyKind::rigid>& body, const Lanes& h)
    {
        rotation_ = rotation_by(Lanes(0.5F) * h * body.angular) * body.delta_rotation;
    }
    /// `start` is I^-1 when the step began.
    void find_speed(const Body<BodyKind::rigid>& body, const Sym3<Lanes>& start)
    {
        speed_ = speed_with(rotate_tensor(rotation_, start), body);
    }
    void turn(const Body<BodyKind::rigid>& body, const Lanes& h)
    {
        rotation_ = normalised(rotation_by(h * speed_) * body.delta_rotation);
    }
    /// Returns whether a lane may want rotate_again() or tell_contacts().
    [[nodiscard]] bool end(Body<BodyKind::rigid>& body, const Sym3<Lanes>& start) const
    {
        const Sym3<Lanes> inverse_inertia = rotate_tensor(rotation_, start);
        body.angular = speed_with(inverse_inertia, body);
        body.inverse_inertia = inverse_inertia;
        body.delta_rotation = rotation_;
        const Lanes at_most =
            maximum(Lanes(4) * squared_half_sine(body), Lanes(0.25F) * turn_squared_) * spread_;
        // A little less than most_change: change_at_most(), which then decides, is rounded differently.
        return any(at_most > Lanes(0.9F * most_change)) || any(precesses(turn_squared_, spread_));
    }

  private:
    Lanes turn_squared_, spread_;
    Vec3<Lanes> momentum_, speed_;
    Quat<Lanes> rotation_;  ///< since the step began: half way through the substep, and then after it

    [[nodiscard]] Vec3<Lanes> speed_with(const Sym3<Lanes>& inverse_inertia,
                                         const Body<BodyKind::rigid>& before) const
    {
        const auto turns = (trace(before.inverse_inertia) > Lanes(0)) & (turn_squared_ < Lanes(1));
        const Vec3<Lanes>&speed = before.angular, w = inverse_inertia * momentum_;
        return {select(turns, w.x, speed.x), select(turns, w.y, speed.y), select(turns, w.z, speed.z)};
    }
};

/// Calls all functions of Tumble but end(), each for all bodies. for_each(work) calls work(Tumble, body, start) for each of them, where start() is
/// I^-1 when the step began.
template <class ForEach>
[[gnu::always_inline]] inline void begin_to_tumble(const ForEach& for_each, const Lanes& h)
{
    using Mover = Body<BodyKind::rigid>;
    for_each([&](Tumble& tumble, const Mover& body, const auto&) { tumble.begin(body, h); });
    for_each([&](Tumble& tumble, const Mover& body, const auto&) { tumble.turn_half_way(body, h); });
    for_each([&](Tumble& tumble, const Mover& body, const auto& start) { tumble.find_speed(body, start()); });
    for_each([&](Tumble& tumble, const Mover& body, const auto&) { tumble.turn(body, h); });
}
/// How many bundles of bodies are rotated together. 2 and 8 take the same time.
constexpr int tumbling_together = 4;

/// rotate_again() for bodies whose state before is that of the arrays. It takes little, so that the call is small where it is
/// inlined.
[[gnu::noinline, gnu::cold]] inline void rotate_rows_again(Body<BodyKind::rigid>& body,
                                                           const BodyArrays& arrays,
                                                           const std::int32_t* offsets, float h)
{
    rotate_again(body, load_body(arrays, offsets, static_cast<Body<BodyKind::rigid>*>(nullptr)),
                 load_tensor(arrays.start_inverse_inertia, offsets), Lanes(h), arrays, offsets);
    tell_contacts(body, arrays);
}
