#include "core/preview/preview.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <thread>

namespace relight {
namespace {

constexpr Rgb8 orange{200, 100, 37};
constexpr Rgb8 navy{10, 20, 90};

struct Scene {
    Mesh mesh;
    Surface surface;
    std::vector<Rgb8> colors;
    Camera camera;
};

/// A surface over these vertices, as far as the preview reads one.
Scene scene_of(std::vector<Point3> positions, std::vector<Triangle> triangles,
               std::vector<Rgb8> colors)
{
    Scene scene;
    if (!positions.empty()) {
        Bounds& bounds = scene.surface.bounds;
        bounds = {positions[0], positions[0]};
        for (const Point3 p : positions) {
            bounds.min = {std::min(bounds.min.x, p.x), std::min(bounds.min.y, p.y),
                          std::min(bounds.min.z, p.z)};
            bounds.max = {std::max(bounds.max.x, p.x), std::max(bounds.max.y, p.y),
                          std::max(bounds.max.z, p.z)};
        }
    }
    scene.surface.spacing.assign(positions.size(), 0.1F);
    scene.surface.normals.resize(positions.size());
    scene.surface.bend.resize(positions.size());
    scene.surface.triangles = std::move(triangles);
    scene.mesh.positions = std::move(positions);
    scene.colors = std::move(colors);
    scene.camera = {{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.7};
    return scene;
}

/// The rectangle [x0,x1] x [y0,y1] at z = 0, counter-clockwise from below left.
Scene rectangle(double x0, double x1, double y0, double y1, const std::array<Rgb8, 4>& colors)
{
    return scene_of({{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}}, {{0, 1, 2}, {0, 2, 3}},
                    {colors.begin(), colors.end()});
}
Scene right_half()
{
    return rectangle(0, 9, -9, 9, {orange, orange, orange, orange});
}

Picture drawn(const Scene& scene, const PreviewOptions& options)
{
    Progress progress;
    Result<Picture> picture =
        preview(scene.mesh, scene.surface, scene.colors, scene.camera, options, progress);
    if (!picture) { throw std::runtime_error(picture.error().detail); }
    return std::move(*picture);
}
constexpr PreviewOptions small{.width = 160, .height = 120, .background = navy};

std::size_t at(const Picture& picture, int x, int y)
{
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
           static_cast<std::size_t>(x);
}
Rgb8 pixel(const Picture& picture, int x, int y)
{
    return picture.pixels.at(at(picture, x, y));
}
int alpha(const Picture& picture, int x, int y)
{
    return picture.alpha.at(at(picture, x, y));
}

/// Where the camera formula says that the centre ray of a pixel meets the plane z = 0.
Point3 on_plane(const Camera& camera, int width, int height, int x, int y)
{
    const Vec3 d = PixelRays(camera, width, height).through(x + 0.5, y + 0.5);
    return camera.eye + d * (-camera.eye.z / d.z);
}

bool same(const Picture& a, const Picture& b)
{
    return a.pixels == b.pixels && a.alpha == b.alpha;
}

TEST(Preview, ShowsAVertexColourAsItIsAndTheBackgroundBesideIt)
{
    const Picture picture = drawn(right_half(), small);
    ASSERT_EQ(picture.pixels.size(), 160U * 120U);
    ASSERT_EQ(picture.alpha.size(), 160U * 120U);
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            ASSERT_EQ(pixel(picture, x, y), x < 80 ? navy : orange) << x << ',' << y;
            ASSERT_EQ(alpha(picture, x, y), x < 80 ? 0 : 255) << x << ',' << y;
        }
    }
}

TEST(Preview, EveryByteOfAColourArrivesUnchanged)
{
    for (int code = 0; code < 256; code += 5) {
        const auto c = static_cast<unsigned char>(code);
        const Rgb8 color{c, static_cast<unsigned char>(255 - c), static_cast<unsigned char>(c / 2)};
        const Picture picture = drawn(rectangle(-9, 9, -9, 9, {color, color, color, color}),
                                      {.width = 8, .height = 8, .background = navy});
        EXPECT_TRUE(std::all_of(picture.pixels.begin(), picture.pixels.end(), [&](Rgb8 p) {
            return p == color;
        })) << code;
    }
}

TEST(Preview, PutsEachPointWhereTheCameraFormulaSays)
{
    Scene scene = rectangle(-0.7, 0.3, -0.2, 0.6, {orange, orange, orange, orange});
    scene.camera = {{0.4, 0.9, 2.0}, {-0.1, 0.1, 0.0}, {0.2, 1.0, 0.1}, 0.8};
    const Picture picture = drawn(scene, small);
    int inside = 0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const Point3 p = on_plane(scene.camera, picture.width, picture.height, x, y);
            // > 0 inside; pixels that the border crosses (a pixel is 0.02 wide there) say nothing.
            const double depth = std::min({p.x + 0.7, 0.3 - p.x, p.y + 0.2, 0.6 - p.y});
            if (std::abs(depth) < 0.02) { continue; }
            inside += depth > 0 ? 1 : 0;
            ASSERT_EQ(pixel(picture, x, y), depth > 0 ? orange : navy) << x << ',' << y;
        }
    }
    EXPECT_GT(inside, 1000);
}

