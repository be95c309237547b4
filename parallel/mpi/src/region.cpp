// See region.h: what the ranks of a crowd agree on, and what they tell each other in every step. How people move from rank to
// rank is in migration.cpp.
#include "region.h"

#include <algorithm>
#include <array>
#include <string>

#include "motley/core/invalid_input.h"
#include "stopwatch.h"
#include "stores/disc_fields.h"
#include "stores/growth.h"

namespace motley {
namespace {

constexpr std::size_t floats_a_person = 3;  // vx vy w

}  // namespace

Region::Region(MPI_Comm comm, Scene& scene) : comm_(comm), scene_(scene)
{
    MPI_Comm_rank(comm, &rank_);
    MPI_Comm_size(comm, &ranks_);
    starts_.assign(static_cast<std::size_t>(ranks_) + 1, 1);
}

void Region::grow_with_slots()
{
    const std::size_t slots = core_of(scene_).bodies.slot_count();
    grow_to(core_of(scene_).discs.numbers, slots);
    grow_to(core_of(scene_).discs.shapes, slots);
    grow_to(is_copy_, slots);
    grow_to(was_asleep_, slots);
    grow_to(island_of_, slots);
}

void Region::renew_copies(SceneCore& scene)
{
    has_spoken_ = true;
    const Stopwatch watch(figures.seconds_agreeing);
    // Copies of people who were removed since go where they touch nobody, until everybody searches in this step.
    PersonState removed;
    removed.pose.position.x = static_cast<PoseReal>(1e15);
    outgoing_states_.assign(below_.people.size(), removed);
    for (std::size_t i = 0; i < below_.people.size(); ++i) {
        if (scene.bodies.is_alive(below_.people[i]))
            outgoing_states_[i] = read_state(scene, below_.people[i].slot);
    }
    incoming_states_.resize(above_.people.size());
    pass(below_, outgoing_states_, above_, incoming_states_, states_tag);
    for (std::size_t i = 0; i < above_.people.size(); ++i)
        write_state(scene, above_.people[i].slot, incoming_states_[i]);
    if (below_.rank != nobody) ++figures.messages;
    figures.bytes += static_cast<std::int64_t>(sizeof(PersonState) * outgoing_states_.size());
    // Rows may have been sorted since the last step.
    find_rows(scene, above_);
    find_rows(scene, below_);
}

void Region::agree(SearchVote& vote)
{
    const Stopwatch watch(figures.seconds_agreeing);
    // Not vote.discs, which counts copies as well.
    std::array<std::int64_t, 4> sums{static_cast<std::int64_t>(people.size()), vote.leaving, vote.late,
                                     vote.must_search ? 1 : 0};
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_INT64_T, MPI_SUM, comm_);
    vote = {sums[0], sums[1], sums[2], sums[3] > 0};
}

void Region::agree(float& reach, float& drift, double& room)
{
    const Stopwatch watch(figures.seconds_agreeing);
    std::array<double, 3> most{static_cast<double>(reach), static_cast<double>(drift), -room};
    MPI_Allreduce(MPI_IN_PLACE, most.data(), static_cast<int>(most.size()), MPI_DOUBLE, MPI_MAX, comm_);
    reach = static_cast<float>(most[0]);
    drift = static_cast<float>(most[1]);
    room = -most[2];
}

bool Region::is_so_everywhere(bool here)
{
    const Stopwatch watch(figures.seconds_agreeing);
    int all = here ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_LAND, comm_);
    return all != 0;
}

void Region::refuse_everywhere(const char* what, std::int64_t count, const char* valid)
{
    MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (count == 0) return;
    refused_together_ = true;
    refuse(what, static_cast<double>(count), valid);
}

