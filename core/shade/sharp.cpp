#include "core/shade/sharp.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string_view>

namespace relight {

std::vector<std::uint32_t> sharp_vertices(const Mesh& mesh, const Surface& surface,
                                          std::span<const Rgbf> irradiance, unsigned threads,
                                          Progress& progress)
{
    constexpr float lit_at_all = 1e-3F;  // of the brightest
    constexpr std::size_t block = 1 << 14;
    std::vector<float> E(irradiance.size());
    std::vector<float> brightest_of(E.size() / block + 1);  // each block
    parallel_for(E.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        float brightest = 0.0F;
        for (std::size_t v = begin; v < end; ++v) {
            E[v] = static_cast<float>(luminance(to_double(irradiance[v])));
            brightest = std::max(brightest, E[v]);
        }
        brightest_of[begin / block] = brightest;
    });
    const float brightest = *std::max_element(brightest_of.begin(), brightest_of.end());
    const auto is_sharp = [&](std::uint32_t a, std::uint32_t b) {
        const float larger = std::max(E[a], E[b]);
        const float apart = std::abs(E[a] - E[b]);
        if (!(apart > 0.5F * larger) || !(larger > lit_at_all * brightest)) { return false; }
        // Of a vertex without a normal, which is dark, the difference is 1: never sharp.
        const double turned = length(Vec3(surface.normals[a]) - surface.normals[b]);
        return static_cast<double>(apart) >
               0.5 * static_cast<double>(larger) + 2.0 * static_cast<double>(brightest) * turned;
    };
    std::vector<std::uint8_t> sharp(irradiance.size());
    const auto mark = [&](std::uint32_t v) {
        std::atomic_ref(sharp[v]).store(1, std::memory_order_relaxed);
    };
    const Faces& faces = mesh.faces;
    // An edge that is sharp falls to less than half of the face's brightest corner.
    const std::uint32_t* const corners = faces.indices.data();
    const bool triangles = faces.offsets.empty();
    const auto falls_by_half = [&](std::size_t f) {
        if (!triangles) { return true; }
        const float a = E[corners[3 * f]], b = E[corners[3 * f + 1]], c = E[corners[3 * f + 2]];
        return std::min(a, std::min(b, c)) < 0.5F * std::max(a, std::max(b, c));
    };
    parallel_for(faces.count(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            if (!falls_by_half(f)) { continue; }
            for (std::size_t c = faces.begin(f), before = faces.end(f) - 1; c < faces.end(f);
                 before = c++) {
                const std::uint32_t a = faces.indices[before], b = faces.indices[c];
                if (!is_sharp(a, b)) { continue; }
                mark(a);
                mark(b);
            }
        }
    });
    std::vector<std::uint32_t> vertices;
    const std::string_view marks(reinterpret_cast<const char*>(sharp.data()), sharp.size());
    for (auto v = marks.find('\1'); v != std::string_view::npos; v = marks.find('\1', v + 1)) {
        vertices.push_back(static_cast<std::uint32_t>(v));  // few, and found by memchr
    }
    return vertices;
}

}  // namespace relight
