// Numbers of bodies within a figure.
#pragma once

#include <cstdint>

#include "stores/array.h"
#include "stores/body_store.h"
#include "stores/growth.h"

namespace motley {

/// Numbers the bodies of a figure from 0 on, figure after figure.
class BodyNames {
  public:
    /// For the present rows of the store.
    void make_room(const BodyStore& bodies)
    {
        grow_to(rigid_, bodies.rows(BodyKind::rigid).size());
        grow_to(fixed_, bodies.rows(BodyKind::fixed).size());
    }
    /// Begins to number the next figure. A rigid body is in one figure only; a fixed one may be in many.
    void start_figure() { ++figure_; }
    /// The number of a body. One that this figure has not numbered yet is added to the end of `bodies`, in which the
    /// figure begins at `first`.
    std::uint32_t name(BodyRow body, Array<BodyRow>& bodies, std::size_t first)
    {
        Name& name = (body.kind() == BodyKind::rigid ? rigid_ : fixed_)[body.row()];
        if (name.figure != figure_) {
            name = {figure_, static_cast<std::uint32_t>(bodies.size() - first)};
            bodies.push_back(body);
        }
        return name.number;
    }

  private:
    struct Name {
        std::uint64_t figure = 0;
        std::uint32_t number = 0;
    };
    Array<Name> rigid_, fixed_;
    std::uint64_t figure_ = 0;
};

}  // namespace motley
