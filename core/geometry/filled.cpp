#include "core/geometry/filled.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <memory>

namespace relight {

void ask_for_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes)
{
#if defined(__linux__)
    constexpr std::size_t huge = std::size_t{1} << 21;
    if (std::align(huge, huge, memory, bytes) != nullptr) {
        madvise(memory, bytes / huge * huge, MADV_HUGEPAGE);
    }
#endif
}

}  // namespace relight
