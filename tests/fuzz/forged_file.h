// Files of scenes that somebody has changed and then given a valid size and checksum.
#pragma once

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "motley/core/snapshot.h"
#include "motley/motley.h"
#include "scene/scene_core.h"
#include "stores/joint_store.h"

namespace motley::testing {

inline constexpr std::size_t snapshot_header = 32;  ///< bytes; the size is at 16, the checksum at 24

/// The checksum by which a reader verifies the file.
inline std::uint64_t snapshot_checksum(const std::string& file)
{
    std::uint64_t hash = 0xCBF29CE484222325ULL;
    const auto mix = [&](std::uint64_t word) {
        hash = (hash ^ word) * 0x100000001B3ULL;
        hash ^= hash >> 29;
    };
    std::size_t at = snapshot_header;
    for (; at + 8 <= file.size(); at += 8) {
        std::uint64_t word;
        std::memcpy(&word, file.data() + at, sizeof word);
        mix(word);
    }
    for (; at < file.size(); ++at) mix(static_cast<unsigned char>(file[at]));
    return hash;
}

/// Makes size and checksum valid again.
inline void make_whole(std::string& file)
{
    const std::uint64_t size = file.size() - snapshot_header, checksum = snapshot_checksum(file);
    std::memcpy(file.data() + 16, &size, sizeof size);
    std::memcpy(file.data() + 24, &checksum, sizeof checksum);
}

inline std::string bytes_of(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Adds a joint of every type, with the defaults of its definition.
template <class... Types>
void add_one_of_each(Scene& scene, BodyId a, BodyId b, TypeList<Types...>)
{
    const auto add = [&]<class Definition>(Definition definition) {
        definition.body_a = a;
        definition.body_b = b;
        scene.add_joint(definition);
    };
    (add(typename Types::Definition{}), ...);
}

/// A scene some steps old that has something of everything that a file holds: each body model and type of joint,
/// discs and walls, capsules and half-spaces, figures in lockstep, requested iterations, break limits, contacts, and slots
/// that removed bodies, joints and shapes have left free.
inline StepProblem seed_problem()
{
    StepProblem problem;
    Scene& scene = problem.scene;
    std::vector<BodyId> bodies;
    for (int i = 0; i < 5; ++i) {
        BodyDefinition body;
        body.model = static_cast<BodyModel>(i % 3);
        body.motion = i == 4 ? BodyMotion::kinematic_body : BodyMotion::dynamic_body;
        body.position = {1.0 * i, 0.1 * i, 0};
        bodies.push_back(scene.add_body(body));
        if (i < 3) scene.add_joint(BallSocketDefinition{scene.ground(), bodies.back(), {}, {}});
    }
    BodyDefinition body;
    body.position = {0, 2, 0};
    const BodyId other = scene.add_body(body);
    add_one_of_each(scene, bodies[2], other, JointTypes{});
    const ConstraintId gone = scene.add_joint(BallSocketDefinition{scene.ground(), other, {}, {0, 2, 0}});
    const ConstraintId rope = scene.add_joint(DistanceDefinition{scene.ground(), other, {}, {}, 0, 2});
    scene.set_break_limit(rope, {1, 2});
    scene.set_iterations(rope, 3);
    scene.set_island_iterations(other, 2);
    scene.set_user_data(other, 5);
    const BodyId neighbour = scene.add_body({.model = BodyModel::planar, .position = {1.3, 0.1, 0}});
    scene.set_disc(bodies[1], {.radius = 0.2F});
    scene.set_disc(neighbour, {.radius = 0.2F, .friction = 0.5F});
    const Vec2<double> ends[] = {{-2, -0.1}, {3, -0.1}};
    scene.remove_wall(scene.add_wall({.points = ends}));
    scene.add_wall({.points = ends, .friction = 0.3F});
    scene.add_wall({.points = ends, .body = bodies[4]});
    scene.add_half_space({.point = {0, -3, 0}, .normal = {0, 1, 0}, .friction = 0.5F});
    scene.add_capsule({.body = bodies[2], .from = {-0.5F, 0, 0}, .to = {0.5F, 0, 0}, .radius = 0.3F});
    scene.remove_shape(scene.add_capsule({.body = other}));
    scene.add_capsule({.body = bodies[0], .radius = 0.2F, .friction = 0.5F, .group = 3});
    scene.remove_joint(gone);
    scene.remove_body(bodies[3]);
    Figure figure;
    const BodyId hook = figure.add_body({.motion = BodyMotion::static_body});
    const BodyId bob = figure.add_body({.position = {0, -1, 0}});
    figure.add_joint(BallSocketDefinition{hook, bob, {}, {0, 1, 0}});
    std::vector<Placing> placings(8);
    for (std::size_t i = 0; i < placings.size(); ++i) placings[i].position.x = 10 + static_cast<double>(i);
    add_assembly(scene, figure, placings);
    problem.settings.gravity = {0, -9.81F, 0};
    problem.dt = 1.0F / 60;
    Contact contact;
    contact.body_a = scene.ground();
    contact.body_b = bodies[0];
    contact.normal = {0, 1, 0};
    contact.friction = 0.5F;
    problem.contacts = {contact};
    Solver solver(problem.settings);
    for (int step = 0; step < 3; ++step) solver.step(scene, problem.dt, problem.contacts);
    return problem;
}

/// Writes the seed to a file at `path` and returns its bytes.
inline std::string seed_file(const std::string& path, bool problem)
{
    const StepProblem seed = seed_problem();
    if (problem) {
        save_problem(seed, path);
    } else {
        save_scene(seed.scene, path);
    }
    return bytes_of(path);
}

/// The seed with each of these changes xored into one of its bytes.
inline std::string forged(const std::string& path, const std::string& changes, bool problem)
{
    static const std::string seeds[] = {seed_file(path, false), seed_file(path, true)};
    std::string file = seeds[problem ? 1 : 0];
    // Three bytes each: two for the place, one for the change.
    for (std::size_t i = 0; i + 2 < changes.size(); i += 3) {
        const std::size_t where =
            static_cast<unsigned char>(changes[i]) * 256U + static_cast<unsigned char>(changes[i + 1]);
        char& at = file[snapshot_header + where % (file.size() - snapshot_header)];
        at = static_cast<char>(at ^ changes[i + 2]);
    }
    make_whole(file);
    return file;
}

/// What a host may do with any scene: step it with swept and with exact joints, and add and remove bodies and joints.
inline void live_on(Scene& scene)
{
    for (const bool exact : {false, true}) Solver({.exact_joints = exact}).step(scene, 1.0F / 60);
    std::vector<BodyId> going;
    const BodyStore& bodies = core_of(scene).bodies;
    for (std::uint32_t slot = 1; slot < bodies.slot_count(); ++slot) {
        const BodyId body = bodies.id_of_slot(slot);
        if (bodies.is_slot_live(slot) && slot % 2 == 0 && body != scene.ground()) going.push_back(body);
    }
    scene.remove_bodies(going);
    for (std::size_t i = 0; i <= going.size(); ++i)
        scene.add_joint(BallSocketDefinition{scene.ground(), scene.add_body({}), {}, {}});
    Solver({.gravity = {0, -9.81F, 0}}).step(scene, 1.0F / 60);
}

}  // namespace motley::testing
