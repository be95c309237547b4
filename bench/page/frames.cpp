// Draws discs and walls as pixels.
#include "page/frames.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "page/font.h"
#include "worlds/density.h"

namespace motley::bench {
namespace {

constexpr int longest_side = 900;  // pixels
constexpr int margin = 20;
constexpr int bar_width = 14;
constexpr int label_width = 44;

struct Colour {
    std::uint8_t r, g, b;
    friend bool operator==(const Colour&, const Colour&) = default;
};

/// Blue over yellow to red, in 96 steps, so that all colours of a picture, edges included, fit the 256 of a palette.
Colour colour_of(double share)
{
    constexpr double stops[4][3] = {{70, 120, 180}, {120, 190, 170}, {250, 210, 90}, {205, 40, 45}};
    const double at = std::round(96 * std::clamp(share, 0.0, 1.0)) / 32;
    const int i = std::min(2, static_cast<int>(at));
    const auto mix = [&](int c) {
        return static_cast<std::uint8_t>(stops[i][c] + (at - i) * (stops[i + 1][c] - stops[i][c]));
    };
    return {mix(0), mix(1), mix(2)};
}

class Picture {
  public:
    Picture(int width, int height)
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Colour{250, 250, 248})
    {
    }

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    void set(int x, int y, Colour c)
    {
        if (x >= 0 && y >= 0 && x < width_ && y < height_)
            pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                    static_cast<std::size_t>(x)] = c;
    }
    /// A capsule, or a disc: all within `radius` of the axis from `from` to `to`.
    void capsule(Vec2<double> from, Vec2<double> to, double radius, Colour c)
    {
        const Colour edge{static_cast<std::uint8_t>(c.r * 6 / 10), static_cast<std::uint8_t>(c.g * 6 / 10),
                          static_cast<std::uint8_t>(c.b * 6 / 10)};
        const Vec2<double> along = to - from;
        const double length2 = std::max(dot(along, along), 1e-12);
        for (int py = static_cast<int>(std::min(from.y, to.y) - radius);
             py <= static_cast<int>(std::max(from.y, to.y) + radius) + 1; ++py) {
            for (int px = static_cast<int>(std::min(from.x, to.x) - radius);
                 px <= static_cast<int>(std::max(from.x, to.x) + radius) + 1; ++px) {
                const Vec2<double> off = Vec2<double>{px + 0.5, py + 0.5} - from;
                const Vec2<double> gap = off - std::clamp(dot(off, along) / length2, 0.0, 1.0) * along;
                const double d = std::sqrt(dot(gap, gap));
                if (d < radius) set(px, py, d > radius - 1 && radius > 3 ? edge : c);
            }
        }
    }
    /// All from the upper left corner `from` to the lower right one `to`.
    void rectangle(Vec2<double> from, Vec2<double> to, Colour c)
    {
        for (int py = static_cast<int>(from.y); py < static_cast<int>(to.y); ++py) {
            for (int px = static_cast<int>(from.x); px < static_cast<int>(to.x); ++px) set(px, py, c);
        }
    }
    /// A line from `from` to `to`, `width` pixels wide.
    void line(Vec2<double> from, Vec2<double> to, int width, Colour c)
    {
        const int steps =
            static_cast<int>(std::max(std::abs(to.x - from.x), std::abs(to.y - from.y)) * 2) + 1;
        for (int i = 0; i <= steps; ++i) {
            const Vec2<double> at = from + static_cast<double>(i) / steps * (to - from);
            for (int w = -(width / 2); w < width - width / 2; ++w) {
                set(static_cast<int>(at.x) + w, static_cast<int>(at.y), c);
                set(static_cast<int>(at.x), static_cast<int>(at.y) + w, c);
            }
        }
    }
    /// Writes text with two pixels a dot; (x, y) is its upper left corner.
    void text(int x, int y, std::string_view letters)
    {
        for (const char letter : letters) {
            for (const Glyph& glyph : glyphs) {
                if (glyph.letter != letter) continue;
                for (int dot = 0; dot < 7 * 5 * 4; ++dot) {
                    const int row = dot / 20, column = dot / 4 % 5;
                    if ((glyph.rows[static_cast<std::size_t>(row)] >> (4 - column) & 1) != 0)
                        set(x + 2 * column + dot % 2, y + 2 * row + dot / 2 % 2, {50, 50, 55});
                }
            }
            x += 12;
        }
    }
    void save(const std::string& path) const
    {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = static_cast<png_uint_32>(width_);
        image.height = static_cast<png_uint_32>(height_);
        image.format = PNG_FORMAT_RGB_COLORMAP;
        std::vector<Colour> palette;
        std::vector<std::uint8_t> indices;
        indices.reserve(pixels_.size());
        for (const Colour& pixel : pixels_) {
            // Neighbours are mostly alike.
            if (indices.empty() || palette[indices.back()] != pixel) {
                const auto found = std::ranges::find(palette, pixel);
                indices.push_back(static_cast<std::uint8_t>(found - palette.begin()));
                if (found == palette.end()) palette.push_back(pixel);
            } else {
                indices.push_back(indices.back());
            }
        }
        image.colormap_entries = static_cast<png_uint_32>(palette.size());
        if (png_image_write_to_file(&image, path.c_str(), 0, indices.data(), 0, palette.data()) == 0) {
            throw std::runtime_error(fmt::format("{}: {}", path, image.message));
        }
    }

