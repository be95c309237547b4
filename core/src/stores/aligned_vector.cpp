// Memory of many pages. See also whole_file.cpp: nothing else in core calls the operating system by name.
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
