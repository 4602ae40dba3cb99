#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

#include "tests/import/gltf_texts.h"

namespace relight::test {
namespace {

using Matrix = std::array<double, 12>;

constexpr Matrix at_home{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
/// +Z to +X, then three times as large, then to (5, 6, 7).
constexpr Matrix elsewhere{0, 0, 3, 5, 0, 3, 0, 6, -3, 0, 0, 7};

Json lit(const std::string& light)
{
    return gltf_with(
        {{"extensions", {{"KHR_lights_punctual", {{"lights", {Json::parse(light)}}}}}}});
}

Result<Light> light_of(const std::string& light, const Matrix& to_world = at_home)
{
    return test::light_of(lit(light), 0, to_world);
}

void expect_near(Vec3 a, Vec3 b)
{
    EXPECT_NEAR(length(a - b), 0.0, 1e-9);
}

TEST(GltfLight, ThatSaysNothingButItsTypeIsTheDefaultOfTheSpecification)
{
    const auto light = light_of(R"({"type": "spot"})");
    ASSERT_TRUE(light) << detail_of(light);
    EXPECT_EQ(light->name, "light_0");
    EXPECT_EQ(light->power, Rgb::grey(1.0));
    EXPECT_TRUE(light->enabled && light->cast_shadows);
    const auto& spot = std::get<SpotLight>(light->shape);
    EXPECT_EQ(spot.inner_cone, 0.0);
    EXPECT_EQ(spot.outer_cone, 0.25 * std::numbers::pi);
    EXPECT_EQ(spot.position, Point3{});
    expect_near(spot.axis, {0, 0, -1});
}

TEST(GltfLight, HasItsColourTimesItsIntensity)
{
    for (const char* type : {"point", "spot", "directional"}) {
        const auto light = light_of(R"({"name": "lamp", "intensity": 20, "color": [1, 0.5, 0],
                                        "type": ")" +
                                    std::string(type) + "\"}");
        ASSERT_TRUE(light) << detail_of(light);
        EXPECT_EQ(light->name, "lamp");
        EXPECT_EQ(light->power, (Rgb{20.0, 10.0, 0.0}));
    }
}

TEST(GltfLight, StandsWhereItsNodeStandsAndKeepsItsPowerWhateverTheScale)
{
    const auto point = light_of(R"({"type": "point", "intensity": 7, "range": 2})", elsewhere);
    ASSERT_TRUE(point) << detail_of(point);
    EXPECT_EQ(point->power, Rgb::grey(7.0));
    EXPECT_EQ(std::get<PointLight>(point->shape).position, (Point3{5, 6, 7}));
    EXPECT_EQ(std::get<PointLight>(point->shape).range, 2.0);

    const auto spot = light_of(
        R"({"type": "spot", "range": 3, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.8}})",
        elsewhere);
    ASSERT_TRUE(spot) << detail_of(spot);
    EXPECT_EQ(std::get<SpotLight>(spot->shape).range, 3.0);
    EXPECT_EQ(std::get<SpotLight>(spot->shape).position, (Point3{5, 6, 7}));
    EXPECT_EQ(std::get<SpotLight>(spot->shape).inner_cone, 0.2);
    EXPECT_EQ(std::get<SpotLight>(spot->shape).outer_cone, 0.8);
    expect_near(std::get<SpotLight>(spot->shape).axis, {-1, 0, 0});

    const auto sun = light_of(R"({"type": "directional"})", elsewhere);
    ASSERT_TRUE(sun) << detail_of(sun);
    expect_near(std::get<DirectionalLight>(sun->shape).travel, {-1, 0, 0});
    EXPECT_EQ(std::get<DirectionalLight>(sun->shape).half_angle, 0.0);
}

TEST(GltfLight, LooksTheOtherWayUnderAMirror)
{
    const auto sun = light_of(R"({"type": "directional"})", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -2, 0});
    ASSERT_TRUE(sun) << detail_of(sun);
    expect_near(std::get<DirectionalLight>(sun->shape).travel, {0, 0, 1});
}

TEST(GltfLight, NeedsADirectionOnlyIfItHasOne)
{
    constexpr Matrix flat{1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 0, 3};
    EXPECT_TRUE(light_of(R"({"type": "point"})", flat));
    for (const char* light : {R"({"type": "spot"})", R"({"type": "directional"})"}) {
        const auto refused = light_of(light, flat);
        ASSERT_FALSE(refused) << light;
        EXPECT_EQ(refused.error().fault, Fault::MalformedBody);
        EXPECT_NE(refused.error().detail.find("/nodes/7"), std::string::npos);
    }
}

TEST(GltfLight, BeyondTheWorldIsRefused)
{
    for (const double far : {1e16, -1e300, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
        Matrix there = at_home;
        there[7] = far;
        for (const char* light : {R"({"type": "point"})", R"({"type": "spot"})"}) {
            const auto refused = light_of(light, there);
            ASSERT_FALSE(refused) << far;
            EXPECT_EQ(refused.error().fault, Fault::CoordinateTooLarge);
        }
    }
}

TEST(GltfLight, OutOfRangeOrOfAnotherTypeIsRefusedWithItsPlace)
{
    const std::string place = "/extensions/KHR_lights_punctual/lights/0";
    for (const auto& [light, member] :
         {std::pair{R"({"type": "area"})", "/type"},
          {R"({})", "/type"},
          {R"({"type": 1})", "/type"},
          {R"({"type": "point", "name": {}})", "/name"},
          {R"({"type": "point", "intensity": -1})", "/intensity"},
          {R"({"type": "point", "intensity": 1e13})", "/intensity"},
          {R"({"type": "point", "color": [1, 1, 1.5]})", "/color/2"},
          {R"({"type": "point", "color": [1, 1]})", "/color"},
          {R"({"type": "point", "range": 0})", "/range"},
          {R"({"type": "point", "range": -3})", "/range"},
          {R"({"type": "point", "range": "far"})", "/range"},
          {R"({"type": "spot", "spot": []})", "/spot"},
          {R"({"type": "spot", "spot": {"innerConeAngle": -0.1}})", "/spot/innerConeAngle"},
          {R"({"type": "spot", "spot": {"outerConeAngle": 1.6}})", "/spot/outerConeAngle"},
          {R"({"type": "spot", "spot": {"outerConeAngle": 0}})", "/spot"},
          {R"({"type": "spot", "spot": {"innerConeAngle": 0.8}})", "/spot"},
          {R"({"type": "spot", "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.5}})",
           "/spot"}}) {
        const auto refused = light_of(light);
        ASSERT_FALSE(refused) << light;
        EXPECT_NE(refused.error().detail.find(place + member), std::string::npos)
            << refused.error().detail;
    }
}

