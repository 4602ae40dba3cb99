#include "core/shade/sharp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/shade/shade.h"
#include "tests/scenes.h"

namespace relight {
namespace {

std::vector<std::uint32_t> sharp_of(const Mesh& mesh, const Surface& surface,
                                    std::span<const Rgbf> irradiance)
{
    Progress progress;
    return sharp_vertices(mesh, surface, irradiance, 2, progress);
}

struct Lit {
    Stage stage;
    UnsetVector<Rgbf> irradiance;
    std::vector<std::uint32_t> sharp;

    Lit(Mesh mesh, LightShape shape) : stage(test::staged(std::move(mesh)))
    {
        Scene scene;
        scene.lights = {test::light_of(std::move(shape), Rgb::grey(100.0))};
        Progress progress;
        irradiance =
            shade(stage, trace(stage, scene, {}, progress), scene, {}, progress).irradiance;
        sharp = sharp_of(*stage.mesh, *stage.surface, irradiance);
    }
};

/// A square n x n floor over [-1, 1]^2 and, above it, a roof over x < 0.12.
Mesh roofed_floor(int n)
{
    Mesh roof = test::mesh_of({{-2, -2, 0.5}, {0.12, -2, 0.5}, {0.12, 2, 0.5}, {-2, 2, 0.5}},
                              {0, 1, 2, 0, 2, 3});
    return test::joined(test::grid(n), roof);
}

constexpr std::size_t floor_vertices(std::size_t n)
{
    return (n + 1) * (n + 1);
}

TEST(SharpVertices, PolygonsHaveThoseOfTheirEdges)
{
    // The same floor in squares: a diagonal is no edge, but what it joins has a neighbour beside
    // it.
    const Stage stage = test::staged(test::grid(40));
    Mesh squares = *stage.mesh;
    std::vector<std::uint32_t> corners;
    squares.faces.offsets = {0};
    for (std::uint32_t y = 0; y < 40; ++y) {
        for (std::uint32_t x = 0; x < 40; ++x) {
            const std::uint32_t first = y * 41 + x;
            corners.insert(corners.end(), {first, first + 1, first + 42, first + 41});
            squares.faces.offsets.push_back(static_cast<std::uint32_t>(corners.size()));
        }
    }
    squares.faces.indices = corners;
    std::vector<Rgbf> lit;  // a step along x
    for (const Point3 p : squares.positions) { lit.push_back(p.x < 0.11 ? Rgbf{} : Rgbf{1, 1, 1}); }
    const auto sharp = sharp_of(squares, *stage.surface, lit);
    EXPECT_EQ(sharp.size(), 82U);  // two columns of vertices
    EXPECT_EQ(sharp, sharp_of(*stage.mesh, *stage.surface, lit));
}

TEST(SharpVertices, AFloorUnderAPointLightHasNone)
{
    for (const int n : {8, 50}) {  // edges up to 0.35 for a light of height 1
        EXPECT_TRUE(Lit(test::grid(n), PointLight{{0.3, -0.2, 1.0}, {}}).sharp.empty()) << n;
    }
}

TEST(SharpVertices, TheEdgeOfDaylightOnAConvexBodyIsNone)
{
    // From day to night over a sphere E falls to nothing, but so do the cosines say.
    for (const int levels : {2, 3, 4, 5}) {
        const Vec3 directions[] = {{1, 0, 0}, {1, 2, 3}, {-1, 1, 0.1}};
        for (const Vec3 toward : directions) {
            EXPECT_TRUE(
                Lit(test::icosphere(levels), DirectionalLight{-normalize(toward)}).sharp.empty())
                << levels;
        }
    }
    // Nor on gentle hills that no vertex of which faces a low sun.
    Mesh hills = test::grid(60);
    for (Point3& p : hills.positions) { p.z = 0.1 * std::sin(3.0 * p.x) * std::cos(2.0 * p.y); }
    for (const double elevation : {0.25, 0.2, 0.15}) {
        const Vec3 sun{std::cos(elevation), 0, std::sin(elevation)};
        const Stage stage = test::staged(hills);
        std::vector<Rgbf> irradiance;  // without cast shadows, whose edges are sharp rightly
        for (const Dir3& n : stage.surface->normals) {
            irradiance.push_back(to_float(Rgb::grey(std::max(0.0, dot(n, sun)))));
        }
        EXPECT_TRUE(sharp_of(hills, *stage.surface, irradiance).empty()) << elevation;
    }
}

TEST(SharpVertices, AShadowsEdgeHasThemAtItsTwoSidesAlone)
{
    constexpr std::size_t n = 40;
    const Lit lit(roofed_floor(n), DirectionalLight{normalize({0, 0, -1})});
    std::vector<std::uint32_t> expected;  // the columns at 0.1 and 0.15
    for (std::uint32_t v = 0; v < floor_vertices(n); ++v) {
        if (std::abs(lit.stage.mesh->positions[v].x - 0.125) < 0.03) { expected.push_back(v); }
    }
    EXPECT_EQ(expected.size(), 2 * (n + 1));
    EXPECT_EQ(lit.sharp, expected);
}

TEST(SharpVertices, AShadowsEdgeAcrossARoundBodyHasThemToo)
{
    const Mesh mesh = test::icosphere(5);
    const Stage stage = test::staged(mesh);
    std::vector<Rgbf> irradiance;  // from above, shaded beyond x = 0.011
    for (const Point3& p : mesh.positions) {
        irradiance.push_back(to_float(Rgb::grey(p.x > 0.011 ? 0.0 : std::max(0.0, p.z))));
    }
    const std::vector<std::uint32_t> sharp = sharp_of(mesh, *stage.surface, irradiance);
    EXPECT_GT(sharp.size(), 50U);
    for (const std::uint32_t v : sharp) { EXPECT_LT(std::abs(mesh.positions[v].x), 0.06); }
}

TEST(SharpVertices, EachEdgeOfAFaceCounts)
{
    const Mesh mesh = test::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2});
    const Stage stage = test::staged(mesh);
    for (std::uint32_t k = 0; k < 3; ++k) {  // from 1 to 0.35 is too far; over 0.6 it is not
        std::vector<Rgbf> irradiance(3, Rgbf{0.6F, 0.6F, 0.6F});
        const std::uint32_t bright = k, dim = (k + 1) % 3;
        irradiance[bright] = {1, 1, 1};
        irradiance[dim] = {0.35F, 0.35F, 0.35F};
        const auto [first, second] = std::minmax(bright, dim);
        EXPECT_EQ(sharp_of(mesh, *stage.surface, irradiance),
                  (std::vector<std::uint32_t>{first, second}));
    }
}

