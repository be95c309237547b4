// Measures what a sweep changes of the bodies of a block: see watched_sweep.h. Included inside an anonymous
// namespace, after kernel_integration.h.
#pragma once

/// Copies the bodies into fields of sixteen consecutive floats.
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

/// Restores the kept velocities.
template <BodyKind kind>
void bring_back(const BodyArrays& arrays, const std::int32_t* offsets, const float* kept, int count)
{
    for (int lane = 0; lane < count; lane += Lanes_width)
        store_velocity(arrays, offsets + lane, load_row<Body<kind>>(kept + lane), count - lane);
}
