#include "worlds/neighbours.h"

#include <algorithm>

namespace motley::bench {

void Neighbours::find(const Crowd& crowd, float within, Executor& executor)
{
    const std::size_t people = crowd.agents.size();
    positions_.assign(crowd.positions.begin(), crowd.positions.end());
    radii_.assign(crowd.radii().begin(), crowd.radii().end());
    person_.resize(people);
    for (std::size_t i = 0; i < people; ++i) person_[i] = static_cast<std::int32_t>(i);
    if (crowd.period_y > 0) add_images(crowd, static_cast<double>(within));
    grid_.sort(positions_, radii_, within, executor);
    pairs_.clear();
    for (std::int64_t chunk = 0; chunk < grid_.chunk_count(); ++chunk) {
        const std::size_t count = grid_.find_pairs(chunk, of_chunk_);
        for (std::size_t k = 0; k < count; ++k) {
            const NeighbourGrid::Pair pair = of_chunk_[k];
            const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
            // A pair of two images is the pair of the two people once more.
            if (a >= people && b >= people) continue;
            pairs_.push_back({person_[a], person_[b]});
        }
    }
    sort_by_person(people);
}

void Neighbours::add_images(const Crowd& crowd, double within)
{
    float largest = 0;
    for (const float radius : crowd.radii()) largest = std::max(largest, radius);
    const double reach = within + 2 * static_cast<double>(largest);
    // Only above the upper end: so each pair across the seam is found once.
    for (std::size_t i = 0; i < crowd.agents.size(); ++i) {
        const Vec3<double>& at = crowd.positions[i];
        if (at.y > reach) continue;
        positions_.push_back({at.x, at.y + crowd.period_y, 0});
        radii_.push_back(crowd.radii()[i]);
        person_.push_back(static_cast<std::int32_t>(i));
    }
}

/// Each pair appears in the lists of both.
void Neighbours::sort_by_person(std::size_t people)
{
    starts_.assign(people + 1, 0);
    for (const NeighbourGrid::Pair& pair : pairs_) {
        ++starts_[static_cast<std::size_t>(pair.a) + 1];
        ++starts_[static_cast<std::size_t>(pair.b) + 1];
    }
    for (std::size_t i = 0; i < people; ++i) starts_[i + 1] += starts_[i];
    others_.resize(starts_[people]);
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const NeighbourGrid::Pair& pair : pairs_) {
        others_[next[static_cast<std::size_t>(pair.a)]++] = pair.b;
        others_[next[static_cast<std::size_t>(pair.b)]++] = pair.a;
    }
}

}  // namespace motley::bench
