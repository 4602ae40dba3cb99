// The camera's pixels against expected values computed independently.
#include <gtest/gtest.h>

#include "core/shade/raytrace.h"
#include "tests/oracle.h"
#include "tests/scenes.h"

namespace relight {
namespace {

using nlohmann::json;
using test::oracle;
using test::point_of;
using test::vec_of;

Camera camera_of(const json& j)
{
    const Point3 eye = point_of(j["eye"]);
    return {eye, eye - vec_of(j["back"]), vec_of(j["up"]), j["yfov"]};
}

Rendered rendered(const Stage& stage, const Scene& scene, const json& camera, int samples,
                  std::uint64_t seed = 1)
{
    RaytraceOptions options;
    options.width = camera["width"];
    options.height = camera["height"];
    options.samples = samples;
    options.seed = seed;
    Progress progress;
    return raytrace(stage, scene, options, progress);
}

TEST(Pixels, SolidAnglesAddUpToTheFrustum)
{
    int cases = 0;
    const json file = oracle("image_pixels");
    for (const json& c : file["cases"]) {
        if (c["kind"] != "pixel_solid_angle") { continue; }
        ++cases;
        const int width = c["width"];
        const int height = c["height"];
        double total = 0.0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double omega = pixel_solid_angle(c["yfov"], width, height, x, y);
                const double expected =
                    c["solid_angle_rows"][static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
                EXPECT_NEAR(omega, expected, 1e-6 * expected) << c["id"];
                total += omega;
            }
        }
        EXPECT_NEAR(total, c["total"].get<double>(), 1e-12) << c["id"];
    }
    EXPECT_EQ(cases, 4);
}

TEST(Pixels, ANarrowConesFootprint)
{
    int cases = 0;
    const json file = oracle("image_pixels");
    for (const json& c : file["cases"]) {
        if (c["kind"] != "footprint_area") { continue; }
        ++cases;
        const double area = footprint_area(c["pixel_solid_angle"], c["distance"],
                                           std::cos(c["theta"].get<double>()));
        EXPECT_NEAR(area, c["area"].get<double>(), 1e-6 * area) << c["id"];
    }
    EXPECT_EQ(cases, 6);
}

TEST(Pixels, AnEdgeCoversEachPixelsExactShare)
{
    int cases = 0;
    const json file = oracle("image_pixels");
    for (const json& c : file["cases"]) {
        if (c["kind"] != "edge_coverage") { continue; }
        ++cases;
        // The white part of the ground, p . e < offset, as a large quad that ends at the edge.
        const Dir3 e = normalize(vec_of(c["edge"]["direction_normal"]));
        const Vec3 along = cross({0, 0, 1}, e);
        const Point3 edge = Point3{} + Vec3(e) * c["edge"]["offset"].get<double>();
        const Vec3 back = Vec3(e) * -400.0;
        const Mesh white = test::mesh_of({edge - along * 400, edge + along * 400,
                                          edge + along * 400 + back, edge - along * 400 + back},
                                         {0, 1, 2, 0, 2, 3});
        Scene scene;
        scene.camera = camera_of(c["camera"]);
        const Stage stage = test::staged(white);
        // 16 renders of 256 samples: their spread is the standard error of one.
        std::vector<Image> runs;
        for (std::uint64_t run = 0; run < 16; ++run) {
            runs.push_back(rendered(stage, scene, c["camera"], 256, run).image);
        }
        double squared_error = 0.0;
        for (int y = 0; y < runs[0].height; ++y) {
            for (int x = 0; x < runs[0].width; ++x) {
                const double expected =
                    c["coverage_rows"][static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
                double mean = 0.0;
                for (const Image& image : runs) {
                    const auto covered = static_cast<double>(image.coverage[image.at(x, y)]);
                    mean += covered / 16.0;
                    squared_error += (covered - expected) * (covered - expected) / 16.0;
                }
                // No cell of the pixel is off by more than a sample: sd <= sqrt(2 * 16 / 4) / 256.
                const double sigma = std::sqrt(8.0) / 256.0 / std::sqrt(16.0);
                EXPECT_NEAR(mean, expected, 4.0 * sigma) << c["id"] << " " << x << "," << y;
            }
        }
        const double rms = std::sqrt(squared_error / (runs[0].width * runs[0].height));
        EXPECT_LT(rms, 0.01) << c["id"];
    }
    EXPECT_EQ(cases, 3);
}

TEST(Pixels, AreAveragesOfRadianceOverTheirFootprint)
{
    int cases = 0;
    const json file = oracle("image_pixels");
    for (const json& c : file["cases"]) {
        if (c["kind"] != "box_filtered_ground") { continue; }
        ++cases;
        const Mesh ground = test::moved(test::grid(1), test::upright(), 2000.0, {});
        Scene scene;
        scene.camera = camera_of(c["camera"]);
        scene.materials[0] = Lambert{Rgb::grey(c["albedo"].get<double>())};
        scene.lights = {test::light_of(PointLight{point_of(c["point_light"]["position"]), {}},
                                       Rgb::grey(c["point_light"]["intensity"].get<double>()))};
        const Stage stage = test::staged(ground);
        const auto value = [&](const char* rows, int x, int y) {
            return c[rows][static_cast<std::size_t>(y)][static_cast<std::size_t>(x)].get<double>();
        };
        // 16 renders of 256 samples: their spread is the standard error of one.
        constexpr int run_count = 16;
        std::vector<Image> runs;
        runs.reserve(run_count);
        for (int run = 0; run < run_count; ++run) {
            runs.push_back(
                rendered(stage, scene, c["camera"], 256, static_cast<std::uint64_t>(run)).image);
        }
        for (int y = 0; y < runs[0].height; ++y) {
            for (int x = 0; x < runs[0].width; ++x) {
                double mean = 0.0;
                double squares = 0.0;
                for (const Image& image : runs) {
                    const auto L = static_cast<double>(image.pixels[image.at(x, y)][0]);
                    mean += L / run_count;
                    squares += L * L / run_count;
                }
                const double sigma =
                    std::sqrt(std::max(0.0, squares - mean * mean) / (run_count - 1));
                const double expected = value("L_box_filtered_rows", x, y);
                EXPECT_NEAR(mean, expected, 4.0 * sigma + 1e-4 * expected)
                    << c["id"] << " " << x << "," << y;
                const auto single = static_cast<double>(runs[0].pixels[runs[0].at(x, y)][0]);
                EXPECT_NEAR(single, expected, 0.01 * expected) << c["id"] << " " << x << "," << y;
            }
        }
    }
    EXPECT_EQ(cases, 3);
}

}  // namespace
}  // namespace relight
