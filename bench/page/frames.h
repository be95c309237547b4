// Pictures of a crowd, coloured by contact pressure.
#pragma once

#include <string>

#include "worlds/crowd.h"

namespace motley::bench {

/// Draws the crowd as PNG files, all with the same view: `frame-00000.png` and so on in a folder it makes.
class FrameWriter {
  public:
    /// Throws std::runtime_error when the folder cannot be made.
    explicit FrameWriter(std::string folder);
    /// Draws the observed positions and the contact impulses of the last step. Colour runs from blue (free) over
    /// yellow to red (`full_pressure` N per metre of circumference and more); the bar at the right edge is its scale.
    void write(const Crowd& crowd, const Scene& scene);

    static constexpr double full_pressure = 600;  ///< N/m

  private:
    std::string folder_;
    int count_ = 0;
    double min_x_ = 0, min_y_ = 0, scale_ = 0;  ///< of the view, set by the first frame
    int width_ = 0, height_ = 0;

    void fit(const Crowd& crowd);
};

}  // namespace motley::bench
