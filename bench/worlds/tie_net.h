// A square net of bodies held together by one kind of constraint: what kernels are measured on.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

/// The order of the bodies of a net in memory.
enum class BodyOrder { in_line, shuffled };

/// A square net of bodies, each tied to the one on its right and the one above.
struct TieNet {
    Scene scene;
    std::vector<BodyId> bodies;  ///< row by row of the net
    std::vector<Contact> contacts;

    /// A square of bodies 0.4 m apart.
    void add_bodies(int side, BodyModel model, BodyOrder order = BodyOrder::in_line);
};

/// Ties two bodies; the arm leads from the centre of a to the point between them.
using Tie = std::function<void(TieNet&, BodyId a, BodyId b, Vec3<float> arm)>;

std::unique_ptr<TieNet> make_net(const Tie& tie, BodyModel model, int side,
                                 BodyOrder order = BodyOrder::in_line);
/// Contacts that overlap by a millimetre.
Tie contact_tie(float friction, float restitution = 0);

struct NamedTie {
    std::string name;  ///< "hinge/rigid"
    BodyModel model;
    Tie tie;
};
/// Every constraint, some between several models of bodies.
std::vector<NamedTie> every_tie();
/// The one of this name. Throws std::runtime_error where there is none.
NamedTie tie_called(std::string_view name);

/// A side whose net stays in a second level cache, and one whose does not.
inline constexpr int side_in_cache = 45, side_streaming = 400;

}  // namespace motley::bench
