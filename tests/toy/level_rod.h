// A toy type of joint, added as from outside the library: two centres stay at one height, y_a = y_b.
//
//   C = y_b - y_a,   J = [-e_y, 0, e_y, 0]
//
// It takes one file, and one name in the list of types: tests/toy/CMakeLists.txt puts that into a copy of the list.
#pragma once

#include <cmath>
#include <memory>

#include "contract/constraint_type.h"
#include "contract/type_list.h"
#include "maths/limit.h"
#include "motley/core/constraints/ball_socket_definition.h"

namespace motley {

struct LevelRodDefinition {
    BodyId body_a{};
    BodyId body_b{};
    float offset = 0;  ///< m: how far b is above a, finite
};

/// Its formulas in double, for Method::direct and for comparisons: level_rod_model.cpp.
namespace reference {
class JointModel;
}
std::shared_ptr<const reference::JointModel> model_of(const LevelRodDefinition& joint);

struct LevelRod : ConstraintTraits {
    using Definition = LevelRodDefinition;

    template <class Real>
    struct Parameters {
        Real offset;
    };
    template <class Real>
    struct Memory {
        Real lambda;  ///< N s on b, up
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Row {
        Real start_error;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct SubstepRow {
        Real effective_mass, error;
    };
    template <class Real, BodyKind a, BodyKind b>
    struct Impulse {
        Real lambda;
    };

    static void validate(const Definition& joint, const JointBodies&)
    {
        check_range("offset", joint.offset, -largest_length, largest_length, "-1e9 to 1e9 (m)");
    }
    static Parameters<float> parameters(const Definition& joint) { return {joint.offset}; }

    template <class Start, class Real, class A, class B>
    static auto prepare(const Start& start, const Parameters<Real>& joint, const Memory<Real>& memory,
                        const A&, const B&, Impulse<Real, A::kind, B::kind>& impulse)
    {
        impulse.lambda = Real(start.step().warm_start_scale) * memory.lambda;
        return Row<Real, A::kind, B::kind>{start.pose().between.y - joint.offset};
    }
    template <class Real, class Row, class Impulse, class Substep, class A, class B>
    static void prepare_substep(const Row& row, const Impulse&, Substep& substep, const A& a, const B& b)
    {
        build<Real>(row, substep, a, b);
    }
    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void warm_start(const Row&, const Substep&, const Impulse& impulse, A& a, B& b)
    {
        apply_impulse(a, at_centre<A, B, Real>(), -up<A, B>(impulse.lambda));
        apply_impulse(b, at_centre<A, B, Real>(), up<A, B>(impulse.lambda));
    }
    template <class Real, class Row, class Substep, class Impulse, class A, class B>
    static void solve(const StepConstants& step, const Row&, const Substep& substep, Impulse& impulse, A& a,
                      B& b)
    {
        const Real speed = b.linear.y - a.linear.y;
        const Real wanted = lock_impulse(step, substep.error, speed, substep.effective_mass, impulse.lambda);
        const Real change = wanted - impulse.lambda;
        impulse.lambda = wanted;
        apply_impulse(a, at_centre<A, B, Real>(), -up<A, B>(change));
        apply_impulse(b, at_centre<A, B, Real>(), up<A, B>(change));
    }
    template <class Real, class Row, class A, class B>
    static void project(const StepConstants&, const Row& row, A& a, B& b)
    {
        SubstepRow<Real, A::kind, B::kind> now;
        build<Real>(row, now, a, b);
        const Real push = -(now.effective_mass * now.error);
        apply_displacement(a, at_centre<A, B, Real>(), -up<A, B>(push));
        apply_displacement(b, at_centre<A, B, Real>(), up<A, B>(push));
    }
    template <class Real, class Row, class Impulse, class End>
    static Memory<Real> remember(const Row&, const Impulse& impulse, const End&)
    {
        return {impulse.lambda};
    }
    template <class Real, class Row, class Substep, class Impulse>
    static Wrench<Real> wrench(const Row&, const Substep&, const Impulse& impulse)
    {
        const Vec3<Real> none{Real(0), Real(0), Real(0)};
        return {{Real(0), impulse.lambda, Real(0)}, none};
    }
    static JointReport report(const Definition& joint, const Memory<float>&, const BodyState& a,
                              const BodyState& b)
    {
        JointReport report;
        report.error =
            static_cast<float>(std::abs(b.position.y - a.position.y - static_cast<double>(joint.offset)));
        report.state = JointState::active;
        return report;
    }

  private:
    template <class A, class B, class Real>
    static auto up(const Real& y)
    {
        return to_space<PairVector<Real, A::kind, B::kind>>(Vec3<Real>{Real(0), y, Real(0)});
    }
    template <class A, class B, class Real>
    static auto at_centre()
    {
        return up<A, B>(Real(0));
    }
    template <class Real, class Row, class Substep, class A, class B>
    static void build(const Row& row, Substep& substep, const A& a, const B& b)
    {
        const auto e = up<A, B>(Real(1));
        const auto centre = at_centre<A, B, Real>();
        substep.effective_mass =
            inverse_or_zero(dot(e, (inverse_point_mass(a, centre) + inverse_point_mass(b, centre)) * e));
        substep.error = row.start_error + b.delta.y - a.delta.y;
    }
};

/// The constraint types of this header.
using LevelRodTypes = TypeList<LevelRod>;

}  // namespace motley
