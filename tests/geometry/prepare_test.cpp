// prepare() against a scalar sum over the triangles, whatever the threads and the file's order.
#include <gtest/gtest.h>

#include <chrono>
#include <numeric>
#include <random>
#include <thread>

#include "core/geometry/corners.h"
#include "core/geometry/surface.h"
#include "tests/shapes.h"

namespace relight {
namespace {

Surface prepared(const Mesh& mesh, unsigned threads = 1)
{
    Progress progress;
    return prepare(mesh, threads, progress);
}

/// Hills with needles, degenerate faces and vertices of no face.
Mesh rough(int side)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit;
    Mesh mesh = test::grid(side);
    for (Point3& p : mesh.positions) {
        const bool thin = unit(random) < 0.1;
        p = {p.x + 0.4 / side * unit(random), thin ? 1e-9 * p.y : p.y, 0.3 * unit(random)};
    }
    constexpr std::size_t every_17th = 51;
    for (std::size_t c = 0; c < mesh.faces.indices.size(); c += every_17th) {
        mesh.faces.indices[c] = mesh.faces.indices[c + 1];
    }
    for (int i = 0; i < 9; ++i) { mesh.positions.push_back({1.0 * i, 0, 0}); }
    for (const Point3 p : mesh.positions) {
        mesh.uvs.push_back({static_cast<float>(p.x + p.z), static_cast<float>(p.y)});
    }
    return mesh;
}

/// The same with its vertices in no order.
Mesh shuffled(const Mesh& mesh)
{
    std::vector<std::uint32_t> to(mesh.positions.size());
    std::iota(to.begin(), to.end(), 0U);
    std::shuffle(to.begin(), to.end(), std::mt19937(5));
    Mesh out = mesh;
    for (std::size_t v = 0; v < to.size(); ++v) {
        out.positions[to[v]] = mesh.positions[v];
        out.uvs[to[v]] = mesh.uvs[v];
    }
    for (std::uint32_t& v : out.faces.indices) { v = to[v]; }
    return out;
}

struct Reference {
    std::vector<Vec3> normals;
    std::vector<float> spacing;
    std::vector<double> weights;  // sum of those of a vertex: what its normal may have cancelled of
    Intake counts;
};

/// Angle-weighted normals and shortest edges as one would write them down.
Reference reference(const Mesh& mesh)
{
    const std::size_t count = mesh.positions.size();
    constexpr float far = std::numeric_limits<float>::infinity();
    Reference sum{
        std::vector<Vec3>(count), std::vector<float>(count, far), std::vector<double>(count), {}};
    std::vector<bool> used(count);
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        const std::uint32_t* t = &mesh.faces.indices[3 * f];
        std::array<Vec3, 3> edge;
        double longest = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            used[t[k]] = true;
            edge[k] = mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]];
            longest = std::max(longest, dot(edge[k], edge[k]));
        }
        const Vec3 normal = cross(edge[0], -edge[2]);
        const double area2 = std::sqrt(dot(normal, normal));
        if (!(area2 > 1e-14 * longest)) {
            ++sum.counts.degenerate_faces;
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = edge[k], b = edge[(k + 2) % 3];
            const double angle = std::atan2(area2, -dot(a, b));
            sum.normals[t[k]] += normal * (angle / area2);
            sum.weights[t[k]] += angle;
            const double shorter = std::sqrt(std::min(dot(a, a), dot(b, b)));
            sum.spacing[t[k]] = std::min(sum.spacing[t[k]], static_cast<float>(shorter));
        }
    }
    for (std::size_t v = 0; v < count; ++v) {
        sum.counts.unreferenced_vertices += used[v] ? 0 : 1;
        sum.counts.unlit_vertices += sum.normals[v] == Vec3{} ? 1 : 0;
        if (sum.spacing[v] == far) { sum.spacing[v] = 0.0F; }
    }
    return sum;
}

