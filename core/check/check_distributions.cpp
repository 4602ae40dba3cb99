#include <cmath>
#include <numbers>

#include "core/bsdf/beckmann.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/smith.h"
#include "core/bsdf/vndf.h"
#include "core/check/cases.h"
#include "core/check/quadrature.h"

// Facets: their distribution D, what of them is seen (G1), and the change from facet normals to
// directions of light (the Jacobian).

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

std::string number(double x)
{
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

/// One isotropic lobe: its distribution, and the masking that goes with it.
struct Lobe {
    std::string name;
    double alpha;
    std::function<double(double cos_m)> D;
    std::function<double(Vec3 w)> hidden;  ///< Lambda(w) cos(w)
};

Lobe beckmann_lobe(double alpha)
{
    return {"Beckmann, alpha " + number(alpha), alpha,
            [=](double c) { return beckmann::D(c, alpha); },
            [=](Vec3 w) { return beckmann::Lambda_cos(w, alpha, alpha); }};
}
Lobe ggx_lobe(double alpha)
{
    return {"GGX, alpha " + number(alpha), alpha, [=](double c) { return ggx::D(c, alpha); },
            [=](Vec3 w) { return ggx::Lambda_cos(w, alpha, alpha); }};
}
Lobe gtr_lobe(double alpha, double gamma)
{
    return {"GTR of exponent " + number(gamma) + ", alpha " + number(alpha), alpha,
            [=](double c) { return gtr::D(c, alpha, gamma); },
            [masking = gtr::Masking(alpha, gamma)](Vec3 w) { return masking.Lambda_cos(w); }};
}

/// int over facets around a ring: slope r = tan(theta) of their normals, dw = cos^3 r dr dphi.
double over_facets(const Lobe& lobe, const std::function<double(double cos_m, double sin_m)>& ring)
{
    return quadrature::over_positive(
        [&](double r) {
            const double c = 1.0 / std::sqrt(1.0 + r * r);
            return lobe.D(c) * ring(c, r * c) * c * c * c * r;
        },
        lobe.alpha);
}

void check_normals(Cases& cases)
{
    cases.group("D", "1");
    std::vector<Lobe> lobes;
    for (const double alpha : {0.01, 0.1, 0.5, 1.0}) {
        lobes.push_back(beckmann_lobe(alpha));
        lobes.push_back(ggx_lobe(alpha));
        lobes.push_back(gtr_lobe(alpha, 1.0));
    }
    lobes.push_back(gtr_lobe(0.3, 0.5));
    lobes.push_back(gtr_lobe(0.3, 1.5));
    lobes.push_back(gtr_lobe(0.3, 3.0));
    for (const Lobe& lobe : lobes) {
        cases.relative("facets of " + lobe.name + " project to the surface", "int D cos dw = 1",
                       1.0, over_facets(lobe, [](double c, double) { return 2.0 * pi * c; }));
    }
    for (const bool is_ggx : {true, false}) {
        const double ax = 0.2, ay = 0.6;
        const double area = quadrature::over_positive(
            [&](double r) {
                const double c = 1.0 / std::sqrt(1.0 + r * r);
                double sum = 0.0;
                constexpr int turns = 256;
                for (int j = 0; j < turns; ++j) {
                    const Vec3 m = quadrature::direction(c, 2.0 * pi * j / turns);
                    sum += is_ggx ? ggx::D(m, ax, ay) : beckmann::D(m, ax, ay);
                }
                return sum * 2.0 * pi / turns * c * c * c * c * r;
            },
            ay, 0.1);
        cases.relative(std::string("facets of anisotropic ") + (is_ggx ? "GGX" : "Beckmann") +
                           ", alpha 0.2 and 0.6, project to the surface",
                       "int D cos dw = 1", 1.0, area);
    }
    cases.group("D", "1/sr");
    cases.relative("GGX at its peak, alpha 0.1", "D(1) = 1 / (pi alpha^2)", 1.0 / (pi * 0.01),
                   ggx::D(1.0, 0.1), 1e-12);
    cases.relative("Beckmann at 45 degrees, alpha 0.5",
                   "D = exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4)", std::exp(-4.0) * 16.0 / pi,
                   beckmann::D(std::sqrt(0.5), 0.5), 1e-12);
    cases.relative("GTR of exponent 2 is GGX", "a^2 / (pi (1 + (a^2 - 1) cos^2)^2)",
                   0.09 / (pi * std::pow(1.0 - 0.91 * 0.64, 2)), gtr::D(0.8, 0.3, 2.0), 1e-12);
    cases.relative("GTR of exponent 1", "(a^2 - 1) / (pi ln a^2 (1 + (a^2 - 1) cos^2))",
                   (0.09 - 1.0) / (pi * std::log(0.09) * (1.0 - 0.91 * 0.64)),
                   gtr::D(0.8, 0.3, 1.0), 1e-12);
    cases.relative("GTR of width 1 is even", "D = 1 / pi", 1.0 / pi, gtr::D(0.4, 1.0, 1.3), 1e-12);
}

void check_masking(Cases& cases)
{
    cases.group("G1", "1");
    for (const Lobe& lobe : {beckmann_lobe(0.1), beckmann_lobe(0.5), ggx_lobe(0.1), ggx_lobe(0.5),
                             ggx_lobe(1.0), gtr_lobe(0.3, 1.0), gtr_lobe(0.3, 1.5)}) {
        for (const double degrees : {45.0, 80.0}) {
            const double angle = degrees * pi / 180.0;
            const double c = std::cos(angle), s = std::sin(angle);
            // Facets that face wo, however many, are seen as cos(wo) of area.
            const double facing = over_facets(lobe, [&](double cos_m, double sin_m) {
                return quadrature::positive_turn(c * cos_m, s * sin_m);
            });
            cases.relative("seen share of " + lobe.name + ", at " + number(degrees) + " degrees",
                           "G1 = cos / int (wo.m)+ D dm", c / facing,
                           smith::G1(c, lobe.hidden({s, 0, c})));
        }
    }
    const double c = std::cos(1.2), t = std::tan(1.2);
    cases.relative("GGX, alpha 0.4, by its closed form", "G1 = 2 / (1 + sqrt(1 + alpha^2 tan^2))",
                   2.0 / (1.0 + std::sqrt(1.0 + 0.16 * t * t)),
                   smith::G1(c, ggx::Lambda_cos({std::sin(1.2), 0, c}, 0.4, 0.4)), 1e-12);
    cases.relative("all is seen from straight above", "G1 = 1", 1.0,
                   smith::G1(1.0, ggx::Lambda_cos({0, 0, 1}, 0.4, 0.4)), 1e-12);
    const Vec3 grazing = quadrature::direction(1e-9, 0.3);
    cases.absolute("nothing is seen from the side", "G1 -> 0", 0.0,
                   smith::G1(grazing.z, ggx::Lambda_cos(grazing, 0.4, 0.4)), 1e-8);
    for (const double alpha : {0.1, 0.5, 1.0}) {
        const Vec3 wo = quadrature::direction(0.6, 0.2);
        const auto facets = [&](Vec3 wi) {
            const Vec3 h = normalize(wi + wo);
            const double G = smith::G1(wo.z, ggx::Lambda_cos(wo, alpha, alpha));
            return G * ggx::D(h.z, alpha) / (4.0 * wo.z);
        };
        // D ends abruptly where h lies in the surface.
        const double sphere = quadrature::over_zone(facets, -wo.z, 0.9, 60, 480) +
                              quadrature::over_zone(facets, 0.9, 1.0, 20, 480);
        cases.relative("weak white furnace of GGX, alpha " + number(alpha),
                       "int over the sphere G1(wo) D(h) / (4 cos_o) dwi = 1", 1.0, sphere, 1e-4);
    }
}

/// |dwh/dwi| by moving wi a little two ways: the area that the halfway vectors span.
double half_vector_jacobian(Vec3 wi, Vec3 wo)
{
    constexpr double step = 1e-5;
    const Frame frame = frame_around(normalize(wi));
    const auto moved = [&](Vec3 along) {
        const auto half = [&](double by) {
            return Vec3(normalize(Vec3(normalize(wi + along * by)) + wo));
        };
        return (half(step) - half(-step)) / (2.0 * step);
    };
    return length(cross(moved(frame.x), moved(frame.y)));
}

void check_jacobian(Cases& cases)
{
    cases.group("Jacobian", "1");
    const Vec3 wo = quadrature::direction(0.7, 0.3);
    for (const auto& [wi, name] : {std::pair{quadrature::direction(0.9, 2.0), "across"},
                                   std::pair{quadrature::direction(0.2, 3.4), "grazing"},
                                   std::pair{quadrature::direction(0.65, 0.35), "nearly back"}}) {
        const Vec3 h = normalize(wi + wo);
        cases.relative(std::string("halfway vector, light ") + name,
                       "dwh/dwi by differences = 1 / (4 wi.h) in the density",
                       half_vector_jacobian(wi, wo),
                       vndf::pdf_wi(wo, wi, 0.4, 0.3) / vndf::D_visible(wo, h, 0.4, 0.3));
    }
}

}  // namespace

void check_distributions(Cases& cases)
{
    check_normals(cases);
    check_masking(cases);
    check_jacobian(cases);
}

}  // namespace relight
