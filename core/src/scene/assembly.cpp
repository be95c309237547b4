// Copies of a figure.
#include "motley/core/assembly.h"

#include <algorithm>
#include <cmath>

#include "motley/core/invalid_input.h"

namespace motley {
namespace {

Quat<double> checked_orientation(const Placing& placing, std::span<const BodyDefinition> bodies)
{
    const Quat<double>& q = placing.orientation;
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(length > 0) || !std::isfinite(length))
        refuse("Placing.orientation", length, "a finite quaternion of a length above 0");
    const bool tilts = q.x != 0 || q.y != 0;
    for (const BodyDefinition& body : bodies) {
        if (tilts && body.model == BodyModel::planar)
            refuse("Placing.orientation", "tilted", "a turn about z, for a figure with planar bodies");
    }
    return {q.x / length, q.y / length, q.z / length, q.w / length};
}

BodyDefinition placed(BodyDefinition body, const Placing& placing, const Quat<double>& turn)
{
    const Quat<float> narrow = convert<float>(turn);
    body.position = placing.position + rotate(turn, body.position);
    body.linear_velocity = rotate(narrow, body.linear_velocity);
    if (body.motion != BodyMotion::static_body)
        body.linear_velocity = body.linear_velocity + placing.linear_velocity;
    if (body.model == BodyModel::planar) {
        body.yaw += 2 * std::atan2(turn.z, turn.w);
    } else {
        body.orientation = turn * body.orientation;
        body.angular_velocity = rotate(narrow, body.angular_velocity);
    }
    return body;
}

}  // namespace

BodyId Figure::add_body(const BodyDefinition& definition)
{
    const BodyId id = sketch_.add_body(definition);
    bodies_.push_back(definition);
    ids_.push_back(id);
    return id;
}

std::size_t Figure::index_of(BodyId body) const
{
    const auto found = std::find(ids_.begin(), ids_.end(), body);
    if (found == ids_.end())
        refuse("joint.body_a or body_b", "the ground", "bodies of the figure; a static one for the world");
    return static_cast<std::size_t>(found - ids_.begin());
}

void Figure::join(Scene& scene, std::span<const BodyId> bodies) const
{
    for (const auto& add : joints_) add(scene, bodies);
}

std::vector<BodyId> add_assembly(Scene& scene, const Figure& figure, std::span<const Placing> copies)
{
    std::vector<BodyDefinition> definitions;
    definitions.reserve(copies.size() * figure.bodies().size());
    for (const Placing& placing : copies) {
        const Quat<double> turn = checked_orientation(placing, figure.bodies());
        for (const BodyDefinition& body : figure.bodies()) definitions.push_back(placed(body, placing, turn));
    }
    std::vector<BodyId> ids(definitions.size());
    scene.add_bodies(definitions, ids);
    for (std::size_t copy = 0; copy < copies.size(); ++copy)
        figure.join(scene, std::span(ids).subspan(copy * figure.bodies().size(), figure.bodies().size()));
    return ids;
}

}  // namespace motley
