// See penetrations.h.
#include "penetrations.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stores/disc_fields.h"

namespace motley {
namespace {

/// Their root mean square and the deepest of them.
class Penetrations {
  public:
    /// Counts a contact with this separation, m, if it overlaps.
    void note(float separation)
    {
        if (!(separation < 0)) return;
        const auto depth = -static_cast<double>(separation);
        squares_ += depth * depth;
        max_ = std::max(max_, depth);
        ++overlapping_;
    }
    void fill_in(StepMeasures& measures) const
    {
        measures.penetration_max = max_;
        if (overlapping_ > 0)
            measures.penetration_rms = std::sqrt(squares_ / static_cast<double>(overlapping_));
    }

  private:
    double squares_ = 0, max_ = 0;
    std::int64_t overlapping_ = 0;
};

}  // namespace

void note_penetrations(const SceneCore& scene, std::span<const Contact> contacts, StepMeasures& measures)
{
    Penetrations all;
    const ContactList& list = scene.contacts.staged();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (list.colours[i] != no_colour) all.note(contacts[i].separation);  // else it is left out
    }
    for_each_solved_blocks(scene.discs, [&](auto c, const DiscBlocks& blocks) {
        using Fields = DiscFieldsOf<c.value>;
        constexpr std::size_t field = offsetof(typename Fields::Row, start_separation) / sizeof(float);
        for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
            all.note(blocks.rows[block_lanes * (Fields::row_floats * block + field) + lane]);
        });
    });
    all.fill_in(measures);
}

}  // namespace motley
