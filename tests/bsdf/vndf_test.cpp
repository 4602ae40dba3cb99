#include "core/bsdf/vndf.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/smith.h"
#include "tests/bsdf/quadrature.h"
#include "tests/chi2.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

Sample2 random2(std::uint64_t seed, int i)
{
    const auto sample = static_cast<std::uint64_t>(i);
    return {uniform(seed, 0, sample, 0), uniform(seed, 0, sample, 1)};
}

Vec3 reflect(Vec3 w, Vec3 m)
{
    return 2.0 * dot(w, m) * m - w;
}

struct Setting {
    double alpha_x, alpha_y;
    Vec3 wo;
};
/// Narrow, broad and stretched lobes, from straight above to nearly in the plane.
std::vector<Setting> settings()
{
    std::vector<Setting> all;
    for (const auto& [ax, ay] : {std::pair{0.05, 0.05}, {0.3, 0.3}, {1.0, 1.0}, {0.1, 0.6}}) {
        for (const double c : {1.0, 0.7, 0.2, 0.02}) {
            all.push_back({ax, ay, test::direction(c, 2.5)});
        }
    }
    return all;
}
std::string name(const Setting& s)
{
    return "alpha = " + std::to_string(s.alpha_x) + ", " + std::to_string(s.alpha_y) +
           ", cos_o = " + std::to_string(s.wo.z);
}

TEST(Vndf, EveryOracleSampleAgrees)
{
    const json file = test::oracle("vndf_sampling");
    const test::Tolerance tolerance(file["tolerance"]);
    std::size_t checked = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        ASSERT_FALSE(c.contains("tolerance"));  // none has its own; if one comes, obey it
        const double ax = c["alpha_x"], ay = c["alpha_y"];
        const Vec3 wo = test::vec_of(c["wo"]);
        ASSERT_FALSE(c["samples"].empty());
        for (const json& s : c["samples"]) {
            const Vec3 m = vndf::sample(wo, ax, ay, {s["u"][0], s["u"][1]});
            const Vec3 wi = reflect(wo, m);
            for (const auto& [x, expected] :
                 {std::pair{m, test::vec_of(s["wm"])}, {wi, test::vec_of(s["wi"])}}) {
                EXPECT_TRUE(tolerance.holds(x.x, expected.x)) << x.x << " for " << expected.x;
                EXPECT_TRUE(tolerance.holds(x.y, expected.y)) << x.y << " for " << expected.y;
                EXPECT_TRUE(tolerance.holds(x.z, expected.z)) << x.z << " for " << expected.z;
            }
            EXPECT_TRUE(tolerance.holds(vndf::D_visible(wo, m, ax, ay), s["D_visible"]));
            EXPECT_TRUE(tolerance.holds(vndf::pdf_wi(wo, wi, ax, ay), s["pdf_wi"]));
        }
        ++checked;
    }
    EXPECT_EQ(checked, file["case_count"].get<std::size_t>());
}

TEST(Vndf, MomentsOfItsSamplesAreTheOraclesWithinFourStandardErrors)
{
    const json file = test::oracle("vndf_sampling");
    constexpr int n = 20000;
    int beyond_3 = 0, moments = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        const Vec3 wo = test::vec_of(c["wo"]);
        std::array<double, 6> sum{}, squares{};
        for (int i = 0; i < n; ++i) {
            const Vec3 m = vndf::sample(wo, c["alpha_x"], c["alpha_y"], random2(17, i));
            const std::array<double, 6> x{m.x, m.y, m.z, m.x * m.x, m.y * m.y, m.z * m.z};
            for (std::size_t k = 0; k < 6; ++k) {
                sum[k] += x[k];
                squares[k] += x[k] * x[k];
            }
        }
        for (std::size_t k = 0; k < 6; ++k) {
            const double expected = k < 3 ? c["mean_wm"][k] : c["mean_wm_squared"][k - 3];
            const double mean = sum[k] / n;
            const double error = std::sqrt((squares[k] / n - mean * mean) / n);
            EXPECT_LE(std::abs(mean - expected), 4.0 * error) << "moment " << k;
            beyond_3 += std::abs(mean - expected) > 3.0 * error ? 1 : 0;
            ++moments;
        }
    }
    EXPECT_LE(beyond_3, std::max(2, moments / 100));
}

TEST(Vndf, EveryHalfVectorJacobianOfTheOracleTurnsFacetsIntoDirections)
{
    const json file = test::oracle("mis_units_jacobian");
    const test::Tolerance tolerance(file["tolerance"]);
    int checked = 0;
    for (const json& c : file["cases"]) {
        if (c["kind"] != "half_vector_jacobian") { continue; }
        SCOPED_TRACE(c["id"].get<std::string>());
        ASSERT_FALSE(c.contains("tolerance"));
        const Vec3 wi = test::vec_of(c["wi"]), wo = test::vec_of(c["wo"]);
        const double per_facet = vndf::D_visible(wo, normalize(wi + wo), 0.5, 0.3);
        const double jacobian = vndf::pdf_wi(wo, wi, 0.5, 0.3) / per_facet;
        EXPECT_TRUE(tolerance.holds(jacobian, c["dwh_dwi"]));
        EXPECT_TRUE(tolerance.holds(jacobian, c["numeric"]));
        ++checked;
    }
    EXPECT_GT(checked, 0);
}

