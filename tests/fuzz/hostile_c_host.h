// A host that calls the C interface in an order and with structs that bytes decide: sizes, enumerations, flags, counts and
// strides that cannot be, null pointers and handles of what was removed. It checks the promises: a call that is not done
// says why and changes nothing, and a step leaves finite bodies. Every pointer that is not null leads to memory of its size,
// for more no interface in C can check.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "motley/c/motley.h"

namespace motley::testing {

class HostileCHost {
  public:
    explicit HostileCHost(std::span<const std::uint8_t> bytes) : rest_(bytes)
    {
        done(motley_scene_create(&scene_));
        done(motley_solver_create(nullptr, nullptr, &solver_));
        motley_body_id ground;
        done(motley_scene_ground(scene_, &ground));
        bodies_ = {ground, {}};
        // With a person and a box from the start, more of what is tried succeeds.
        motley_body_definition definition = motley_default_body_definition();
        for (const motley_body_model model : {MOTLEY_RIGID, MOTLEY_PLANAR, MOTLEY_RIGID}) {
            definition.model = model;
            bodies_.emplace_back();
            done(motley_scene_add_body(scene_, &definition, &bodies_.back()));
        }
    }
    HostileCHost(const HostileCHost&) = delete;
    HostileCHost& operator=(const HostileCHost&) = delete;
    ~HostileCHost()
    {
        motley_solver_destroy(solver_);
        motley_scene_destroy(scene_);
    }

    /// Plays until the bytes are used up. Throws std::logic_error when a promise was not kept.
    void play()
    {
        for (int call = 0; call < 300 && !rest_.empty(); ++call) call_something();
    }

  private:
    std::span<const std::uint8_t> rest_;
    motley_scene* scene_ = nullptr;
    motley_solver* solver_ = nullptr;
    std::vector<motley_body_id> bodies_;
    std::vector<motley_constraint_id> joints_{{}};
    std::vector<motley_wall_id> walls_{{}};
    std::vector<motley_shape_id> shapes_{{}};
    bool is_direct_ = false;

