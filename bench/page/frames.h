// Pictures of people and walls from above, coloured by pressure or by density.
#pragma once

#include <string>

#include "worlds/view.h"

namespace motley::bench {

/// What the colours of people show: the pressure on them; how many are on each square metre, which is then coloured
/// itself; or the density of each person's Voronoi cell.
enum class FrameColour { pressure, density, voronoi };

/// Draws PNG files, all with the same view: `frame-00000.png` and so on in a folder it makes.
class FrameWriter {
  public:
    /// Throws std::runtime_error when the folder cannot be made.
    explicit FrameWriter(std::string folder, FrameColour colour = FrameColour::pressure);
    /// Colour runs from blue (free, or nobody) over yellow to red (`full_pressure` and more, or `full_density`; of walls
    /// `full_wall_pressure`, in bands of a metre). The bars at the right edge are the scales: of people, and left of it of
    /// walls.
    void write(const View& view, Executor& executor);

    static constexpr double full_pressure = 600;        ///< N per metre of circumference
    static constexpr double full_wall_pressure = 6000;  ///< N/m; barriers are built for 3,000 to 5,000
    static constexpr double full_density = 8;           ///< 1/m2; discs of 0.2 m touch each other at 7.2

  private:
    std::string folder_;
    FrameColour colour_;
    int count_ = 0;
    double min_x_ = 0, min_y_ = 0, scale_ = 0;  ///< of the view, set by the first frame
    int width_ = 0, height_ = 0;

    void fit(const View& view);
};

}  // namespace motley::bench
