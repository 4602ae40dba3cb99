#include "core/bsdf/multiscatter.h"

#include <gtest/gtest.h>

#include "core/bsdf/cook_torrance.h"
#include "core/bsdf/fresnel.h"
#include "tests/bsdf/quadrature.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

constexpr double pi = std::numbers::pi;
const FresnelModel white = SchlickF0{Rgb::grey(1.0)};  // F = 1

CookTorrance facets(double alpha_x, double alpha_y, FresnelModel fresnel = white,
                    bool multiscatter = false)
{
    CookTorrance m;
    m.alpha_x = alpha_x;
    m.alpha_y = alpha_y;
    m.fresnel = fresnel;
    m.multiscatter = multiscatter;
    return make_cook_torrance(m);
}

/// Facets with F = 1 of every kind the model has, compensated.
std::vector<CookTorrance> every_lobe(double alpha)
{
    std::vector<CookTorrance> all;
    for (const auto shadowing : {Shadowing::HeightCorrelated, Shadowing::Separable}) {
        CookTorrance m;
        m.alpha_x = m.alpha_y = alpha;
        m.fresnel = white;
        m.multiscatter = true;
        m.shadowing = shadowing;
        all.push_back(make_cook_torrance(m));
        m.distribution = Distribution::Beckmann;
        all.push_back(make_cook_torrance(m));
        m.distribution = Distribution::Gtr;
        for (const double gamma : {0.6, 1.0, 4.0}) {
            m.gamma = gamma;
            all.push_back(make_cook_torrance(m));
        }
    }
    return all;
}
std::string name(const CookTorrance& m)
{
    return "distribution " + std::to_string(static_cast<int>(m.distribution)) + ", shadowing " +
           std::to_string(static_cast<int>(m.shadowing)) + ", gamma " + std::to_string(m.gamma) +
           ", alpha " + std::to_string(m.alpha_x) + ", " + std::to_string(m.alpha_y);
}

double albedo(const CookTorrance& m, Vec3 wo)
{
    return directional_albedo([&](Vec3 wi, Vec3 o) { return f(m, wi, o, {}).value.g; }, wo,
                              m.alpha_x, m.alpha_y);
}

CookTorrance material_of(const json& c)
{
    CookTorrance m;
    m.alpha_x = c.contains("alpha") ? c["alpha"] : c["alpha_x"];
    m.alpha_y = c.contains("alpha") ? c["alpha"] : c["alpha_y"];
    m.fresnel = SchlickF0{Rgb::grey(c.value("f0", 1.0))};
    m.distribution = c["kind"] == "beckmann_F1" ? Distribution::Beckmann : Distribution::Ggx;
    const std::string shadowing = c.value("G2", "height_correlated");
    EXPECT_TRUE(shadowing == "separable" || shadowing == "height_correlated") << shadowing;
    m.shadowing = shadowing == "separable" ? Shadowing::Separable : Shadowing::HeightCorrelated;
    return make_cook_torrance(m);
}
CookTorrance compensated(CookTorrance m)
{
    m.multiscatter = true;
    return make_cook_torrance(m);
}

TEST(Multiscatter, EveryAlbedoTableOfTheOracleAgrees)
{
    const json file = test::oracle("albedo_tables");
    const test::Tolerance tolerance(file["tolerance"]);
    const auto near = [&](double x, const json& expected) {
        EXPECT_TRUE(tolerance.holds(x, expected.get<double>())) << x << " for " << expected;
    };
    std::size_t checked = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        ASSERT_FALSE(c.contains("tolerance"));  // none has its own; if one comes, obey it
        const std::string kind = c["kind"];
        const CookTorrance single = material_of(c), whole = compensated(single);
        if (kind == "ggx_F1_aniso") {  // its table is an average: the quadrature alone is held
            ASSERT_EQ(c["wo"].size(), c["albedo"].size());
            for (std::size_t i = 0; i < c["wo"].size(); ++i) {
                near(albedo(single, test::vec_of(c["wo"][i])), c["albedo"][i]);
            }
        } else if (kind == "ggx_schlick") {
            near(whole.F_avg.r, c["F_avg"]);
            near(whole.lost->F_ms(whole.F_avg).g, c["F_ms"]);
            const double f0 = c["f0"];
            for (std::size_t i = 0; i < c["mu"].size(); ++i) {
                const Vec3 wo = test::direction(c["mu"][i], 0.3);
                const double E = whole.lost->E(wo.z);
                near(albedo(single, wo), c["albedo_single_scatter"][i]);
                near(albedo(whole, wo), c["albedo_kulla_conty"][i]);
                near(albedo(single, wo) * (1.0 + f0 * (1.0 - E) / E), c["albedo_turquin"][i]);
            }
        } else {
            ASSERT_TRUE(kind == "ggx_F1" || kind == "beckmann_F1") << kind;
            ASSERT_EQ(c["mu"].size(), c["albedo"].size());
            for (std::size_t i = 0; i < c["mu"].size(); ++i) {
                near(albedo(single, test::direction(c["mu"][i], 0.3)), c["albedo"][i]);
                near(whole.lost->E(c["mu"][i]), c["albedo"][i]);
            }
            if (kind == "ggx_F1") { near(whole.lost->E_avg(), c["average_albedo"]); }
        }
        ++checked;
    }
    EXPECT_EQ(checked, file["case_count"].get<std::size_t>());
}

