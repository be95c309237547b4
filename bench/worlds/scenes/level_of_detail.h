// A crowd that models only what it must: people near a viewer are discs with friction, those farther away discs without,
// the farthest particles that touch nobody, and the fallen rigid bodies. The viewer walks round, so that some change their
// model every second; each keeps its body and its momenta.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <utility>
#include <vector>

#include "measuring/clock.h"
#include "measuring/median.h"
#include "worlds/bench_scene.h"
#include "worlds/fallen.h"
#include "worlds/random.h"

namespace motley::bench {

/// How a person is modelled, from little to much.
enum class Level { particle, smooth, rough, single, figure };
inline constexpr std::array<const char*, 5> level_names{"particle", "disc, smooth", "disc, rough",
                                                        "rigid body", "figure of 11 bodies"};

/// What a crowd of several models is like.
struct LevelsPlan {
    double density = 2;            ///< people per m2
    bool has_particles = true;     ///< the two fifths that are farthest are particles; else smooth discs
    bool is_rough = true;          ///< the fifth that is nearest are discs with friction; else nobody is
    double lying = 0;              ///< share of the people who lie from the start
    std::size_t falls = 1;         ///< a second, as figures, of those who are near
    std::size_t falls_as_one = 1;  ///< a second, as one body, of those who are farthest
    double lies_for = 8;           ///< s
};

class LevelOfDetail final : public BenchScene {
  public:
    /// At the start a fifth are rough discs and two fifths smooth ones, unless everybody is to be of one level for good.
    explicit LevelOfDetail(const RunOptions& options, const LevelsPlan& plan,
                           const Level* everybody = nullptr)
        : options_(options), plan_(plan), everybody_(everybody != nullptr), random_(options.seed)
    {
        const double density = options.density > 0 ? options.density : plan.density;
        const auto count = static_cast<std::size_t>(options.agents);
        side_ = std::sqrt(static_cast<double>(count) / density);
        const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
        const double pitch = side_ / static_cast<double>(columns);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec2<double> at{pitch * (0.5 + static_cast<double>(i % columns)),
                                  pitch * (0.5 + static_cast<double>(i / columns))};
            BodyDefinition body;
            body.model = BodyModel::particle;
            body.position = {at.x, at.y, height};
            body.mass = standing.mass;
            Person person;
            person.body = scene.add_body(body);
            person.goal = somewhere();
            bodies_.push_back(person.body);
            people_.push_back(person);
        }
        forces_.resize(count);
        const Vec2<double> corners[] = {{0, 0}, {side_, 0}, {side_, side_}, {0, side_}};
        scene.add_wall({.points = corners, .closed = true});
        scene.add_half_space({.friction = 0.6F});  // only capsules meet it: those of the fallen
        observe_people();
        if (everybody_) {
            for (std::size_t i = 0; i < count; ++i) {
                bring_to(i, *everybody);
                push_over(i, 0);
            }
        } else {
            rank(0);
            for (std::size_t place = 0; place < count; ++place)
                bring_to(by_distance_[place], wanted_at(place));
            lay_down();
        }
        promoted_ = demoted_ = 0;
        seconds_of_changes_.clear();
    }

    void adjust(SolverSettings& settings) const override
    {
        settings.gravity = gravity;
        // Between walkers who push from all sides sweeps let figures part by centimetres.
        if (plan_.lying > 0) settings.exact_joints = true;
    }

    void steer(double time, Executor&) override
    {
        observe_people();
        if (!everybody_ && time >= next_changes_) {
            next_changes_ += 1;
            rank(time);
            promote_and_demote();
            fall_and_rise(time);
        }
        push_people();
    }

    std::span<const Contact> find_contacts(Executor&) override { return {}; }
    void observe(double time, const Solver&) override
    {
        if (time < settling || fallen_.empty()) return;
        const BodyId ground = scene.ground();
        BodyLoad load;
        scene.read_loads({&ground, 1}, {}, StridedSpan<BodyLoad>(&load, 1));
        floor_force_ -= static_cast<double>(load.net_force.z);
        weight_ -= static_cast<double>(fallen_.size()) * static_cast<double>(standing.mass * gravity.z);
        if (++observed_ % 30 != 0) return;
        for (const Lying& lying : fallen_) add_drifts(scene, lying.fallen, drifts_);
    }

