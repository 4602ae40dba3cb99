#include "core/geometry/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "tests/shapes.h"

namespace relight {
namespace {

constexpr std::uint64_t plenty = 10'000'000;

Mesh refined(const Mesh& mesh, double max_edge)
{
    Progress progress;
    Result<Mesh> result = refine(mesh, max_edge, plenty, plenty, progress);
    EXPECT_TRUE(result) << result.error().detail;
    return result ? std::move(*result) : Mesh{};
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

template <class Visit>
void for_edges(const Mesh& mesh, Visit visit)
{
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        for (std::size_t c = mesh.faces.begin(f); c < mesh.faces.end(f); ++c) {
            const std::size_t after = c + 1 == mesh.faces.end(f) ? mesh.faces.begin(f) : c + 1;
            visit(mesh.faces.indices[c], mesh.faces.indices[after]);
        }
    }
}

double longest_edge(const Mesh& mesh)
{
    double longest = 0.0;
    for_edges(mesh, [&](auto a, auto b) {
        longest = std::max(longest, length(mesh.positions[a] - mesh.positions[b]));
    });
    return longest;
}

/// How many triangles run along each edge in each direction.
std::map<Edge, int> uses(const Mesh& mesh)
{
    std::map<Edge, int> count;
    for_edges(mesh, [&](auto a, auto b) { ++count[{a, b}]; });
    return count;
}

/// Whether every edge is shared by two triangles that run along it in opposite directions: closed,
/// without a vertex of one triangle in the middle of another's edge.
bool is_closed(const Mesh& mesh)
{
    const std::map<Edge, int> count = uses(mesh);
    return std::all_of(count.begin(), count.end(), [&](const auto& edge) {
        const auto back = count.find({edge.first.second, edge.first.first});
        return edge.second == 1 && back != count.end() && back->second == 1;
    });
}

Vec3 doubled_area(const Mesh& mesh, std::size_t triangle)
{
    const auto p = [&](std::size_t k) {
        return mesh.positions[mesh.faces.indices[3 * triangle + k]];
    };
    return cross(p(1) - p(0), p(2) - p(0));
}

double area(const Mesh& mesh)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.faces.count(); ++t) {
        sum += 0.5 * length(doubled_area(mesh, t));
    }
    return sum;
}

double volume(const Mesh& mesh)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.faces.count(); ++t) {
        sum +=
            dot(mesh.positions[mesh.faces.indices[3 * t]] - Point3{}, doubled_area(mesh, t)) / 6.0;
    }
    return sum;
}

/// Triangles of all shapes: slivers, needles, right and equilateral ones.
Mesh random_triangles(int count)
{
    std::mt19937 random(17);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    Mesh mesh = test::mesh_of({}, {});
    for (int i = 0; i < 3 * count; ++i) {
        const double thin = i % 9 < 3 ? 1e-3 : 1.0;
        mesh.positions.push_back({any(random), thin * any(random), any(random)});
        mesh.faces.indices.push_back(static_cast<std::uint32_t>(i));
    }
    return mesh;
}

TEST(Refine, NoEdgeIsLongerThanAskedFor)
{
    const Mesh meshes[] = {test::box({0, 0, 0}, {1, 2, 9}), test::icosphere(1),
                           test::latlong_sphere(20, 5), random_triangles(40)};
    for (const Mesh& mesh : meshes) {
        for (const double max_edge : {0.9, 0.31, 0.07}) {
            EXPECT_LE(longest_edge(refined(mesh, max_edge)), max_edge);
        }
    }
}

TEST(Refine, TheVerticesOfTheFileComeFirstUnchanged)
{
    const Mesh mesh = test::icosphere(2);
    const Mesh fine = refined(mesh, 0.1);
    ASSERT_GT(fine.positions.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_EQ(fine.positions[i], mesh.positions[i]);
    }
}

