// libFuzzer on the public API: see hostile_host.h.
#include "hostile_host.h"

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer looks for
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    motley::testing::HostileHost({bytes, size}).play();
    return 0;
}
