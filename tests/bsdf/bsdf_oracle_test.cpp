#include <gtest/gtest.h>

#include "core/bsdf/beckmann.h"
#include "core/bsdf/fresnel.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/material.h"
#include "core/bsdf/smith.h"
#include "tests/bsdf/quadrature.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

void expect_near(const test::Tolerance& tolerance, double x, const json& expected)
{
    EXPECT_TRUE(tolerance.holds(x, expected.get<double>())) << x << " for " << expected;
}

/// Runs `check(case)` on every case of a file; a case it does not know must fail there.
template <class Check>
void every_case(const std::string& name, Check check)
{
    const json file = test::oracle(name);
    const test::Tolerance tolerance(file["tolerance"]);
    std::size_t checked = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        ASSERT_FALSE(c.contains("tolerance"));  // none has its own; if one comes, obey it
        check(c, tolerance);
        ++checked;
    }
    EXPECT_EQ(checked, file["case_count"].get<std::size_t>());
    EXPECT_GT(checked, 0U);
}

TEST(BsdfOracle, EveryFresnelCaseAgrees)
{
    every_case("fresnel", [](const json& c, const test::Tolerance& tolerance) {
        const std::string type = c["type"];
        const auto F = [&](double u) {
            if (type == "schlick") { return fresnel::schlick(c["f0"], u); }
            if (type == "dielectric") { return fresnel::dielectric(c["eta_t_over_eta_i"], u); }
            EXPECT_EQ(type, "conductor");
            return fresnel::conductor(c["n"], c["k"], u);
        };
        ASSERT_EQ(c["cos"].size(), c["F"].size());
        for (std::size_t i = 0; i < c["cos"].size(); ++i) {
            expect_near(tolerance, F(c["cos"][i]), c["F"][i]);
        }
        if (type != "schlick") { expect_near(tolerance, F(1.0), c["f0"]); }
        // F has a square-root corner at the critical angle: panels end there, and crowd toward it.
        const double critical = c.value("critical_cos", 0.0);
        const auto crowded = [&](double t) {
            const double u = critical + (1.0 - critical) * t * t;
            return 2.0 * F(u) * u * (1.0 - critical) * 2.0 * t;
        };
        expect_near(tolerance, critical * critical + test::over_interval(crowded, 0.0, 1.0, 400),
                    c["F_avg"]);
        if (c.contains("F_avg_closed")) {
            expect_near(tolerance, fresnel::schlick_mean(c["f0"]), c["F_avg_closed"]);
        }
        if (c.contains(
                "brewster_cos")) {  // r_p = 0 leaves half of r_s^2 = ((1 - eta^2)/(1 + eta^2))^2
            const double eta2 = std::pow(c["eta_t_over_eta_i"].get<double>(), 2);
            const double r_s = (1.0 - eta2) / (1.0 + eta2);
            EXPECT_TRUE(tolerance.holds(F(c["brewster_cos"]), 0.5 * r_s * r_s));
        }
    });
}

