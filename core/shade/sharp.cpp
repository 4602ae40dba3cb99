#include "core/shade/sharp.h"

namespace relight {

std::vector<std::uint32_t> sharp_vertices(const Mesh& /*mesh*/, const Surface& /*surface*/,
                                          std::span<const Rgbf> /*irradiance*/)
{
    return {};
}

}  // namespace relight