TEST(SharpVertices, AShadowOnASingleVertexNamesItAndItsNeighbours)
{
    Mesh mesh = test::grid(10);
    const Point3 middle{0.2, 0.2, 0};
    mesh = test::joined(
        std::move(mesh),
        test::mesh_of({{0.15, 0.15, 0.3}, {0.3, 0.15, 0.3}, {0.15, 0.3, 0.3}}, {0, 1, 2}));
    const Lit lit(std::move(mesh), DirectionalLight{normalize({0, 0, -1})});
    std::vector<std::uint32_t> of_floor;
    for (const std::uint32_t v : lit.sharp) {
        if (v < floor_vertices(10)) { of_floor.push_back(v); }
    }
    ASSERT_EQ(of_floor.size(), 7U);  // six neighbours in a grid of triangles
    for (const std::uint32_t v : of_floor) {
        EXPECT_LT(length(lit.stage.mesh->positions[v] - middle), 0.29);
    }
    EXPECT_TRUE(std::is_sorted(lit.sharp.begin(), lit.sharp.end()));
}

TEST(SharpVertices, TheirShareFallsAsTheMeshIsRefined)
{
    double before = 1.0;
    for (const std::size_t n : {10U, 20U, 40U, 80U}) {
        const Lit lit(roofed_floor(static_cast<int>(n)), PointLight{{0.3, -0.2, 1.5}, {}});
        const auto floor = std::count_if(lit.sharp.begin(), lit.sharp.end(),
                                         [&](std::uint32_t v) { return v < floor_vertices(n); });
        const double share = static_cast<double>(floor) / static_cast<double>(floor_vertices(n));
        EXPECT_GT(share, 0.0);
        EXPECT_LT(share, 0.65 * before) << n;  // a line's vertices among a square's: 1/2
        before = share;
    }
}

TEST(SharpVertices, DarkMeshesAndCloudsAndUnlitVerticesHaveNone)
{
    const Mesh mesh = test::grid(4);
    const Stage stage = test::staged(mesh);
    const std::vector<Rgbf> dark(mesh.positions.size());
    EXPECT_TRUE(sharp_of(mesh, *stage.surface, dark).empty());
    std::vector<Rgbf> spot = dark;
    spot[12] = {1, 1, 1};
    EXPECT_EQ(sharp_of(mesh, *stage.surface, spot).size(), 7U);
    spot[0] = {2000, 2000, 2000};  // beside which a corner far from it is dark
    EXPECT_EQ(sharp_of(mesh, *stage.surface, spot), (std::vector<std::uint32_t>{0, 1, 5, 6}));
    spot[0] = {};
    Surface unlit = *stage.surface;
    unlit.normals[12] = {};
    EXPECT_TRUE(sharp_of(mesh, unlit, spot).empty());
    Mesh cloud = mesh;
    cloud.faces = {};
    EXPECT_TRUE(sharp_of(cloud, *stage.surface, spot).empty());
}

}  // namespace
}  // namespace relight
