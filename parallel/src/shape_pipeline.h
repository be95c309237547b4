// The path of the contacts that the library finds for capsules: they join those of the host's list. Each phase is one
// function here, in the order in which they run.
#pragma once

#include <span>
#include <string>

#include "shapes/shape_contacts.h"
#include "shapes/shape_pairs.h"
#include "stage_runner.h"
#include "stores/array.h"

namespace motley {

class ShapePipeline {
  public:
    explicit ShapePipeline(StageRunner& runner) : runner_(runner) {}

    /// Before a step of dt seconds: returns the host's contacts, and behind them those of capsules, if there are any.
    /// Valid until the next call.
    std::span<const Contact> join(SceneCore& scene, std::span<const Contact> hosts, float dt);
    /// What the surfaces of the contacts of capsules do, in their order; empty if all are the default.
    [[nodiscard]] std::span<const ContactSurface<float>> surfaces() const { return surfaces_; }
    /// What is wrong with the keys of the host's list, or empty.
    [[nodiscard]] static std::string wrong_key(const SceneCore& scene, std::span<const Contact> hosts);
    /// After a step that is done: the scene remembers what was found. Allocates nothing.
    void remember(SceneCore& scene) const;
    /// The number of contacts of capsules.
    [[nodiscard]] std::size_t found() const { return all_.size() - hosts_; }

  private:
    StageRunner& runner_;
    ShapePairs pairs_;
    ShapeContacts contacts_;
    Array<Contact> all_;
    Array<ContactSurface<float>> surfaces_;
    std::size_t hosts_ = 0;  ///< of `all_`, those of the host's list

    void find_surfaces(const SceneCore& scene);
    void find_pairs(SceneCore& scene, double dt);
};

}  // namespace motley
