#include "page/plot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace motley::bench {
namespace {

constexpr const char* head =
    "set terminal svg size 860,{} dynamic font 'sans-serif,12' background '#ffffff'\n"
    "set border 3 lc rgb '#888888'\nset tics nomirror textcolor rgb '#333333'\nset grid lc rgb '#dddddd'\n";

/// Text between gnuplot's double quotes, which understand escapes; labels are shown as they are.
std::string quoted(const std::string& text)
{
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + "\"";
}

/// Runs gnuplot on a script and returns what it prints.
std::string run_gnuplot(const std::string& script)
{
    std::string path = (std::filesystem::temp_directory_path() / "motley-plot-XXXXXX").string();
    const int file = mkstemp(path.data());
    if (file < 0) throw std::runtime_error(path + ": cannot be made");
    close(file);
    std::ofstream(path) << script;
    FILE* pipe = popen(fmt::format("gnuplot '{}'", path).c_str(), "r");
    std::string output;
    std::array<char, 4096> part{};
    for (std::size_t size = 0; pipe != nullptr && (size = fread(part.data(), 1, part.size(), pipe)) > 0;)
        output.append(part.data(), size);
    const int status = pipe != nullptr ? pclose(pipe) : -1;
    std::filesystem::remove(path);
    const std::size_t start = output.find("<svg");
    if (status != 0 || start == std::string::npos) throw std::runtime_error("gnuplot could not draw a chart");
    return output.substr(start);
}

bool is_shown(const Plot& plot, const PlotPoint& p)
{
    return (!plot.log_x || p.x > 0) && (!plot.log_y || p.y > 0);
}

}  // namespace

void require_gnuplot()
{
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        throw std::runtime_error("charts need gnuplot: install the package gnuplot-nox");
}

std::string svg_of(const Plot& plot)
{
    std::string script = fmt::format(fmt::runtime(head), 520);
    if (plot.log_x) script += "set logscale x\n";
    if (plot.log_y) script += "set logscale y\n";
    script += fmt::format("set xlabel {}\nset ylabel {}\nset key outside bottom center horizontal\n",
                          quoted(plot.x_name), quoted(plot.y_name));
    script +=
        "set format '%g'\nset autoscale noextend\nset offsets graph 0.16, graph 0.14, graph 0.05, graph "
        "0.05\n";
    std::string clauses, labels;
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const PlotSeries& series = plot.series[i];
        script += fmt::format("$series{} << EOD\n", i);
        std::size_t shown = 0;
        for (const PlotPoint& p : series.points) {
            if (!is_shown(plot, p)) continue;
            ++shown;
            // Neighbours on either side of the line, so that their labels do not meet.
            const bool right = shown % 2 != 0;
            script += fmt::format("{:.9g} {:.9g}\n", p.x, p.y);
            if (!p.label.empty()) {
                labels +=
                    fmt::format("set label {} at {:.9g},{:.9g} {} font ',9' textcolor rgb '{}' noenhanced\n",
                                quoted(p.label), p.x, p.y,
                                right ? "left offset 0.7,0.35" : "right offset -0.7,-0.35", series.colour);
            }
        }
        script += "EOD\n";
        if (shown == 0) continue;
        const char* with = series.style == PlotSeries::Style::dots   ? "points pt 7 ps 0.6"
                           : series.style == PlotSeries::Style::line ? "lines lw 2"
                                                                     : "linespoints lw 2 pt 7 ps 0.7";
        clauses += fmt::format("{}$series{} using 1:2 with {} lc rgb '{}' title {} noenhanced",
                               clauses.empty() ? "plot " : ", ", i, with, series.colour, quoted(series.name));
    }
    if (clauses.empty()) return "<p>No point of this chart has a value.</p>";
    return run_gnuplot(script + labels + clauses + "\n");
}

std::string svg_of(const Bars& bars)
{
    const int count = static_cast<int>(bars.bars.size());
    std::string script = fmt::format(fmt::runtime(head), 90 + 26 * count);
    double most = 0;
    for (const auto& [name, value] : bars.bars) most = std::max(most, value);
    script += fmt::format(
        "set xrange [0:{:.9g}]\nset yrange [{}:-1]\nset xlabel {}\nunset ytics\nset style fill solid\nunset "
        "key\n",
        1.12 * most, count, quoted(bars.value_name));
    script += "set lmargin 38\n$bars << EOD\n";
    for (int i = 0; i < count; ++i)
        script += fmt::format("0 {} 0 {:.9g} {} {}\n", i, bars.bars[static_cast<std::size_t>(i)].second,
                              i - 0.36, i + 0.36);
    script += "EOD\n";
    for (int i = 0; i < count; ++i) {
        const auto& [name, value] = bars.bars[static_cast<std::size_t>(i)];
        script += fmt::format("set label {} at 0,{} right offset -0.6,0 noenhanced\n", quoted(name), i);
        script += fmt::format("set label '{:.3g}' at {:.9g},{} offset 0.5,0\n", value, value, i);
    }
    return run_gnuplot(script + "plot $bars using 1:2:3:4:5:6 with boxxyerror lc rgb '#2f6db5'\n");
}

}  // namespace motley::bench