/// int f cos_i dwi in plain (cos_i, azimuth): nothing of facets in it, so it wants broad lobes.
double over_directions(const CookTorrance& m, Vec3 wo)
{
    return test::over_interval(
        [&](double t) {
            const double z = t * t * t;  // crowds at grazing
            const auto around = [&](double phi) {
                return f(m, test::direction(z, phi), wo, {}).value.g;
            };
            return test::over_interval(around, 0.0, 2.0 * pi, 80) * z * 3.0 * t * t;
        },
        0.0, 1.0, 40);
}

TEST(Multiscatter, AlbedoIsTheIntegralOverDirections)
{
    for (CookTorrance m : every_lobe(0.4)) {
        m.lost = nullptr;
        SCOPED_TRACE(name(m));
        for (const double c : {0.1, 0.5, 1.0}) {
            const Vec3 wo = test::direction(c, 0.4);
            EXPECT_NEAR(albedo(m, wo), over_directions(m, wo), 2e-5) << "cos_o = " << c;
        }
    }
    const CookTorrance stretched = facets(0.7, 0.3);
    for (const double c : {0.1, 0.5, 1.0}) {
        const Vec3 wo = test::direction(c, 0.4);
        EXPECT_NEAR(albedo(stretched, wo), over_directions(stretched, wo), 2e-5) << c;
    }
}

TEST(Multiscatter, AlbedoOfNarrowLobesIsTheIntegralOverTheirFacets)
{
    for (const double alpha : {1e-3, 0.05}) {
        for (const CookTorrance& m : {facets(alpha, alpha), facets(alpha, 3.0 * alpha)}) {
            SCOPED_TRACE(name(m));
            for (const double c : {0.1, 0.6, 1.0}) {
                const Vec3 wo = test::direction(c, 0.3);
                const double expected = test::over_facets(
                    [&](Vec3 h) {
                        const double u = dot(wo, h);
                        const Vec3 wi = 2.0 * u * h - wo;
                        if (u <= 0.0 || wi.z <= 0.0) { return 0.0; }
                        return f(m, wi, wo, {}).value.g * wi.z * 4.0 * u;
                    },
                    alpha, 128, 0.005);
                EXPECT_NEAR(albedo(m, wo), expected, 2e-5) << "cos_o = " << c;
            }
        }
    }
}

TEST(Multiscatter, TheTableIsTheAlbedoAtEveryAngle)
{
    for (const double alpha : {1e-3, 0.05, 0.3, 1.0}) {
        for (const CookTorrance& m : every_lobe(alpha)) {
            SCOPED_TRACE(name(m));
            CookTorrance single = m;
            single.lost = nullptr;
            for (const double c : {1e-3, 0.013, 0.11, 0.47, 0.83, 1.0}) {
                EXPECT_NEAR(m.lost->E(c), albedo(single, test::direction(c, 0.0)), 3e-4) << c;
            }
        }
    }
}

TEST(Multiscatter, AWhiteFurnaceGetsItsLightBack)
{
    for (const double alpha : {0.05, 0.2, 0.6, 1.0}) {
        std::vector<CookTorrance> lobes = every_lobe(alpha);
        lobes.push_back(facets(0.2 * alpha, alpha, white, true));
        for (const CookTorrance& m : lobes) {
            SCOPED_TRACE(name(m));
            const bool stretched = m.alpha_x != m.alpha_y;
            for (const double c : {0.05, 0.3, 0.7, 1.0}) {
                double share = 0.0;  // of a stretched lobe over the azimuth: as its table is
                const int turns = stretched ? 16 : 1;
                for (int k = 0; k < turns; ++k) {
                    share += albedo(m, test::direction(c, 0.5 * pi * (k + 0.5) / turns)) / turns;
                }
                EXPECT_NEAR(share, 1.0, 2e-3) << "cos_o = " << c;
            }
        }
    }
}

