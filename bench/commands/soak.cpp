// The town of the soak, and the checks after every step.
#include "commands/soak.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "measuring/clock.h"
#include "measuring/host.h"
#include "motley/core/snapshot.h"
#include "worlds/crowd.h"
#include "worlds/random.h"

namespace motley::bench {
namespace {

constexpr float frame = 1.0F / 60;
constexpr double people_a_square_metre = 2;
constexpr std::size_t most_figures = 24;
constexpr int days_down = 300;   ///< steps that a figure lies before it rises
constexpr float bears = 4000;    ///< N: the break limit of a joint
constexpr double fastest = 100;  ///< m/s: five times a blow
constexpr std::int64_t save_every = 1000;

/// Somebody who fell: a torso and four limbs.
struct FallenPerson {
    std::vector<BodyId> bodies;
    std::vector<std::uint64_t> numbers;  ///< of each body, for contact keys
    std::vector<ConstraintId> joints;
    int age = 0;  ///< steps
};
constexpr float torso_radius = 0.15F, limb_radius = 0.08F;
float radius_of(std::size_t part)
{
    return part == 0 ? torso_radius : limb_radius;
}

/// One of the two copies: a host and its scene. What it does follows from the seed alone.
class Town {
  public:
    Town(const SoakOptions& options, int threads)
        : solver({.gravity = {0, 0, -9.81F}}, {.threads = threads, .alone_below = 0}),
          random_(options.seed),
          wanted_(static_cast<std::size_t>(options.people)),
          side_(std::sqrt(static_cast<double>(options.people) / people_a_square_metre))
    {
        people_.friction = 0.2F;
        people_.walls = {{{0, 0}, {side_, 0}},
                         {{side_, 0}, {side_, side_}},
                         {{side_, side_}, {0, side_}},
                         {{0, side_}, {0, 0}}};
    }

    Scene scene;
    Solver solver;
    SoakResult counted;

    /// The host's part of a step, then the solver's. Returns what is wrong, or an empty string.
    std::string step()
    {
        // The number of people falls and rises by a fifth, so that memory is freed and needed again as well.
        const double tide = 0.9 + 0.1 * std::sin(static_cast<double>(counted.steps) / 2000);
        const auto wanted = static_cast<std::size_t>(tide * static_cast<double>(wanted_));
        for (int i = 0; i < 8 && people_.agents.size() < wanted; ++i) {
            add_person(somewhere());
            ++counted.joined;
        }
        while (people_.agents.size() > wanted || random_.uniform() < 0.1) {
            remove_person(anybody());
            ++counted.left;
        }
        if (figures_.size() < most_figures && random_.uniform() < 0.05) fall(anybody());
        if (!figures_.empty() && random_.uniform() < 0.03) strike();
        while (!figures_.empty() && figures_.front().age >= days_down) rise();

        people_.observe(scene, solver.executor());
        for (Agent& agent : people_.agents) {
            if (random_.uniform() < 0.005) agent.goal = somewhere();
        }
        people_.steer(scene, solver.executor());
        const std::span<const Contact> among_people = people_.find_contacts(scene, solver.executor());
        contacts_.assign(among_people.begin(), among_people.end());
        for (const FallenPerson& figure : figures_) add_contacts(figure);

        const StepReport report = solver.step(scene, frame, contacts_);
        ++counted.steps;
        for (FallenPerson& figure : figures_) ++figure.age;
        if (report.status != StepStatus::done) return "the step was refused: " + report.error;
        if (report.bodies_contained > 0) return fmt::format("{} bodies frozen", report.bodies_contained);
        for (const BreakEvent& event : std::vector(scene.break_events().begin(), scene.break_events().end()))
            break_joint(event.joint);
        counted.most_bodies = std::max(counted.most_bodies, static_cast<std::int64_t>(scene.body_count()));
        counted.most_contacts = std::max(counted.most_contacts, report.contacts);
        return what_is_wrong();
    }

  private:
    Random random_;
    std::size_t wanted_;
    double side_;
    Crowd people_;
    std::deque<FallenPerson> figures_;
    std::vector<Contact> contacts_;
    std::uint64_t next_part_ = 0;
    std::deque<BodyId> dead_;  ///< the bodies removed last

