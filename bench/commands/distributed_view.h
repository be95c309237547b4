// What is to be seen of a crowd on several ranks, gathered on one of them.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "motley/mpi/distributed_crowd.h"
#include "worlds/scenes/open_crowd_people.h"
#include "worlds/view.h"

namespace motley::bench {

class DistributedView {
  public:
    /// `walls`: in the scene of every rank, those of `people`.
    DistributedView(const OpenCrowdPeople& people, std::span<const WallId> walls);
    /// To be called as a step begins: the view shows people where they were then, as that of one process does.
    void note_places(const DistributedCrowd& crowd);
    /// Collective, when that step has ended: the view on rank `root`, nothing on the others.
    [[nodiscard]] std::optional<View> gather(const DistributedCrowd& crowd, int root) const;

  private:
    struct Place {
        std::uint64_t number;
        Vec2<double> at;
    };
    struct Pressed {
        std::uint64_t number;
        double pressure;  ///< N/m
    };
    struct Leaning {
        std::uint64_t number;
        std::int64_t wall;
        double force;  ///< N
    };
    const OpenCrowdPeople& people_;
    std::vector<WallId> walls_;
    std::vector<Place> places_;  ///< of the people of this rank

    [[nodiscard]] View view_of(std::vector<Place> places, std::vector<Pressed> pressed,
                               const std::vector<Leaning>& leaning) const;
};

/// Collective: does something on each rank. What it throws on one of them is thrown on all.
void try_on_all(const std::function<void()>& work);

}  // namespace motley::bench
