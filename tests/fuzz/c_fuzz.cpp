// libFuzzer on the C interface: see hostile_c_host.h.
#include "hostile_c_host.h"

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer looks for
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    motley::testing::HostileCHost({bytes, size}).play();
    return 0;
}