void Region::add_up(DiscStrips::Measured& measured)
{
    const Stopwatch watch(figures.seconds_agreeing);
    std::array<double, 4> most{-measured.low.x, -measured.low.y, measured.high.x, measured.high.y};
    MPI_Allreduce(MPI_IN_PLACE, most.data(), static_cast<int>(most.size()), MPI_DOUBLE, MPI_MAX, comm_);
    measured.low = {-most[0], -most[1]};
    measured.high = {most[2], most[3]};
    MPI_Allreduce(MPI_IN_PLACE, &measured.discs, 1, MPI_INT64_T, MPI_SUM, comm_);
    MPI_Allreduce(MPI_IN_PLACE, measured.reaches.data(), DiscStrips::buckets, MPI_INT32_T, MPI_SUM, comm_);
}

void Region::add_up(std::span<std::uint32_t> discs_by_strip)
{
    const Stopwatch watch(figures.seconds_agreeing);
    MPI_Allreduce(MPI_IN_PLACE, discs_by_strip.data(), static_cast<int>(discs_by_strip.size()), MPI_UINT32_T,
                  MPI_SUM, comm_);
}

void Region::find_rows(const SceneCore& scene, Border& border)
{
    border.rows.resize(border.pushed.size());
    for (std::size_t i = 0; i < border.pushed.size(); ++i) {
        const BodyId body = border.people[border.pushed[i]];
        border.rows[i] = scene.bodies.is_alive(body) ? scene.bodies.row_of(body).row() : 0;
    }
}

/// Lists which copies the contacts of this region may push, and tells the region above.
void Region::list_pushed(const SceneCore& scene, const DiscStrips& strips)
{
    const Stopwatch watch(figures.seconds_agreeing);
    if (is_dealt_anew_) {
        const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
        const auto list = [&](Border& border, std::size_t band) {
            border.people.clear();
            if (border.rank == nobody) return;
            for (std::uint32_t p = strips.first_place(band); p < strips.first_place(band + 1); ++p)
                border.people.push_back(scene.bodies.id_of_slot(slots[strips.disc(p).row]));
        };
        list(above_, last_);
        list(below_, first_);
        is_dealt_anew_ = false;
    }
    list_copies_pushed(scene);
    figures.copies = static_cast<std::int64_t>(above_.people.size());
    figures.pushed = static_cast<std::int64_t>(above_.pushed.size());
    MPI_Request sent = MPI_REQUEST_NULL;
    MPI_Isend(above_.pushed.data(), static_cast<int>(above_.pushed.size()), MPI_UINT32_T, above_.rank,
              pushed_tag, comm_, &sent);
    MPI_Status status;
    MPI_Probe(below_.rank, pushed_tag, comm_, &status);
    int count = 0;
    if (below_.rank != nobody) MPI_Get_count(&status, MPI_UINT32_T, &count);
    below_.pushed.resize(static_cast<std::size_t>(count));
    MPI_Recv(below_.pushed.data(), count, MPI_UINT32_T, below_.rank, pushed_tag, comm_, MPI_STATUS_IGNORE);
    MPI_Wait(&sent, MPI_STATUS_IGNORE);
    if (above_.rank != nobody) ++figures.messages;
    figures.bytes += static_cast<std::int64_t>(sizeof(std::uint32_t) * above_.pushed.size());
    for (Border* border : {&above_, &below_}) {
        find_rows(scene, *border);
        resize_with_room(border->outgoing, floats_a_person * border->pushed.size());
        resize_with_room(border->incoming, floats_a_person * border->pushed.size());
    }
}

