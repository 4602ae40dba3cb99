#include "core/bsdf/metallic_roughness.h"
#include "core/bsdf/principled.h"
#include "tests/bsdf/models.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

Principled principled_of(const json& j)
{
    Principled m;
    m.base_color = test::rgb_of(j.at("baseColor"));
    m.metallic = j.at("metallic");
    m.subsurface = j.at("subsurface");
    m.specular = j.at("specular");
    m.roughness = j.at("roughness");
    m.specular_tint = j.at("specularTint");
    m.anisotropic = j.at("anisotropic");
    m.sheen = j.at("sheen");
    m.sheen_tint = j.at("sheenTint");
    m.clearcoat = j.at("clearcoat");
    m.clearcoat_gloss = j.at("clearcoatGloss");
    EXPECT_EQ(j.size(), 11U);  // nothing that we do not read
    return m;
}

MetallicRoughness metallic_roughness_of(const json& j)
{
    MetallicRoughness m;
    m.base_color = test::rgb_of(j.at("baseColor"));
    m.metallic = j.at("metallic");
    m.roughness = j.at("roughness");
    EXPECT_EQ(j.size(), 3U);
    return m;
}

void expect_within(const test::Tolerance& tolerance, Rgb x, Rgb expected)
{
    EXPECT_TRUE(tolerance.holds(x.r, expected.r)) << x.r << " for " << expected.r;
    EXPECT_TRUE(tolerance.holds(x.g, expected.g)) << x.g << " for " << expected.g;
    EXPECT_TRUE(tolerance.holds(x.b, expected.b)) << x.b << " for " << expected.b;
}

/// Runs `check(case, tolerance)` on every case of a file.
template <class Check>
void every_case(const std::string& name, Check check)
{
    const json file = test::oracle(name);
    const test::Tolerance common(file.at("tolerance"));
    for (const json& c : file.at("cases")) {
        SCOPED_TRACE(c.at("id").get<std::string>());
        check(c, c.contains("tolerance") ? test::Tolerance(c["tolerance"]) : common);
    }
    EXPECT_EQ(file.at("cases").size(), file.at("case_count").get<std::size_t>());
    EXPECT_GT(file.at("cases").size(), 0U);
}

template <class Model>
void expect_values(const json& c, const Model& model, const test::Tolerance& tolerance)
{
    ASSERT_GT(c.at("wi").size(), 0U);
    ASSERT_EQ(c.at("wi").size(), c.at("wo").size());
    ASSERT_EQ(c.at("wi").size(), c.at("f_r").size());
    for (std::size_t i = 0; i < c.at("wi").size(); ++i) {
        const Rgb value = f(model, test::vec_of(c["wi"][i]), test::vec_of(c["wo"][i]), {}).value;
        expect_within(tolerance, value, test::rgb_of(c["f_r"][i]));
    }
}

TEST(ModelOracle, EveryDisneyCaseAgrees)
{
    every_case("brdf_disney", [](const json& c, const test::Tolerance& tolerance) {
        expect_values(c, principled_of(c.at("params")), tolerance);
    });
}

TEST(ModelOracle, EveryGltfCaseAgrees)
{
    every_case("brdf_gltf", [](const json& c, const test::Tolerance& tolerance) {
        expect_values(c, metallic_roughness_of(c.at("params")), tolerance);
    });
}

template <class Model>
double expect_albedos(const json& c, const Model& model, const test::Tolerance& tolerance)
{
    double brightest = 0.0;
    for (std::size_t i = 0; i < c.at("mu").size(); ++i) {
        const Rgb share = test::albedo(model, test::direction(c["mu"][i], 0.0));
        expect_within(tolerance, share, test::rgb_of(c.at("albedo").at(i)));
        brightest = std::max({brightest, share.r, share.g, share.b});
    }
    return brightest;
}

TEST(ModelOracle, EveryAlbedoAgreesAboveOneToo)  // white furnace; neither model conserves energy
{
    double gltf = 0.0, disney = 0.0;
    every_case("albedo_materials", [&](const json& c, const test::Tolerance& tolerance) {
        const json& params = c.at("params");
        if (c.at("model") == "gltf") {
            gltf = std::max(gltf, expect_albedos(c, metallic_roughness_of(params), tolerance));
        } else {
            ASSERT_EQ(c.at("model"), "disney");
            disney = std::max(disney, expect_albedos(c, principled_of(params), tolerance));
        }
    });
    const json checks = test::oracle("albedo_materials").at("generator_checks");
    EXPECT_NEAR(gltf, checks.at("max_albedo_gltf").get<double>(), 1e-3);
    EXPECT_NEAR(disney, checks.at("max_albedo_disney").get<double>(), 1e-3);
}

}  // namespace
}  // namespace relight
