#pragma once

#include <span>

#include "core/transport/gather.h"
#include "core/transport/transport.h"

namespace relight {

/// Some vertices in some order, of which a block of a column is made.
struct Vertices {
    std::span<const std::uint32_t> ids;  ///< in the file
    const VertexFields* fields;          ///< what they are: from `first` on, in the same order
    std::size_t first = 0;

    std::size_t size() const { return ids.size(); }
    std::size_t operator[](std::size_t i) const { return ids[i]; }
};

/// What must be sampled: E, visibility, bounces and their error of one light; of a delta light the
/// bounces alone.
Column direct_and_bounced(const Source& source, Vertices vertices);

/// E of a delta light: one ray a vertex that faces it; -0 where it is not seen. That of vertex v
/// goes to E[v - first_id]. Returns rays traced.
std::uint64_t fill_delta(const Source& source, Vertices vertices, std::size_t first_id,
                         std::span<float> E);

/// Some vertex may send light toward the viewer that its E does not tell.
bool needs_radiance(const Source& source);

/// Draws that radiance, Column::Lo. `materials`: vertex_materials().
Column radiance_drawn(const Source& source, std::span<const std::uint32_t> materials,
                      Vertices vertices);

/// Cosine-weighted visibility of the sky, and with `sh` what it lets in of each of the nine real
/// spherical harmonics up to degree 2: int V cos Y_lm dw (Ramamoorthi & Hanrahan 2001 for the open
/// case). E of a sky with coefficients L_lm is sum T_lm L_lm.
/// World axes; order (0,0) (1,-1) (1,0) (1,1) (2,-2) .. (2,2); Y_1-1 ~ y, Y_10 ~ z, Y_11 ~ x.
Column sky_visibility(const Stage& stage, const Scene& scene, bool sh, Vertices vertices);

}  // namespace relight
