// What a sweep changes of bodies, of a block of them in any place: see watched_sweep.h. Included inside an anonymous
// namespace, after kernel_integration.h.

/// Bodies as they are, fields of sixteen floats in line.
template <BodyKind kind>
void keep_bodies(const BodyArrays& arrays, const std::int32_t* offsets, float* kept)
{
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        store_row(load_body(arrays, offsets + lane, static_cast<Body<kind>*>(nullptr)), kept + lane);
    }
}

template <BodyKind kind>
void find_energy(const BodyArrays& arrays, const std::int32_t* offsets, const float* kept, float* energy,
                 float* inverse_mass)
{
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        const Body<kind> now = load_body(arrays, offsets + lane, static_cast<Body<kind>*>(nullptr));
        store_lanes(energy_of_change(load_row<Body<kind>>(kept + lane), now), energy + lane);
        store_lanes(inverse_mass_of<Lanes>(now), inverse_mass + lane);
    }
}

template <BodyKind kind>
void store_speeds(const Body<kind>& before, const Body<kind>& now, float* changes, float* speeds)
{
    store_lanes(square_of_speeds(change_between(before, now)), changes);
    store_lanes(square_of_speeds(before), speeds);
}
template <BodyKind kind>
void find_speeds(const BodyArrays& arrays, const std::int32_t* offsets, const float* kept, float* changes,
                 float* speeds)
{
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        store_speeds(load_row<Body<kind>>(kept + lane),
                     load_body(arrays, offsets + lane, static_cast<Body<kind>*>(nullptr)), changes + lane,
                     speeds + lane);
    }
}
inline void find_copy_speeds(const float* copies, const float* kept, float* changes, float* speeds)
{
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        store_speeds(load_row<Mover>(kept + lane), load_row<Mover>(copies + lane), changes + lane,
                     speeds + lane);
    }
}

/// The velocity that was kept where `goes_on` is 0.
template <BodyKind kind>
Body<kind> going_on(const Body<kind>& now, const Body<kind>& before, const float* goes_on)
{
    Body<kind> body = now;
    const auto goes = load_lanes(goes_on) > Lanes(0);
    for_each_component(body, before,
                       [&](Lanes& new_one, const Lanes& old) { new_one = select(goes, new_one, old); });
    return body;
}
template <BodyKind kind>
void bring_back(const BodyArrays& arrays, const std::int32_t* offsets, const float* kept,
                const float* goes_on, int count)
{
    for (int lane = 0; lane < count; lane += Lanes_width) {
        const Body<kind> now = load_body(arrays, offsets + lane, static_cast<Body<kind>*>(nullptr));
        store_velocity(arrays, offsets + lane,
                       going_on(now, load_row<Body<kind>>(kept + lane), goes_on + lane), count - lane);
    }
}
inline void bring_copies_back(float* copies, const float* kept, const float* goes_on)
{
    for (int lane = 0; lane < block_lanes; lane += Lanes_width) {
        store_copy_velocity(
            going_on(load_row<Mover>(copies + lane), load_row<Mover>(kept + lane), goes_on + lane),
            copies + lane);
    }
}