    /// The fallen below, with the people who stand as discs above them.
    [[nodiscard]] std::optional<View> view() const override
    {
        View view;
        const Vec2<double> corners[] = {{0, 0}, {side_, 0}, {side_, side_}, {0, side_}};
        for (std::size_t i = 0; i < 4; ++i) view.walls.push_back({corners[i], corners[(i + 1) % 4]});
        for (const Lying& lying : fallen_) add_silhouettes(scene, lying.fallen, view);
        std::vector<BodyLoad> loads(bodies_.size());
        scene.read_loads(bodies_, {}, StridedSpan<BodyLoad>(loads));
        constexpr auto radius = static_cast<double>(standing.radius);
        for (std::size_t i = 0; i < people_.size(); ++i) {
            if (has_fallen(people_[i].level)) continue;
            const Vec2<double> at{positions_[i].x, positions_[i].y};
            view.shapes.push_back({at, at, radius,
                                   static_cast<double>(loads[i].normal_force) / (6.283185307179586 * radius),
                                   view.people.size()});
            view.people.push_back(at);
            view.numbers.push_back(bodies_[i].slot);
        }
        return view;
    }
    [[nodiscard]] std::vector<Figure> figures() const override
    {
        std::vector<Figure> all;
        all.emplace_back("people who lie", static_cast<double>(fallen_.size()));
        all.emplace_back("people promoted", promoted_);
        all.emplace_back("people demoted", demoted_);
        all.emplace_back("people who fell", fell_);
        all.emplace_back("people who rose again", risen_);
        all.emplace_back("host's time for a change, median (us)", 1e6 * median(seconds_of_changes_));
        for (std::size_t level = 0; level < level_names.size(); ++level)
            all.emplace_back(
                fmt::format("price of a {}: solver's time a step and person (ns)", level_names[level]),
                price_of(static_cast<Level>(level)));
        return all;
    }
    [[nodiscard]] std::vector<Mark> marks() const override
    {
        std::vector<Mark> all{
            {"momentum: largest jump at a change (share of a walker's)", momentum_jump_, 1e-6},
            {"angular momentum: likewise (share of a walker's momentum at an arm of 1 m)", angular_jump_,
             1e-6}};
        if (plan_.lying > 0 && weight_ > 0 && !drifts_.empty()) {
            std::vector<double> drifts = drifts_;
            const auto p99 = drifts.begin() + static_cast<std::ptrdiff_t>(drifts.size() * 99 / 100);
            std::nth_element(drifts.begin(), p99, drifts.end());
            all.push_back({"joints of the fallen part by, p99 (m)", *p99, 0.005});
            all.push_back({"force of the floor against the weight of the fallen, mean (%)",
                           100 * std::abs(floor_force_ / weight_ - 1), 1});
        }
        return all;
    }

  private:
    struct Person {
        BodyId body{};
        Vec2<double> goal{};
        Level level = Level::particle;
    };
    struct Lying {
        Fallen fallen;
        double since = 0;  ///< s
    };
    static constexpr Vec3<float> gravity{0, 0, -9.81F};
    static constexpr double height = 0.96;  ///< m, of the pelvis
    static constexpr Standing standing{};
    static constexpr double walking_speed = 1.34;        ///< m/s
    static constexpr double settling = 3;                ///< s before the floor and the joints are watched
    static constexpr std::size_t changes_a_second = 20;  ///< of each direction

    RunOptions options_;
    LevelsPlan plan_;
    bool everybody_;
    Random random_;
    double side_ = 0, next_changes_ = 1;
    std::vector<Person> people_;
    std::vector<BodyId> bodies_;
    std::vector<Vec3<double>> positions_;
    std::vector<Vec3<float>> velocities_, forces_;
    std::vector<std::size_t> by_distance_;  ///< people, the one nearest to the viewer first
    const FallenShape figure_ = FallenShape::figure(standing.mass),
                      single_ = FallenShape::single(standing.mass);
    std::deque<Lying> fallen_;
    double promoted_ = 0, demoted_ = 0, fell_ = 0, risen_ = 0;
    double floor_force_ = 0, weight_ = 0;  ///< N, summed over the steps that were observed
    std::size_t observed_ = 0;
    std::vector<double> drifts_;  ///< m
    double momentum_jump_ = 0, angular_jump_ = 0;
    std::vector<double> seconds_of_changes_;

    Vec2<double> somewhere()
    {
        const double x = 0.5 + (side_ - 1) * random_.uniform(), y = 0.5 + (side_ - 1) * random_.uniform();
        return {x, y};
    }
    static bool has_fallen(Level level) { return level >= Level::single; }

