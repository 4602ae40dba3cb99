#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "core/geometry/mesh.h"

namespace relight::test {

/// A Mesh of these places and triangles, doubles kept.
inline Mesh mesh_of(std::vector<Point3> positions, std::vector<std::uint32_t> corners)
{
    Mesh mesh;
    mesh.format = "test";
    mesh.positions = std::move(positions);
    mesh.faces.indices = std::move(corners);
    mesh.double_positions = true;
    return mesh;
}

/// A regular icosahedron split `levels` times onto the unit sphere: convex, closed, outward.
inline Mesh icosphere(int levels)
{
    const double g = std::numbers::phi;
    std::vector<Point3> p{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                          {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                          {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::uint32_t> f{0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                 4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                 6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
    const auto onto_sphere = [](Point3 q) { return Point3{} + Vec3(normalize(q - Point3{})); };
    for (Point3& q : p) { q = onto_sphere(q); }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), p.size());
            if (is_new) { p.push_back(onto_sphere(p[a] + (p[b] - p[a]) * 0.5)); }
            return at->second;
        };
        std::vector<std::uint32_t> finer;
        for (std::size_t t = 0; t < f.size(); t += 3) {
            const std::uint32_t a = f[t], b = f[t + 1], c = f[t + 2];
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        f = std::move(finer);
    }
    return mesh_of(std::move(p), std::move(f));
}

/// A sphere of latitude and longitude, with slivers at its poles.
inline Mesh latlong_sphere(int rings, int sectors)
{
    std::vector<Point3> p{{0, 0, 1}};
    for (int i = 1; i < rings; ++i) {
        for (int j = 0; j < sectors; ++j) {
            const double theta = std::numbers::pi * i / rings;
            const double phi = 2.0 * std::numbers::pi * j / sectors;
            p.push_back({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                         std::cos(theta)});
        }
    }
    p.push_back({0, 0, -1});
    std::vector<std::uint32_t> f;
    const auto at = [&](int i, int j) {
        return static_cast<std::uint32_t>(1 + (i - 1) * sectors + j % sectors);
    };
    const auto last = static_cast<std::uint32_t>(p.size() - 1);
    for (int j = 0; j < sectors; ++j) {
        f.insert(f.end(), {0, at(1, j), at(1, j + 1)});
        f.insert(f.end(), {last, at(rings - 1, j + 1), at(rings - 1, j)});
        for (int i = 1; i + 1 < rings; ++i) {
            f.insert(f.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            f.insert(f.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh_of(std::move(p), std::move(f));
}

/// A flat n x n grid of quads in z = 0 over [-1, 1]^2, two triangles each, facing +z.
inline Mesh grid(int n)
{
    std::vector<Point3> p;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) { p.push_back({-1.0 + 2.0 * j / n, -1.0 + 2.0 * i / n, 0.0}); }
    }
    std::vector<std::uint32_t> f;
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            f.insert(f.end(), {at(i, j), at(i, j + 1), at(i + 1, j + 1)});
            f.insert(f.end(), {at(i, j), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh_of(std::move(p), std::move(f));
}

/// An axis-aligned box of shared corners, outward.
inline Mesh box(Point3 lo, Point3 hi)
{
    return mesh_of({{lo.x, lo.y, lo.z},
                    {hi.x, lo.y, lo.z},
                    {hi.x, hi.y, lo.z},
                    {lo.x, hi.y, lo.z},
                    {lo.x, lo.y, hi.z},
                    {hi.x, lo.y, hi.z},
                    {hi.x, hi.y, hi.z},
                    {lo.x, hi.y, hi.z}},
                   {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                    1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7});
}

/// Both meshes in one.
inline Mesh joined(Mesh a, const Mesh& b)
{
    const auto shift = static_cast<std::uint32_t>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (const std::uint32_t i : b.faces.indices) { a.faces.indices.push_back(i + shift); }
    return a;
}

/// Turned, scaled, then moved; filed normals turn along.
inline Mesh moved(Mesh mesh, const Frame& turn, double scale, Vec3 shift)
{
    for (Point3& p : mesh.positions) { p = Point3{} + turn.to_world(p - Point3{}) * scale + shift; }
    for (Vec3& n : mesh.normals) { n = turn.to_world(n); }
    return mesh;
}

inline Frame upright()
{
    return {normalize({1, 0, 0}), normalize({0, 1, 0}), normalize({0, 0, 1})};
}

}  // namespace relight::test