TEST(Multiscatter, WhatItAddsIsReciprocalAndNeverNegative)
{
    const FresnelModel gold = ConductorEtaK{{0.14, 0.37, 1.44}, {3.98, 2.39, 1.60}};
    for (const double alpha : {1e-3, 0.1, 1.0}) {
        std::vector<CookTorrance> lobes = every_lobe(alpha);
        lobes.push_back(facets(alpha, 0.4, gold, true));
        for (const CookTorrance& m : lobes) {
            SCOPED_TRACE(name(m));
            for (const double a : {1e-300, 1e-9, 0.01, 0.4, 1.0}) {
                for (const double b : {1e-12, 0.2, 0.9, 1.0}) {
                    const Rgb there = m.lost->f_ms(a, b, m.F_avg);
                    const Rgb back = m.lost->f_ms(b, a, m.F_avg);
                    EXPECT_NEAR(there.r, back.r, 1e-9);
                    for (const double band : {there.r, there.g, there.b}) {
                        EXPECT_TRUE(std::isfinite(band) && band >= 0.0) << band;
                    }
                    const Vec3 wi = test::direction(a, 1.0), wo = test::direction(b, 2.0);
                    const double whole = f(m, wi, wo, {}).value.g;
                    EXPECT_NEAR(f(m, wo, wi, {}).value.g, whole, 1e-9 * std::max(1.0, whole));
                }
            }
        }
    }
}

TEST(Multiscatter, SmoothFacetsLoseNothing)
{
    for (const double c : {0.3, 0.6, 1.0}) {
        for (const FresnelModel& model :
             {FresnelModel{SchlickF0{}}, FresnelModel{DielectricIor{1.5}},
              FresnelModel{ConductorEtaK{Rgb::grey(0.2), Rgb::grey(3.9)}}}) {
            const CookTorrance m = facets(0.01, 0.01, model, true);
            EXPECT_GT(m.lost->E(c), 0.998);
            EXPECT_NEAR(albedo(m, test::direction(c, 0.0)) / F(model, c).g, 1.0, 0.005);
        }
    }
}

TEST(Multiscatter, ColoursDeepenWithEveryFacetAndWhiteAndBlackStayThemselves)
{
    const CookTorrance m = facets(0.8, 0.8, white, true);
    const MultiscatterTable& table = *m.lost;
    const Rgb F_ms = table.F_ms({0.0, 0.5, 1.0});
    EXPECT_EQ(F_ms.r, 0.0);
    EXPECT_GT(F_ms.g, 0.0);
    EXPECT_LT(F_ms.g, 0.25);  // two facets at least
    EXPECT_NEAR(F_ms.b, 1.0, 1e-12);
    // The series of bounces: F_avg each, of which E_avg leaves.   sum F^(k+1) E (1 - E)^(k-1)
    double series = 0.0, F = 0.5;
    for (int k = 1; k < 100; ++k) {
        F *= 0.5;
        series += F * table.E_avg() * std::pow(1.0 - table.E_avg(), k - 1);
    }
    EXPECT_NEAR(F_ms.g, series, 1e-12);
}

TEST(Multiscatter, EveryMeanFresnelOfTheOracleAgrees)
{
    const json file = test::oracle("fresnel");
    const test::Tolerance tolerance(file["tolerance"]);
    std::size_t checked = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        ASSERT_FALSE(c.contains("tolerance"));
        const std::string type = c["type"];
        FresnelModel model;
        if (type == "schlick") { model = SchlickF0{Rgb::grey(c["f0"])}; }
        if (type == "dielectric") { model = DielectricIor{c["eta_t_over_eta_i"]}; }
        if (type == "conductor") { model = ConductorEtaK{Rgb::grey(c["n"]), Rgb::grey(c["k"])}; }
        EXPECT_TRUE(tolerance.holds(F_avg(model).g, c["F_avg"])) << F_avg(model).g << c["F_avg"];
        ++checked;
    }
    EXPECT_EQ(checked, file["case_count"].get<std::size_t>());
}

TEST(CookTorranceTerms, AreTheFactorsOfFToTheBit)
{
    CookTorrance m = facets(0.3, 0.5, ConductorEtaK{{0.2, 0.9, 1.1}, {3.9, 2.4, 2.2}}, true);
    m.albedo = {0.1, 0.5, 0.9};
    for (const bool compensate : {true, false}) {
        if (!compensate) { m.lost = nullptr; }
        for (const double c : {-0.3, 0.0, 1e-9, 0.2, 1.0}) {
            const Vec3 wi = test::direction(c, 0.7), wo = test::direction(0.6, 2.0);
            const std::vector<BsdfTerm> factors = terms(m, wi, wo, {});
            const auto term = [&](const std::string& wanted) {
                for (const BsdfTerm& t : factors) {
                    if (t.name == wanted) { return t.value; }
                }
                ADD_FAILURE() << "no " << wanted;
                return Rgb{};
            };
            EXPECT_EQ(term("f"), f(m, wi, wo, {}).value);
            EXPECT_EQ(term("f"), term("base") + term("specular") + term("multiscatter"));
            if (c <= 1e-9) { continue; }
            const Rgb specular = term("F") * term("D") * term("G2") / (4.0 * wi.z * wo.z);
            EXPECT_NEAR(term("specular").r / specular.r, 1.0, 1e-12);
            EXPECT_GT(term("G2").g, 0.0);
            EXPECT_LE(term("G2").g, 1.0);
            EXPECT_EQ(term("multiscatter").b > 0.0, compensate);
        }
    }
}

}  // namespace
}  // namespace relight
