#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/io/photometry_checks.h"
#include "tests/io/reader_checks.h"

/// libFuzzer's entry for one reader, which the build names: whatever the bytes, it answers with a
/// mesh, picture or profile that keeps every promise of its header, or with an error that says
/// where.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size);  // its name, not ours

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const std::string broken = relight::test::broken_promise(relight::RELIGHT_READER, text);
    if (!broken.empty()) {
        std::fprintf(stderr, "broken promise: %s\n", broken.c_str());
        std::abort();
    }
    return 0;
}