void expect_as_reference(const Mesh& mesh)
{
    const Surface surface = prepared(mesh, 2);
    const Reference sum = reference(mesh);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Vec3 off = Vec3(surface.normals[v]) - Vec3(normalize(sum.normals[v]));
        EXPECT_LE(length(off) * length(sum.normals[v]), 1e-12 * sum.weights[v]) << v;
    }
    EXPECT_EQ(surface.spacing, sum.spacing);
    EXPECT_GT(sum.counts.degenerate_faces, 0U);
    EXPECT_EQ(surface.intake.degenerate_faces, sum.counts.degenerate_faces);
    EXPECT_EQ(surface.intake.unreferenced_vertices, sum.counts.unreferenced_vertices);
    EXPECT_EQ(surface.intake.unlit_vertices, sum.counts.unlit_vertices);
    EXPECT_EQ(surface.intake.normals_computed + sum.counts.unlit_vertices, mesh.positions.size());
}

TEST(Prepare, AgreesWithAScalarSumToARelative1e12)
{
    expect_as_reference(rough(250));
    expect_as_reference(shuffled(rough(250)));
}

TEST(Prepare, GivesTheSameBytesForAnyNumberOfThreads)
{
    for (const Mesh& mesh : {rough(350), shuffled(rough(350))}) {
        const Surface one = prepared(mesh, 1);
        for (const unsigned threads : {2U, 3U, 8U}) {
            const Surface many = prepared(mesh, threads);
            EXPECT_EQ(many.normals, one.normals);
            EXPECT_EQ(many.spacing, one.spacing);
            EXPECT_EQ(many.triangles, one.triangles);
            EXPECT_EQ(many.tangents, one.tangents);
            EXPECT_EQ(many.order, one.order);
            EXPECT_EQ(many.bounds.min, one.bounds.min);
            EXPECT_EQ(many.bounds.max, one.bounds.max);
            EXPECT_EQ(many.intake.degenerate_faces, one.intake.degenerate_faces);
            EXPECT_EQ(many.intake.unlit_vertices, one.intake.unlit_vertices);
        }
    }
}

TEST(Prepare, SplitsPolygonsIntoTheSameTrianglesForAnyNumberOfThreads)
{
    Mesh mesh = rough(60);  // pairs of triangles as quadrilaterals, every fifth left as it is
    Faces faces;
    faces.offsets.push_back(0);
    const std::vector<std::uint32_t> t = mesh.faces.indices;
    for (std::size_t c = 0; c + 5 < t.size(); c += 6) {
        const bool whole = c % 5 == 0;
        if (whole) {
            faces.indices.insert(faces.indices.end(), {t[c], t[c + 1], t[c + 2]});
        } else {
            faces.indices.insert(faces.indices.end(), {t[c], t[c + 1], t[c + 2], t[c + 5]});
        }
        faces.offsets.push_back(static_cast<std::uint32_t>(faces.indices.size()));
    }
    mesh.faces = faces;
    const Surface one = prepared(mesh, 1), many = prepared(mesh, 8);
    EXPECT_EQ(one.triangles.size(), faces.indices.size() - 2 * faces.count());
    EXPECT_EQ(one.triangle_face.size(), one.triangles.size());
    EXPECT_TRUE(std::is_sorted(one.triangle_face.begin(), one.triangle_face.end()));
    EXPECT_EQ(many.triangles, one.triangles);
    EXPECT_EQ(many.triangle_face, one.triangle_face);
    EXPECT_EQ(many.intake.polygons_triangulated, one.intake.polygons_triangulated);
    EXPECT_EQ(one.intake.polygons_triangulated, faces.indices.size() - 3 * faces.count());
}

TEST(Prepare, OrdersAbsentPointsToo)
{
    Mesh cloud = test::grid(20);
    cloud.faces = {};
    cloud.absent = {0, 7, 440};
    for (const std::uint32_t v : cloud.absent) { cloud.positions[v] = cloud.positions[100]; }
    const Surface surface = prepared(cloud);
    std::vector<std::uint32_t> order = surface.order;
    std::sort(order.begin(), order.end());
    ASSERT_EQ(order.size(), cloud.positions.size());
    for (std::uint32_t v = 0; v < order.size(); ++v) { EXPECT_EQ(order[v], v); }
    EXPECT_EQ(surface.spacing[7], 0.0F);
    EXPECT_FALSE(surface.normals[7]);
}

