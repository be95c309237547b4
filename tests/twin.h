// One scene twice: in lanes, and in the reference in double.
#pragma once

#include <algorithm>

#include "mixed_scene.h"
#include "motley/reference/joint_models.h"
#include "motley/reference/world.h"

namespace motley::testing {

struct Twin {
    Scene scene;
    reference::World world;
    std::vector<BodyId> ids;

    int add(const BodyDefinition& definition)
    {
        ids.push_back(scene.add_body(definition));
        world.bodies.push_back(reference::Body::from(definition));
        return static_cast<int>(ids.size()) - 1;
    }
    /// Adds a joint between bodies of this twin.
    template <class Definition>
    ConstraintId add_joint(const Definition& joint)
    {
        world.joints.push_back({index_of(joint.body_a), index_of(joint.body_b), reference::model_of(joint)});
        return scene.add_joint(joint);
    }
    [[nodiscard]] int index_of(BodyId body) const
    {
        return static_cast<int>(std::find(ids.begin(), ids.end(), body) - ids.begin());
    }
    /// The largest difference of positions and velocities.
    [[nodiscard]] double difference() const
    {
        double most = 0;
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const BodyState s = scene.state(ids[i]);
            const reference::Body& b = world.bodies[i];
            most = std::max(most, (Eigen::Vector3d(s.position.x, s.position.y, s.position.z) - b.position)
                                      .cwiseAbs()
                                      .maxCoeff());
            reference::Vector6 v;
            v << s.linear_velocity.x, s.linear_velocity.y, s.linear_velocity.z, s.angular_velocity.x,
                s.angular_velocity.y, s.angular_velocity.z;
            most = std::max(most, (v - b.velocity).cwiseAbs().maxCoeff());
        }
        return most;
    }
};

}  // namespace motley::testing
