// The impulses of friction of one contact, and Coulomb's bound on them.
#pragma once

#include <cmath>

namespace motley {

/// N s along the two tangents of a contact.
struct FrictionImpulse {
    double x = 0, y = 0;
    [[nodiscard]] double length() const { return std::sqrt(x * x + y * y); }
    /// The same direction, `wanted` N s long.
    [[nodiscard]] FrictionImpulse scaled_to(double wanted) const
    {
        const double now = length();
        return now > 0 ? FrictionImpulse{x * (wanted / now), y * (wanted / now)} : *this;
    }
    [[nodiscard]] FrictionImpulse within(double bound) const
    {
        return length() > bound ? scaled_to(bound) : *this;
    }
};

}  // namespace motley
