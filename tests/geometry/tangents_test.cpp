#include <gtest/gtest.h>

#include "core/geometry/surface.h"
#include "tests/shapes.h"

namespace relight {
namespace {

Surface prepared(const Mesh& mesh)
{
    Progress progress;
    return prepare(mesh, 1, progress);
}

Vec3 tangent(const Surface& surface, std::size_t v)
{
    const auto& t = surface.tangents[v];
    return {static_cast<double>(t[0]), static_cast<double>(t[1]), static_cast<double>(t[2])};
}

/// uv = (u_x x + u_y y, v_x x + v_y y) over a mesh in the plane.
Mesh mapped(Mesh mesh, Vec3 u, Vec3 v)
{
    for (const Point3 p : mesh.positions) {
        mesh.uvs.push_back(
            {static_cast<float>(dot(p - Point3{}, u)), static_cast<float>(dot(p - Point3{}, v))});
    }
    return mesh;
}

void expect_right_handed(const Frame& f)
{
    EXPECT_NEAR(dot(f.x, f.x), 1.0, 1e-14);
    EXPECT_NEAR(dot(f.x, f.n), 0.0, 1e-14);
    EXPECT_NEAR(length(cross(f.x, f.y) - f.n), 0.0, 1e-14);
}

TEST(Tangents, RunAlongGrowingUWhateverVDoes)
{
    struct Case {
        Vec3 u, v, tangent;
    };
    const double h = std::sqrt(0.5);
    for (const Case& c :
         {Case{{1, 0, 0}, {0, 1, 0}, {1, 0, 0}},
          Case{{-1, 0, 0}, {0, 1, 0}, {-1, 0, 0}},  // mirrored
          Case{{1, 0, 0}, {0, -9, 0}, {1, 0, 0}}, Case{{0, 3, 0}, {1, 0, 0}, {0, 1, 0}},
          // dP/du holds v: along (1, -1) where v = x + y.
          Case{{1, 0, 0}, {1, 1, 0}, {h, -h, 0}}}) {
        const Surface surface = prepared(mapped(test::grid(4), c.u, c.v));
        ASSERT_EQ(surface.tangents.size(), 25U);
        for (std::size_t v = 0; v < 25; ++v) {
            EXPECT_NEAR(length(tangent(surface, v) - c.tangent), 0.0, 1e-6);
            const Frame frame = shading_frame(surface, v);
            EXPECT_NEAR(length(Vec3(frame.x) - c.tangent), 0.0, 1e-6);
            expect_right_handed(frame);
        }
    }
}

TEST(Tangents, OfAUvSphereFollowItsParallels)
{
    const int rings = 40, sectors = 80;
    Mesh sphere = test::latlong_sphere(rings, sectors);
    // Longitude jumps at the seam, so it is filed for each corner; a pole's is its triangle's
    // middle.
    for (std::size_t f = 0; f < sphere.faces.indices.size(); f += 3) {
        Vec3 middle;
        for (std::size_t k = 0; k < 3; ++k) {
            const Point3 p = sphere.positions[sphere.faces.indices[f + k]];
            if (std::abs(p.z) < 0.999999) { middle += Vec3{p.x, p.y, 0.0}; }
        }
        const double phi0 = std::atan2(middle.y, middle.x);
        for (std::size_t k = 0; k < 3; ++k) {
            const Point3 p = sphere.positions[sphere.faces.indices[f + k]];
            const double turn = std::atan2(p.y * std::cos(phi0) - p.x * std::sin(phi0),
                                           p.x * std::cos(phi0) + p.y * std::sin(phi0));
            const bool pole = std::abs(p.z) > 0.999999;
            sphere.corner_uvs.push_back(
                {static_cast<float>(phi0 + (pole ? 0.0 : turn)), static_cast<float>(p.z)});
        }
    }
    const Surface surface = prepared(sphere);
    for (std::size_t v = 1; v + 1 < sphere.positions.size(); ++v) {
        const Point3 p = sphere.positions[v];
        const Vec3 t = tangent(surface, v);
        EXPECT_GT(dot(t, normalize({-p.y, p.x, 0.0})), 0.99);
        EXPECT_NEAR(dot(t, surface.normals[v]), 0.0, 1e-6);
        EXPECT_NEAR(length(t), 1.0, 1e-6);
        expect_right_handed(shading_frame(surface, v));
    }
}

TEST(Tangents, CornersOfPolygonsAreFoundAgainInTheirTriangles)
{
    Mesh arrow = test::mesh_of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}, {-3, 0, 0}},
                               {5, 0, 4, 0, 1, 2, 3, 4});
    arrow.faces.offsets = {0, 3, 8};
    for (const std::uint32_t i : arrow.faces.indices) {  // u = y, v = -x
        const Point3 p = arrow.positions[i];
        arrow.corner_uvs.push_back({static_cast<float>(p.y), static_cast<float>(-p.x)});
    }
    const Surface surface = prepared(arrow);
    for (std::size_t v = 0; v < 6; ++v) {
        EXPECT_NEAR(length(tangent(surface, v) - Vec3{0, 1, 0}), 0.0, 1e-6);
    }
}

TEST(Tangents, WhereTheCoordinatesSpanNothingTheFrameIsTheNormalsOwn)
{
    const Frame tilt = frame_around(normalize({0.3, -0.5, 0.7}));
    const Mesh flat = test::grid(7);  // coordinates that round
    for (const Mesh& mesh : {mapped(flat, {}, {}), mapped(flat, {0.1, 0.3, 0}, {0.3, 0.9, 0}),
                             mapped(flat, {1, 0, 0}, {}), flat}) {
        const Surface surface = prepared(test::moved(mesh, tilt, 1.0, {}));
        for (std::size_t v = 0; v < surface.normals.size(); ++v) {
            const Frame frame = shading_frame(surface, v);
            EXPECT_EQ(frame.x, frame_around(surface.normals[v]).x);
            expect_right_handed(frame);
        }
    }
}

TEST(Tangents, MirroredHalvesAgreeBesideTheirSeamAndCancelOnIt)
{
    Mesh mesh = test::grid(2);  // u = |x|
    for (const Point3 p : mesh.positions) {
        mesh.uvs.push_back({static_cast<float>(std::abs(p.x)), static_cast<float>(p.y)});
    }
    const Surface surface = prepared(mesh);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const double x = mesh.positions[v].x;
        EXPECT_TRUE(is_finite(tangent(surface, v)));
        if (x != 0.0) { EXPECT_NEAR(length(tangent(surface, v) - Vec3{x, 0, 0}), 0.0, 1e-6); }
        expect_right_handed(shading_frame(surface, v));
    }
    EXPECT_EQ(tangent(surface, 4), Vec3{});  // as much area to either side
}

TEST(Tangents, ACloudAndAMeshWithoutCoordinatesHaveNone)
{
    EXPECT_TRUE(prepared(test::grid(2)).tangents.empty());
    Mesh cloud = mapped(test::grid(4), {1, 0, 0}, {0, 1, 0});
    cloud.faces = {};
    EXPECT_TRUE(prepared(cloud).tangents.empty());
}

}  // namespace
}  // namespace relight