TEST(BsdfOracle, EveryDistributionAndMaskingCaseAgrees)
{
    every_case("ndf_g1", [](const json& c, const test::Tolerance& tolerance) {
        const std::string ndf = c["ndf"];
        const double alpha = c.value("alpha", 0.0);
        const double ax = c.value("alpha_x", alpha), ay = c.value("alpha_y", alpha);
        const double gamma = c.value("gamma", 1.0);
        const auto D = [&](Vec3 m) {
            if (ndf == "ggx") { return ggx::D(m, ax, ay); }
            if (ndf == "beckmann") { return beckmann::D(m, ax, ay); }
            EXPECT_TRUE(ndf == "gtr1" || ndf == "gtr") << ndf;
            return gtr::D(m.z, alpha, gamma);
        };
        const auto G1 = [&](Vec3 w) {
            return smith::G1(
                w.z, ndf == "ggx" ? ggx::Lambda_cos(w, ax, ay) : beckmann::Lambda_cos(w, ax, ay));
        };
        const auto polar = [](double theta) { return Vec3{std::sin(theta), 0.0, std::cos(theta)}; };
        std::size_t checked = 0;
        const auto check_all = [&](const char* at, const char* value, auto direction,
                                   auto function) {
            if (!c.contains(at) || !c.contains(value)) { return; }
            ASSERT_EQ(c[at].size(), c[value].size());
            for (std::size_t i = 0; i < c[at].size(); ++i) {
                expect_near(tolerance, function(direction(c[at][i])), c[value][i]);
                ++checked;
            }
        };
        check_all("theta_m", "D", polar, D);
        check_all("theta_o", "G1", polar, G1);
        check_all("m", "D", test::vec_of, D);
        check_all("w", "G1", test::vec_of, G1);
        EXPECT_GE(checked, 5U);
        if (c.contains("normalisation_D_cos")) {
            const double area = test::over_facets([&](Vec3 m) { return D(m) * m.z; }, alpha, 16);
            EXPECT_NEAR(area, c["normalisation_D_cos"].get<double>(), 1e-6);
        }
        if (c.contains("plain_integral_of_D")) {
            EXPECT_NEAR(test::over_facets(D, alpha, 16), c["plain_integral_of_D"].get<double>(),
                        1e-6);
        }
        if (c.contains("D_max")) { expect_near(tolerance, D(Vec3{0, 0, 1}), c["D_max"]); }
        for (const json& pair : c.value("G1_from_identity", json::array())) {
            expect_near(tolerance, G1(polar(pair[0])), pair[1]);
        }
        for (std::size_t i = 0; i < c.value("G1_rational_walter", json::array()).size(); ++i) {
            const double fit = c["G1_rational_walter"][i];  // another's approximation, within 0.4 %
            EXPECT_NEAR(G1(polar(c["theta_o"][i])), fit, 0.004);
        }
    });
}

Material material_of(const json& c)
{
    const std::string ndf = c["ndf"];
    if (ndf == "lambert") { return Lambert{test::rgb_of(c["albedo"])}; }
    EXPECT_TRUE(ndf == "ggx" || ndf == "beckmann") << ndf;
    CookTorrance m;
    m.distribution = ndf == "ggx" ? Distribution::Ggx : Distribution::Beckmann;
    m.alpha_x = c["alpha_x"];
    m.alpha_y = c["alpha_y"];
    m.shadowing = c["G2"] == "separable" ? Shadowing::Separable : Shadowing::HeightCorrelated;
    const json& fresnel = c["fresnel"];
    const std::string type = fresnel["type"];
    if (type == "one") { m.fresnel = SchlickF0{Rgb::grey(1.0)}; }
    if (type == "schlick") { m.fresnel = SchlickF0{test::rgb_of(fresnel["f0"])}; }
    if (type == "dielectric") { m.fresnel = DielectricIor{fresnel["eta"]}; }
    if (type == "conductor") {
        m.fresnel = ConductorEtaK{test::rgb_of(fresnel["n"]), test::rgb_of(fresnel["k"])};
    }
    return make_cook_torrance(m);
}

TEST(BsdfOracle, EveryMicrofacetCaseAgrees)
{
    every_case("brdf_microfacet", [](const json& c, const test::Tolerance& tolerance) {
        const Material material = material_of(c);
        ASSERT_EQ(c["wi"].size(), c["f_r"].size());
        ASSERT_GT(c["f_r"].size(), 0U);
        for (std::size_t i = 0; i < c["f_r"].size(); ++i) {
            const Rgb value =
                f(material, test::vec_of(c["wi"][i]), test::vec_of(c["wo"][i]), {}).value;
            const json& expected = c["f_r"][i];
            expect_near(tolerance, value.r, expected.is_array() ? expected[0] : expected);
            expect_near(tolerance, value.g, expected.is_array() ? expected[1] : expected);
            expect_near(tolerance, value.b, expected.is_array() ? expected[2] : expected);
        }
    });
}

}  // namespace
}  // namespace relight