TEST(Vndf, NormalsAndMirroredDirectionsFollowTheirDensities)
{
    std::uint64_t seed = 200;
    for (const Setting& s : settings()) {
        SCOPED_TRACE(name(s));
        ++seed;
        const auto normal = [&](int i) {
            return vndf::sample(s.wo, s.alpha_x, s.alpha_y, random2(seed, i));
        };
        const auto facets = test::chi2_directions(
            normal, [&](Vec3 m) { return vndf::D_visible(s.wo, m, s.alpha_x, s.alpha_y); }, 20000);
        EXPECT_GT(facets.p, 1e-3) << facets.statistic << " of " << facets.degrees;
        EXPECT_NEAR(facets.integral, 1.0, 3e-4);

        const auto pdf = [&](Vec3 wi) { return vndf::pdf_wi(s.wo, wi, s.alpha_x, s.alpha_y); };
        const auto mirrored =
            test::chi2_directions([&](int i) { return reflect(s.wo, normal(i)); }, pdf, 20000);
        EXPECT_GT(mirrored.p, 1e-3) << mirrored.statistic << " of " << mirrored.degrees;
        EXPECT_NEAR(mirrored.integral, 1.0, 1e-3);  // it has an edge; the furnace below is finer
        const auto above = test::chi2_directions(
            [&](int i) {
                const Vec3 wi = reflect(s.wo, normal(i));
                return wi.z > 0.0 ? wi : Vec3{};
            },
            [&](Vec3 wi) { return wi.z > 0.0 ? pdf(wi) : 0.0; }, 20000);
        EXPECT_LE(above.integral, 1.0 + 1e-3);
        EXPECT_GT(above.p, 1e-3) << above.statistic << " of " << above.degrees;
    }
}

TEST(Vndf, DensityOfMirroredDirectionsIsOneOverTheSphereAndLessAboveTheSurface)
{
    // Weak white furnace. It ends at wi.z = -wo.z, below which h is under the surface, and peaks at
    // azimuth pi (wo's is 0), where h has no limit as wi nears -wo: nodes crowd to both.
    const auto furnace = [](double alpha, Vec3 wo, double lowest) {
        const auto at_height = [&](double z) {
            const auto half_turn = [&](double t) {
                const Vec3 wi = test::direction(z, std::numbers::pi * (1.0 - t * t * t));
                return vndf::pdf_wi(wo, wi, alpha, alpha) * 3.0 * std::numbers::pi * t * t;
            };
            return 2.0 * test::over_interval(half_turn, 0.0, 1.0, 60);
        };
        const auto height = [&](double t) {
            const double reach = 1.0 - lowest;
            return at_height(lowest + reach * t * t) * 2.0 * reach * t;
        };
        return test::over_interval(height, 0.0, 1.0, 150);
    };
    for (const double alpha : {0.05, 0.2, 1.0}) {
        for (const double cos_o : {0.2, 0.7, 0.98}) {
            SCOPED_TRACE(testing::Message() << "alpha = " << alpha << ", cos_o = " << cos_o);
            const Vec3 wo = test::direction(cos_o, 0.0);
            EXPECT_NEAR(furnace(alpha, wo, -cos_o), 1.0, 1e-4);
            EXPECT_LE(furnace(alpha, wo, 0.0), 1.0);
        }
    }
}

TEST(Vndf, ItsEstimateOfAMirrorLobeNeverWeighsMoreThanOne)  // G2 / G1(wo)
{
    for (const Setting& s : settings()) {
        SCOPED_TRACE(name(s));
        for (int i = 0; i < 200; ++i) {
            const Vec3 m = vndf::sample(s.wo, s.alpha_x, s.alpha_y, random2(5, i));
            const Vec3 wi = reflect(s.wo, m);
            if (wi.z <= 0.0) { continue; }
            const double V =
                smith::V_height_correlated(wi.z, ggx::Lambda_cos(wi, s.alpha_x, s.alpha_y), s.wo.z,
                                           ggx::Lambda_cos(s.wo, s.alpha_x, s.alpha_y));
            const double lobe = ggx::D(m, s.alpha_x, s.alpha_y) * V * wi.z;
            EXPECT_LE(lobe / vndf::pdf_wi(s.wo, wi, s.alpha_x, s.alpha_y), 1.0 + 1e-9);
        }
    }
}

