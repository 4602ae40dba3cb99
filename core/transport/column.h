#pragma once

#include <span>

#include "core/transport/gather.h"
#include "core/transport/transport.h"

namespace relight {

/// E, visibility, bounces and their error of one light at the vertices [begin, end).
Column direct_and_bounced(const Source& source, std::size_t begin, std::size_t end);

/// Some vertex may send light toward the viewer that its E does not tell.
bool needs_radiance(const Source& source);

/// Draws that radiance, Column::Lo, of the same vertices. `materials`: vertex_materials().
void add_radiance(const Source& source, std::span<const std::uint32_t> materials, std::size_t begin,
                  std::size_t end, Column& column);

/// Cosine-weighted visibility of the sky at the vertices [begin, end), and with `sh` what it lets
/// in of each of the nine real spherical harmonics up to degree 2: int V cos Y_lm dw (Ramamoorthi &
/// Hanrahan 2001 for the open case). E of a sky with coefficients L_lm is sum T_lm L_lm.
/// World axes; order (0,0) (1,-1) (1,0) (1,1) (2,-2) .. (2,2); Y_1-1 ~ y, Y_10 ~ z, Y_11 ~ x.
struct SkyVisibility {
    std::vector<float> ambient_occlusion;  ///< one a vertex
    std::vector<float> sh;                 ///< nine a vertex, or empty
    std::uint64_t rays = 0;
};
SkyVisibility sky_visibility(const Stage& stage, const Scene& scene, bool sh, std::size_t begin,
                             std::size_t end);

}  // namespace relight