TEST(Preview, InterpolatesLinearlyInCodesBetweenVertices)
{
    Scene scene =
        rectangle(-1, 1, -9, 9, {Rgb8{20, 0, 255}, {220, 0, 255}, {220, 0, 255}, {20, 0, 255}});
    const Picture picture = drawn(scene, small);
    int seen = 0;
    for (int x = 0; x < picture.width; ++x) {
        const Point3 p = on_plane(scene.camera, picture.width, picture.height, x, 60);
        if (std::abs(p.x) < 0.95) {
            ++seen;
            EXPECT_NEAR(pixel(picture, x, 60)[0], 120.0 + 100.0 * p.x, 1.0) << x;
            EXPECT_EQ(pixel(picture, x, 60)[2], 255) << x;
        }
    }
    EXPECT_GT(seen, 80);
}

TEST(Preview, MixesAnEdgeByTheShareOfThePixelItCovers)
{
    for (const bool lying : {false, true}) {
        // An edge a little off the vertical (or the horizontal): along it the share runs through
        // 0..1.
        Scene scene = scene_of({{0, -9, 0}, {9, -9, 0}, {9, 9, 0}, {0.45, 9, 0}},
                               {{0, 1, 2}, {0, 2, 3}}, std::vector<Rgb8>(4, orange));
        if (lying) {
            for (Point3& p : scene.mesh.positions) { std::swap(p.x, p.y); }
        }
        const Picture picture =
            drawn(scene, {.width = 120, .height = 120, .samples = 9, .background = navy});
        double covered = 0.0;
        int partly = 0;
        for (int y = 0; y < 120; ++y) {
            for (int x = 0; x < 120; ++x) {
                const int a = alpha(picture, x, y);
                const int hits = static_cast<int>(std::lround(a * 9 / 255.0));
                ASSERT_EQ(a, std::lround(hits * 255 / 9.0));
                for (std::size_t band = 0; band < 3; ++band) {
                    const double sum = hits * orange.at(band) + (9 - hits) * navy.at(band);
                    ASSERT_EQ(pixel(picture, x, y).at(band), std::lround(sum / 9.0));
                }
                covered += hits / 9.0;
                partly += hits > 0 && hits < 9 ? 1 : 0;
            }
        }
        // In the middle of the picture the edge stands at 0.225, beyond it all is covered.
        const double pixel_width = 2.0 * 3.0 * std::tan(0.35) / 120.0;
        EXPECT_GT(partly, 70);  // the edge is between the outer samples of 2 in 3 pixels
        EXPECT_NEAR(covered / 120, 60.0 - 0.225 / pixel_width, 0.02) << lying;
    }
}

TEST(Preview, NoColourIsBrighterThanTheBrightestVertex)
{
    // A strip a quarter of a pixel wide, a little off the vertical, that grows from black to 100:
    // a colour taken at the centre of the pixel would run on beyond the strip's edge.
    const double width = 0.25 * 2.0 * 3.0 * std::tan(0.35) / 120.0;
    const Scene scene =
        scene_of({{0, -1, 0}, {width, -1, 0}, {0.2 + width, 1, 0}, {0.2, 1, 0}},
                 {{0, 1, 2}, {0, 2, 3}}, {{0, 0, 0}, {100, 0, 0}, {100, 0, 0}, {0, 0, 0}});
    const Picture picture = drawn(scene, {.width = 160, .height = 120});
    int seen = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        seen += picture.pixels[i][0] > 0 ? 1 : 0;
        EXPECT_LE(picture.pixels[i][0], 100 * picture.alpha[i] / 255.0 + 1.0);
    }
    EXPECT_GT(seen, 50);
}

