// Pictures of a crowd on several ranks: each is gathered on one rank, and all ranks draw at once.
#pragma once

#include <mpi.h>

#include <optional>
#include <span>
#include <vector>

#include "measuring/runner.h"
#include "motley/mpi/distributed_crowd.h"
#include "worlds/scenes/open_crowd_people.h"

namespace motley::bench {

/// Writes the files that FrameWriter writes of the crowd in one process. Picture n is drawn by rank n modulo their number, as soon
/// as every rank has one. Every call but note_places() is made by all ranks. A picture that one of them cannot write is an error
/// on all.
class DistributedFrames {
  public:
    /// `walls`: in the scene of every rank, those of `people`. Throws std::runtime_error when the folder cannot be made.
    DistributedFrames(const RunOutputs& outputs, const OpenCrowdPeople& people,
                      std::span<const WallId> walls);
    /// To be called as the step of a picture begins, which shows people where they were then.
    void note_places(const DistributedCrowd& crowd);
    /// To be called when that step has ended.
    void write(DistributedCrowd& crowd);
    /// Draws what has been gathered since.
    void close(DistributedCrowd& crowd) { draw(crowd.executor()); }

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
    int rank_ = 0, ranks_ = 1;
    int gathered_ = 0;  ///< how many pictures, on any rank
    std::optional<FrameWriter> writer_;
    std::vector<Place> places_;  ///< of the people of this rank
    std::optional<View> view_;   ///< the picture that this rank is to draw

    [[nodiscard]] View view_of(std::vector<Place> places, std::vector<Pressed> pressed,
                               const std::vector<Leaning>& leaning) const;
    void draw(Executor& executor);
    /// Does something on each rank. What it throws on one of them is thrown on all.
    template <class Work>
    void try_on_all(const Work& work) const;
};

}  // namespace motley::bench
