#include "core/geometry/surface.h"

#include <gtest/gtest.h>

#include "core/geometry/polygon.h"
#include "tests/shapes.h"

namespace relight {
namespace {

using test::mesh_of;

Surface prepared(const Mesh& mesh)
{
    Progress progress;
    return prepare(mesh, 1, progress);
}

double area_along_z(const Mesh& mesh, const Surface& surface)
{
    double area = 0.0;
    for (const Triangle& t : surface.triangles) {
        const Point3 a = mesh.positions[t[0]];
        area += 0.5 * cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a).z;
    }
    return area;
}

TEST(Surface, NormalsOfASphereAreItsRadii)
{
    const Mesh sphere = test::icosphere(4);
    const Surface surface = prepared(sphere);
    for (std::size_t v = 0; v < sphere.positions.size(); ++v) {
        EXPECT_GT(dot(surface.normals[v], sphere.positions[v] - Point3{}), 0.9999);
    }
}

TEST(Surface, ANormalDoesNotDependOnHowItsFacesAreTriangulated)  // angle weights add up over a fan
{
    const Mesh box = test::box({-1, -1, -1}, {1, 1, 1});
    const Surface surface = prepared(box);
    for (std::size_t v = 0; v < 8; ++v) {
        const Dir3 diagonal = normalize(box.positions[v] - Point3{});
        EXPECT_NEAR(dot(surface.normals[v], diagonal), 1.0, 1e-14);
    }
}

TEST(Surface, CornersWeighByTheirAngleNotByTheirArea)
{
    // At the origin a long thin corner (area 5) and a square one (area 0.5), at right angles.
    const Mesh mesh =
        mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 100, 0}, {0, 100, 0.1}}, {0, 1, 2, 0, 3, 4});
    const Dir3 n = prepared(mesh).normals[0];
    EXPECT_NEAR(n.x() / n.z(), std::atan2(0.1, 100.0) / (std::numbers::pi / 2.0), 1e-12);
}

TEST(Surface, FiledNormalsAreKeptAndOpposingOnesCounted)
{
    Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2});
    mesh.normals = {{0, 0, 2}, {0, 0, -5}, {0, 0, 0}};
    const Surface surface = prepared(mesh);
    EXPECT_EQ(surface.normals[0], normalize({0, 0, 1}));
    EXPECT_EQ(surface.normals[1], normalize({0, 0, -1}));
    EXPECT_EQ(surface.normals[2], normalize({0, 0, 1}));  // filed as zero: taken from the face
    EXPECT_EQ(surface.intake.normals_opposing, 1U);
    EXPECT_EQ(surface.intake.normals_computed, 1U);
}

TEST(Surface, AVertexThatNoFaceUsesHasNoNormalUnlessItBringsOne)
{
    Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}, {8, 8, 8}}, {0, 1, 2});
    mesh.normals = {{}, {}, {}, {0, 1, 0}, {}};
    const Surface surface = prepared(mesh);
    EXPECT_TRUE(surface.normals[3]);
    EXPECT_FALSE(surface.normals[4]);
    EXPECT_EQ(surface.intake.unreferenced_vertices, 2U);
    EXPECT_EQ(surface.intake.unlit_vertices, 1U);
}

TEST(Surface, DegenerateFacesGiveNoNormalAndAreCounted)
{
    const Surface surface =
        prepared(mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {0, 1, 2, 0, 0, 3}));
    EXPECT_EQ(surface.intake.degenerate_faces, 2U);
    EXPECT_EQ(surface.intake.unlit_vertices, 4U);
}

TEST(Surface, ConcavePolygonsKeepTheirArea)  // a fan would cover the notch
{
    Mesh arrow = mesh_of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}}, {0, 1, 2, 3, 4});
    arrow.faces.offsets = {0, 5};
    const Surface surface = prepared(arrow);
    EXPECT_EQ(surface.triangles.size(), 3U);
    EXPECT_NEAR(area_along_z(arrow, surface), 10.0, 1e-12);  // shoelace
    for (const Triangle& t : surface.triangles) {
        const Point3 a = arrow.positions[t[0]];
        EXPECT_GT(cross(arrow.positions[t[1]] - a, arrow.positions[t[2]] - a).z, 0.0);
    }
}