TEST(Refine, AreaAndVolumeStayAndNoTriangleTurnsOver)
{
    const Mesh meshes[] = {test::box({0, 0, 0}, {1, 2, 3}), test::icosphere(1),
                           test::latlong_sphere(9, 6)};
    for (const Mesh& mesh : meshes) {
        const Mesh fine = refined(mesh, 0.13);
        EXPECT_NEAR(area(fine), area(mesh), 1e-12 * area(mesh));
        EXPECT_NEAR(volume(fine), volume(mesh), 1e-12 * volume(mesh));
    }
    const Mesh flat = refined(test::grid(3), 0.05);
    for (const Point3& p : flat.positions) { EXPECT_EQ(p.z, 0.0); }
    for (std::size_t t = 0; t < flat.faces.count(); ++t) {
        EXPECT_GT(doubled_area(flat, t).z, 0.0);
    }
    EXPECT_NEAR(area(flat), 4.0, 1e-12);
}

TEST(Refine, NoVertexLandsInTheMiddleOfANeighboursEdge)
{
    // Long boxes and poles: triangles with one, two and three long edges beside each other.
    const Mesh meshes[] = {test::box({0, 0, 0}, {1, 2, 9}), test::box({0, 0, 0}, {0.3, 0.01, 7}),
                           test::icosphere(1), test::latlong_sphere(20, 7)};
    for (const Mesh& mesh : meshes) {
        ASSERT_TRUE(is_closed(mesh));
        for (const double max_edge : {1.3, 0.4, 0.15}) {
            EXPECT_TRUE(is_closed(refined(mesh, max_edge))) << max_edge;
        }
    }
}

TEST(Refine, TrianglesThatMeetWithoutSharingVerticesStillMeet)
{
    const Mesh whole = test::moved(test::icosphere(1), test::upright(), 0.7, {0.1, 0.2, 0.3});
    Mesh soup = test::mesh_of({}, {});
    for (const std::uint32_t i : whole.faces.indices) {  // numbered from the other side, too
        soup.positions.insert(soup.positions.begin(), whole.positions[i]);
        soup.faces.indices.push_back(
            static_cast<std::uint32_t>(whole.faces.indices.size() - soup.positions.size()));
    }
    Mesh welded = refined(soup, 0.1);
    std::map<std::array<double, 3>, std::uint32_t> numbers;
    for (std::uint32_t& i : welded.faces.indices) {
        const Point3 p = welded.positions[i];
        i = numbers.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(numbers.size()))
                .first->second;
    }
    EXPECT_GT(welded.faces.count(), whole.faces.count());
    EXPECT_TRUE(is_closed(welded));
}

TEST(Refine, AllLeavesOfABookShareTheNewVerticesOfItsSpine)
{
    Mesh book = test::mesh_of({{0, 0, 0}, {0, 0, 1}}, {});  // five triangles at one edge
    for (std::uint32_t leaf = 0; leaf < 5; ++leaf) {
        book.positions.push_back({std::cos(1.2 * leaf), std::sin(1.2 * leaf), 0.5});
        const std::uint32_t flip = leaf % 2;  // wound this way and that
        book.faces.indices.insert(book.faces.indices.end(), {flip, 1 - flip, 2 + leaf});
    }
    const Mesh fine = refined(book, 0.26);
    EXPECT_LE(longest_edge(fine), 0.26);
    EXPECT_NEAR(area(fine), area(book), 1e-14);
    std::map<Edge, int> both_ways;
    for (const auto& [edge, count] : uses(fine)) {
        both_ways[std::minmax(edge.first, edge.second)] += count;
    }
    int spine = 0;
    for (const auto& [edge, count] : both_ways) {
        const Point3 a = fine.positions[edge.first], b = fine.positions[edge.second];
        const bool on_spine = a.x == 0.0 && a.y == 0.0 && b.x == 0.0 && b.y == 0.0;
        EXPECT_LE(count, on_spine ? 5 : 2);
        if (on_spine) { EXPECT_EQ(count, 5); }
        spine += on_spine ? 1 : 0;
    }
    EXPECT_EQ(spine, 4);  // halved twice
}

TEST(Refine, AMeshThatIsFineStaysAsItIs)
{
    Mesh mesh = test::box({0, 0, 0}, {1, 1, 1});
    mesh.faces.indices = {0, 3, 2, 1, 4, 5, 6, 7};
    mesh.faces.offsets = {0, 4, 8};
    mesh.notes = {"as filed"};
    mesh.pieces.push_back({0, 0, 0, 0, 8});
    const Mesh same = refined(mesh, 1.5);
    EXPECT_EQ(same.positions, mesh.positions);
    EXPECT_EQ(same.faces.indices, mesh.faces.indices);
    EXPECT_EQ(same.faces.offsets, mesh.faces.offsets);
    EXPECT_EQ(same.notes, mesh.notes);
    EXPECT_EQ(same.pieces.size(), 1U);
    EXPECT_GT(refined(mesh, 1.2).faces.count(), 2U);  // the diagonal of 1.41 is too long
}