    Vec2<double> somewhere()
    {
        const double x = 0.5 + (side_ - 1) * random_.uniform(), y = 0.5 + (side_ - 1) * random_.uniform();
        return {x, y};
    }
    std::size_t anybody()
    {
        return static_cast<std::size_t>(random_.uniform() * static_cast<double>(people_.agents.size()));
    }

    void add_person(Vec2<double> at)
    {
        Agent agent;
        agent.radius = static_cast<float>(0.20 + 0.02 * random_.symmetric());
        agent.goal = somewhere();
        people_.add(scene, agent, at);
    }
    void remove_person(std::size_t who)
    {
        bury(people_.agents[who].body);
        people_.remove(scene, who);
    }
    void bury(BodyId body)
    {
        dead_.push_back(body);
        if (dead_.size() > 100) dead_.pop_front();
    }

    /// A planar person becomes a figure of rigid bodies, z up.
    void fall(std::size_t who)
    {
        const BodyState from = scene.state(people_.agents[who].body);
        remove_person(who);
        FallenPerson figure;
        const auto add = [&](Vec3<double> offset, float mass, float radius) {
            BodyDefinition body;
            body.position = {from.position.x + offset.x, from.position.y + offset.y, 1 + offset.z};
            body.mass = mass;
            const float inertia = 0.4F * mass * radius * radius;
            body.inertia = {inertia, 0, 0, inertia, 0, inertia};
            body.linear_velocity = from.linear_velocity;
            figure.bodies.push_back(scene.add_body(body));
            figure.numbers.push_back(next_part_++);
            return figure.bodies.back();
        };
        const BodyId torso = add({}, 40, 0.25F);
        constexpr Vec3<float> ends[4] = {
            {0.2F, 0, 0.2F}, {-0.2F, 0, 0.2F}, {0.1F, 0, -0.3F}, {-0.1F, 0, -0.3F}};
        for (int i = 0; i < 4; ++i) {
            const Vec3<float> reach{i < 2 ? ends[i].x : 0.0F, 0, i < 2 ? 0.0F : -0.25F};
            const BodyId limb = add(convert<double>(ends[i] + reach), 6, 0.12F);
            const JointFrame on_torso{ends[i]}, on_limb{-reach};
            if (i < 2) {
                watch(figure, scene.add_joint(BallSocketDefinition{torso, limb, ends[i], -reach}));
                figure.joints.push_back(
                    scene.add_joint(SwingLimitDefinition{torso, limb, on_torso, on_limb, 1.2F}));
            } else {
                watch(figure, scene.add_joint(HingeDefinition{torso, limb, on_torso, on_limb}));
                TwistDriveDefinition knee{torso, limb, on_torso, on_limb};
                knee.lower = -0.2F;
                knee.upper = 1.5F;
                figure.joints.push_back(scene.add_joint(knee));
            }
        }
        figures_.push_back(std::move(figure));
        ++counted.fallen;
    }
    void watch(FallenPerson& figure, ConstraintId joint)
    {
        scene.set_break_limit(joint, {.force = bears});
        figure.joints.push_back(joint);
    }
    /// Turns the figure that has lain longest back into a planar person.
    void rise()
    {
        const FallenPerson figure = std::move(figures_.front());
        figures_.pop_front();
        const Vec3<double> at = scene.state(figure.bodies.front()).position;
        scene.remove_bodies(figure.bodies);
        for (const BodyId body : figure.bodies) bury(body);
        add_person({std::clamp(at.x, 0.3, side_ - 0.3), std::clamp(at.y, 0.3, side_ - 0.3)});
        ++counted.risen;
    }
    void strike()
    {
        const auto which = static_cast<std::size_t>(random_.uniform() * static_cast<double>(figures_.size()));
        const FallenPerson& figure = figures_[which];
        const auto part = static_cast<std::size_t>(random_.uniform() * 5);
        const auto speed = static_cast<float>(20 * random_.uniform());
        const float angle = static_cast<float>(6.28 * random_.uniform());
        scene.set_velocity(figure.bodies[part], {speed * std::cos(angle), speed * std::sin(angle), speed / 4},
                           {0, 0, speed});
    }
    void break_joint(ConstraintId joint)
    {
        for (FallenPerson& figure : figures_) {
            const auto at = std::find(figure.joints.begin(), figure.joints.end(), joint);
            if (at == figure.joints.end()) continue;
            figure.joints.erase(at);
            scene.remove_joint(joint);
            ++counted.broken;
            return;
        }
    }

