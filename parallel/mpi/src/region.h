// The region of one rank, and its messages to the others: see RegionLink.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "motley/mpi/distributed_crowd.h"
#include "person_record.h"
#include "region_link.h"

namespace motley {

class Region final : public RegionLink {
  public:
    Region(MPI_Comm comm, Scene& scene);

    DistributedFigures figures;
    std::vector<OwnPerson> people;
    std::unordered_map<std::uint64_t, std::uint32_t> index_of;  ///< in `people`, by number

    [[nodiscard]] MPI_Comm comm() const { return comm_; }
    void begin_step() { has_spoken_ = refused_together_ = false; }
    /// Whether this rank, if its step is refused now, is waited for: it has sent something since begin_step(), and the others have
    /// not refused the step too.
    [[nodiscard]] bool has_left_others_waiting() const { return has_spoken_ && !refused_together_; }
    /// Takes a person off the list; the body stays.
    void forget_person(std::uint64_t number);
    /// Makes room for the numbers of bodies that were added.
    void grow_with_slots();
    /// People of this rank who sleep.
    [[nodiscard]] std::int64_t people_asleep(const SceneCore& scene) const;

    /// What people of the first band bore from contacts of the region below: the sums of one process begin with these.
    void bear_from_below(const SceneCore& scene, std::span<Borne> borne);

    // Checkpoints: see DistributedCrowd.
    void save(const std::string& path);
    void load(const std::string& path);

    [[nodiscard]] std::size_t first_band() const override { return first_; }
    [[nodiscard]] std::size_t last_band() const override { return last_; }
    [[nodiscard]] bool is_copy(std::uint32_t slot) const override
    {
        return slot < is_copy_.size() && is_copy_[slot] != 0;
    }
    void renew_copies(SceneCore& scene) override;
    [[nodiscard]] bool anybody_sleeps() const override { return anybody_sleeps_; }
    void spread_waking(SceneCore& scene) override;
    void renew_slowness(SceneCore& scene) override;
    void join_islands(const SceneCore& scene, const BodySets& islands,
                      std::span<std::uint8_t> restless) override;
    void note_sleepers(const SceneCore& scene) override;
    void agree(SearchVote& vote) override;
    void agree(float& reach, float& drift, double& room) override;
    bool is_so_everywhere(bool here) override;
    void refuse_everywhere(const char* what, std::int64_t count, const char* valid) override;
    void leave_copies_out(SceneCore& scene) override;
    void add_up(DiscStrips::Measured& measured) override;
    void add_up(std::span<std::uint32_t> discs_by_strip) override;
    void move_people(SceneCore& scene, const DiscStrips& strips, CarriedImpulses& carried) override;
    void list_pushed(const SceneCore& scene, const DiscStrips& strips) override;
    void send_velocities(const float* velocities, std::size_t parity) override;
    void take_velocities(float* velocities, std::size_t parity) override;

  private:
    enum Tag {
        states_tag = 1,
        pushed_tag,
        velocities_tag,
        loads_tag,
        slowness_tag,
        islands_tag,
        forgotten_tag
    };
    static constexpr int nobody = MPI_PROC_NULL;
    /// A border: with the region above, its people are copies here; with the region below, people here have copies there.
    struct Border {
        int rank = nobody;
        std::vector<BodyId> people;         ///< the whole band beside the border, in the order of the strips
        std::vector<std::uint32_t> pushed;  ///< those whom both sides may push, by index in `people`
        std::vector<std::uint32_t> rows;    ///< of `pushed`
        std::vector<float> outgoing, incoming;
    };
    MPI_Comm comm_;
    Scene& scene_;
    int rank_ = 0, ranks_ = 1;
    std::size_t first_ = 1, last_ = 1;
    std::vector<std::size_t> starts_;  ///< by rank: its first band; one more at the end
    /// By strip: whose it is, and who has copies of its people, or nobody.
    std::vector<int> owners_, copiers_;
    std::vector<std::size_t> strip_of_;       ///< by row, while people move
    std::vector<std::uint8_t> is_forgotten_;  ///< by row, of copies: see DiscStore::is_forgotten_row
    Border above_, below_;
    bool is_dealt_anew_ = false;
    std::vector<ImpulseRecord> waiting_impulses_;  ///< from a checkpoint, for the first search
    std::vector<std::uint8_t> is_copy_;            ///< by slot
    std::vector<PersonState> outgoing_states_, incoming_states_;
    std::vector<MPI_Request> requests_;
    bool has_spoken_ = false, refused_together_ = false;

    // Sleep: an island is named by the smallest number of its people.
    bool anybody_sleeps_ = false;
    /// By slot, copies included: whether the body slept when all ranks last told each other who has woken...
    std::vector<std::uint8_t> was_asleep_;
    std::vector<std::uint64_t> island_of_;  ///< ...and in which island
    std::size_t sleepers_ = 0;              ///< how many of them sleep, unless somebody has woken since
    std::vector<std::uint64_t> woken_, woken_everywhere_;  ///< islands
    /// Of an island, as one rank knows it.
    struct Part {
        std::uint64_t island = UINT64_MAX, is_restless = 0;
    };

    [[nodiscard]] int rank_of(std::size_t band) const;
    void deal_out(const DiscStrips& strips);
    static ImpulseRecord record_of(const SceneCore& scene, std::uint32_t row, std::uint32_t other,
                                   bool is_wall, const CarriedImpulses::Impulse& impulse);
    template <class Record>
    std::vector<Record> exchange(const std::vector<std::vector<Record>>& outgoing);
    std::vector<std::vector<ImpulseRecord>> take_out_impulses(const SceneCore& scene,
                                                              CarriedImpulses& carried) const;
    [[nodiscard]] std::vector<std::vector<ImpulseRecord>> impulses_by_person(const SceneCore& scene) const;
    void send_waiting_impulses(const SceneCore& scene, std::vector<std::vector<ImpulseRecord>>& records);
    void take_in_people(SceneCore& scene, std::span<const PersonRecord> people);
    void take_in_impulses(const SceneCore& scene, std::span<const ImpulseRecord> impulses,
                          CarriedImpulses& carried) const;
    void remove_those_who_go(SceneCore& scene);
    [[nodiscard]] PersonRecord read(const SceneCore& scene, std::uint32_t slot) const;
    void list_woken(const SceneCore& scene);
    bool exchange_parts(const SceneCore& scene, const Border& to, const Border& from, const BodySets& islands,
                        std::vector<Part>& parts) const;
    /// The slots of which was_asleep_ knows something are those below.
    [[nodiscard]] std::uint32_t known_slots(const SceneCore& scene) const;
    /// Sends records across one border, and takes those that come across the other one, of which the number is known.
    template <class Record>
    void pass(const Border& to, const std::vector<Record>& outgoing, const Border& from,
              std::vector<Record>& incoming, Tag tag) const
    {
        MPI_Sendrecv(outgoing.data(), static_cast<int>(sizeof(Record) * outgoing.size()), MPI_BYTE, to.rank,
                     tag, incoming.data(), static_cast<int>(sizeof(Record) * incoming.size()), MPI_BYTE,
                     from.rank, tag, comm_, MPI_STATUS_IGNORE);
    }
    void list_copies_pushed(const SceneCore& scene);
    static void find_rows(const SceneCore& scene, Border& border);
    void send(Border& border, const float* velocities);
    void receive(Border& border);
    static void unpack(const Border& border, float* velocities);
};

}  // namespace motley