  private:
    int width_, height_;
    std::vector<Colour> pixels_;
};

constexpr Colour wall_colour{50, 50, 55};

/// A bar of colours, its unit above it, and its numbers up to `full`. `place` counts bars from the right edge.
void draw_bar(Picture& picture, int place, std::string_view unit, double full)
{
    const int left = picture.width() - margin / 2 - (label_width + bar_width) * (place + 1);
    const int top = margin + 24, height = picture.height() - margin - top;
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < bar_width; ++column)
            picture.set(left + column, top + row, colour_of(1 - static_cast<double>(row) / height));
    }
    for (int quarter = 0; quarter <= 4; ++quarter)
        picture.text(left + bar_width + 4, top + height - height * quarter / 4 - 7,
                     fmt::format("{:g}", full * quarter / 4));
    picture.text(left, margin / 2, unit);
}

}  // namespace

PictureBounds bounds_of(const View& view)
{
    PictureBounds bounds{{1e300, 1e300}, {-1e300, -1e300}};
    const auto include = [&](const Vec2<double>& p) {
        bounds.low = {std::min(bounds.low.x, p.x), std::min(bounds.low.y, p.y)};
        bounds.high = {std::max(bounds.high.x, p.x), std::max(bounds.high.y, p.y)};
    };
    for (const Vec2<double>& p : view.people) include(p);
    for (const Wall& wall : view.walls) {
        include(wall.from);
        include(wall.to);
    }
    if (bounds.high.x < bounds.low.x) bounds = {};
    constexpr Vec2<double> around{0.5, 0.5};
    return {bounds.low - around, bounds.high + around};
}

FrameWriter::FrameWriter(std::string folder, FrameColour colour, int first, int every)
    : folder_(std::move(folder)), colour_(colour), next_(first), every_(every)
{
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) throw std::runtime_error(fmt::format("{}: {}", folder_, error.message()));
}

void FrameWriter::fit(const PictureBounds& bounds)
{
    low_ = bounds.low;
    const Vec2<double> size = bounds.high - bounds.low;
    scale_ = longest_side / std::max(size.x, size.y);
    width_ = static_cast<int>(size.x * scale_) + 2 * margin + 2 * (bar_width + label_width);
    height_ = static_cast<int>(size.y * scale_) + 2 * margin;
}

void FrameWriter::write(const View& view, Executor& executor)
{
    if (width_ == 0) fit(bounds_of(view));
    Picture picture(width_, height_);
    const auto pixel = [&](const Vec2<double>& world) {
        return Vec2<double>{margin + (world.x - low_.x) * scale_,
                            height_ - margin - (world.y - low_.y) * scale_};
    };
    if (colour_ == FrameColour::density) {
        const DensityField field = density_field(view.people);
        for (std::int32_t row = 0; row < field.rows; ++row) {
            for (std::int32_t column = 0; column < field.columns; ++column) {
                const Vec2<double> corner = field.low + Vec2<double>{1.0 * column, 1.0 * row};
                if (field.at(column, row) > 0)
                    picture.rectangle(pixel(corner + Vec2<double>{0, 1}), pixel(corner + Vec2<double>{1, 0}),
                                      colour_of(field.at(column, row) / full_density));
            }
        }
    }
    for (std::size_t w = 0; w < view.walls.size(); ++w) {
        const Wall& wall = view.walls[w];
        picture.line(pixel(wall.from), pixel(wall.to), 2, wall_colour);
        if (view.wall_pressures.empty()) continue;
        const std::vector<double>& bands = view.wall_pressures[w];
        const Vec2<double> along = wall.to - wall.from;
        const double length = std::max(std::sqrt(dot(along, along)), 1e-9);
        for (std::size_t band = 0; band < bands.size(); ++band) {
            if (bands[band] <= 0) continue;
            const double first = static_cast<double>(band) / length;
            picture.line(pixel(wall.from + first * along),
                         pixel(wall.from + std::min(1.0, first + 1 / length) * along), 6,
                         colour_of(bands[band] / full_wall_pressure));
        }
    }
    std::vector<double> densities;
    if (colour_ == FrameColour::voronoi) densities = voronoi_densities(view, density_reach, executor);
    for (const Silhouette& shape : view.shapes) {
        const Vec2<double> from = pixel(shape.from), to = pixel(shape.to);
        switch (colour_) {
            case FrameColour::pressure:
                picture.capsule(from, to, shape.radius * scale_, colour_of(shape.pressure / full_pressure));
                break;
            case FrameColour::voronoi:
                picture.capsule(from, to, shape.radius * scale_,
                                colour_of(densities[shape.person] / full_density));
                break;
            case FrameColour::density:
                picture.capsule(from, to, std::max(1.0, 0.3 * shape.radius * scale_), wall_colour);
        }
    }
    if (colour_ == FrameColour::pressure) {
        draw_bar(picture, 0, "N/m", full_pressure);
    } else {
        draw_bar(picture, 0, "/m2", full_density);
    }
    draw_bar(picture, 1, "kN/m", full_wall_pressure / 1000);
    picture.save(fmt::format("{}/frame-{:05d}.png", folder_, next_));
    next_ += every_;
}

}  // namespace motley::bench