void Region::list_copies_pushed(const SceneCore& scene)
{
    above_.pushed.clear();
    if (above_.rank == nobody) return;
    struct Place {
        std::uint32_t row, index;
    };
    std::vector<Place> places(above_.people.size());
    for (std::uint32_t i = 0; i < places.size(); ++i)
        places[i] = {scene.bodies.row_of(above_.people[i]).row(), i};
    const auto by_row = [](const Place& p, const Place& q) { return p.row < q.row; };
    std::sort(places.begin(), places.end(), by_row);
    std::vector<std::uint8_t> is_pushed(places.size(), 0);
    const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
    const auto note = [&](std::int32_t offset) {
        const std::uint32_t row = row_at(BodyKind::planar, offset).row();
        if (!is_copy(slots[row])) return;
        const auto place = std::lower_bound(places.begin(), places.end(), Place{row, 0}, by_row);
        if (place != places.end() && place->row == row) is_pushed[place->index] = 1;
    };
    for_each_disc_blocks(scene.discs.bands[last_ - 1], [&](auto c, const DiscBlocks& blocks) {
        for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
            note(blocks.bodies[block].b[lane]);
            if constexpr (!is_wall(c.value)) note(blocks.bodies[block].a[lane]);
        });
    });
    for (std::uint32_t i = 0; i < is_pushed.size(); ++i) {
        if (is_pushed[i] != 0) above_.pushed.push_back(i);
    }
}

void Region::bear_from_below(const SceneCore& scene, std::span<Borne> borne)
{
    std::vector<Borne> here(borne.size());
    if (above_.rank != nobody) scene.bear_disc_impulses(here);
    std::vector<Borne> outgoing, incoming(below_.pushed.size());
    for (const std::uint32_t index : above_.pushed) {
        const BodyId body = above_.people[index];
        outgoing.push_back(scene.bodies.is_alive(body) ? here[body.slot] : Borne{});
    }
    pass(above_, outgoing, below_, incoming, loads_tag);
    for (std::size_t i = 0; i < incoming.size() && below_.rank != nobody; ++i) {
        const BodyId body = below_.people[below_.pushed[i]];
        if (scene.bodies.is_alive(body)) borne[body.slot] = incoming[i];
    }
}

void Region::send(Border& border, const float* velocities)
{
    if (border.rank == nobody || border.pushed.empty()) return;
    for (std::size_t i = 0; i < border.rows.size(); ++i)
        std::copy_n(velocities + std::size_t{4} * border.rows[i], floats_a_person,
                    border.outgoing.data() + floats_a_person * i);
    MPI_Isend(border.outgoing.data(), static_cast<int>(border.outgoing.size()), MPI_FLOAT, border.rank,
              velocities_tag, comm_, &requests_.emplace_back());
    ++figures.messages;
    figures.bytes += static_cast<std::int64_t>(sizeof(float) * border.outgoing.size());
}

void Region::receive(Border& border)
{
    if (border.rank == nobody || border.pushed.empty()) return;
    MPI_Irecv(border.incoming.data(), static_cast<int>(border.incoming.size()), MPI_FLOAT, border.rank,
              velocities_tag, comm_, &requests_.emplace_back());
}

/// The contacts of a band change velocities in it and in the next one. So when the bands of a parity have been solved,
/// one side of each border has news: the lower side if its last band is of that parity, else the upper one.
void Region::send_velocities(const float* velocities, std::size_t parity)
{
    if (first_ == last_) return;
    const Stopwatch watch(figures.seconds_sweeping);
    requests_.clear();
    if (last_ % 2 == parity) receive(above_);
    if (first_ % 2 != parity) receive(below_);
    if (last_ % 2 != parity) send(above_, velocities);
    if (first_ % 2 == parity) send(below_, velocities);
}

void Region::unpack(const Border& border, float* velocities)
{
    for (std::size_t i = 0; i < border.rows.size(); ++i)
        std::copy_n(border.incoming.data() + floats_a_person * i, floats_a_person,
                    velocities + std::size_t{4} * border.rows[i]);
}

void Region::take_velocities(float* velocities, std::size_t parity)
{
    if (first_ == last_) return;
    const Stopwatch watch(figures.seconds_sweeping);
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
    if (last_ % 2 == parity) unpack(above_, velocities);
    if (first_ % 2 != parity) unpack(below_, velocities);
}

}  // namespace motley
