// Every type of constraint has a net, and so a benchmark of its kernels.
#include "worlds/tie_net.h"

#include <gtest/gtest.h>

#include <array>

#include "scene/scene_core.h"
#include "stores/joint_store.h"

namespace motley::bench {
namespace {

TEST(TieNets, EveryTypeOfJointIsInOne)
{
    std::array<bool, JointTypes::size> is_in_one{};
    for (const NamedTie& named : every_tie()) {
        const auto net = make_net(named.tie, named.model, 2, BodyOrder::in_line);
        core_of(net->scene).joints->for_each([&](const auto& store, int type) {
            if (store.size() > 0) is_in_one[static_cast<std::size_t>(type)] = true;
        });
    }
    for (std::size_t type = 0; type < is_in_one.size(); ++type) {
        EXPECT_TRUE(is_in_one[type]) << "joint " << type
                                     << " of JointTypes (constraint_types.h) is in no net of "
                                     << "every_tie(): add a line to bench/worlds/tie_net.cpp";
    }
}

}  // namespace
}  // namespace motley::bench