TEST(Refine, RefinedTwiceIsRefinedOnce)
{
    const Mesh once = refined(test::latlong_sphere(9, 6), 0.2);
    const Mesh twice = refined(once, 0.2);
    EXPECT_EQ(twice.positions, once.positions);
    EXPECT_EQ(twice.faces.indices, once.faces.indices);
    EXPECT_EQ(twice.notes, once.notes);
}

TEST(Refine, ACloudStaysAsItIs)
{
    Mesh cloud = test::mesh_of({{0, 0, 0}, {5, 0, 0}, {9, 9, 9}}, {});
    cloud.absent = {1};
    const Mesh same = refined(cloud, 0.1);
    EXPECT_EQ(same.positions, cloud.positions);
    EXPECT_EQ(same.absent, cloud.absent);
}

TEST(Refine, WhatIsLinearOverAFaceStaysLinear)
{
    for (const bool corners : {false, true}) {
        Mesh mesh = test::grid(2);
        const auto uv_at = [](Point3 p) {
            return Uv{static_cast<float>(0.5 * p.x + 0.25 * p.y), static_cast<float>(1.0 - p.y)};
        };
        const auto color_at = [](Point3 p) {
            return Rgbf{static_cast<float>(2.0 + p.x), static_cast<float>(2.0 - p.y), 1.0F};
        };
        for (const Point3& p : mesh.positions) {
            if (!corners) { mesh.uvs.push_back(uv_at(p)); }
            mesh.uvs_1.push_back({uv_at(p)[1], uv_at(p)[0]});
            mesh.colors.push_back(color_at(p));
            mesh.tangents.push_back({1, 0, 0, -1});
            mesh.normals.push_back({0, 0, 3});
        }
        // A seam: the second half of the faces counts its u from 10 on.
        const auto seam = [&](std::size_t corner, std::size_t size) {
            return 2 * corner < size ? 0.0F : 10.0F;
        };
        const std::size_t before = mesh.faces.indices.size();
        for (std::size_t c = 0; corners && c < before; ++c) {
            const Uv uv = uv_at(mesh.positions[mesh.faces.indices[c]]);
            mesh.corner_uvs.push_back({uv[0] + seam(c, before), uv[1]});
        }
        const Mesh fine = refined(mesh, 0.1);
        ASSERT_EQ(fine.colors.size(), fine.positions.size());
        for (std::size_t i = 0; i < fine.positions.size(); ++i) {
            const Uv uv = uv_at(fine.positions[i]);
            for (std::size_t k = 0; k < 2; ++k) {
                if (!corners) { EXPECT_NEAR(fine.uvs[i][k], uv[k], 1e-6); }
                EXPECT_NEAR(fine.uvs_1[i][k], uv[1 - k], 1e-6);
            }
            for (std::size_t band = 0; band < 3; ++band) {
                EXPECT_NEAR(fine.colors[i][band], color_at(fine.positions[i])[band], 1e-6);
            }
            EXPECT_EQ(fine.tangents[i], (std::array{1.0F, 0.0F, 0.0F, -1.0F}));
            EXPECT_EQ(normalize(fine.normals[i]), normalize({0, 0, 1}));
        }
        ASSERT_EQ(fine.corner_uvs.size(), corners ? fine.faces.indices.size() : 0U);
        for (std::size_t c = 0; c < fine.corner_uvs.size(); ++c) {
            const Point3 p = fine.positions[fine.faces.indices[c]];
            // Which side of the seam: each triangle lies within one of the old rows, y < 0 first.
            const Point3 other = fine.positions[fine.faces.indices[c - c % 3]];
            const Point3 third = fine.positions[fine.faces.indices[c - c % 3 + 1]];
            const Point3 last = fine.positions[fine.faces.indices[c - c % 3 + 2]];
            const float shift = other.y + third.y + last.y < 0.0 ? 0.0F : 10.0F;
            EXPECT_NEAR(fine.corner_uvs[c][0], uv_at(p)[0] + shift, 1e-5);
            EXPECT_NEAR(fine.corner_uvs[c][1], uv_at(p)[1], 1e-5);
        }
    }
}

