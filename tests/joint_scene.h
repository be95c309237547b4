// Every type of joint in every case between every pair of kinds of bodies. The pairs are in a row and tumble under
// gravity.
#pragma once

#include "joint_cases.h"

namespace motley::testing {

class JointScene {
  public:
    Scene scene;
    std::vector<BodyId> bodies;

    /// Scenes that begin as copies of one, which is empty, have the same handles.
    explicit JointScene(const Scene& empty = Scene()) : scene(empty)
    {
        Random random(77);
        for_each_joint_type(JointTypes{}, [&]<class Definition>() {
            for (int kind_a = 0; kind_a < 5; ++kind_a) {
                for (int kind_b = 0; kind_b < 5; ++kind_b) {
                    if (!fits<Definition>(kind_a, kind_b)) continue;
                    const std::size_t count = add_case<Definition>(kind_a, kind_b, random, 0);
                    for (std::size_t i = 1; i < count; ++i) add_case<Definition>(kind_a, kind_b, random, i);
                    // Rigid pairs also fill one whole block and one padded block.
                    if (kind_a != 2 || kind_b != 2) continue;
                    for (std::size_t i = 0; i < 19; ++i)
                        add_case<Definition>(kind_a, kind_b, random, i % count);
                }
            }
        });
    }

  private:
    double place_ = 0;

    /// Adds two bodies with case `which` between them. Returns how many cases there are.
    template <class Definition>
    std::size_t add_case(int kind_a, int kind_b, Random& random, std::size_t which)
    {
        // A planar body cannot follow a partner that tumbles: in a pair with one, both turn about z only.
        const bool flat = kind_a == 1 || kind_b == 1;
        place_ += 3;
        const BodyId a = add(kind_a, {place_, 0, 0}, flat, random);
        const BodyId b = add(kind_b, {place_ + 0.8, 0.1, 0}, flat, random);
        const std::vector<Definition> cases =
            JointCases<Definition>::of(JointPlace(scene, a, kind_a, b, kind_b, random));
        scene.add_joint(cases[which]);
        return cases.size();
    }
    BodyId add(int kind, Vec3<double> at, bool in_plane, Random& random)
    {
        const auto r = [&] { return static_cast<float>(random.symmetric()); };
        BodyDefinition body;
        body.model = kind < 3 ? static_cast<BodyModel>(kind) : BodyModel::rigid;
        if (kind == 3) body.motion = BodyMotion::static_body;
        if (kind == 4) body.motion = BodyMotion::kinematic_body;
        body.position = at;
        body.mass = 2 + r();
        body.inertia = {0.2F, 0.02F, 0, 0.3F, 0, 0.25F};
        if (kind != 3) body.linear_velocity = {r(), r(), in_plane ? 0 : r()};
        if (kind != 3 && kind != 0) body.angular_velocity = {in_plane ? 0 : r(), in_plane ? 0 : r(), r()};
        bodies.push_back(scene.add_body(body));
        return bodies.back();
    }
};

}  // namespace motley::testing
