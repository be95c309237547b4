// A host that calls the public API in an order and with numbers that bytes decide, hostile ones among them. It checks
// the promises of the API: a refused call changes nothing, a completed step leaves finite bodies, and handles are
// valid exactly while their object is alive.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "motley/motley.h"
#include "stores/joint_store.h"

namespace motley::testing {

class HostileHost {
  public:
    explicit HostileHost(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

    /// Plays until the bytes are used up. Throws std::logic_error when a promise was not kept.
    void play()
    {
        for (int call = 0; call < 300 && !rest_.empty(); ++call) {
            const std::uint64_t before = scene_.state_hash();
            const std::size_t bodies = scene_.body_count(), joints = scene_.joint_count();
            try {
                call_something();
            } catch (const InvalidInput&) {
                demand(scene_.state_hash() == before && scene_.body_count() == bodies &&
                           scene_.joint_count() == joints,
                       "a refused call changed the scene");
            }
        }
    }

  private:
    std::span<const std::uint8_t> rest_;
    Scene scene_;
    Solver solver_{SolverSettings{}};
    std::vector<BodyId> bodies_{scene_.ground(), BodyId{}};  ///< also removed ones
    std::vector<ConstraintId> joints_{ConstraintId{}};
    std::vector<ShapeId> shapes_{ShapeId{}};

    static void demand(bool holds, const char* what)
    {
        if (!holds) throw std::logic_error(what);
    }

    std::uint8_t byte()
    {
        if (rest_.empty()) return 0;
        const std::uint8_t value = rest_.front();
        rest_ = rest_.subspan(1);
        return value;
    }
    /// Mostly a number that a host would use; otherwise one at the limits of float.
    float number()
    {
        static constexpr float edges[] = {0,
                                          -0.0F,
                                          1e-45F,
                                          1e-38F,
                                          1e-6F,
                                          1e6F,
                                          1e9F,
                                          1e30F,
                                          3.4e38F,
                                          -3.4e38F,
                                          -1e9F,
                                          std::numeric_limits<float>::infinity(),
                                          -std::numeric_limits<float>::infinity(),
                                          std::numeric_limits<float>::quiet_NaN()};
        const std::uint8_t kind = byte();
        if (kind < 0xD0) return static_cast<float>(kind - 0x68) / 16;
        if (kind < 0xF8) return edges[kind % std::size(edges)];
        std::uint8_t raw[4] = {byte(), byte(), byte(), byte()};
        float value;
        std::memcpy(&value, raw, sizeof value);
        return value;
    }
    Vec3<float> vector() { return {number(), number(), number()}; }
    Vec3<double> point() { return convert<double>(vector()); }
    BodyId body() { return bodies_[byte() % bodies_.size()]; }
    ConstraintId joint() { return joints_[byte() % joints_.size()]; }

    void call_something()
    {
        switch (byte() % 23) {
            case 0:
            case 1:
                return add_body();
            case 2: {
                const BodyId gone = body();
                scene_.remove_body(gone);
                return demand(!scene_.is_alive(gone), "a removed body is alive");
            }
            case 3:
                return scene_.set_pose(body(), point(), {number(), number(), number(), number()}, number());
            case 4:
                return scene_.set_velocity(body(), vector(), vector());
            case 5:
                return scene_.set_force(body(), vector(), vector());
            case 6:
            case 7:
            case 8:
                return add_some_joint(JointTypes{});
            case 9: {
                const ConstraintId gone = joint();
                scene_.remove_joint(gone);
                return demand(!scene_.is_alive(gone), "a removed joint is alive");
            }
            case 10:
                return change_settings();
            case 11:
                scene_.set_break_limit(joint(), {number(), number()});
                return scene_.set_iterations(joint(), byte());
            case 12: {
                const BodyId frozen = body();
                scene_.revive(frozen, point(), vector());
                return demand(!scene_.is_contained(frozen), "a revived body is contained");
            }
            case 13: {
                Scene copy = scene_;
                demand(copy.state_hash() == scene_.state_hash(), "a copy has other bits");
                scene_ = copy;
                return;
            }
            case 14: {
                const BodyId changed = body();
                scene_.set_mass(changed, number(),
                                {number(), number(), number(), number(), number(), number()});
                scene_.set_user_data(changed, 7);
                return demand(scene_.user_data(changed) == 7, "user data is lost");
            }
            case 15:
                return add_shape();
            case 16: {
                const ShapeId gone = shapes_[byte() % shapes_.size()];
                scene_.remove_shape(gone);
                return demand(!scene_.is_alive(gone), "a removed shape is alive");
            }
            case 17:
                return scene_.set_disc(body(), {number(), number(), byte(), byte()});
            case 18: {
                const BodyId changed = body();
                const auto model = static_cast<BodyModel>(byte() % 4);  // one of them is none
                const std::uint8_t round = byte() % 2;
                scene_.change_body(changed, {model, round ? Sym3<float>{1, 0, 0, 1, 0, 1}
                                                          : Sym3<float>{number(), number(), number(),
                                                                        number(), number(), number()}});
                return demand(scene_.is_alive(changed) && scene_.model(changed) == model,
                              "a changed body has another model");
            }
            case 19: {
                const BodyId sleeper = body();
                scene_.wake(sleeper);
                return demand(!scene_.is_asleep(sleeper), "a woken body sleeps");
            }
            case 20:
                return scene_.set_damping(body(), number(), number());
            default:
                return step();
        }
    }

    void add_shape()
    {
        const std::uint8_t kind = byte();
        if (kind % 8 == 0) {
            keep(scene_.add_half_space({body(), point(), vector(), number(), number()}));
        } else if (kind % 8 == 1) {
            const Vec3<double> from = point(), to = point();
            const Vec2<double> ends[] = {{from.x, from.y}, {to.x, to.y}};
            scene_.add_wall({.points = ends, .body = body(), .friction = number(), .one_way = kind > 0x80});
        } else {
            CapsuleDefinition capsule{.body = body(), .radius = number()};
            if (kind % 8 < 5) capsule.from = vector();
            if (kind % 8 == 2) capsule.to = vector();
            if (kind > 0x80) capsule.friction = number();
            if (kind % 3 == 0) capsule.restitution = number();
            if (kind % 5 == 0) capsule.group = byte();
            keep(scene_.add_capsule(capsule));
        }
    }
    void keep(ShapeId shape)
    {
        shapes_.push_back(shape);
        demand(scene_.is_alive(shape), "an added shape is not alive");
    }

    void add_body()
    {
        BodyDefinition body;
        const std::uint8_t kind = byte();
        body.model = static_cast<BodyModel>(kind % 3);
        body.motion = kind < 0xC0 ? BodyMotion::dynamic_body : static_cast<BodyMotion>(kind / 3 % 3);
        body.position = point();
        if (kind % 5 == 0) body.orientation = {number(), number(), number(), number()};
        if (kind % 5 == 1) body.yaw = number();
        if (kind % 7 == 0) body.linear_velocity = vector();
        if (kind % 7 == 1) body.angular_velocity = vector();
        if (kind % 11 == 0) body.mass = number();
        if (kind % 11 == 1) body.inertia = {number(), number(), number(), number(), number(), number()};
        bodies_.push_back(scene_.add_body(body));
        demand(scene_.is_alive(bodies_.back()), "an added body is not alive");
    }

    /// A definition is two bodies and numbers, any of which may be overwritten.
    template <class... Types>
    void add_some_joint(TypeList<Types...>)
    {
        int which = byte() % static_cast<int>(sizeof...(Types));
        const BodyId a = body(), b = body();
        const auto add = [&]<class Definition>(Definition definition) {
            static_assert(std::is_trivially_copyable_v<Definition>);
            definition.body_a = a;
            definition.body_b = b;
            constexpr std::size_t first = 2 * sizeof(BodyId);
            constexpr std::size_t words = (sizeof(Definition) - first) / sizeof(float);
            for (int change = byte() % 6; change > 0; --change) {
                const float value = number();
                std::memcpy(reinterpret_cast<char*>(&definition) + first + byte() % words * sizeof value,
                            &value, sizeof value);
            }
            const std::uint8_t says_anew = byte();
            if (says_anew < 0x20) return scene_.set_joint(joint(), definition);
            joints_.push_back(scene_.add_joint(definition));
            demand(scene_.is_alive(joints_.back()), "an added joint is not alive");
        };
        ((which-- == 0 ? add(typename Types::Definition{}) : void()), ...);
    }

    void change_settings()
    {
        SolverSettings settings;
        settings.method = static_cast<Method>(byte() % 3);
        settings.drift_correction = static_cast<DriftCorrection>(byte() % 3);
        settings.substeps = byte() % 9;
        settings.iterations = byte() % 9;
        settings.relaxations = byte() % 4;
        const std::uint8_t flags = byte();
        settings.exact_joints = flags & 1;
        settings.warm_start = flags & 2;
        settings.measures = flags & 4;
        if (flags & 8) settings.tolerance = number();
        if (flags & 16) settings.gravity = vector();
        if (flags & 32) settings.joint_hertz = number();
        if (flags & 64) settings.contact_hertz = number();
        if (flags & 128) settings.bad_contacts = BadContacts::skip;
        const std::uint8_t sleep = byte();
        if (sleep & 1) settings.sleep_speed = number();
        if (sleep & 2) settings.sleep_after = number();
        settings.exact_contacts = sleep & 4;
        settings.exact_limits = sleep & 8;
        solver_.set_settings(settings);
    }

    void step()
    {
        std::vector<Contact> contacts(byte() % 5);
        for (Contact& contact : contacts) {
            contact.body_a = body();
            contact.body_b = body();
            contact.key = byte() % 8;
            contact.normal = Vec3<float>{byte() % 2 == 0 ? 1.0F : number(), 0, 0};
            contact.separation = number();
            contact.arm_a = vector();
            contact.arm_b = vector();
            if (byte() % 4 == 0) contact.friction = number();
            if (byte() % 4 == 0) contact.restitution = number();
        }
        const std::uint64_t before = scene_.state_hash();
        // The direct method is slow with extreme numbers, so it runs only on small scenes.
        if (solver_.settings().method == Method::direct && scene_.joint_count() + contacts.size() > 6) return;
        const float dt = byte() % 4 != 0 ? 1.0F / 60 : number();
        Scene seen_anew = scene_;
        const StepReport report = solver_.step(scene_, dt, contacts);
        if (report.status != StepStatus::done) {
            demand(!report.error.empty(), "a refused step does not say why");
            return demand(scene_.state_hash() == before, "a refused step changed the scene");
        }
        if (solver_.settings().budget_ms == 0) {
            // What a solver keeps of a scene must not matter.
            Solver(solver_.settings()).step(seen_anew, dt, contacts);
            demand(seen_anew.state_hash() == scene_.state_hash(), "a new solver gives other bits");
        }
        for (const BodyId id : bodies_) {
            if (!scene_.is_alive(id)) continue;
            const BodyState s = scene_.state(id);
            const double sum =
                s.position.x + s.position.y + s.position.z + s.yaw + s.orientation.x + s.orientation.y +
                s.orientation.z + s.orientation.w + static_cast<double>(s.linear_velocity.x) +
                static_cast<double>(s.linear_velocity.y) + static_cast<double>(s.linear_velocity.z) +
                static_cast<double>(s.angular_velocity.x) + static_cast<double>(s.angular_velocity.y) +
                static_cast<double>(s.angular_velocity.z);
            demand(std::isfinite(sum), "a body is not finite after a step");
            const Vec3<float>&v = s.linear_velocity, &w = s.angular_velocity;
            demand(!scene_.is_asleep(id) || (dot(v, v) == 0 && dot(w, w) == 0), "a sleeper moves");
        }
        for (const ConstraintId id : joints_) {
            if (scene_.is_alive(id)) static_cast<void>(scene_.joint_report(id));
        }
    }
};

}  // namespace motley::testing
