#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/trace/bvh.h"
#include "tests/shapes.h"

namespace relight::test {

constexpr double far = std::numeric_limits<double>::infinity();
inline const Dir3 up = normalize({0, 0, 1});

/// A mesh with its acceleration structure.
struct Model {
    Mesh mesh;
    Surface surface;
    Bvh bvh;

    explicit Model(Mesh m) : mesh(std::move(m)), surface(prepared(mesh)), bvh(mesh, surface) {}
    static Surface prepared(const Mesh& mesh)
    {
        Progress progress;
        return prepare(mesh, 1, progress);
    }

    bool blocked(const ShadowRay& ray) const
    {
        std::uint8_t answer = 2;
        bvh.occluded({&ray, 1}, {&answer, 1});
        return answer == 1;
    }

    std::vector<Hit> nearest(const std::vector<ShadowRay>& rays) const
    {
        std::vector<Hit> hits(rays.size());
        bvh.nearest(rays, hits);
        return hits;
    }

    /// The receiver at vertex v as transport makes it.
    ShadowRay from_vertex(std::size_t v, Dir3 toward) const
    {
        const Clearance clear = bvh.clearance(static_cast<double>(surface.spacing[v]));
        return {mesh.positions[v] + Vec3(surface.normals[v]) * clear.offset, toward, clear.from,
                far};
    }
};

/// The same numbers on every machine.
class Numbers {
  public:
    double in(double lo, double hi)
    {
        return lo + (hi - lo) * 0x1p-32 * static_cast<double>(bits_());
    }
    Dir3 direction()
    {
        while (true) {
            const Vec3 v{in(-1, 1), in(-1, 1), in(-1, 1)};
            if (dot(v, v) <= 1.0 && dot(v, v) > 1e-4) { return normalize(v); }
        }
    }

  private:
    std::mt19937 bits_{7};
};

}  // namespace relight::test
