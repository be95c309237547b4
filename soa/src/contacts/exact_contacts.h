// SolverSettings::exact_contacts: the contacts of each island are solved at once.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "layout/batches.h"
#include "layout/body_sets.h"
#include "stores/array.h"

namespace motley {

struct IslandContact;

class ExactContacts {
  public:
    /// An island whose matrix would take more products of blocks than this is left to the sweeps.
    static constexpr std::int64_t most_products = 300'000;

    ExactContacts();
    ~ExactContacts();

    /// Finds the islands of a step of dt seconds: its listed contacts, those of capsules, and those of discs near each
    /// other. Makes all space that is needed to solve them.
    void find_islands(const BodyStore& bodies, const SweepLists& sweeps, std::span<const SweepChunk> discs,
                      float dt);
    [[nodiscard]] std::int64_t islands() const { return count_; }
    /// Islands that are left to the sweeps.
    [[nodiscard]] std::int64_t left_out() const { return left_out_; }

    /// Once rows and impulses are prepared, and before anything changes them.
    void begin(std::int64_t i);
    /// Solves island i, 0 to islands() - 1; islands may be solved beside each other. With `relaxes` penetration asks for
    /// no speed.
    void solve(const KernelContext& context, std::int64_t i, bool relaxes);
    /// m/s, of the solves since find_islands(): the largest residual that was left.
    [[nodiscard]] double residual() const;

  private:
    struct Island;
    Array<IslandContact> contacts_, now_;  ///< by which the islands were made; of this step
    bool has_islands_ = false;
    BodySets sets_;
    Array<std::int32_t> island_of_;           ///< by root
    Array<std::int32_t> local_;               ///< number in its island, by BodySets::number
    Array<std::unique_ptr<Island>> islands_;  ///< never shrinks, so that islands keep their memory
    std::int64_t count_ = 0, left_out_ = 0;

    void list_contacts(const BodyStore& bodies, const SweepLists& sweeps, std::span<const SweepChunk> discs,
                       double dt);
    void make_islands(const BodyStore& bodies);
    Island& island_of(std::int32_t root);
    std::int32_t number_in(Island& island, BodyRow body);
};

}  // namespace motley
