// The one call to the operating system in core.
#include "stores/aligned_vector.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace motley {

void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes)
{
#if defined(__linux__)
    madvise(memory, bytes, MADV_HUGEPAGE);
#endif
}

}  // namespace motley