    /// Contacts of the figure's parts, which are balls, with the floor, the walls and people, who are taken as
    /// cylinders up to z = 1.9 m.
    void add_contacts(const FallenPerson& figure)
    {
        constexpr std::uint64_t of_parts = std::uint64_t{3} << 62, no_person = 0xffffffff;
        for (std::size_t i = 0; i < figure.bodies.size(); ++i) {
            const Vec3<double> at = scene.state(figure.bodies[i]).position;
            const float radius = radius_of(i);
            const std::uint64_t number = figure.numbers[i] & 0x3fffffff;
            const std::pair<Vec3<float>, double> planes[] = {{{0, 0, 1}, at.z},
                                                             {{1, 0, 0}, at.x},
                                                             {{-1, 0, 0}, side_ - at.x},
                                                             {{0, 1, 0}, at.y},
                                                             {{0, -1, 0}, side_ - at.y}};
            for (std::uint64_t plane = 0; plane < std::size(planes); ++plane) {
                const auto& [normal, distance] = planes[plane];
                // Farther away than the fastest body moves in a step.
                if (distance - static_cast<double>(radius) > fastest * static_cast<double>(frame)) continue;
                Contact contact;
                contact.body_a = scene.ground();
                contact.body_b = figure.bodies[i];
                contact.key = of_parts | number << 32 | (no_person - plane);
                contact.normal = normal;
                contact.separation = static_cast<float>(distance) - radius;
                contact.arm_a = convert<float>(at - distance * convert<double>(normal));
                contact.arm_b = static_cast<float>(-distance) * normal;
                contact.friction = 0.6F;
                contact.restitution = 0.2F;
                contacts_.push_back(contact);
            }
            for (std::size_t who = 0; who < people_.agents.size(); ++who) {
                const auto dx = static_cast<float>(at.x - people_.positions[who].x),
                           dy = static_cast<float>(at.y - people_.positions[who].y);
                const float reach = radius + people_.agents[who].radius, squared = dx * dx + dy * dy;
                if (squared > (reach + 0.3F) * (reach + 0.3F) || at.z > 1.9) continue;
                const float distance = std::sqrt(squared);
                Contact contact;
                contact.body_a = people_.agents[who].body;
                contact.body_b = figure.bodies[i];
                contact.key = of_parts | number << 32 | people_.number_of(who);
                contact.normal =
                    distance > 1e-6F ? Vec3<float>{dx / distance, dy / distance, 0} : Vec3<float>{1, 0, 0};
                contact.separation = distance - reach;
                contact.arm_a = people_.agents[who].radius * contact.normal;
                contact.arm_b = -radius * contact.normal;
                contact.friction = 0.3F;
                contacts_.push_back(contact);
            }
        }
    }

    [[nodiscard]] std::string what_is_wrong() const
    {
        std::size_t joints = 0;
        const auto wrong = [&](BodyId body, double room) -> const char* {
            if (!scene.is_alive(body)) return "a body is lost";
            const BodyState state = scene.state(body);
            const Vec3<double> v = convert<double>(state.linear_velocity);
            // A not-a-number fails these comparisons too.
            if (!(dot(v, v) < fastest * fastest)) return "a body is too fast";
            const Vec3<double>& p = state.position;
            const bool inside = p.x > -room && p.x < side_ + room && p.y > -room && p.y < side_ + room &&
                                p.z > -room && p.z < 50;
            return inside ? nullptr : "a body is out of town";
        };
        for (const Agent& agent : people_.agents) {
            if (const char* what = wrong(agent.body, 0.5)) return what;
        }
        for (const FallenPerson& figure : figures_) {
            for (const BodyId body : figure.bodies) {
                if (const char* what = wrong(body, 1)) return what;
            }
            for (const ConstraintId joint : figure.joints) {
                if (!scene.is_alive(joint)) return "a joint is lost";
            }
            joints += figure.joints.size();
        }
        if (scene.body_count() != people_.agents.size() + 5 * figures_.size())
            return fmt::format("{} bodies where {} are known", scene.body_count(),
                               people_.agents.size() + 5 * figures_.size());
        if (scene.joint_count() != joints)
            return fmt::format("{} joints where {} are known", scene.joint_count(), joints);
        for (const BodyId body : dead_) {
            if (scene.is_alive(body)) return "a removed body is alive";
        }
        return {};
    }
};

/// How much of the soak is done: by steps if their number is given, else by the clock.
class Progress {
  public:
    explicit Progress(const SoakOptions& options) : options_(options) {}
    [[nodiscard]] double seconds() const { return now() - began_; }
    [[nodiscard]] double share(std::int64_t steps) const
    {
        return options_.steps > 0 ? static_cast<double>(steps) / static_cast<double>(options_.steps)
                                  : seconds() / options_.seconds;
    }