TEST(Refine, DirectionsOfNewVerticesAreUnitAndBetweenTheirEnds)
{
    Mesh mesh = test::mesh_of({{0, 0, 0}, {2, 0, 0}, {0, 0.1, 0}}, {0, 1, 2});
    mesh.normals = {{0, 0, 5}, {0, 1, 0}, {0, 0, 0}};
    mesh.tangents = {{1, 0, 0, 1}, {0, 0, 1, 1}, {0, 0, 0, 0}};
    const Mesh fine = refined(mesh, 1.5);
    ASSERT_EQ(fine.positions.size(), 5U);  // (0, 1) and (1, 2) are halved
    const double h = std::sqrt(0.5);
    EXPECT_NEAR(length(fine.normals[3] - Vec3{0, h, h}), 0.0, 1e-15);
    EXPECT_EQ(fine.normals[4], (Vec3{0, 1, 0}));  // of the end that has one
    EXPECT_NEAR(fine.tangents[3][0], h, 1e-7);
    EXPECT_NEAR(fine.tangents[3][2], h, 1e-7);
    EXPECT_EQ(fine.tangents[3][3], 1.0F);
    EXPECT_EQ(fine.tangents[4], (std::array{0.0F, 0.0F, 1.0F, 1.0F}));
    mesh.tangents = {{0, 0, 0, 0}, {0, 0, 1, -1}, {0, 0, 0, 0}};
    EXPECT_EQ(refined(mesh, 1.5).tangents[3], (std::array{0.0F, 0.0F, 1.0F, -1.0F}));
}

TEST(Refine, ATriangleWithTwoLongEdgesIsCutAlongTheShorterDiagonal)
{
    // Leaning right, the middles are (1, 1) and (1.5, 1): 1 from (1, 0), or 1.8 from (0, 0).
    // Leaning left, the other way round. The longer one would be halved again.
    for (const double top : {2.0, -1.0}) {
        const Mesh mesh = test::mesh_of({{0, 0, 0}, {1, 0, 0}, {top, 2, 0}}, {0, 1, 2});
        EXPECT_EQ(refined(mesh, 1.5).faces.count(), 3U);
    }
}

TEST(Refine, PolygonsBecomeTrianglesWithTheirAreaMaterialAndCoordinates)
{
    // An L, concave, and a square beside it, with a material and texture coordinates each.
    Mesh mesh = test::mesh_of(
        {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {3, 0, 0}, {3, 1, 0}},
        {0, 1, 2, 3, 4, 5, 1, 6, 7, 2});
    mesh.faces.offsets = {0, 6, 10};
    mesh.materials = {"l", "square"};
    mesh.face_materials = {0, 1};
    for (const std::uint32_t i : mesh.faces.indices) {
        mesh.corner_uvs.push_back({static_cast<float>(mesh.positions[i].x), 7.0F});
    }
    const Mesh fine = refined(mesh, 0.3);
    EXPECT_TRUE(fine.faces.offsets.empty());
    EXPECT_LE(longest_edge(fine), 0.3);
    EXPECT_NEAR(area(fine), 4.0, 1e-12);
    ASSERT_EQ(fine.face_materials.size(), fine.faces.count());
    double of_square = 0.0;
    for (std::size_t t = 0; t < fine.faces.count(); ++t) {
        EXPECT_GT(doubled_area(fine, t).z, 0.0);
        double centre = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t c = 3 * t + k;
            const double x = fine.positions[fine.faces.indices[c]].x;
            centre += x / 3.0;
            EXPECT_NEAR(fine.corner_uvs[c][0], x, 1e-6);
            EXPECT_EQ(fine.corner_uvs[c][1], 7.0F);
        }
        EXPECT_EQ(fine.face_materials[t], centre > 2.0 ? 1U : 0U);
        of_square += centre > 2.0 ? 0.5 * doubled_area(fine, t).z : 0.0;
    }
    EXPECT_NEAR(of_square, 1.0, 1e-12);
}

