// One scene twice: in lanes, and in the reference's double.
#pragma once

#include <algorithm>

#include "mixed_scene.h"
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