TEST(Prepare, TheOrderedCopyIsTheFilesVerticesInTheOrderWithZerosBehind)
{
    Mesh cloud = rough(60);
    cloud.faces = {};
    cloud.absent = {3, 500};
    for (const Mesh& mesh : {shuffled(rough(150)), cloud, test::joined({}, {})}) {
        for (const unsigned threads : {1U, 3U}) {
            const Surface surface = prepared(mesh, threads);
            const VertexFields& ordered = surface.ordered;
            ASSERT_EQ(ordered.size(), mesh.positions.size());
            for (std::size_t i = 0; i < ordered.size(); ++i) {
                const std::uint32_t v = surface.order[i];
                ASSERT_EQ(ordered.p(i), mesh.positions[v]);
                ASSERT_EQ(ordered.n(i), surface.normals[v]);
                ASSERT_EQ(ordered.spacing[i], surface.spacing[v]);
            }
            for (std::size_t i = ordered.size(); i < ordered.size() + VertexFields::spare; ++i) {
                for (const auto& field : {ordered.p_x, ordered.p_y, ordered.p_z, ordered.n_x,
                                          ordered.n_y, ordered.n_z}) {
                    ASSERT_EQ(field.data()[i], 0.0);
                }
                ASSERT_EQ(ordered.spacing.data()[i], 0.0F);
            }
            EXPECT_GE(ordered.bytes(), 52 * mesh.positions.size());
        }
    }
}

TEST(Prepare, StoppedAtAnyMomentEnds)
{
    Mesh cloud = rough(150);
    cloud.faces = {};
    for (const Mesh& mesh : {shuffled(rough(150)), cloud}) {
        for (int microseconds = 0; microseconds < 20'000; microseconds += 1'000) {
            Progress progress;
            std::jthread stopper([&] {
                std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
                progress.stop();
            });
            const Surface surface = prepare(mesh, 2, progress);
            if (!progress.stopped()) { EXPECT_EQ(surface.normals.size(), mesh.positions.size()); }
        }
    }
}

/// `size` triangles of all shapes: from needles of 1e-9 to right angles and nearly straight ones.
TriangleBatch some_triangles()
{
    TriangleBatch batch{};
    batch.centre = {0.3, -0.2, 1.0};
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (std::size_t i = 0; i < TriangleBatch::size; ++i) {
        const double thin = std::pow(10.0, -static_cast<double>(i % 10));
        const Vec3 along{unit(random), unit(random), unit(random)};
        const Vec3 off{unit(random), unit(random), unit(random)};
        const Vec3 base{unit(random), unit(random), unit(random)};
        const std::array<Vec3, 3> corners{base, base + along,
                                          base + along * 0.5 * (1.0 + unit(random)) + off * thin};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p = i % 7 == 6 ? base : corners[k];
            batch.corner[k][0][i] = p.x;
            batch.corner[k][1][i] = p.y;
            batch.corner[k][2][i] = p.z;
        }
    }
    return batch;
}

TEST(Corners, AnglesAreThoseOfAtan2AndTheRestIsPlainArithmetic)
{
    TriangleBatch batch = some_triangles();
    measure(batch);
    int degenerate = 0;
    for (std::size_t i = 0; i < TriangleBatch::size; ++i) {
        std::array<Point3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = {batch.corner[k][0][i], batch.corner[k][1][i], batch.corner[k][2][i]};
        }
        const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
        const double area2 = std::sqrt(dot(normal, normal));
        if (batch.area2[i] == 0.0) {
            ++degenerate;
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_EQ(batch.weight[k][i], 0.0);
                EXPECT_EQ(batch.shorter2[k][i], TriangleBatch::none);
            }
            continue;
        }
        EXPECT_EQ(
            (Vec3{batch.doubled_area[0][i], batch.doubled_area[1][i], batch.doubled_area[2][i]}),
            normal);
        EXPECT_EQ(batch.area2[i], area2);
        EXPECT_EQ(batch.volume6[i], dot(p[0] - batch.centre, normal));
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = p[(k + 1) % 3] - p[k], b = p[k] - p[(k + 2) % 3];
            EXPECT_EQ(batch.shorter2[k][i], std::min(dot(a, a), dot(b, b)));
            const long double angle =
                std::atan2(static_cast<long double>(area2), static_cast<long double>(-dot(a, b)));
            const long double found = static_cast<long double>(batch.weight[k][i]) * area2;
            EXPECT_LT(std::abs(found / angle - 1.0L), 1e-15L) << i << ' ' << k;
        }
    }
    EXPECT_EQ(degenerate, static_cast<int>(TriangleBatch::size / 7));
}

}  // namespace
}  // namespace relight