    static void demand(bool holds, const char* what)
    {
        if (!holds) throw std::logic_error(what);
    }
    static void done(motley_status status) { demand(status == MOTLEY_DONE, "an ordinary call was refused"); }

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
                                          1e-6F,
                                          1e6F,
                                          1e9F,
                                          1e30F,
                                          3.4e38F,
                                          -3.4e38F,
                                          std::numeric_limits<float>::infinity(),
                                          std::numeric_limits<float>::quiet_NaN()};
        const std::uint8_t kind = byte();
        return kind < 0xD0 ? static_cast<float>(kind - 0x68) / 16 : edges[kind % std::size(edges)];
    }
    motley_vec3f vector() { return {number(), number(), number()}; }
    motley_vec3d point() { return {number(), number(), number()}; }
    template <class Id>
    Id one_of(const std::vector<Id>& ids)
    {
        return ids[byte() % ids.size()];
    }
    motley_body_id body() { return one_of(bodies_); }
    /// One of the host's pointers, or null.
    template <class T>
    T* or_null(T* pointer)
    {
        return byte() % 32 == 31 ? nullptr : pointer;
    }
    /// Mostly what it should be.
    std::size_t length(std::size_t right)
    {
        static constexpr std::size_t wrong[] = {0, 1, 4, SIZE_MAX, SIZE_MAX / 2};
        const std::uint8_t kind = byte();
        return kind < 0xF0 ? right : wrong[kind % std::size(wrong)];
    }

    /// Calls, and checks what is promised of every call.
    template <class Call>
    motley_status call(const Call& of_interface)
    {
        std::uint64_t before = 0, after = 0;
        std::size_t bodies_before = 0, joints_before = 0, bodies_after = 0, joints_after = 0;
        done(motley_scene_state_hash(scene_, &before));
        done(motley_scene_body_count(scene_, &bodies_before));
        done(motley_scene_joint_count(scene_, &joints_before));
        const motley_status status = of_interface();
        if (status == MOTLEY_DONE) return status;
        demand(status == MOTLEY_REFUSED || status == MOTLEY_OUT_OF_MEMORY || status == MOTLEY_FILE_ERROR,
               "a call failed in an unknown way");
        demand(motley_last_error()[0] != 0, "a refused call does not say why");
        done(motley_scene_state_hash(scene_, &after));
        done(motley_scene_body_count(scene_, &bodies_after));
        done(motley_scene_joint_count(scene_, &joints_after));
        demand(before == after && bodies_before == bodies_after && joints_before == joints_after,
               "a refused call changed the scene");
        return status;
    }
    /// The same, and keeps the handle that a successful call wrote.
    template <class Id, class Call>
    void add(std::vector<Id>& ids, const Call& of_interface)
    {
        static constexpr Id untouched{77, 77};
        Id id = untouched;
        if (call([&] { return of_interface(&id); }) == MOTLEY_DONE) {
            ids.push_back(id);
        } else {
            demand(std::memcmp(&id, &untouched, sizeof id) == 0, "a refused call wrote a handle");
        }
    }

    /// Overwrites some words of a struct behind `first` bytes, and seldom its size.
    template <class Struct>
    void distort(Struct& value, std::size_t first)
    {
        const std::size_t words = (sizeof value - first) / 4;
        const std::uint8_t changes = byte();
        for (int change = changes < 0x80 ? 0 : changes % 6; change > 0; --change) {
            const float as_float = number();
            const std::int32_t as_integer = byte() % 8 - 2;
            char* word = reinterpret_cast<char*>(&value) + first + byte() % words * 4;
            if (byte() % 3 == 0) {
                std::memcpy(word, &as_integer, 4);
            } else {
                std::memcpy(word, &as_float, 4);
            }
        }
        value.struct_size = length(value.struct_size);
    }

    void call_something()
    {
        switch (byte() % 24) {
            case 0:
            case 1:
            case 2:
                return add_body();
            case 3:
                call([&] { return motley_scene_remove_body(scene_, body()); });
                return;
            case 4:
                call([&] {
                    return motley_scene_set_pose(scene_, body(), point(),
                                                 {number(), number(), number(), number()}, number());
                });
                return;
            case 5:
                call([&] { return motley_scene_set_velocity(scene_, body(), vector(), vector()); });
                return;
            case 6:
            case 7:
            case 8:
                return add_joint();
            case 9:
                call([&] { return motley_scene_remove_joint(scene_, one_of(joints_)); });
                return;
            case 10:
                return change_settings();
            case 11:
                return add_wall();
            case 12:
                return add_shape();
            case 13: {
                motley_disc_definition disc = motley_default_disc_definition();
                distort(disc, sizeof(std::size_t));
                call([&] { return motley_scene_set_disc(scene_, body(), or_null(&disc)); });
                return;
            }
            case 14: {
                motley_body_change change = motley_default_body_change();
                distort(change, sizeof(std::size_t));
                call([&] { return motley_scene_change_body(scene_, body(), or_null(&change)); });
                return;
            }
            case 15:
                return bulk();
            case 16:
                call([&] { return motley_scene_remove_shape(scene_, one_of(shapes_)); });
                call([&] { return motley_scene_remove_wall(scene_, one_of(walls_)); });
                return;
            case 17:
                call([&] {
                    return motley_scene_set_break_limit(scene_, one_of(joints_), number(), number());
                });
                call([&] { return motley_scene_set_iterations(scene_, one_of(joints_), byte() - 3); });
                call([&] { return motley_scene_set_island_iterations(scene_, body(), byte() - 3); });
                return;
            case 18:
                return save_and_load();
            case 19:
                return read_everything();
            case 20:
                return ask();
            default:
                return step();
        }
    }

    void add_body()
    {
        motley_body_definition definition = motley_default_body_definition();
        definition.model = byte() % 3;
        definition.position = point();
        if (byte() % 2 == 0) distort(definition, sizeof(std::size_t));
        add(bodies_,
            [&](motley_body_id* id) { return motley_scene_add_body(scene_, or_null(&definition), id); });
    }

    void add_joint()
    {
        int which = byte() % 21;
        const motley_body_id a = body(), b = body();
        const auto add_one = [&](auto definition, auto* add_call, auto* set_call) {
            definition.body_a = a;
            definition.body_b = b;
            distort(definition, sizeof(std::size_t) + 2 * sizeof a);
            if (byte() % 4 == 0) {
                call([&] { return set_call(scene_, one_of(joints_), &definition); });
            } else {
                add(joints_,
                    [&](motley_constraint_id* id) { return add_call(scene_, or_null(&definition), id); });
            }
        };
#define MOTLEY_ADD_ONE(name, Cpp) \
    if (which-- == 0)             \
        add_one(motley_default_##name##_definition(), motley_scene_add_##name, motley_scene_set_##name);
        MOTLEY_JOINT_TYPES(MOTLEY_ADD_ONE)
#undef MOTLEY_ADD_ONE
    }

    void change_settings()
    {
        motley_solver_settings settings = motley_default_solver_settings();
        settings.method = byte() % 3;
        settings.substeps = 1 + byte() % 4;
        distort(settings, sizeof(std::size_t));
        // What depends on the clock or takes long is not for a fuzzer.
        settings.budget_ms = 0;
        if (settings.substeps > 8 || settings.iterations > 20 || settings.relaxations > 20 ||
            settings.projections > 20)
            return;
        if (call([&] { return motley_solver_set_settings(solver_, or_null(&settings)); }) == MOTLEY_DONE)
            is_direct_ = settings.method == MOTLEY_DIRECT;
    }

    void add_wall()
    {
        std::array<motley_vec2d, 5> points;
        for (motley_vec2d& p : points) p = {number(), number()};
        motley_wall_definition wall = motley_default_wall_definition();
        distort(wall, offsetof(motley_wall_definition, closed));
        wall.points = or_null(points.data());
        wall.point_count = byte() % 6;
        if (byte() % 16 == 15) wall.point_count = SIZE_MAX;
        if (byte() % 2 == 0) {
            return add(walls_,
                       [&](motley_wall_id* id) { return motley_scene_add_wall(scene_, or_null(&wall), id); });
        }
        wall.points = nullptr;
        wall.point_count = 0;
        const motley_ring rings[] = {{points.data(), 3 + byte() % 3U}, {points.data() + 1, byte() % 5U}};
        motley_wall_id made[2];
        const std::size_t count = byte() % 3;
        if (call([&] { return motley_scene_add_polygon(scene_, count, rings, or_null(&wall), made); }) ==
            MOTLEY_DONE)
            walls_.insert(walls_.end(), made, made + count);
    }

    void add_shape()
    {
        motley_capsule_definition capsule = motley_default_capsule_definition();
        motley_half_space_definition half_space = motley_default_half_space_definition();
        if (byte() % 4 == 0) {
            distort(half_space, sizeof(std::size_t) + sizeof(motley_body_id));
            return add(shapes_, [&](motley_shape_id* id) {
                return motley_scene_add_half_space(scene_, or_null(&half_space), id);
            });
        }
        capsule.body = body();
        distort(capsule, sizeof(std::size_t) + sizeof(motley_body_id));
        add(shapes_,
            [&](motley_shape_id* id) { return motley_scene_add_capsule(scene_, or_null(&capsule), id); });
    }

    void bulk()
    {
        struct Agent {
            motley_vec3d position;
            motley_vec3f velocity;
            float other;
            motley_quatd orientation;
        };
        std::array<Agent, 4> agents{};
        std::array<motley_body_id, 4> of{};
        for (std::size_t i = 0; i < of.size(); ++i) {
            of[i] = body();
            agents[i].velocity = vector();
        }
        std::size_t count = byte() % 5, stride = length(sizeof(Agent));
        if (byte() % 16 == 15) count = SIZE_MAX - byte();
        call([&] {
            return motley_scene_set_velocities(scene_, count, or_null(of.data()),
                                               or_null(&agents[0].velocity), stride,
                                               or_null(&agents[0].velocity), stride);
        });
        call([&] {
            return motley_scene_read_positions(scene_, count, or_null(of.data()),
                                               or_null(&agents[0].position), stride);
        });
        call([&] {
            return motley_scene_read_orientations(scene_, count, or_null(of.data()),
                                                  or_null(&agents[0].orientation), stride);
        });
        call([&] {
            return motley_scene_set_forces(scene_, count, of.data(), or_null(&agents[0].velocity), stride,
                                           nullptr, 0);
        });
    }

    /// What is read back continues with the same bits, and cut bytes are refused.
    void save_and_load()
    {
        void* bytes = nullptr;
        std::size_t size = 0;
        motley_scene* loaded = nullptr;
        done(motley_scene_save(scene_, &bytes, &size));
        const std::size_t given = byte() % 4 == 0 ? size - 1 : size;
        const motley_status status = call([&] { return motley_scene_load(or_null(bytes), given, &loaded); });
        motley_free(bytes);
        demand((status == MOTLEY_DONE) == (loaded != nullptr), "a scene was read, and not");
        if (status != MOTLEY_DONE) return;
        demand(given == size, "cut bytes were read");
        motley_scene_destroy(scene_);
        scene_ = loaded;
    }

    void read_everything()
    {
        std::array<motley_disc_contact, 2> discs;
        std::array<motley_shape_contact, 2> shapes;
        std::array<motley_body_load, 2> loads;
        std::array<motley_body_id, 2> of{body(), body()};
        motley_joint_report report;
        motley_scene_errors errors;
        motley_body_state state;
        std::size_t count = 0;
        const std::size_t capacity = length(discs.size());
        if (capacity <= discs.size()) {
            call([&] {
                return motley_scene_disc_contacts(scene_, capacity, or_null(discs.data()), or_null(&count));
            });
            call([&] { return motley_scene_shape_contacts(scene_, capacity, shapes.data(), &count); });
            call(
                [&] { return motley_scene_disc_contacts_of(scene_, of[0], capacity, discs.data(), &count); });
            call([&] {
                return motley_scene_shape_contacts_of(scene_, of[0], capacity, shapes.data(), &count);
            });
            call([&] { return motley_scene_read_bodies(scene_, capacity, of.data(), &count); });
        }
        call([&] {
            return motley_scene_read_loads(scene_, 2, of.data(), 0, nullptr, loads.data(),
                                           length(sizeof loads[0]), nullptr, 0);
        });
        call([&] { return motley_scene_joint_report(scene_, one_of(joints_), &report); });
        call([&] { return motley_scene_body_state(scene_, of[1], &state); });
        done(motley_scene_measure_errors(scene_, &errors));
        done(motley_scene_renumber_bodies(scene_));
    }

    void ask()
    {
        motley_crowd_index* people = nullptr;
        motley_wall_index* walls = nullptr;
        done(motley_crowd_index_create(&people));
        done(motley_wall_index_create(&walls));
        std::array<motley_body_id, 3> found;
        std::array<motley_near_person, 3> near;
        const motley_vec2d corners[] = {{number(), number()}, {number(), number()}, {number(), number()}};
        const motley_ring area{or_null(corners), byte() % 4U};
        std::size_t count = 0;
        motley_bool is_hit = 0;
        motley_wall_hit hit;
        call([&] { return motley_crowd_index_build(people, or_null(scene_)); });
        call([&] { return motley_wall_index_build(walls, or_null(scene_)); });
        call([&] {
            return motley_crowd_index_nearest(people, corners[0], number(), 3, or_null(near.data()),
                                              or_null(&count));
        });
        call([&] {
            return motley_crowd_index_discs_within(people, corners[1], number(), 3, found.data(), &count);
        });
        call([&] { return motley_crowd_index_inside(people, byte() % 2, &area, 3, found.data(), &count); });
        call([&] {
            return motley_wall_index_first_hit(walls, corners[0], corners[1], byte(), or_null(&is_hit),
                                               or_null(&hit));
        });
        motley_crowd_index_destroy(people);
        motley_wall_index_destroy(walls);
    }

    void step()
    {
        std::vector<motley_contact> contacts(byte() % 5);
        for (motley_contact& contact : contacts) {
            contact = {};
            contact.body_a = body();
            contact.body_b = body();
            contact.key = byte() % 8;
            contact.normal.x = byte() % 2 == 0 ? 1.0F : number();
            contact.separation = number();
            contact.arm_a = vector();
            contact.arm_b = vector();
        }
        std::size_t joints = 0;
        done(motley_scene_joint_count(scene_, &joints));
        // The direct method is slow with extreme numbers, so it runs only on small scenes.
        if (is_direct_ && joints + contacts.size() > 6) return;
        const float dt = byte() % 4 != 0 ? 1.0F / 60 : number();
        motley_step_report report = motley_default_step_report();
        report.struct_size = length(report.struct_size);
        const motley_status status = call([&] {
            return motley_solver_step(solver_, or_null(scene_), dt, contacts.size(), or_null(contacts.data()),
                                      or_null(&report));
        });
        if (status != MOTLEY_DONE) return;
        for (const motley_body_id id : bodies_) {
            motley_bool alive = 0;
            done(motley_scene_is_body_alive(scene_, id, &alive));
            if (alive == 0) continue;
            motley_body_state s;
            done(motley_scene_body_state(scene_, id, &s));
            const double sum =
                s.position.x + s.position.y + s.position.z + s.yaw + s.orientation.w +
                static_cast<double>(s.linear_velocity.x) + static_cast<double>(s.linear_velocity.y) +
                static_cast<double>(s.linear_velocity.z) + static_cast<double>(s.angular_velocity.z);
            demand(std::isfinite(sum), "a body is not finite after a step");
        }
    }
};

}  // namespace motley::testing
