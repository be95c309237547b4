// The table of extremes. To add a case: a function that runs it and returns its figure, and its line in the table.
#include "extremes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace motley::bench {
namespace {

constexpr float frame = 1.0F / 60;
constexpr Vec3<float> gravity{0, -9.81F, 0};

double length(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// A scene under one way of solving, which remembers whether anything went wrong.
class Trial {
  public:
    Scene scene;

    explicit Trial(const ExtremeRun& run, Vec3<float> pull = gravity) : settings(settings_of(run.way))
    {
        settings.gravity = pull;
        options_ = run.options;
    }
    SolverSettings settings;

    BodyId box(Vec3<double> at, float mass = 1, Vec3<float> inertia_of_mass = {0.1F, 0.1F, 0.1F})
    {
        BodyDefinition body;
        body.position = at;
        body.mass = mass;
        body.inertia = {inertia_of_mass.x * mass, 0, 0,
                        inertia_of_mass.y * mass, 0, inertia_of_mass.z * mass};
        bodies_.push_back(scene.add_body(body));
        return bodies_.back();
    }
    /// `links` bodies of 0.5 m along `way`, and one of `load` kg at the end, from a static body at `origin`.
    void chain(int links, Vec3<double> way, float load, Vec3<double> origin = {})
    {
        BodyDefinition post;
        post.motion = BodyMotion::static_body;
        post.position = origin;
        BodyId before = scene.add_body(post);
        Vec3<float> hook{};
        for (int i = 0; i < links; ++i) {
            const bool last = i + 1 == links;
            const BodyId link = box(origin + (0.25 + 0.5 * i) * way, last ? load : 1, {0.02F, 0.02F, 0.02F});
            const Vec3<float> half = convert<float>(0.25 * way);
            scene.add_joint(BallSocketDefinition{before, link, hook, -half});
            hook = half;
            before = link;
        }
    }
    void step(float dt = frame, std::span<const Contact> contacts = {})
    {
        if (!solver_) solver_ = std::make_unique<Solver>(settings, options_);
        const StepReport report = solver_->step(scene, dt, contacts);
        went_wrong_ = went_wrong_ || report.status != StepStatus::done || report.bodies_contained > 0;
        for (const BodyId id : bodies_) {
            const BodyState s = scene.state(id);
            const Quat<double>& q = s.orientation;
            const double unit = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
            went_wrong_ = went_wrong_ || !std::isfinite(length(s.position)) || !(std::abs(unit - 1) < 1e-5);
        }
    }
    /// Largest rms separation of the joints over so many steps.
    double worst_separation(int steps, float dt = frame)
    {
        double worst = 0;
        for (int i = 0; i < steps; ++i) {
            step(dt);
            worst = std::max(worst, scene.errors().joint_separation_rms);
        }
        return figure(worst);
    }
    [[nodiscard]] double energy() const
    {
        double sum = scene.errors().kinetic_energy;
        const Vec3<double> pull = convert<double>(settings.gravity);
        for (const BodyId id : bodies_) {
            const auto inverse = scene.bodies().inverse_masses[id.slot];
            if (inverse > 0) sum -= dot(pull, scene.state(id).position) / static_cast<double>(inverse);
        }
        return sum;
    }
    /// The largest energy after any of so many steps, or now; `dt(i)` is the length of step i.
    template <class Length>
    double peak_energy(int steps, const Length& dt)
    {
        double peak = energy();
        for (int i = 0; i < steps; ++i) {
            step(dt(i));
            peak = std::max(peak, energy());
        }
        return peak;
    }
    double peak_energy(int steps)
    {
        return peak_energy(steps, [](int) { return frame; });
    }
    [[nodiscard]] double figure(double value) const
    {
        return went_wrong_ || std::isnan(value) ? no_claim : value;
    }
    [[nodiscard]] std::span<const BodyId> bodies() const { return bodies_; }

  private:
    SolverOptions options_;
    std::unique_ptr<Solver> solver_;
    std::vector<BodyId> bodies_;
    bool went_wrong_ = false;
};

// ---- mass ratios ----------------------------------------------------------------------------------------------------

template <int exponent>
double light_tip(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(10, {0, -1, 0}, static_cast<float>(std::pow(10.0, -exponent)));
    trial.scene.set_velocity(trial.bodies()[4], {3, 0, 0}, {});
    return trial.worst_separation(300) / 0.5;
}
template <int exponent>
double hanging_load(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 16;
    trial.settings.joint_hertz = 1e6F;
    trial.chain(11, {0, -1, 0}, static_cast<float>(std::pow(10.0, exponent)));
    return trial.worst_separation(600) / 0.5;
}
double level_load(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 16;
    trial.settings.joint_hertz = 1e6F;
    trial.chain(11, {1, 0, 0}, 1000);
    return trial.worst_separation(600) / 0.5;
}
double long_chain(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(1000, {0, -1, 0}, 1);
    return trial.worst_separation(run.way == ExtremeWay::direct ? 3 : 120) / 0.5;
}

// ---- inertia, spin, time steps --------------------------------------------------------------------------------------

double needle_on_a_lever(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    const BodyId needle = trial.box({10, 0, 0}, 1, {1e-4F, 1, 1});
    trial.scene.add_joint(BallSocketDefinition{trial.scene.ground(), needle, {}, {-10, 0, 0}});
    trial.scene.set_velocity(needle, {}, {50, 0, 0});
    return trial.worst_separation(300) / 10;
}
double tumbling(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({}, 1, {0.1F, 0.2F, 0.25F});
    trial.scene.set_velocity(body, {}, {0.01F, 5, 0.01F});
    const double before = trial.energy();
    const double peak = trial.peak_energy(3600);
    return trial.figure(100 * (peak / before - 1));
}
double fast_spin(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({}, 1, {0.1F, 0.2F, 0.25F});
    trial.scene.set_velocity(body, {}, {3e3F, 1e4F, 2e3F});
    const double before = trial.energy();
    const double peak = trial.peak_energy(600);
    return trial.figure(100 * (peak / before - 1));
}
double coarse_steps(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(5, {1, 0, 0}, 1);
    const double before = trial.energy();
    const double peak = trial.peak_energy(100, [](int) { return 0.5F; });
    return trial.figure((peak - before) / (5 * 9.81 * 1.25));
}
double alternating_steps(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(5, {1, 0, 0}, 1);
    const double before = trial.energy();
    const double peak = trial.peak_energy(1200, [](int i) { return i % 2 == 0 ? 1.0F / 30 : 1.0F / 3000; });
    return trial.figure(100 * (peak - before) / (5 * 9.81 * 1.25));
}
double tiny_steps(const ExtremeRun& run)
{
    const auto end = [&](float dt, int steps) {
        Trial trial(run);
        trial.settings.substeps = 1;
        trial.chain(3, {1, 0, 0}, 1);
        for (int i = 0; i < steps; ++i) trial.step(dt);
        return trial.scene.state(trial.bodies().back()).position;
    };
    const Vec3<double> fine = end(1e-5F, 10000), usual = end(1e-3F, 100);
    const Vec3<double> start{1.25, 0, 0};
    return 100 * length(fine - usual) / length(usual - start);
}

// ---- places ---------------------------------------------------------------------------------------------------------

double far_away(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(10, {1, 0, 0}, 1, {1e7, -1e7, 1e7});
    Trial home(run);
    home.chain(10, {1, 0, 0}, 1);
    return trial.worst_separation(300) - home.worst_separation(300);
}
double fast_travel(const ExtremeRun& run)
{
    Trial trial(run);
    trial.chain(10, {1, 0, 0}, 1);
    // The whole chain and its post at 10 km/s.
    Scene& scene = trial.scene;
    BodyDefinition post;
    post.motion = BodyMotion::kinematic_body;
    post.linear_velocity = {1e4F, 0, 0};
    const BodyId carrier = scene.add_body(post);
    for (const BodyId id : trial.bodies()) scene.set_velocity(id, {1e4F, 0, 0}, {});
    scene.joints().for_each([&](auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        if constexpr (std::is_same_v<typename Store::Type, BallSocket>) {
            const ConstraintId first{store.slots[0], scene.joints().slots[store.slots[0]].generation};
            const BallSocketDefinition hook = store.definitions[0];
            scene.remove_joint(first);
            scene.add_joint(BallSocketDefinition{carrier, hook.body_b, {}, hook.local_anchor_b});
        }
    });
    return trial.worst_separation(300);
}

// ---- degenerate geometry --------------------------------------------------------------------------------------------

double no_distance(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId a = trial.box({}), b = trial.box({});
    DistanceDefinition rod{a, b};
    rod.min_length = rod.max_length = 1;
    trial.scene.add_joint(rod);
    for (int i = 0; i < 600; ++i) trial.step();
    return trial.figure(std::abs(length(trial.scene.state(b).position - trial.scene.state(a).position) - 1));
}
double coincident_contact(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId a = trial.box({}), b = trial.box({});
    double fastest = 0;
    for (int i = 0; i < 240; ++i) {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.normal = {1, 0, 0};
        contact.separation =
            static_cast<float>(trial.scene.state(b).position.x - trial.scene.state(a).position.x) - 2;
        trial.step(frame, {&contact, 1});
        fastest = std::max(fastest, static_cast<double>(trial.scene.state(b).linear_velocity.x -
                                                        trial.scene.state(a).linear_velocity.x));
    }
    return trial.figure(fastest / static_cast<double>(trial.settings.push_out_speed));
}
double half_a_turn_off(const ExtremeRun& run)
{
    double worst = 0;
    for (int axis = 0; axis < 3; ++axis) {
        Trial trial(run, {});
        const BodyId body = trial.box({});
        const double half = (3.14159265358979 - 1e-3) / 2;
        Quat<double> q{0, 0, 0, std::cos(half)};
        (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = std::sin(half);
        trial.scene.set_pose(body, {}, q, 0);
        trial.scene.add_joint(RotationLockDefinition{trial.scene.ground(), body});
        for (int i = 0; i < 120; ++i) trial.step();
        worst = std::max(worst, trial.figure(trial.scene.errors().joint_angle_max));
    }
    return worst;
}
double same_joint_ten_times(const ExtremeRun& run)
{
    const auto end = [&](int times) {
        Trial trial(run);
        trial.settings.substeps = 1;
        const BodyId body = trial.box({0.5, 0, 0});
        for (int i = 0; i < times; ++i)
            trial.scene.add_joint(BallSocketDefinition{trial.scene.ground(), body, {}, {-0.5F, 0, 0}});
        trial.step();
        return convert<double>(trial.scene.state(body).linear_velocity);
    };
    return length(end(10) - end(1));
}
double contradictory_welds(const ExtremeRun& run)
{
    Trial trial(run);
    const BodyId body = trial.box({});
    trial.scene.add_joint(FixedDefinition{trial.scene.ground(), body, {{0.5F, 0, 0}}});
    trial.scene.add_joint(FixedDefinition{trial.scene.ground(), body, {{-0.5F, 0, 0}}});
    double farthest = 0;
    for (int i = 0; i < 2000; ++i) {
        trial.step();
        farthest = std::max(farthest, length(trial.scene.state(body).position));
    }
    return trial.figure(farthest);
}
double loop_of_four(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    const BodyId left = trial.box({0, -0.5, 0}), right = trial.box({1, -0.5, 0}),
                 rod = trial.box({0.5, -1, 0});
    const auto hinge = [&](BodyId a, BodyId b, Vec3<double> at) {
        const Quat<float> z{0, -0.70710678F, 0, 0.70710678F};
        const auto arm = [&](BodyId body) { return convert<float>(at - trial.scene.state(body).position); };
        trial.scene.add_joint(HingeDefinition{a, b, {arm(a), z}, {arm(b), z}});
    };
    hinge(trial.scene.ground(), left, {});
    hinge(trial.scene.ground(), right, {1, 0, 0});
    hinge(left, rod, {0, -1, 0});
    hinge(right, rod, {1, -1, 0});
    trial.scene.set_velocity(rod, {2, 0, 0}, {});
    return trial.worst_separation(run.way == ExtremeWay::direct ? 300 : 3600);
}
double closed_range(const ExtremeRun& run)
{
    const auto end = [&](bool limit) {
        Trial trial(run);
        trial.settings.joint_hertz = 1e6F;
        trial.settings.contact_hertz = 1e6F;
        trial.settings.substeps = 8;
        const BodyId body = trial.box({0.5, 0, 0});
        if (limit) {
            trial.scene.add_joint(SliderDefinition{trial.scene.ground(), body, {}, {{-0.5F, 0, 0}}});
            SlideDriveDefinition range{trial.scene.ground(), body, {}, {{-0.5F, 0, 0}}};
            range.lower = range.upper = 0;
            trial.scene.add_joint(range);
        } else {
            trial.scene.add_joint(FixedDefinition{trial.scene.ground(), body, {}, {{-0.5F, 0, 0}}});
        }
        for (int i = 0; i < 120; ++i) trial.step();
        return trial.scene.state(body).position;
    };
    return length(end(true) - end(false));
}
double limits_at_speed(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({});
    trial.scene.add_joint(SliderDefinition{trial.scene.ground(), body});
    SlideDriveDefinition range{trial.scene.ground(), body};
    range.lower = -1;
    range.upper = 1;
    trial.scene.add_joint(range);
    trial.scene.set_velocity(body, {200, 0, 0}, {});
    const double before = trial.energy();
    const double peak = trial.peak_energy(2000);
    return trial.figure(100 * (peak / before - 1));
}

// ---- loads ----------------------------------------------------------------------------------------------------------

double a_blow(const ExtremeRun& run)
{
    Trial trial(run);
    trial.settings.substeps = 8;
    trial.chain(5, {0, -1, 0}, 1);
    const BodyId tip = trial.bodies().back();
    trial.scene.set_force(tip, {1e6F, 0, 0}, {});
    trial.step();
    trial.scene.set_force(tip, {}, {});
    for (int i = 0; i < 120; ++i) trial.step();
    return trial.figure(trial.scene.errors().joint_separation_rms / 0.5);
}
double deep_overlap(const ExtremeRun& run)
{
    Trial trial(run, {});
    std::vector<BodyId> balls;
    for (int i = 0; i < 3; ++i) balls.push_back(trial.box({0.01 * i, 0, 0}));
    double fastest = 0;
    for (int step = 0; step < 240; ++step) {
        std::vector<Contact> contacts;
        for (std::size_t i = 0; i + 1 < balls.size(); ++i) {
            Contact contact;
            contact.body_a = balls[i];
            contact.body_b = balls[i + 1];
            contact.key = i;
            contact.normal = {1, 0, 0};
            contact.separation = static_cast<float>(trial.scene.state(balls[i + 1]).position.x -
                                                    trial.scene.state(balls[i]).position.x) -
                                 2;
            contacts.push_back(contact);
        }
        trial.step(frame, contacts);
        fastest = std::max(
            fastest, trial.figure(length(convert<double>(trial.scene.state(balls[2]).linear_velocity))));
    }
    // Each of the two contacts parts at the push-out speed, so the outer balls leave the middle one with it.
    return fastest / static_cast<double>(trial.settings.push_out_speed);
}
double huge_friction(const ExtremeRun& run)
{
    Trial trial(run, {3, -9.81F, 0});
    const BodyId body = trial.box({0, 0.5, 0});
    for (int step = 0; step < 600; ++step) {
        std::vector<Contact> contacts;
        for (int corner = 0; corner < 4; ++corner) {
            Contact contact;
            contact.body_a = trial.scene.ground();
            contact.body_b = body;
            contact.key = static_cast<std::uint64_t>(corner);
            contact.normal = {0, 1, 0};
            const BodyState s = trial.scene.state(body);
            const Vec3<double> local{corner % 2 == 0 ? -0.5 : 0.5, -0.5, corner < 2 ? -0.5 : 0.5};
            const Vec3<double> arm = rotate(s.orientation, local);
            contact.separation = static_cast<float>(s.position.y + arm.y);
            contact.arm_b = convert<float>(arm);
            contact.arm_a = convert<float>(s.position + arm);
            contact.friction = 1e6F;
            contacts.push_back(contact);
        }
        trial.step(frame, contacts);
    }
    return trial.figure(std::abs(trial.scene.state(body).position.x) / 10);
}
double weightless_hour(const ExtremeRun& run)
{
    Trial trial(run, {});
    trial.settings.substeps = 1;
    trial.chain(3, {1, 0, 0}, 1);
    const double steps = run.way == ExtremeWay::direct ? 600 : 216000;
    for (int i = 0; i < static_cast<int>(steps); ++i) trial.step();
    return trial.figure(length(trial.scene.state(trial.bodies().back()).position - Vec3<double>{1.25, 0, 0}));
}
template <int exponent>
double spring_of(const ExtremeRun& run)
{
    Trial trial(run, {});
    const BodyId body = trial.box({1.5, 0, 0});
    DistanceDefinition spring{trial.scene.ground(), body};
    spring.min_length = 0;
    spring.max_length = 100;
    spring.spring_hertz = static_cast<float>(std::pow(10.0, exponent));
    spring.spring_damping_ratio = 0.5F;
    spring.rest_length = 1;
    trial.scene.add_joint(spring);
    double farthest = 0;
    for (int i = 0; i < 600; ++i) {
        trial.step();
        farthest = std::max(farthest, std::abs(trial.scene.state(body).position.x - 1));
    }
    return trial.figure(farthest);
}
double both_static(const ExtremeRun& run)
{
    Trial trial(run);
    BodyDefinition still;
    still.motion = BodyMotion::static_body;
    const BodyId a = trial.scene.add_body(still), b = trial.scene.add_body(still);
    int refused = 0;
    try {
        trial.scene.add_joint(BallSocketDefinition{a, b});
    } catch (const InvalidInput&) {
        ++refused;
    }
    try {
        trial.scene.add_joint(BallSocketDefinition{a, a});
    } catch (const InvalidInput&) {
        ++refused;
    }
    trial.step();
    return trial.figure(2 - refused);
}

constexpr std::array<double, extreme_way_count> all(double bound)
{
    return {bound, bound, bound, bound, bound};
}

// Bounds: soft_step, exact_joints, baumgarte, projection, direct.
constexpr ExtremeCase cases[] = {
    {"tip of 1e-6 kg",
     "hanging, pushed at 3 m/s: whips, and holds",
     "L",
     {0.05, 5e-3, 0.05, 0.05, 1e-6},
     light_tip<6>},
    {"tip of 1e-4 kg", "likewise", "L", {0.05, 5e-3, 0.05, 0.05, 1e-6}, light_tip<4>},
    {"load of 1e2 kg, hanging",
     "what a locked joint gives under a weight",
     "L",
     {5e-3, 1e-6, no_claim, no_claim, 1e-9},
     hanging_load<2>},
    {"load of 1e3 kg, hanging", "likewise", "L", {no_claim, 1e-6, no_claim, no_claim, 1e-9}, hanging_load<3>},
    {"load of 1e6 kg, hanging", "likewise", "L", {no_claim, 1e-6, no_claim, no_claim, 1e-9}, hanging_load<6>},
    {"load of 1e3 kg, from level",
     "light links whip round",
     "L",
     {no_claim, 1e-3, no_claim, no_claim, 1e-3},
     level_load},
    {"chain of 1,000 links",
     "its own weight, 9,810 N at the top",
     "L",
     {no_claim, 1e-3, no_claim, no_claim, 1e-6},
     long_chain},
    {"needle on a lever of 10 m", "inertia 1 : 1e4, solved as a block", "L", all(1e-3), needle_on_a_lever},
    {"tumbling about the middle axis", "nobody pushes: energy must not grow in 60 s", "%", all(0.1),
     tumbling},
    {"spin of 1e4 rad/s", "no more energy than before, though a step turns it 166 rad", "%", all(0.1),
     fast_spin},
    {"steps of 0.5 s",
     "implicit locks must not gain energy, of what falls",
     "x",
     {no_claim, 1.0, 1.0, 1.0, 1.0},
     coarse_steps},
    {"steps of 1/30 s and 1/3000 s in turn",
     "cached impulses scale with the step",
     "%",
     {1.0, 1.0, no_claim, 1.0, 1.0},
     alternating_steps},
    {"steps of 1e-5 s", "as steps of 1e-3 s", "%", all(2.0), tiny_steps},
    {"1e7 m from the origin", "doubles resolve 2e-9 m there: separation as at home", "m", all(1e-3),
     far_away},
    {"10 km/s", "floats resolve 1e-3 m/s there", "m", all(0.05), fast_travel},
    {"rod of 1 m between coincident points",
     "an axis is made up; it opens",
     "m",
     {1e-3, 1e-3, 1e-3, 1e-3, 1e-3},
     no_distance},
    {"coincident bodies in contact", "they part at the push-out speed at most", "x", all(1.1),
     coincident_contact},
    {"locked rotation half a turn off", "found within 2 s from pi - 1e-3", "rad", all(1e-2), half_a_turn_off},
    {"one joint ten times",
     "the velocities of one",
     "m/s",
     {1e-4, 1e-4, 1e-4, 1e-4, 1e-5},
     same_joint_ten_times},
    {"two contradictory welds", "1 m apart: the body stays between", "m", all(0.6), contradictory_welds},
    {"loop of four hinges", "redundant rows", "m", {5e-3, 1e-3, 5e-2, 5e-3, 1e-3}, loop_of_four},
    {"slide from 0 to 0", "a fixed joint", "m", {1e-3, 1e-3, 1e-2, 1e-3, 1e-3}, closed_range},
    {"limit hit at 200 m/s", "energy must not grow", "%", all(1.0), limits_at_speed},
    {"1e6 N for one step on 1 kg",
     "whole again within 2 s",
     "L",
     {no_claim, no_claim, no_claim, 0.2, 0.2},
     a_blow},
    {"overlap of 2 m", "nobody is thrown faster than the push-out speed", "x", all(1.1), deep_overlap},
    {"friction 1e6", "sticks: m crept in 10 s, a second", "m/s", all(1e-3), huge_friction},
    {"an hour without weight", "nothing moves what rests", "m", all(1e-6), weightless_hour},
    {"spring of 1e-3 Hz", "never farther than it began, 0.5 m", "m", all(0.501), spring_of<-3>},
    {"spring of 1e6 Hz", "likewise: stiffer than a step can follow", "m", all(0.501), spring_of<6>},
    {"two static bodies, a body with itself", "refused", "not refused", all(0), both_static},
};

}  // namespace

const char* name_of(ExtremeWay way)
{
    static constexpr const char* names[] = {"soft_step", "exact joints", "Baumgarte", "projection", "direct"};
    return names[static_cast<int>(way)];
}

SolverSettings settings_of(ExtremeWay way)
{
    SolverSettings settings;
    settings.exact_joints = way == ExtremeWay::exact_joints;
    if (way == ExtremeWay::direct) {
        settings.method = Method::direct;
        settings.drift_correction = DriftCorrection::projection;
    }
    if (way == ExtremeWay::baumgarte || way == ExtremeWay::projection) {
        settings.method = Method::sequential_impulse;
        settings.iterations = 10;
        settings.drift_correction =
            way == ExtremeWay::baumgarte ? DriftCorrection::baumgarte : DriftCorrection::projection;
    }
    return settings;
}

std::span<const ExtremeCase> extreme_cases()
{
    return cases;
}

int print_extremes(const SolverOptions& options)
{
    int beyond = 0;
    fmt::print("figures; * beyond its bound, - no claim. Bounds in brackets where a claim is made\n{:<40}",
               "");
    for (int way = 0; way < extreme_way_count; ++way)
        fmt::print("{:>24}", name_of(static_cast<ExtremeWay>(way)));
    fmt::print("\n");
    for (const ExtremeCase& extreme : cases) {
        fmt::print("{:<40}", extreme.name);
        for (int way = 0; way < extreme_way_count; ++way) {
            const double figure = extreme.figure({static_cast<ExtremeWay>(way), options});
            const double bound = extreme.bound[static_cast<std::size_t>(way)];
            const bool is_beyond = !(figure <= bound);
            beyond += is_beyond ? 1 : 0;
            fmt::print("{:>24}", bound == no_claim ? fmt::format("{:.2g} -", figure)
                                                   : fmt::format("{:.2g} [{:.2g}]{}", figure, bound,
                                                                 is_beyond ? "*" : " "));
        }
        fmt::print("  {}: {}\n", extreme.unit, extreme.must);
    }
    fmt::print("{} figures beyond their bounds\n", beyond);
    return beyond;
}

}  // namespace motley::bench
