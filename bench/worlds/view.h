// What is to be seen of a scene of people from above, with what presses on them and on the walls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "worlds/crowd.h"

namespace motley::bench {

/// A disc, a torso or a limb: a capsule from above.
struct Silhouette {
    Vec2<double> from{}, to{};  ///< m, the ends of the axis
    double radius = 0;          ///< m
    double pressure = 0;        ///< N per m of circumference
    std::size_t person = 0;     ///< whose it is: index in View::people
};

struct View {
    std::vector<Silhouette> shapes;      ///< what lies below comes first
    std::vector<Vec2<double>> people;    ///< m, the centre of each
    std::vector<std::uint32_t> numbers;  ///< of each, the same as long as the person is there
    std::vector<Wall> walls;
    /// N/m, by wall and metre of it from its first point on; the last metre may be shorter. Empty: not known.
    std::vector<std::vector<double>> wall_pressures;
    double period_y = 0;  ///< m, as Crowd::period_y
};

/// A person who leans on a wall.
struct PressOnWall {
    Vec2<double> at{};  ///< m, the person's centre
    double radius = 0;  ///< m
    double force = 0;   ///< N
};
/// View::wall_pressures of one wall.
std::vector<double> wall_pressures(const Wall& wall, const std::vector<PressOnWall>& presses);

/// The crowd as last observed, with the forces of the last step.
View view_of(const Crowd& crowd, const Scene& scene);

}  // namespace motley::bench