TEST(GltfLight, ThatIsNotThereIsRefusedWhereItIsAskedFor)
{
    for (const Json& gltf : {lit(R"({"type": "point"})"), gltf_with({})}) {
        const auto refused = test::light_of(gltf, 1, at_home);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().fault, Fault::IndexOutOfRange);
        EXPECT_NE(refused.error().detail.find("/nodes/7"), std::string::npos);
    }
}

TEST(GltfLight, MayOpenToARightAngleThatWasRoundedUpToAFloat)
{
    const auto light = light_of(R"({"type": "spot", "spot": {"outerConeAngle": 1.5707964}})");
    ASSERT_TRUE(light) << detail_of(light);
    EXPECT_EQ(std::get<SpotLight>(light->shape).outer_cone, 0.5 * std::numbers::pi);
}

TEST(GltfLight, HasANameThatAnAnswerCanCarry)
{
    EXPECT_EQ(light_of(R"({"type": "point", "name": ""})")->name, "light_0");
    EXPECT_EQ(light_of(R"({"type": "point", "name": "a\nb"})")->name, "light_0");
    EXPECT_EQ(light_of(R"({"type": "point", "name": ")" + std::string(65, 'x') + "\"}")->name,
              "light_0");
    EXPECT_EQ(light_of(R"({"type": "point", "name": "Lämpchen"})")->name, "Lämpchen");
}

TEST(GltfLight, OfASphereIsReadByTypeAsFiled)  // figures: the file's own JSON
{
    const Json gltf = embedded_gltf("sphere_lights/sphere_lights.gltf");
    const auto saber = test::light_of(gltf, 0, at_home);
    ASSERT_TRUE(saber) << detail_of(saber);
    EXPECT_EQ(saber->name, "Blue Lightsaber");
    EXPECT_EQ(saber->power, (Rgb{0.72, 0.71, 1.0} * 3.0));
    EXPECT_EQ(std::get<SpotLight>(saber->shape).inner_cone, 0.2);
    const auto star = test::light_of(gltf, 1, at_home);
    ASSERT_TRUE(star) << detail_of(star);
    EXPECT_EQ(std::get<PointLight>(star->shape).range, 1000.0);
    const auto arc = test::light_of(gltf, 2, at_home);
    ASSERT_TRUE(arc) << detail_of(arc);
    EXPECT_EQ(arc->power, Rgb::grey(0.9));
    EXPECT_TRUE(std::holds_alternative<DirectionalLight>(arc->shape));
    const auto last = test::light_of(gltf, 3, at_home);
    ASSERT_TRUE(last) << detail_of(last);
    EXPECT_EQ(last->name, "light_3");
    const auto look = look_of(gltf, 1U << 25U);
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_TRUE(look->notes.empty());
}

TEST(GltfLight, OfAGlbIsReadAsFiled)
{
    const std::string glb =
        file_bytes(std::filesystem::path(RELIGHT_TEST_DATA) / "gltf" / "geometry-camera-light.glb");
    const auto spot = attempt(
        glb, [](gltf::File& file) { return gltf::read_light(file, 1, "/nodes/3", at_home); });
    ASSERT_TRUE(spot) << detail_of(spot);
    EXPECT_EQ(spot->name, "Light.001");
    EXPECT_EQ(spot->power.r, 1000.0);
    EXPECT_NEAR(std::get<SpotLight>(spot->shape).outer_cone, 0.6544984579086304, 1e-15);
}

}  // namespace
}  // namespace relight::test
