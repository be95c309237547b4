// Ranges and messages for the values that a host gives for bodies.
#include "scene/body_checks.h"

#include <cmath>
#include <string>

#include "contract/built.h"
#include "motley/core/invalid_input.h"

namespace motley {
namespace {

constexpr double largest_position = 1e12;

void check_moment(const char* who, const char* field, float moment)
{
    if (!(moment >= least_moment && moment <= most_moment))
        refuse(std::string(who) + field, moment, "1e-20 to 1e20 (kg m2)");
}

}  // namespace

void check(const char* field, double value, double low, double high, const char* expected)
{
    if (!(value >= low && value <= high)) refuse(field, value, expected);  // NaN fails too
}

bool is_coordinate(double value)
{
    return value >= -largest_position && value <= largest_position;
}

void check_position(const char* who, const Vec3<double>& p)
{
    // The name is made only for a refusal: queries allocate nothing.
    const auto check_coordinate = [who](const char* which, double value) {
        if (!is_coordinate(value))
            refuse(std::string(who) + which, value, "a finite value from -1e12 to 1e12 (m)");
    };
    check_coordinate(".x", p.x);
    check_coordinate(".y", p.y);
    check_coordinate(".z", p.z);
}

void check_vector(const char* who, const Vec3<float>& v, float limit, const char* expected)
{
    // The name is made only for a refusal: hosts set velocities of whole crowds.
    const auto check_component = [&](const char* which, float value) {
        if (!(value >= -limit && value <= limit)) refuse(std::string(who) + which, value, expected);
    };
    check_component(".x", v.x);
    check_component(".y", v.y);
    check_component(".z", v.z);
}

void check_velocity_of(BodyModel model, BodyMotion motion, const Vec3<float>* linear,
                       const Vec3<float>* angular)
{
    if (motion == BodyMotion::static_body) {
        if (linear) check_vector("linear_velocity", *linear, 0, "0 of a static body (m/s)");
        if (angular) check_vector("angular_velocity", *angular, 0, "0 of a static body (rad/s)");
        return;
    }
    if (linear)
        check_vector("linear_velocity", *linear, largest_speed, "a finite value from -1e9 to 1e9 (m/s)");
    if (angular)
        check_vector("angular_velocity", *angular, largest_speed, "a finite value from -1e9 to 1e9 (rad/s)");
    if (motion == BodyMotion::kinematic_body) return;
    if (model == BodyModel::planar) {
        if (linear) check("linear_velocity.z", linear->z, 0, 0, "0 of a planar body (m/s)");
        if (angular) check("angular_velocity.x", angular->x, 0, 0, "0 of a planar body (rad/s)");
        if (angular) check("angular_velocity.y", angular->y, 0, 0, "0 of a planar body (rad/s)");
    } else if (model == BodyModel::particle && angular) {
        check_vector("angular_velocity", *angular, 0, "0 of a particle (rad/s)");
    }
}

/// The principal moments of a real body, the eigenvalues of its tensor m, obey A + B >= C: none exceeds half of the
/// trace. Checked by tr(m)/2 I - m being positive semi-definite, which needs no eigenvalues.
void check_inertia(const char* who, const Sym3<float>& inertia)
{
    const auto refuse_all = [&](double value, const char* expected) {
        refuse(std::string(who) + ".inertia", value, expected);
    };
    const double xx = inertia.xx, xy = inertia.xy, xz = inertia.xz, yy = inertia.yy, yz = inertia.yz,
                 zz = inertia.zz;
    const double sum = xx + xy + xz + yy + yz + zz;
    if (!std::isfinite(sum)) refuse_all(sum, "finite components (kg m2)");
    check_moment(who, ".inertia.xx", inertia.xx);
    check_moment(who, ".inertia.yy", inertia.yy);
    check_moment(who, ".inertia.zz", inertia.zz);
    const double trace = xx + yy + zz;
    const double minor = xx * yy - xy * xy;
    const double full = determinant(Sym3<double>{xx, xy, xz, yy, yz, zz});
    if (!(minor > 0) || !(full > 0)) {
        refuse_all(full, "a positive definite tensor (determinant above 0)");
    }
    const double half = trace / 2 * (1 + 1e-5);  // room for float rounding: a thin rod is on the boundary
    const Sym3<double> rest{half - xx, -xy, -xz, half - yy, -yz, half - zz};
    const double scale = trace * trace * trace;
    const double edge = -1e-12;
    if (rest.xx < edge * trace || rest.yy < edge * trace || rest.zz < edge * trace ||
        rest.xx * rest.yy - rest.xy * rest.xy < edge * trace * trace || determinant(rest) < edge * scale) {
        refuse_all(trace, "moments that obey the triangle inequality A + B >= C");
    }
}

void check_mass(const char* who, BodyModel model, float mass, const Sym3<float>& inertia)
{
    if (!(mass >= lightest_body && mass <= heaviest_body))
        refuse(std::string(who) + ".mass", mass, "1e-10 to 1e10 (kg)");
    check_inertia_of(who, model, inertia);
}

void check_inertia_of(const char* who, BodyModel model, const Sym3<float>& inertia)
{
    if (model == BodyModel::planar) check_moment(who, ".inertia.zz", inertia.zz);
    if (model == BodyModel::rigid) check_inertia(who, inertia);
}

void check_damping(const char* who, float linear, float angular)
{
    // The name is made only for a refusal: hosts add whole crowds.
    const auto check_one = [who](const char* which, float value) {
        if (!(value >= 0 && value <= most_damping)) refuse(std::string(who) + which, value, "0 to 1e6 (1/s)");
    };
    check_one(".linear_damping", linear);
    check_one(".angular_damping", angular);
}

void check_model(const char* field, BodyModel model)
{
    if (model > BodyModel::rigid) refuse(field, static_cast<double>(model), "particle, planar or rigid");
}

void check_definition(const BodyDefinition& d)
{
    check_model("BodyDefinition.model", d.model);
    if (d.motion > BodyMotion::static_body) {
        refuse("BodyDefinition.motion", static_cast<double>(d.motion),
               "dynamic_body, kinematic_body or static_body");
    }
    check_position("BodyDefinition.position", d.position);
    check("BodyDefinition.yaw", d.yaw, -1e9, 1e9, "a finite value from -1e9 to 1e9 (rad)");
    const bool fixed = d.motion != BodyMotion::dynamic_body;
    const Quat<double>& q = d.orientation;
    const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (fixed || d.model == BodyModel::rigid) {
        check("BodyDefinition.orientation", length2, 1e-12, 1e12,
              "a quaternion with a length from 1e-6 to 1e6 (squared shown)");
    }
    check_velocity_of(d.model, d.motion, &d.linear_velocity, &d.angular_velocity);
    if (fixed) return;
    check_model_is_built("BodyDefinition.model", d.model);
    check_mass("BodyDefinition", d.model, d.mass, d.inertia);
    check_damping("BodyDefinition", d.linear_damping, d.angular_damping);
}

void check_disc(const DiscDefinition& disc)
{
    check("DiscDefinition.radius", disc.radius, 1e-6, 1e6, "1e-6 to 1e6 (m)");
    check("DiscDefinition.friction", disc.friction, 0, 1e9, "0 to 1e9");
}

void check_segment(const char* name, const Vec2<double>& from, const Vec2<double>& to)
{
    constexpr double shortest = 1e-6;  // m
    check_position(name, {from.x, from.y, 0});
    const Vec2<double> along = to - from;
    if (dot(along, along) < shortest * shortest)
        refuse(name, "at the next point", "neighbours at least 1e-6 m apart");
}

void check_wall_surface(float friction, float surface_speed)
{
    check("WallDefinition.friction", friction, 0, 1e9, "0 to 1e9");
    check("WallDefinition.surface_speed", surface_speed, -1e6, 1e6, "-1e6 to 1e6 (m/s)");
    if (friction == 0 && surface_speed != 0)
        refuse("WallDefinition.surface_speed", surface_speed, "0 for a wall without friction");
}

void check_wall_force(float max_force)
{
    if (!(max_force > 0)) refuse("WallDefinition.max_force", max_force, "above 0 (N)");
}

}  // namespace motley
