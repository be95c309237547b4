// An engine simulating a rig: motley, or a peer that is installed here.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motley/motley.h"
#include "worlds/rig.h"

namespace motley::bench {

class Engine {
  public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;
    /// Advances by `dt` seconds; this call is what is timed. Throws std::runtime_error when the engine gives up.
    virtual void step(float dt) = 0;
    /// Seconds that the solver took in the last step; negative for an engine that does not time it separately.
    [[nodiscard]] virtual double solver_seconds() const { return -1; }
    /// Where the bodies are, in the order of the rig.
    virtual void read(std::span<RigPose> poses) const = 0;
};

/// motley with these settings; gravity is the rig's.
std::unique_ptr<Engine> make_motley_engine(const Rig& rig, SolverSettings settings,
                                           const SolverOptions& options);

/// Adds a rig to a scene: a body each, in order, and the joints. Returns the bodies.
std::vector<BodyId> add_rig(Scene& scene, const Rig& rig);
/// Adds its joints alone, between bodies that lie to each other as those of the rig do.
void tie_rig(Scene& scene, const Rig& rig, std::span<const BodyId> bodies);

/// One setting of a peer.
struct PeerSetting {
    std::string label;
    int iterations = 10;
    float erp = 0.2F;        ///< share of the error removed a step
    int substeps = 1;        ///< steps of dt / substeps
    bool is_direct = false;  ///< the peer's own direct solver
};

/// Another engine, as its users would set it.
struct Peer {
    std::string name;  ///< with its version
    std::vector<PeerSetting> settings;
    std::unique_ptr<Engine> (*make)(const Rig& rig, const PeerSetting& setting);
};

/// The peers that were found when the program was built.
std::vector<Peer> peers();
/// The peers that were not found, each with the package that provides it.
std::vector<std::string> missing_peers();

}  // namespace motley::bench
