#include "core/shade/sharp.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <string_view>

#include "core/base/unset.h"
#include "core/base/vectors.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {
namespace {

/// take(i) where marks[i] is 1, which is rare: found by memchr.
template <class Marks, class Take>
void for_marked(const Marks& marks, const Take& take)
{
    const std::string_view all(reinterpret_cast<const char*>(marks.data()), marks.size());
    for (auto i = all.find('\1'); i != std::string_view::npos; i = all.find('\1', i + 1)) {
        take(i);
    }
}

}  // namespace

std::vector<std::uint32_t> sharp_vertices(const Mesh& mesh, const Surface& surface,
                                          std::span<const Rgbf> irradiance, unsigned threads,
                                          Progress& progress)
{
    constexpr float lit_at_all = 1e-3F;  // of the brightest
    constexpr std::size_t block = 1 << 14;
    UnsetVector<float> E(irradiance.size());
    std::vector<std::uint32_t> brightest_of(E.size() / block + 1);  // each block; as bits, whose
                                                                    // order is that of the numbers
    parallel_for(E.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        std::uint32_t brightest = 0;
        in_vectors([&] {
            for (std::size_t v = begin; v < end; ++v) {
                E[v] = static_cast<float>(luminance(to_double(irradiance[v])));
                brightest = std::max(brightest, std::bit_cast<std::uint32_t>(E[v]));
            }
        });
        brightest_of[begin / block] = brightest;
    });
    const auto brightest =
        std::bit_cast<float>(*std::max_element(brightest_of.begin(), brightest_of.end()));
    const auto is_sharp = [&](std::uint32_t a, std::uint32_t b) {
        const float larger = std::max(E[a], E[b]);
        const float apart = std::abs(E[a] - E[b]);
        if (!(apart > 0.5F * larger) || !(larger > lit_at_all * brightest)) { return false; }
        // Of a vertex without a normal, which is dark, the difference is 1: never sharp.
        const Vec3 turn = Vec3(surface.normals[a]) - surface.normals[b];
        const double most = (static_cast<double>(apart) - 0.5 * static_cast<double>(larger)) /
                            (2.0 * static_cast<double>(brightest));
        return dot(turn, turn) < most * most;
    };
    std::vector<std::uint8_t> sharp(irradiance.size());
    const auto mark = [&](std::uint32_t v) {
        std::atomic_ref(sharp[v]).store(1, std::memory_order_relaxed);
    };
    const Faces& faces = mesh.faces;
    // An edge that is sharp falls to less than half of the face's brightest corner.
    const std::uint32_t* const corners = faces.indices.data();
    const bool triangles = faces.offsets.empty();
    const float* const of = E.data();
    const auto falls_by_half = [=](std::size_t f) {
        const float a = of[corners[3 * f]], b = of[corners[3 * f + 1]], c = of[corners[3 * f + 2]];
        return std::min(a, std::min(b, c)) < 0.5F * std::max(a, std::max(b, c));
    };
    const auto look_at = [&](std::size_t f) {
        for (std::size_t c = faces.begin(f), before = faces.end(f) - 1; c < faces.end(f);
             before = c++) {
            const std::uint32_t a = faces.indices[before], b = faces.indices[c];
            if (!is_sharp(a, b)) { continue; }
            mark(a);
            mark(b);
        }
    };
    parallel_for(faces.count(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        if (!triangles) {
            for (std::size_t f = begin; f < end; ++f) { look_at(f); }
            return;
        }
        UnsetVector<char> falls(end - begin);
        in_vectors([&] {
            char* const to = falls.data();
            for (std::size_t f = begin; f < end; ++f) { to[f - begin] = falls_by_half(f) ? 1 : 0; }
        });
        for_marked(falls, [&](std::size_t i) { look_at(begin + i); });
    });
    std::vector<std::uint32_t> vertices;
    for_marked(sharp, [&](std::size_t v) { vertices.push_back(static_cast<std::uint32_t>(v)); });
    return vertices;
}

}  // namespace relight