TEST(Preview, APictureWiderThanADriverAllowsHasNoSeamsAndIsNotSquashed)
{
    // The edge of the rectangle is where it is in a small picture of the same shape, and the
    // colours run on over the parts that the picture is drawn in.
    Scene scene = rectangle(-80, 80, -9, 9, {Rgb8{0, 7, 7}, {250, 7, 7}, {250, 7, 7}, {0, 7, 7}});
    scene.camera.fov_y = 0.05;
    constexpr PreviewOptions wide{.width = 20'000, .height = 16, .background = navy};
    const Picture picture = drawn(scene, wide);
    int seen = 0;
    for (int x = 0; x < wide.width; ++x) {
        const Point3 p = on_plane(scene.camera, wide.width, wide.height, x, 8);
        if (std::abs(p.x) < 79.9) {
            ++seen;
            ASSERT_NEAR(pixel(picture, x, 8)[0], 125.0 + 125.0 * p.x / 80.0, 1.0) << x;
        } else if (std::abs(p.x) > 80.1) {
            ASSERT_EQ(pixel(picture, x, 8), navy) << x;
        }
    }
    EXPECT_GT(seen, 15'000);
}

TEST(Preview, ShowsTheBackOfAFaceToo)
{
    Scene scene = right_half();
    scene.camera.eye = {0, 0, -3};  // now the rectangle is on the left, seen from behind
    const Picture picture = drawn(scene, small);
    EXPECT_EQ(pixel(picture, 20, 60), orange);
    EXPECT_EQ(pixel(picture, 140, 60), navy);
}

TEST(Preview, NearerHidesFarther)
{
    for (const bool near_first : {true, false}) {
        Scene scene = scene_of(
            {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, {-9, -9, 1e-3}, {9, -9, 1e-3}, {0, 9, 1e-3}},
            {{0, 1, 2}, {3, 4, 5}}, {navy, navy, navy, orange, orange, orange});
        if (near_first) { std::swap(scene.surface.triangles[0], scene.surface.triangles[1]); }
        EXPECT_EQ(pixel(drawn(scene, small), 80, 60), orange) << near_first;
    }
}

TEST(Preview, IsTheSameAtTenMillionUnitsFromTheOrigin)
{
    // Coordinates that a double still holds exactly after the shift.
    Scene scene = scene_of({{-0.75, -0.5, 0}, {0.5, -0.625, 0.25}, {0.125, 0.5, -0.125}},
                           {{0, 1, 2}}, {orange, {0, 255, 0}, {255, 255, 255}});
    const Picture here = drawn(scene, small);
    const Vec3 shift{1e7, -1e7, 1e7};
    for (Point3& p : scene.mesh.positions) { p = p + shift; }
    scene.surface.bounds = {scene.surface.bounds.min + shift, scene.surface.bounds.max + shift};
    scene.camera.eye = scene.camera.eye + shift;
    scene.camera.target = scene.camera.target + shift;
    EXPECT_TRUE(same(drawn(scene, small), here));
}

TEST(Preview, IsTheSameAtAnyScale)
{
    const Picture here = drawn(right_half(), small);
    for (const double scale : {0x1p-30, 0x1p-10, 0x1p10, 0x1p40}) {
        Scene scene = right_half();
        for (Point3& p : scene.mesh.positions) { p = Point3{} + (p - Point3{}) * scale; }
        scene.surface.bounds = {scene.mesh.positions[0], scene.mesh.positions[2]};
        scene.camera.eye = {0, 0, 3 * scale};
        EXPECT_TRUE(same(drawn(scene, small), here)) << scale;
    }
}

TEST(Preview, EightThreadsAtOnceEachGetTheirOwnPicture)
{
    std::array<Picture, 8> pictures;
    std::vector<std::thread> threads;
    threads.reserve(pictures.size());
    const auto color = [](int i) { return Rgb8{static_cast<unsigned char>(30 * i), 7, 9}; };
    for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&, i] {
            pictures.at(static_cast<std::size_t>(i)) =
                drawn(rectangle(0, 9, -9, 9, {color(i), color(i), color(i), color(i)}),
                      {.width = 40 + i, .height = 30 + 2 * i, .background = navy});
        });
    }
    for (std::thread& thread : threads) { thread.join(); }
    for (int i = 0; i < 8; ++i) {
        const Picture& picture = pictures.at(static_cast<std::size_t>(i));
        ASSERT_EQ(picture.width, 40 + i);
        ASSERT_EQ(picture.height, 30 + 2 * i);
        EXPECT_EQ(pixel(picture, 38, 15), color(i));
        EXPECT_EQ(pixel(picture, 2, 15), navy);
    }
}