    void observe_people()
    {
        positions_.resize(people_.size());
        velocities_.resize(people_.size());
        scene.read_positions(bodies_, std::span(positions_));
        scene.read_velocities(bodies_, std::span(velocities_));
    }
    /// Everybody walks to a goal. The floor carries who stands: only particles can fall, so that the others ignore it.
    void push_people()
    {
        constexpr float relaxation = 0.5F;  // s
        for (std::size_t i = 0; i < people_.size(); ++i) {
            Person& person = people_[i];
            forces_[i] = {};
            if (has_fallen(person.level)) continue;
            double x = person.goal.x - positions_[i].x, y = person.goal.y - positions_[i].y;
            if (x * x + y * y < 1) {
                person.goal = somewhere();
                x = person.goal.x - positions_[i].x, y = person.goal.y - positions_[i].y;
            }
            const double per_metre = walking_speed / (std::hypot(x, y) + 1e-9);
            const float push = standing.mass / relaxation;
            forces_[i] = {push * (static_cast<float>(per_metre * x) - velocities_[i].x),
                          push * (static_cast<float>(per_metre * y) - velocities_[i].y),
                          -standing.mass * gravity.z};
        }
        scene.set_forces(bodies_, std::span<const Vec3<float>>(forces_));
    }

    /// Sorts people by their distance from the viewer, who walks round the middle once a minute.
    void rank(double time)
    {
        constexpr double turn = 6.283185307179586 / 60;  // rad/s
        const double x = side_ * (0.5 + 0.25 * std::cos(turn * time)),
                     y = side_ * (0.5 + 0.25 * std::sin(turn * time));
        by_distance_.resize(people_.size());
        for (std::size_t i = 0; i < people_.size(); ++i) by_distance_[i] = i;
        std::vector<double> away(people_.size());
        for (std::size_t i = 0; i < people_.size(); ++i)
            away[i] = std::hypot(positions_[i].x - x, positions_[i].y - y);
        std::stable_sort(by_distance_.begin(), by_distance_.end(),
                         [&](std::size_t i, std::size_t j) { return away[i] < away[j]; });
    }
    [[nodiscard]] Level wanted_at(std::size_t place) const
    {
        const std::size_t fifth = people_.size() / 5;
        if (place < fifth && plan_.is_rough) return Level::rough;
        return place < 3 * fifth || !plan_.has_particles ? Level::smooth : Level::particle;
    }
    /// The nearest of those who are modelled too simply, and the farthest of those who are modelled too well.
    void promote_and_demote()
    {
        std::size_t left = changes_a_second;
        for (std::size_t place = 0; place < by_distance_.size() && left > 0; ++place) {
            const std::size_t who = by_distance_[place];
            if (people_[who].level >= wanted_at(place)) continue;
            bring_to(who, wanted_at(place));
            --left;
        }
        left = changes_a_second;
        for (std::size_t place = by_distance_.size(); place-- > 0 && left > 0;) {
            const std::size_t who = by_distance_[place];
            if (people_[who].level <= wanted_at(place) || has_fallen(people_[who].level)) continue;
            bring_to(who, wanted_at(place));
            --left;
        }
    }
    /// Those who lie from the start are spread over all places; each has lain for another while.
    void lay_down()
    {
        const auto count = static_cast<std::size_t>(plan_.lying * static_cast<double>(people_.size()));
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t who = i * people_.size() / count;
            const double since = plan_.lies_for * (static_cast<double>(i) / static_cast<double>(count) - 1);
            bring_to(who, Level::figure);
            push_over(who, since);
        }
    }
    /// Some who are near fall as figures, and some who are far as one body; who has lain for long rises.
    void fall_and_rise(double time)
    {
        const std::size_t fifth = people_.size() / 5;
        const auto somebody = [&](std::size_t first, std::size_t count) {
            return by_distance_[first +
                                static_cast<std::size_t>(random_.uniform() * static_cast<double>(count))];
        };
        const auto topple = [&](std::size_t who, Level level) {
            if (has_fallen(people_[who].level)) return;
            bring_to(who, level);
            push_over(who, time);
        };
        for (std::size_t i = 0; i < plan_.falls; ++i) topple(somebody(0, fifth), Level::figure);
        for (std::size_t i = 0; i < plan_.falls_as_one; ++i)
            topple(somebody(3 * fifth, fifth), Level::single);
        while (!fallen_.empty() && fallen_.front().since + plan_.lies_for <= time)
            bring_to(fallen_.front().fallen.number, plan_.is_rough ? Level::rough : Level::smooth);
    }

    /// Changes the model of a person, and notes what the momenta do.
    void bring_to(std::size_t who, Level level)
    {
        Person& person = people_[who];
        if (person.level == level) return;
        const Momenta before = momenta_of_person(who);
        const double began = now();
        if (has_fallen(person.level)) {
            stand_up(who, level);
        } else if (has_fallen(level)) {
            fall_down(who, level);
        } else {
            change_model(person, level);
        }
        seconds_of_changes_.push_back(now() - began);
        person.level = level;
        note_jump(before, momenta_of_person(who), level);
    }
    void change_model(Person& person, Level level)
    {
        level > person.level ? ++promoted_ : ++demoted_;
        if (level == Level::particle) {
            scene.clear_disc(person.body);
            scene.change_body(person.body, {.model = BodyModel::particle});
            return;
        }
        if (person.level == Level::particle) become_planar(person);
        wear_disc(person, level);
    }
    void become_planar(const Person& person)
    {
        scene.change_body(person.body, {BodyModel::planar, {0, 0, 0, 0, 0, standing.moment()}});
    }
    void wear_disc(const Person& person, Level level)
    {
        scene.set_disc(person.body,
                       {.radius = standing.radius, .friction = level == Level::rough ? 0.3F : 0.0F});
    }
    void fall_down(std::size_t who, Level level)
    {
        ++fell_;
        const BodyId body = people_[who].body;
        if (scene.has_disc(body)) scene.clear_disc(body);
        scene.set_force(body, {}, {});
        const FallenShape& shape = level == Level::figure ? figure_ : single_;
        fallen_.push_back({fall(scene, body, shape, static_cast<std::uint32_t>(who)), 0});
    }
    /// Without a push those who fall would stand for a while.
    void push_over(std::size_t who, double time)
    {
        if (!has_fallen(people_[who].level)) return;
        fallen_.back().since = time;
        tip_over(scene, fallen_.back().fallen, 1.5F);
    }
    void stand_up(std::size_t who, Level level)
    {
        ++risen_;
        const auto lying = std::find_if(fallen_.begin(), fallen_.end(),
                                        [&](const Lying& l) { return l.fallen.number == who; });
        rise(scene, lying->fallen, standing, height);
        fallen_.erase(lying);
        wear_disc(people_[who], level);
    }
    [[nodiscard]] Momenta momenta_of_person(std::size_t who) const
    {
        for (const Lying& lying : fallen_) {
            if (lying.fallen.number == who) return momenta_of(scene, lying.fallen);
        }
        return momenta_of(scene, people_[who].body, standing);
    }
    /// Of what the new model has: who stands has neither momentum along z nor, unless a particle, any but about z.
    void note_jump(const Momenta& before, const Momenta& after, Level level)
    {
        Vec3<double> linear = after.linear - before.linear, angular = after.angular - before.angular;
        if (!has_fallen(level)) linear.z = angular.x = angular.y = 0;
        if (level == Level::particle) angular = {};
        const double walker = static_cast<double>(standing.mass) * walking_speed;
        momentum_jump_ = std::max(momentum_jump_, std::sqrt(dot(linear, linear)) / walker);
        angular_jump_ = std::max(angular_jump_, std::sqrt(dot(angular, angular)) / walker);
    }

    /// The solver's time a step and person, ns, where everybody is of this level, after two seconds.
    [[nodiscard]] double price_of(Level level) const
    {
        RunOptions options = options_;
        const std::int64_t most = level == Level::figure ? 200 : 2000;
        options.agents = std::min(options.agents, most);
        options.settings.gravity = gravity;
        LevelOfDetail all(options, plan_, &level);
        Solver solver(options.settings, options.solver);
        std::vector<double> seconds;
        for (int step = 0; step < 240; ++step) {
            all.steer(step * static_cast<double>(options.dt), solver.executor());
            const double began = now();
            const StepReport report = solver.step(all.scene, options.dt);
            if (report.status != StepStatus::done)
                throw std::runtime_error("level-of-detail: " + report.error);
            if (step >= 120) seconds.push_back(now() - began);
        }
        return 1e9 * median_of_eights(seconds) / static_cast<double>(options.agents);
    }
};

}  // namespace motley::bench
