// Charts by gnuplot, as SVG to stand inside a page.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace motley::bench {

struct PlotPoint {
    double x = 0, y = 0;
    std::string label;  ///< shown next to the point; empty: none
};

struct PlotSeries {
    enum class Style { dots, line, line_and_dots };
    std::string name;
    std::string colour;  ///< "#rrggbb"
    Style style = Style::dots;
    std::vector<PlotPoint> points;
};

struct Plot {
    std::string x_name, y_name;
    bool log_x = true, log_y = true;
    std::vector<PlotSeries> series;
};
/// A chart of points and lines. Points that a logarithm cannot show are left out.
std::string svg_of(const Plot& plot);

struct Bars {
    std::string value_name;
    std::vector<std::pair<std::string, double>> bars;
};
/// A chart of horizontal bars, each with its value.
std::string svg_of(const Bars& bars);

/// Throws std::runtime_error, which names the package, when there is no gnuplot.
void require_gnuplot();

}  // namespace motley::bench
