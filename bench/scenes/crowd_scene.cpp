// The host's part of a step for people, and their picture.
#include "scenes/crowd_scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "crowd/random.h"

namespace motley::bench {
namespace {

class HostClock {
  public:
    void charge(double& seconds)
    {
        const auto now = std::chrono::steady_clock::now();
        seconds += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Room around the walls, m: of pictures, and of the grid.
constexpr double border = 0.5;

/// Corners of the smallest box that holds all walls.
void bounds_of(const Walls& walls, Vec2<double>& low, Vec2<double>& high)
{
    low = {1e30, 1e30};
    high = {-1e30, -1e30};
    for (const WallSegment& wall : walls.segments()) {
        low = {std::min({low.x, wall.start.x, wall.end.x}), std::min({low.y, wall.start.y, wall.end.y})};
        high = {std::max({high.x, wall.start.x, wall.end.x}), std::max({high.y, wall.start.y, wall.end.y})};
    }
}

}  // namespace

void CrowdScene::start_search()
{
    ContactSearchSettings settings;
    bounds_of(walls_, settings.low, settings.high);
    settings.low = settings.low - Vec2<double>{border, border};
    settings.high = settings.high + Vec2<double>{border, border};
    for (const float radius : crowd_.radii) settings.largest_radius = std::max(settings.largest_radius, radius);
    settings.dt = options_.dt;
    settings.friction = options_.friction;
    search_ = std::make_unique<ContactSearch>(settings, walls_);
}

std::span<const Contact> CrowdScene::prepare_step(Executor& executor, HostSeconds& seconds)
{
    HostClock clock;
    crowd_.read(scene_, executor);
    clock.charge(seconds.exchange);
    steer(executor);
    clock.charge(seconds.steering);
    crowd_.write_forces(scene_, executor);
    clock.charge(seconds.exchange);
    const std::span<const Contact> contacts = search_->find(crowd_, scene_.ground(), executor);
    clock.charge(seconds.search);
    return contacts;
}

Picture CrowdScene::picture(std::span<const Contact> contacts) const
{
    Picture picture;
    bounds_of(walls_, picture.low, picture.high);
    picture.low = picture.low - Vec2<double>{border, border};
    picture.high = picture.high + Vec2<double>{border, border};
    picture.legend = "contact pressure N/m";
    picture.full_scale = pressure_full_scale_;
    for (const WallSegment& wall : walls_.segments()) picture.lines.push_back({wall.start, wall.end});

    // Two-dimensional pressure on a disc: the normal forces all around it over its circumference.
    std::vector<double> force_of_slot(scene_.bodies().slot_count());
    const auto impulses = scene_.contact_impulses();
    for (std::size_t i = 0; i < std::min(contacts.size(), impulses.size()); ++i) {
        const double force = double(impulses[i].normal) / double(scene_.last_substep);
        force_of_slot[contacts[i].body_a.slot] += force;
        force_of_slot[contacts[i].body_b.slot] += force;
    }
    std::vector<Vec3<double>> now(crowd_.size());
    scene_.read_positions(crowd_.bodies, now);
    for (std::size_t i = 0; i < crowd_.size(); ++i) {
        const double radius = double(crowd_.radii[i]);
        picture.discs.push_back({{now[i].x, now[i].y},
                                 radius,
                                 force_of_slot[crowd_.bodies[i].slot] / (2 * 3.14159265358979 * radius)});
    }
    return picture;
}

std::vector<Vec2<double>> rectangle(const Vec2<double>& low, const Vec2<double>& high)
{
    return {low, {high.x, low.y}, high, {low.x, high.y}};
}

std::vector<Vec2<double>> lattice(const Vec2<double>& low, const Vec2<double>& high, double density,
                                  std::size_t count, double jitter, std::uint64_t seed)
{
    // The triangular lattice of this density: spacing d along a row, rows sqrt(3)/2 d apart.
    const double spacing = std::sqrt(2 / (std::sqrt(3.0) * density));
    const double row_height = 0.5 * std::sqrt(3.0) * spacing;
    Random random(seed);
    std::vector<Vec2<double>> points;
    for (int row = 0; points.size() < count; ++row) {
        const double y = low.y + (row + 0.5) * row_height;
        if (y > high.y) break;
        for (double x = low.x + (row % 2 == 0 ? 0.5 : 1.0) * spacing; x < high.x && points.size() < count;
             x += spacing) {
            points.push_back({x + random.between(-jitter, jitter), y + random.between(-jitter, jitter)});
        }
    }
    return points;
}

}  // namespace motley::bench
