// Rows of discs along x that do not affect each other: crowds whose laws are known exactly.
#pragma once

#include <algorithm>
#include <cmath>

#include "worlds/bench_scene.h"
#include "worlds/slot_index.h"

namespace motley::bench {

/// The root of the mean of squares.
class MeanSquare {
  public:
    void add(double value)
    {
        sum_ += value * value;
        ++count_;
    }
    [[nodiscard]] bool is_empty() const { return count_ == 0; }
    /// NaN if there are no values.
    [[nodiscard]] double root() const { return std::sqrt(sum_ / static_cast<double>(count_)); }

  private:
    double sum_ = 0;
    std::int64_t count_ = 0;
};

/// Rows of planar discs that touch only their neighbours in the row and a wall at its lower end, so that a host needs no
/// search to list the contacts. Discs that bounce are always listed: the library's contacts of discs have no restitution.
class Rows : public BenchScene {
  public:
    void steer(double, Executor&) override {}
    std::span<const Contact> find_contacts(Executor&) override
    {
        contacts_.clear();
        if (!is_listed_) return contacts_;
        touch_neighbours();
        if (has_wall_) touch_wall();
        return contacts_;
    }

  protected:
    static constexpr double radius = 0.2;
    static constexpr float mass = 80;
    static constexpr double margin = 0.05;  ///< m: a pair with a gap up to this becomes a contact
    std::vector<BodyId> bodies_;
    std::vector<Vec3<double>> positions_;
    std::vector<Contact> contacts_;
    bool is_listed_;
    bool has_wall_ = false;
    int length_ = 0;         ///< discs a row
    float restitution_ = 0;  ///< of each contact between them

    explicit Rows(bool is_listed) : is_listed_(is_listed) {}

    /// Adds rows of `length` discs from x = 0 on, `gap` apart.
    void add_rows(std::int64_t agents, int length, double gap)
    {
        length_ = length;
        for (std::int64_t row = 0; row < std::max<std::int64_t>(1, agents / length); ++row) {
            for (int i = 0; i < length; ++i) {
                BodyDefinition body{.model = BodyModel::planar, .mass = mass};
                body.position = {(2 * radius + gap) * i, static_cast<double>(row), 0};
                body.inertia.zz = 0.5F * mass * static_cast<float>(radius * radius);
                bodies_.push_back(scene.add_body(body));
                if (!is_listed_) scene.set_disc(bodies_.back(), {.radius = static_cast<float>(radius)});
            }
        }
        positions_.resize(bodies_.size());
        index_.build(bodies_);
    }
    /// A wall that the first disc of each row touches.
    void add_wall()
    {
        has_wall_ = true;
        if (is_listed_) return;
        const Vec2<double> ends[] = {{-radius, -1}, {-radius, static_cast<double>(bodies_.size())}};
        scene.add_wall({.points = ends});
    }
    /// What each disc is pushed with from its lower side in the last step, N: by the disc before it, or by the wall.
    void read_forces(std::vector<double>& forces) const
    {
        forces.assign(bodies_.size(), 0);
        for (const DiscContact& contact : scene.disc_contacts()) {
            std::int32_t pushed = index_.of(contact.b);
            if (contact.wall == WallId{}) pushed = std::max(pushed, index_.of(contact.a));
            forces[static_cast<std::size_t>(pushed)] = static_cast<double>(contact.normal_force);
        }
        const auto impulses = scene.contact_impulses();
        for (std::size_t k = 0; k < impulses.size(); ++k)
            forces[contacts_[k].key] =
                static_cast<double>(impulses[k].normal) / static_cast<double>(scene.last_step());
    }
    /// The deepest overlap now, m.
    [[nodiscard]] double deepest_overlap() const
    {
        double deepest = 0;
        std::vector<Vec3<double>> at(bodies_.size());
        scene.read_positions(bodies_, at);
        for (std::size_t i = 0; i < at.size(); ++i) {
            const bool is_first = i % static_cast<std::size_t>(length_) == 0;
            if (!is_first) deepest = std::max(deepest, 2 * radius - (at[i].x - at[i - 1].x));
            if (is_first && has_wall_) deepest = std::max(deepest, -at[i].x);
        }
        return deepest;
    }

  private:
    SlotIndex index_;

    /// Adds a contact of each disc with the one before it in its row if that is near. Its key is the disc's number.
    void touch_neighbours()
    {
        scene.read_positions(bodies_, positions_);
        for (std::size_t i = 1; i < bodies_.size(); ++i) {
            if (i % static_cast<std::size_t>(length_) == 0) continue;
            const double gap = positions_[i].x - positions_[i - 1].x - 2 * radius;
            if (gap < margin)
                touch(bodies_[i - 1], bodies_[i], gap, i, {static_cast<float>(radius + gap / 2), 0, 0});
        }
    }
    void touch_wall()
    {
        for (std::size_t i = 0; i < bodies_.size(); i += static_cast<std::size_t>(length_))
            touch(scene.ground(), bodies_[i], positions_[i].x, i,
                  {static_cast<float>(-radius), static_cast<float>(positions_[i].y), 0});
    }
    void touch(BodyId a, BodyId b, double gap, std::uint64_t key, Vec3<float> arm_a)
    {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = key;
        contact.normal = {1, 0, 0};
        contact.separation = static_cast<float>(gap);
        contact.restitution = restitution_;
        contact.arm_a = arm_a;
        contact.arm_b = {-static_cast<float>(radius + gap / 2), 0, 0};
        contacts_.push_back(contact);
    }
};

}  // namespace motley::bench
