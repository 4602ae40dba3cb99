#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry/mesh.h"

namespace relight {

/// Ends face number `face`, whose `corners` are the last indices. Offsets are kept from the first
/// face on that is no triangle.
inline void end_face(Faces& faces, std::size_t face, std::size_t corners)
{
    if (corners != 3 && faces.offsets.empty()) {
        for (std::size_t f = 0; f <= face; ++f) {
            faces.offsets.push_back(static_cast<std::uint32_t>(3 * f));
        }
    }
    if (!faces.offsets.empty()) {
        faces.offsets.push_back(static_cast<std::uint32_t>(faces.indices.size()));
    }
}

}  // namespace relight
