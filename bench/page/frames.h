// Pictures of a crowd and its walls, coloured by contact pressure.
#pragma once

#include <string>

#include "worlds/crowd.h"

namespace motley::bench {

/// Draws the crowd as PNG files, all with the same view: `frame-00000.png` and so on in a folder it makes.
class FrameWriter {
  public:
    /// Throws std::runtime_error when the folder cannot be made.
    explicit FrameWriter(std::string folder);
    /// Draws the observed positions and the contact forces of the last step. Colour runs from blue (free) over yellow to
    /// red (`full_pressure` N per metre of circumference and more; of walls `full_wall_pressure` N per metre of wall, in
    /// bands of a metre). The bars at the right edge are the scales: of people, and left of it of walls.
    void write(const Crowd& crowd, const Scene& scene);

    static constexpr double full_pressure = 600;        ///< N/m
    static constexpr double full_wall_pressure = 6000;  ///< N/m; barriers are built for 3,000 to 5,000

  private:
    std::string folder_;
    int count_ = 0;
    double min_x_ = 0, min_y_ = 0, scale_ = 0;  ///< of the view, set by the first frame
    int width_ = 0, height_ = 0;

    void fit(const Crowd& crowd);
};

}  // namespace motley::bench
