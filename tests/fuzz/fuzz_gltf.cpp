// The glTF reader on any bytes: an asset that keeps its promises, or a refusal that can be printed.
// In the service it runs shut in; what is tried here is that it need not be. Draco is left out:
// that library allocates what its streams claim, which the sandbox answers and the fuzzer cannot.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "server/import/gltf.h"
#include "server/import/promises.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size);  // its name, not ours

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    constexpr relight::GltfLimits limits{100'000, 100'000, 1U << 16U};
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (text.find("_draco_") != std::string_view::npos) { return -1; }
    const auto asset = relight::decode_gltf(std::as_bytes(std::span(data, size)), limits);
    bool good = false;
    if (asset) {
        good = relight::keeps_promises(*asset);
    } else {
        const std::string& detail = asset.error().detail;
        good = !detail.empty() && std::all_of(detail.begin(), detail.end(),
                                              [](char c) { return c >= ' ' && c <= '~'; });
    }
    if (!good) {
        std::fputs("broken promise\n", stderr);
        std::abort();
    }
    return 0;
}