TEST(Surface, AShellWhoseFrontsLookInwardIsReportedAndASheetIsNot)
{
    Mesh ball = test::moved(test::icosphere(2), test::upright(), 1e-3, {1e3, 0, 0});
    EXPECT_FALSE(prepared(ball).intake.wound_inward);
    for (std::size_t f = 0; f < ball.faces.indices.size(); f += 3) {
        std::swap(ball.faces.indices[f], ball.faces.indices[f + 1]);
    }
    EXPECT_TRUE(prepared(ball).intake.wound_inward);
    EXPECT_FALSE(
        prepared(test::moved(test::grid(3), test::upright(), 1.0, {0, 0, -9})).intake.wound_inward);
}

TEST(Surface, ATranslationByTenMillionChangesNoNormal)
{
    const Mesh near = test::icosphere(3);
    const Surface a = prepared(near);
    const Surface b = prepared(test::moved(near, test::upright(), 1.0, {1e7, -1e7, 1e7}));
    for (std::size_t v = 0; v < near.positions.size(); ++v) {
        EXPECT_GT(dot(a.normals[v], b.normals[v]), 1.0 - 1e-12);
    }
}

TEST(Surface, SpacingOfARegularCloudIsItsStep)
{
    Mesh cloud = test::grid(20);
    cloud.faces = {};
    const Surface surface = prepared(cloud);
    const std::size_t middle = 10 * 21 + 10;
    EXPECT_NEAR(surface.spacing[middle], 0.1,
                0.015);  // the 8 nearest of a square grid: 0.886 steps
}

TEST(Topology, CountsWhatTheFacesAreLike)
{
    // Two triangles share an edge the right way, a third makes the edge non-manifold; one repeats.
    const Mesh fin = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                             {0, 1, 2, 1, 0, 3, 0, 1, 4, 2, 0, 1});
    const Intake intake = inspect(fin, prepared(fin));
    EXPECT_EQ(intake.duplicate_faces, 1U);
    EXPECT_EQ(intake.non_manifold_edges, 1U);
    EXPECT_EQ(intake.inconsistent_edges, 2U);  // the repeated face runs along 1-2 and 2-0 again
    EXPECT_EQ(intake.boundary_edges, 4U);
}

TEST(Topology, AClosedSphereHasNoBoundaryAndAMoebiusStripIsInconsistent)
{
    const Mesh sphere = test::icosphere(2);
    const Intake closed = inspect(sphere, prepared(sphere));
    EXPECT_EQ(closed.boundary_edges + closed.non_manifold_edges + closed.inconsistent_edges, 0U);

    std::vector<Point3> p;
    std::vector<std::uint32_t> f;
    const int n = 12;
    for (int i = 0; i < n; ++i) {
        const double a = 2.0 * std::numbers::pi * i / n;
        for (const double s : {-0.3, 0.3}) {
            const double r = 1.0 + s * std::cos(0.5 * a);
            p.push_back({r * std::cos(a), r * std::sin(a), s * std::sin(0.5 * a)});
        }
        const auto lo = static_cast<std::uint32_t>(2 * i);
        const std::uint32_t next = i + 1 < n ? lo + 2 : 1;
        const std::uint32_t next_hi = i + 1 < n ? lo + 3 : 0;
        f.insert(f.end(), {lo, next, next_hi, lo, next_hi, lo + 1});
    }
    const Mesh strip = mesh_of(p, f);
    const Intake moebius = inspect(strip, prepared(strip));
    EXPECT_EQ(moebius.inconsistent_edges, 1U);
    EXPECT_EQ(moebius.boundary_edges, static_cast<std::uint64_t>(2 * n));
}

TEST(Polygon, ASelfCrossingPolygonStillGivesCountMinusTwoTriangles)
{
    std::vector<Point3> star;
    std::vector<unsigned> corners;
    for (unsigned i = 0; i < 5; ++i) {
        const double a = 4.0 * std::numbers::pi * i / 5.0;
        star.push_back({std::cos(a), std::sin(a), 0});
        corners.push_back(i);
    }
    std::vector<Triangle> triangles;
    EXPECT_TRUE(triangulate(star, corners, triangles));
    EXPECT_EQ(triangles.size(), 3U);
}

}  // namespace
}  // namespace relight
