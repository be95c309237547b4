// Some thousand hosts of tests/fuzz with bytes from a seeded generator: what the fuzzer does, in every build and in
// bounded time.
#include "fuzz/hostile_host.h"

#include <gtest/gtest.h>

#include "mixed_scene.h"

namespace motley {
namespace {

TEST(HostileHosts, AreRefusedOrServedAndNothingElseHappens)
{
    testing::Random random(4711);
    for (int host = 0; host < 3000; ++host) {
        std::vector<std::uint8_t> bytes(400);
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(127.99 * (1 + random.symmetric()));
        ASSERT_NO_THROW(testing::HostileHost(bytes).play()) << "host " << host;
    }
}

}  // namespace
}  // namespace motley
