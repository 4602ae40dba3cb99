#include "core/bsdf/charlie.h"
#include "core/bsdf/lambert.h"
#include "core/bsdf/metallic_roughness.h"
#include "core/bsdf/roughness.h"
#include "tests/bsdf/models.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 up{0.0, 0.0, 1.0};

MetallicRoughness cloth(double sheen_roughness, Rgb sheen_color = Rgb::grey(1.0))
{
    MetallicRoughness m;
    m.metallic = m.specular = 0.0;  // over a white Lambertian base
    m.sheen_color = sheen_color;
    m.sheen_roughness = sheen_roughness;
    return m;
}

/// int D V cos_i dwi in Gauss panels of cos_i = t^4 and phi: another rule than the table's.
double reflected_share(double cos_o, double alpha)
{
    const Vec3 wo = test::direction(cos_o, 0.0);
    const auto ring = [&](double cos_i) {
        const auto at = [&](double phi) {
            return charlie::D(normalize(test::direction(cos_i, phi) + wo), alpha);
        };
        return 2.0 * test::over_interval(at, 0.0, pi, 12) * charlie::V(cos_i, cos_o, alpha) * cos_i;
    };
    return test::over_interval([&](double t) { return ring(t * t * t * t) * 4.0 * t * t * t; }, 0.0,
                               1.0, 16);
}

TEST(Charlie, DistributionIntegratesToOneOverTheProjectedHemisphere)
{
    for (const double alpha : {least_alpha, 0.01, 0.1, 0.5, 1.0}) {
        const auto at = [&](double theta) {
            const Vec3 m = test::direction(std::cos(theta), 1.0);
            return 2.0 * pi * charlie::D(m, alpha) * std::cos(theta) * std::sin(theta);
        };
        EXPECT_NEAR(test::over_interval(at, 0.0, 0.5 * pi, 60), 1.0, 1e-9) << alpha;
    }
}

/// Projected area is conserved, as for any distribution. The fit is loose where fibres are narrow.
TEST(Charlie, LambdaIsNearTheIntegralOfD)
{
    struct Bound {
        double alpha, ratio;
    };
    for (const auto [alpha, ratio] :
         {Bound{0.04, 1.6}, Bound{0.25, 1.2}, Bound{0.5, 1.12}, Bound{1.0, 1.05}}) {
        const double width = alpha;
        for (const double cos_w : {0.2, 0.5, 0.8}) {
            const Vec3 w = test::direction(cos_w, 0.0);
            const double hidden =
                test::hidden_area([&](Vec3 m) { return charlie::D(m, width); }, w, 1.0);
            const double off = charlie::Lambda(cos_w, alpha) / (hidden / cos_w);
            EXPECT_LT(std::max(off, 1.0 / off), ratio) << alpha << ' ' << cos_w;
        }
        EXPECT_NEAR(charlie::Lambda(std::nextafter(0.5, 0.0), alpha), charlie::Lambda(0.5, alpha),
                    1e-12);
    }
}

TEST(Charlie, AlbedoTableIsTheIntegralOfTheLobe)
{
    for (const double roughness : {0.0, 0.07, 0.11, 0.21, 0.33, 0.52, 0.73, 1.0}) {
        const double alpha = alpha_from_roughness(roughness);
        for (const double cos_o : {1e-3, 0.011, 0.047, 0.13, 0.29, 0.61, 0.93, 1.0}) {
            EXPECT_NEAR(charlie::E(cos_o, alpha), std::min(1.0, reflected_share(cos_o, alpha)),
                        2e-3)
                << "roughness " << roughness << ", cos " << cos_o;
        }
    }
}

TEST(Sheen, IsAbsentWithoutAColour)
{
    MetallicRoughness plain = cloth(0.5, {}), without = plain;
    without.sheen_roughness = 0.0;
    const Vec3 wi = test::direction(0.4, 0.0), wo = test::direction(0.7, 2.0);
    EXPECT_EQ(f(plain, wi, wo, {}), f(without, wi, wo, {}));
    EXPECT_EQ(f(plain, wi, wo, {}), f(Lambert{Rgb::grey(1.0)}, wi, wo, {}));
}

/// With E of the lobe itself at most 1 (fibres of roughness .3 and up), what sheen takes from a
/// white base is never less than what it adds.
TEST(Sheen, OverAWhiteBaseReflectsNoMoreThanItReceives)
{
    for (const double roughness : {0.3, 0.5, 0.8, 1.0}) {
        for (const double cos_o : {0.01, 0.05, 0.3, 0.7, 1.0}) {
            const Vec3 wo = test::direction(cos_o, 0.4);
            const double share = test::albedo(cloth(roughness), wo).g;
            EXPECT_LE(share, 1.0 + 3e-3) << roughness << ' ' << cos_o;
            EXPECT_GT(share, 0.7) << roughness << ' ' << cos_o;  // not by being dark
        }
    }
}

/// The published fit reflects up to six times what reaches narrow fibres at grazing. It stays, but
/// the base below is then black, not negative.
TEST(Sheen, OfNarrowFibresIsTooBrightAtGrazingAsPublished)
{
    const Vec3 wo = test::direction(0.01, 0.4);
    EXPECT_GT(reflected_share(wo.z, alpha_from_roughness(0.1)), 1.5);
    const std::vector<BsdfTerm> all = terms(cloth(0.1), up, wo, {});
    EXPECT_EQ(test::term(all, "diffuse"), Rgb{});
}

TEST(Sheen, TakesFromEveryBandWhatItsStrongestAdds)
{
    const Vec3 wi = test::direction(0.3, 0.0), wo = test::direction(0.6, 2.0);
    const Rgb color{0.2, 0.8, 0.4};
    const std::vector<BsdfTerm> all = terms(cloth(0.5, color), wi, wo, {});
    const Rgb sheen = test::term(all, "sheen");
    test::expect_near(sheen / sheen.g, color / 0.8, 1e-12);
    // wi is nearer the plane, where fibres reflect most: it decides.
    const double kept = 1.0 - 0.8 * reflected_share(0.3, 0.25);
    EXPECT_NEAR(test::term(all, "diffuse").r * pi, kept, 2e-3);
    EXPECT_EQ(test::term(all, "diffuse").r, test::term(all, "diffuse").b);
}

TEST(Sheen, IsMasked)
{
    const Vec3 wi = test::direction(0.3, 0.0), wo = test::direction(0.6, 2.0);
    const double alpha = alpha_from_roughness(0.5);
    const double G2 = 1.0 / (1.0 + charlie::Lambda(0.3, alpha) + charlie::Lambda(0.6, alpha));
    const double D = charlie::D(normalize(wi + wo), alpha);
    test::expect_near(test::term(terms(cloth(0.5), wi, wo, {}), "sheen"),
                      Rgb::grey(D * G2 / (4.0 * 0.3 * 0.6)), 1e-12);
}

TEST(Sheen, LiesUnderTheClearCoat)
{
    const Vec3 wi = test::direction(0.3, 0.0), wo = test::direction(0.6, 2.0);
    MetallicRoughness coated = cloth(0.5);
    const Rgb bare = test::term(terms(coated, wi, wo, {}), "sheen");
    coated.clearcoat = 1.0;
    const double Fc = 0.04 + 0.96 * std::pow(0.4, 5);
    test::expect_near(test::term(terms(coated, wi, wo, {}), "sheen"), bare * (1.0 - Fc), 1e-12);
}

}  // namespace
}  // namespace relight
