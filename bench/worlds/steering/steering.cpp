// The list of steering models.
#include "worlds/steering.h"

#include "worlds/steering/orca.h"
#include "worlds/steering/social_force.h"

namespace motley::bench {

std::unique_ptr<Steering> make_steering(SteeringModel model)
{
    switch (model) {
        case SteeringModel::plain:
            return nullptr;
        case SteeringModel::social_force:
            return std::make_unique<SocialForce>();
        case SteeringModel::orca:
            return std::make_unique<Orca>();
    }
    return nullptr;
}

}  // namespace motley::bench
