#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "core/preview/preview.h"
#include "tests/clouds.h"
#include "tests/shapes.h"

namespace relight {
namespace {

constexpr Rgb8 white{255, 255, 255}, red{255, 0, 0};

/// A ball with a smaller one beside it.
Mesh two_balls()
{
    return test::joined(test::icosphere(4),
                        test::moved(test::icosphere(3), test::upright(), 0.4, {1.4, 0.6, 0.8}));
}

/// White where the camera sees the front of a vertex, red where it sees the back.
Picture drawn(const Mesh& mesh, Point3 eye)
{
    Progress progress;
    const Surface surface = prepare(mesh, 1, progress);
    std::vector<Rgb8> colors;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        colors.push_back(dot(eye - mesh.positions[v], surface.normals[v]) < 0.0 ? red : white);
    }
    const Camera camera{eye, {0.3, 0.1, 0.1}, {0, 1, 0}, 0.6};
    Result<Picture> picture = preview(mesh, surface, colors, camera,
                                      {.width = 200, .height = 200, .samples = 4}, progress);
    if (!picture) { throw std::runtime_error(picture.error().detail); }
    return std::move(*picture);
}

TEST(CloudPreview, CoversWhatTheMeshCovers)
{
    const Mesh mesh = two_balls();
    Mesh cloud = mesh;
    cloud.faces = {};
    for (const Point3 eye : {Point3{1, 1, 5}, Point3{-4, 2, 3}, Point3{3, -3, -3}}) {
        const Picture a = drawn(mesh, eye), b = drawn(cloud, eye);
        double both = 0.0, either = 0.0, back = 0.0, colour = 0.0;
        for (std::size_t i = 0; i < a.alpha.size(); ++i) {
            both += std::min(a.alpha[i], b.alpha[i]);
            either += std::max(a.alpha[i], b.alpha[i]);
            colour += b.pixels[i][0];
            back += b.pixels[i][0] - b.pixels[i][1];
        }
        EXPECT_GT(both / either, 0.95);
        EXPECT_LT(back / colour, 0.003);  // no outline of what lies beyond the silhouette
    }
}

TEST(CloudPreview, ShowsASheetFromBothSides)
{
    test::Draws draws(51);
    Mesh cloud = test::cloud_of(test::random_plane(2000, draws));
    for (const double side : {4.0, -4.0}) {
        const Picture picture = drawn(cloud, {0.3, 0.1, side});
        EXPECT_EQ(picture.alpha[100 * 200 + 100], 255);
        EXPECT_EQ(picture.pixels[100 * 200 + 100], side > 0.0 ? white : red);
    }
}

TEST(CloudPreview, LeavesOutAbsentPoints)
{
    test::Draws draws(52);
    Mesh cloud = test::cloud_of(test::random_plane(2000, draws));
    for (std::uint32_t i = 0; i < 2000; ++i) {
        if (cloud.positions[i].x > 0.0) { cloud.absent.push_back(i); }
    }
    const Picture picture = drawn(cloud, {0.3, 0.1, 4.0});
    EXPECT_EQ(picture.alpha[100 * 200 + 40], 255);
    EXPECT_EQ(picture.alpha[100 * 200 + 140], 0);
}

TEST(CloudPreview, APointWithoutNeighboursIsADotThatCanBeSeen)
{
    const Picture picture = drawn(test::cloud_of({{0.3, 0.1, 0.1}}), {0.3, 0.1, 4.0});
    int covered = 0;
    for (const unsigned char a : picture.alpha) { covered += a > 0 ? 1 : 0; }
    EXPECT_GE(covered, 1);
    EXPECT_LE(covered, 9);
}

}  // namespace
}  // namespace relight