TEST(Preview, AskedTwiceAnswersTheSameBytes)
{
    Scene scene = rectangle(-0.5, 0.6, -0.4, 0.5, {orange, {0, 255, 0}, {255, 255, 255}, navy});
    scene.camera = {{1, 1, 2}, {0, 0, 0}, {0, 1, 0}, 0.8};
    const Picture first = drawn(scene, small);
    drawn(right_half(), {.width = 33, .height = 77});  // another picture in between leaves no trace
    EXPECT_TRUE(same(drawn(scene, small), first));
}

/// n points spread over a sphere of radius 1 (Fibonacci's spiral), red on the side of +x.
Scene sphere_of_points(std::size_t n)
{
    std::vector<Point3> positions;
    std::vector<Rgb8> colors;
    for (std::size_t i = 0; i < n; ++i) {
        const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
        const double azimuth = static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const double r = std::sqrt(1.0 - z * z);
        positions.push_back({r * std::cos(azimuth), r * std::sin(azimuth), z});
        colors.push_back(positions.back().x > 0 ? Rgb8{255, 0, 0} : Rgb8{0, 0, 255});
    }
    Scene scene = scene_of(std::move(positions), {}, std::move(colors));
    const double spacing = std::sqrt(4.0 * std::numbers::pi / static_cast<double>(n));
    scene.surface.spacing.assign(n, static_cast<float>(spacing));
    for (std::size_t i = 0; i < n; ++i) {
        scene.surface.normals[i] = normalize(scene.mesh.positions[i] - Point3{});
    }
    return scene;
}

TEST(Preview, ACloudLooksLikeItsSurface)
{
    for (const std::size_t n : {2'000UL, 300'000UL}) {  // the second is thinned
        const Picture picture = drawn(sphere_of_points(n), {.width = 200, .height = 200});
        // Seen from 3 radii the silhouette has radius tan(asin(1/3)) of tan(0.35) of 100 pixels.
        const double silhouette = 100.0 * std::tan(std::asin(1.0 / 3.0)) / std::tan(0.35);
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 200; ++x) {
                const double r = std::hypot(x - 99.5, y - 99.5);
                if (r < 0.9 * silhouette && std::abs(x - 99.5) > 10.0) {
                    ASSERT_EQ(pixel(picture, x, y), x > 99 ? (Rgb8{255, 0, 0}) : (Rgb8{0, 0, 255}))
                        << n << ": " << x << ',' << y;
                } else if (r > 1.15 * silhouette) {
                    ASSERT_EQ(alpha(picture, x, y), 0) << n << ": " << x << ',' << y;
                }
            }
        }
    }
}

TEST(Preview, NothingToShowIsTheBackground)
{
    Scene behind = right_half();
    behind.camera = {{0, 0, 3}, {0, 0, 9}, {0, 1, 0}, 0.7};  // looks away
    Scene nowhere = sphere_of_points(10);
    nowhere.camera.eye = {0, 0, 1e30};
    for (const Scene& scene : {scene_of({}, {}, {}), behind, nowhere}) {
        const Picture picture = drawn(scene, small);
        EXPECT_EQ(std::count(picture.pixels.begin(), picture.pixels.end(), navy), 160 * 120);
        EXPECT_EQ(std::count(picture.alpha.begin(), picture.alpha.end(), 0), 160 * 120);
    }
}

TEST(Preview, OnePointAndUpAlongTheViewAreDrawn)
{
    Scene scene = scene_of({{5, 5, 5}}, {}, {orange});
    scene.camera = {{5, 9, 5}, {5, 5, 5}, {0, 1, 0}, 0.7};
    const Picture picture = drawn(scene, {.width = 64, .height = 64});
    EXPECT_EQ(pixel(picture, 32, 32), orange);
    EXPECT_EQ(pixel(picture, 32, 40), (Rgb8{0, 0, 0}));
}

TEST(Preview, AStoppedRequestIsCancelled)
{
    const Scene scene = right_half();
    Progress progress;
    progress.stop();
    const Result<Picture> picture =
        preview(scene.mesh, scene.surface, scene.colors, scene.camera, small, progress);
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().fault, Fault::Cancelled);
}

TEST(PreviewWithoutADriver, SaysWhatIsMissing)  // run by itself, as preview_without_driver_test
{
    const Scene scene = right_half();
    Progress progress;
    const Result<Picture> picture =
        preview(scene.mesh, scene.surface, scene.colors, scene.camera, small, progress);
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().fault, Fault::Internal);
    EXPECT_NE(picture.error().detail.find("libegl1"), std::string::npos);
}

TEST(Preview, NeedsNoDisplay)
{
    EXPECT_EQ(std::getenv("DISPLAY"), nullptr);
}

}  // namespace
}  // namespace relight