TEST(Vndf, StaysFiniteAndUnitAtTheEdges)
{
    constexpr double last = 1.0 - 0x1p-53;
    for (const double alpha : {1e-3, 1.0}) {
        for (const Vec3 wo : {Vec3{0, 0, 1}, test::direction(1e-12, 1.0), Vec3{1, 0, 1e-300},
                              Vec3{1e-200, 0, 1}, Vec3{0, 1, 0}, Vec3{0, 0, -1}}) {
            for (const double u : {0.0, 0.5, last}) {
                for (const double v : {0.0, 0.25, 0.5, 0.75, last}) {
                    const Vec3 m = vndf::sample(wo, alpha, alpha, {u, v});
                    EXPECT_NEAR(length(m), 1.0, 1e-12) << wo.z << ' ' << u << ' ' << v;
                    EXPECT_GE(m.z, 0.0);
                    for (const Vec3 wi : {reflect(wo, m), -wo, wo}) {
                        const double p = vndf::pdf_wi(wo, wi, alpha, alpha);
                        EXPECT_TRUE(std::isfinite(p) && p >= 0.0) << p;
                    }
                }
            }
        }
    }
}

TEST(Gtr, NormalsAreDrawnFromTheirDistribution)
{
    std::uint64_t seed = 100;
    for (const double alpha : {0.05, 0.4, 1.0 - 1e-9, 1.0}) {
        for (const double gamma : {0.3, 1.0, 1.0 + 1e-9, 2.0, 60.0}) {
            SCOPED_TRACE(testing::Message() << "alpha = " << alpha << ", gamma = " << gamma);
            ++seed;
            const auto result = test::chi2_directions(
                [&](int i) { return gtr::sample(alpha, gamma, random2(seed, i)); },
                [&](Vec3 m) { return gtr::D(m.z, alpha, gamma) * std::max(0.0, m.z); }, 20000);
            EXPECT_GT(result.p, 1e-3) << result.statistic << " of " << result.degrees;
            EXPECT_NEAR(result.integral, 1.0, 1e-4);
        }
    }
}

TEST(Chi2, TellsAWrongSamplerFromARightOne)
{
    // A fifth too many to the north, an even draw where the density leans, a lobe a little too
    // broad.
    const auto ball = [](Sample2 s, double north) {
        const double z = s.u < north ? s.u / north : (s.u - north) / (1.0 - north) - 1.0;
        return test::direction(z, 2.0 * std::numbers::pi * s.v);
    };
    const auto even = [](Vec3) { return 0.25 * std::numbers::inv_pi; };
    constexpr int n = 20000;
    const auto right =
        test::chi2_directions([&](int i) { return ball(random2(1, i), 0.5); }, even, n);
    EXPECT_GT(right.p, 1e-3);
    EXPECT_NEAR(right.integral, 1.0, 1e-9);
    EXPECT_LT(test::chi2_directions([&](int i) { return ball(random2(1, i), 0.6); }, even, n).p,
              1e-6);
    EXPECT_LT(
        test::chi2_directions([&](int i) { return ball(random2(1, i), 0.5); },
                              [&](Vec3 w) { return w.x > 0.0 ? 1.5 * even(w) : 0.5 * even(w); }, n)
            .p,
        1e-6);
    const Vec3 wo = test::direction(0.5, 0.0);
    const auto lobe = [&](double alpha) {
        return test::chi2_directions(
            [&](int i) { return vndf::sample(wo, alpha, alpha, random2(7, i)); },
            [&](Vec3 m) { return vndf::D_visible(wo, m, 0.05, 0.05); }, n);
    };
    EXPECT_GT(lobe(0.05).p, 1e-3);
    EXPECT_LT(lobe(0.06).p, 1e-6);
}

TEST(Chi2, RefusesASamplerThatGivesOnlyAPoleOrNoDirection)
{
    const auto even = [](Vec3) { return 0.25 * std::numbers::inv_pi; };
    for (const Vec3 w :
         {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, -1e-300, 0}, Vec3{}, Vec3{std::nan(""), 0, 0}}) {
        const auto result = test::chi2_directions([&](int) { return w; }, even, 1000);
        EXPECT_EQ(result.p, 0.0) << w.x << ' ' << w.y << ' ' << w.z;
        EXPECT_NEAR(result.integral, 1.0, 1e-9);
    }
}

TEST(Chi2, ItsTailIsTheIncompleteGammaFunction)
{
    // Q(1/2, x) = erfc(sqrt x), Q(1, x) = exp(-x), Q(a + 1, x) = Q(a, x) + x^a exp(-x)/Gamma(a + 1)
    for (const double x : {1e-3, 0.3, 1.0, 4.0, 30.0, 200.0}) {
        EXPECT_NEAR(test::gamma_q(0.5, x), std::erfc(std::sqrt(x)), 1e-13);
        EXPECT_NEAR(test::gamma_q(1.0, x), std::exp(-x), 1e-13);
        for (const double a : {2.5, 40.0, 150.0}) {
            const double step = std::exp(a * std::log(x) - x - std::lgamma(a + 1.0));
            EXPECT_NEAR(test::gamma_q(a + 1.0, x), test::gamma_q(a, x) + step, 1e-12);
        }
    }
}

}  // namespace
}  // namespace relight