  private:
    const SoakOptions& options_;
    double began_ = now();
};

}  // namespace

SoakResult soak(const SoakOptions& options)
{
    if (!(options.seconds > 0)) throw std::invalid_argument("soak: seconds must be above 0");
    if (options.people < 10) throw std::invalid_argument("soak: people must be at least 10");
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("motley-soak-{}.scene", getpid());
    Town one(options, 1), two(options, 2);
    // Copies have the same handles, so that a town can go on with the scene that the other one has saved.
    two.scene = one.scene;
    SoakResult& result = one.counted;
    const Progress progress(options);
    double said = 0;
    while (progress.share(one.counted.steps) < 1) {
        std::string failure = one.step();
        if (failure.empty()) failure = two.step();
        if (failure.empty() && one.scene.state_hash() != two.scene.state_hash())
            failure = "one and two threads differ";
        if (!failure.empty()) {
            result.failure = fmt::format("step {}: {}", one.counted.steps, failure);
            break;
        }
        if (one.counted.steps % save_every == 0) {
            save_scene(one.scene, file);
            two.scene = load_scene(file);
            ++result.restored;
        }
        if (one.counted.steps % 100 != 0) continue;
        const double share = progress.share(one.counted.steps), memory = resident_bytes() * 1e-6;
        if (share > 0.25 && share < 0.5) result.memory_before = std::max(result.memory_before, memory);
        if (share > 0.75) result.memory_after = std::max(result.memory_after, memory);
        if (options.progress && progress.seconds() > said + 1) {
            said = progress.seconds();
            fmt::print(stderr, "\r{:3.0f} %, {} steps, {} bodies, {:.1f} MB ", 100 * share, one.counted.steps,
                       one.scene.body_count(), memory);
            std::fflush(stderr);
        }
    }
    std::filesystem::remove(file);
    if (options.progress) fmt::print(stderr, "\r{:60}\r", "");
    if (result.failure.empty() && result.memory_before > 0 &&
        result.memory_after > 1.01 * result.memory_before + 2)
        result.failure =
            fmt::format("memory grew from {:.1f} to {:.1f} MB", result.memory_before, result.memory_after);
    return result;
}

std::string table_of(const SoakResult& result, double seconds)
{
    std::string text;
    const auto line = [&](const char* what, const std::string& value) {
        text += fmt::format("{:<44}{}\n", what, value);
    };
    line("steps, each by one and by two threads", fmt::format("{}, in {:.0f} s", result.steps, seconds));
    line("people who joined, left", fmt::format("{}, {}", result.joined, result.left));
    line("fell, rose again", fmt::format("{}, {}", result.fallen, result.risen));
    line("joints that broke", fmt::format("{}", result.broken));
    line("scenes that went on from a file", fmt::format("{}", result.restored));
    line("most bodies, most contacts", fmt::format("{}, {}", result.most_bodies, result.most_contacts));
    if (result.memory_before > 0)
        line("MB resident, second and last quarter",
             fmt::format("{:.1f}, {:.1f}", result.memory_before, result.memory_after));
    line("wrong", result.failure.empty() ? "nothing" : result.failure);
    return text;
}

}  // namespace motley::bench