TEST(Refine, OfAGltfItsTexturesStayAndItsPiecesGo)
{
    Mesh mesh = test::grid(1);
    mesh.format = "glb";
    mesh.pieces.push_back({0, 0, 0, 0, 4});
    mesh.materials = {"wood"};
    mesh.face_materials = {0, 0};
    mesh.maps.resize(1);
    mesh.textures.resize(1);
    mesh.double_positions = false;
    const Mesh fine = refined(mesh, 0.5);
    EXPECT_TRUE(fine.pieces.empty());
    EXPECT_EQ(fine.maps.size(), 1U);
    EXPECT_EQ(fine.textures.size(), 1U);
    EXPECT_FALSE(fine.double_positions);
    ASSERT_EQ(fine.notes.size(), 1U);
    EXPECT_TRUE(fine.notes[0].starts_with("refined: edges longer than 0.5 were halved in "))
        << fine.notes[0];
}

TEST(Refine, TrianglesWithoutAreaAndVerticesWithoutFacesSurvive)
{
    const Mesh mesh = test::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {9, 9, 9}},
                                    {0, 1, 2, 0, 0, 1, 3, 3, 3, 0, 1, 3});
    const Mesh fine = refined(mesh, 0.3);
    EXPECT_LE(longest_edge(fine), 0.3);
    EXPECT_NEAR(area(fine), 0.5, 1e-14);
    EXPECT_EQ(fine.positions[4], (Point3{9, 9, 9}));
    for (const Point3& p : fine.positions) { EXPECT_TRUE(is_finite(p)); }
}

TEST(Refine, MoreVerticesOrFacesThanAllowedIsAnErrorThatSaysWhatToDo)
{
    Progress progress;
    const Mesh mesh = test::box({0, 0, 0}, {1, 1, 1});
    const auto vertices = refine(mesh, 0.01, 1000, plenty, progress);
    ASSERT_FALSE(vertices);
    EXPECT_EQ(vertices.error().fault, Fault::TooManyVertices);
    EXPECT_NE(vertices.error().detail.find("the limit is 1000: raise max_edge"), std::string::npos)
        << vertices.error().detail;
    const auto faces = refine(mesh, 0.01, plenty, 1000, progress);
    ASSERT_FALSE(faces);
    EXPECT_EQ(faces.error().fault, Fault::TooManyFaces);

    const auto at_once = refine(mesh, 1e-9, plenty, plenty, progress);  // before the first round
    ASSERT_FALSE(at_once);
    EXPECT_EQ(at_once.error().fault, Fault::TooManyFaces);

    const Mesh fine = refined(mesh, 0.3);  // exactly as many as it takes are enough
    EXPECT_TRUE(refine(mesh, 0.3, fine.positions.size(), fine.faces.count(), progress));
    EXPECT_FALSE(refine(mesh, 0.3, fine.positions.size() - 1, fine.faces.count(), progress));
    EXPECT_FALSE(refine(mesh, 0.3, fine.positions.size(), fine.faces.count() - 1, progress));
}

TEST(Refine, EdgesThatCoordinatesCannotResolveEndInAnErrorOrStayButNeverInALoop)
{
    Progress progress;
    const double far = 1e15;  // where neighbouring doubles are 1/8 apart
    const Mesh mesh =
        test::mesh_of({{far, far, 0}, {far - 1, far, 0}, {far, far - 1, 0}}, {0, 1, 2});
    for (const double max_edge : {1e-3, 1e-300}) {
        const auto result = refine(mesh, max_edge, 20'000, 40'000, progress);
        EXPECT_FALSE(result);
    }
    const Mesh thin = test::mesh_of({{far, 0, 0}, {far - 0.125, 0, 0}, {far, 0, 0.05}}, {0, 1, 2});
    const auto result = refine(thin, 0.124, 20'000, 40'000, progress);
    ASSERT_TRUE(result);
    EXPECT_LT(result->positions.size(), 100U);
}

TEST(Refine, StopsWhenAsked)
{
    Progress progress;
    progress.stop();
    const auto result = refine(test::icosphere(1), 0.01, plenty, plenty, progress);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().fault, Fault::Cancelled);
}

}  // namespace
}  // namespace relight
