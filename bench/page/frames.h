// Pictures of people and walls from above, coloured by pressure or by density.
#pragma once

#include <string>

#include "worlds/view.h"

namespace motley::bench {

/// What the colours of people show: the pressure on them; how many are on each square metre, which is then coloured
/// itself; or the density of each person's Voronoi cell.
enum class FrameColour { pressure, density, voronoi };

/// The part of the plane that a picture shows, m.
struct PictureBounds {
    Vec2<double> low{}, high{1, 1};
};
/// All people and walls, and half a metre around them.
PictureBounds bounds_of(const View& view);

/// Draws PNG files, all of the same part of the plane: `frame-00000.png` and so on in a folder it makes.
class FrameWriter {
  public:
    /// The first picture has the number `first`, and each further one a number that is higher by `every`. Throws
    /// std::runtime_error when the folder cannot be made.
    explicit FrameWriter(std::string folder, FrameColour colour = FrameColour::pressure, int first = 0,
                         int every = 1);
    /// What all pictures show. Without this call it is bounds_of() the first view.
    void fit(const PictureBounds& bounds);
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
    int next_, every_;
    Vec2<double> low_{};
    double scale_ = 0;            ///< pixels a metre
    int width_ = 0, height_ = 0;  ///< 0 until fit()
};

}  // namespace motley::bench
