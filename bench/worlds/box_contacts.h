// Contacts of boxes that stand on each other or on a floor: corners of one box in a face of the other. This is enough
// for stacks, whose boxes turn little; general collision detection is the host's part.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "motley/motley.h"
#include "worlds/rig.h"

namespace motley::bench {

class BoxContacts {
  public:
    /// Later steps test only pairs of boxes that are near each other when the rig starts.
    BoxContacts(const Rig& rig, std::vector<BodyId> bodies);
    /// The contacts of boxes in these poses. `ground` is the floor at y = 0.
    std::span<const Contact> find(std::span<const RigPose> poses, BodyId ground);

  private:
    /// A box in the world.
    struct Placed {
        Vec3<double> centre;
        Vec3<double> axes[3];
        Vec3<double> corners[8];
    };
    const Rig& rig_;
    std::vector<BodyId> bodies_;
    std::vector<std::pair<int, int>> pairs_;
    std::vector<Placed> placed_;
    std::vector<Contact> contacts_;

    void add(BodyId a, BodyId b, Vec3<double> centre_a, Vec3<double> centre_b, Vec3<double> point,
             Vec3<float> normal, double separation, std::uint64_t key);
    void corners_in_face(int box, int other, std::uint64_t key);
};

}  // namespace motley::bench
