#include "core/shade/sharp.h"

#include <algorithm>
#include <cmath>

namespace relight {

std::vector<std::uint32_t> sharp_vertices(const Mesh& mesh, const Surface& surface,
                                          std::span<const Rgbf> irradiance)
{
    constexpr double lit_at_all = 1e-3;  // of the brightest
    std::vector<double> E;
    E.reserve(irradiance.size());
    for (const Rgbf& bands : irradiance) { E.push_back(luminance(to_double(bands))); }
    const double brightest = E.empty() ? 0.0 : *std::max_element(E.begin(), E.end());
    const auto is_sharp = [&](std::uint32_t a, std::uint32_t b) {
        // Of a vertex without a normal, which is dark, the difference is 1: never sharp.
        const double turned = length(Vec3(surface.normals[a]) - surface.normals[b]);
        const double larger = std::max(E[a], E[b]);
        return larger > lit_at_all * brightest &&
               std::abs(E[a] - E[b]) > 0.5 * larger + 2.0 * brightest * turned;
    };
    std::vector<std::uint32_t> vertices;
    const Faces& faces = mesh.faces;
    for (std::size_t f = 0; f < faces.count(); ++f) {
        for (std::size_t c = faces.begin(f), before = faces.end(f) - 1; c < faces.end(f);
             before = c++) {
            const std::uint32_t a = faces.indices[before], b = faces.indices[c];
            if (is_sharp(a, b)) { vertices.insert(vertices.end(), {a, b}); }
        }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

}  // namespace relight
