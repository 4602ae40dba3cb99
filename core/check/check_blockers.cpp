#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"

// Half-planes and walls in the way of light, through the tree of triangles and its rays.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
// Where endless things end. Under a sky they must go on; where a thin edge throws a shadow they
// must not: single precision of the tree is relative to the whole.
constexpr double very_far = 1e4, far = 50.0;

/// The half-plane x < 0 at height 1.
Mesh roof(double end)
{
    return quads({{-end, -end, 1}, {0, -end, 1}, {0, end, 1}, {-end, end, 1}});
}

/// A wall x = 0 as high as 2, endless along y.
Mesh wall(double end)
{
    return quads({{0, -end, 0}, {0, end, 0}, {0, end, 2}, {0, -end, 2}});
}

Drawn read_under(const Mesh& mesh, const Light& light, Meter meter, unsigned samples = 4096)
{
    return read(mesh, {meter}, lit_by({light}, samples))[0].E;
}

void check_sky_past_edges(Cases& cases)
{
    const double L = 1.5;
    const Light sky = light_of(EnvironmentLight{}, L);
    // What is seen between the horizon and a plane through the y axis at angle psi to it is a
    // wedge, whose projection on the ground is half a disc less half an ellipse: pi (1 - cos psi)
    // / 2.
    cases.drawn("sky under the edge of a half-plane", "E = pi L / 2", pi * L / 2.0,
                read_under(roof(very_far), sky, {{0, 0, 0}}), 1e-3);
    for (const double x : {-1.0, 2.0}) {
        const double psi = std::atan2(1.0, -x);
        cases.drawn(x < 0.0 ? "sky from one height within the edge of a half-plane"
                            : "sky from two heights before the edge of a half-plane",
                    "E = pi L (1 - cos psi) / 2, psi the edge's angle",
                    0.5 * pi * L * (1.0 - std::cos(psi)),
                    read_under(roof(very_far), sky, {{x, 0, 0}}), 1e-3);
    }
    cases.drawn("sky beside an endless wall", "E = pi L (1 + cos gamma) / 2, tan gamma = H / d",
                0.5 * pi * L * (1.0 + std::cos(std::atan(2.0 / 1.5))),
                read_under(wall(very_far), sky, {{1.5, 0, 0}}), 1e-3);
}

void check_edges_of_shadows(Cases& cases)
{
    const Light lamp = light_of(PointLight{{1, 0, 2}, {}}, 6.0);
    // Seen from (1, 0, 2) the edge x = 0 at height 1 throws its shadow's edge to x = -1.
    const double inside = -1.0 - 1e-4, outside = -1.0 + 1e-4;
    const auto E_at = [](double x) {
        return 6.0 * 2.0 / std::pow((1.0 - x) * (1.0 - x) + 4.0, 1.5);
    };
    cases.exact("point light 0.1 mm within the shadow's edge", "E = 0", 0.0,
                read_under(roof(far), lamp, {{inside, 0, 0}}).value);
    cases.relative("point light 0.1 mm outside the shadow's edge", "E = I h / d^3", E_at(outside),
                   read_under(roof(far), lamp, {{outside, 0, 0}}).value);
    const Light sun = light_of(DirectionalLight{normalize({1, 0, -1}), 0.0}, 2.0);  // from -x
    cases.exact("sun behind a wall, at its shadow's edge within", "E = 0", 0.0,
                read_under(wall(far), sun, {{1.9999, 0, 0}}).value);
    cases.relative("sun past a wall, at its shadow's edge outside", "E = E_perp cos 45",
                   2.0 * std::sqrt(0.5), read_under(wall(far), sun, {{2.0001, 0, 0}}).value);
}

void check_penumbra(Cases& cases)
{
    const double L = 4.0;
    // A window in z = 2 over 0 < x < 1, -1 < y < 1, shining down past the roof's edge: from (x, 0,
    // 0), -1 < x < 0, what lies beyond the edge's projection 2 (0 - x) + x = -x is seen.
    const Light window = light_of(RectLight{{0.5, 0, 2}, {0, 2, 0}, {1, 0, 0}, false}, L);
    const auto corner = [](double a, double b, double h) {  // view factor above a corner
        const double A = std::hypot(a, h), B = std::hypot(b, h);
        return (a / A * std::atan(b / A) + b / B * std::atan(a / B)) / (2.0 * pi);
    };
    for (const double x : {-0.2, -0.5, -0.8}) {
        const double E = 2.0 * pi * L * (corner(1.0 - x, 1, 2) - corner(-2.0 * x, 1, 2));
        cases.drawn("window of which " +
                        std::string(x < -0.6   ? "80"
                                    : x < -0.3 ? "50"
                                               : "20") +
                        " % is behind a half-plane",
                    "E = pi L F(visible part)", E, read_under(roof(far), window, {{x, 0, 0}}));
    }
    cases.exact("window wholly behind a half-plane", "E = 0", 0.0,
                read_under(roof(far), window, {{-1.01, 0, 0}}).value);
    // An edge across the middle of what is round to the eye leaves half of it.
    const Meter facing{{-1, 0, 0}, {1, 0, 1}};
    const Light ball = light_of(SphereLight{{1, 0, 2}, 0.4}, L);
    cases.drawn("ball half behind a half-plane", "E = pi L R^2 / (2 d^2)", pi * L * 0.16 / 16.0,
                read_under(roof(far), ball, facing));
    const Light sun = light_of(DirectionalLight{normalize({-1, 0, -1}), 0.05}, 3.0);
    cases.drawn("sun's disc half behind a half-plane", "E = E_perp / 2", 1.5,
                read_under(roof(far), sun, facing));
}

/// Ambient occlusion has no error of its own: that of as many independent rays is allowed, which is
/// more than the sequence makes.
void check_ambient_occlusion(Cases& cases)
{
    cases.group("half-plane blocker", "1");
    constexpr unsigned samples = 4096;
    const std::vector<Meter> places{{{1e-3, 0, 0}}, {{1.5, 0, 0}}};
    const Meters meters(wall(very_far), places);
    Progress unseen;
    const Transport transport =
        trace(meters.stage, lit_by({}, samples), {.ambient_occlusion = true, .threads = 1}, unseen);
    const char* names[] = {"ambient occlusion at a wall's foot", "ambient occlusion beside a wall"};
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double open = 0.5 * (1.0 + std::cos(std::atan(2.0 / places[i].p.x)));
        const double error = std::sqrt(open * (1.0 - open) / samples);
        cases.drawn(
            names[i], "(1 + cos gamma) / 2, tan gamma = H / d", open,
            {static_cast<double>(transport.sky->ambient_occlusion[meters.first + i]), error});
    }
}

}  // namespace

void check_blockers(Cases& cases)
{
    cases.group("half-plane blocker", "W/m2");
    check_sky_past_edges(cases);
    check_edges_of_shadows(cases);
    check_penumbra(cases);
    check_ambient_occlusion(cases);
}

void check_standard_error(Cases& cases)
{
    cases.group("standard error", "1");
    // The window and the roof of check_penumbra, from places that see 15 to 85 % of it.
    std::vector<Meter> places(8);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto k = static_cast<double>(i);
        places[i].p = {-0.15 - 0.1 * k, 0.05 * k, 0};
    }
    const Meters meters(roof(far), places);
    Scene scene = lit_by({light_of(RectLight{{0.5, 0, 2}, {0, 2, 0}, {1, 0, 0}, false})}, 256);
    const auto factor = [](double a,
                           double b) {  // to a parallel rectangle above its corner, odd in both
        const double A = std::hypot(a, 2.0), B = std::hypot(b, 2.0);
        return (a / A * std::atan(b / A) + b / B * std::atan(a / B)) / 2.0;
    };
    constexpr std::uint64_t seeds = 200;
    double within = 0.0;
    for (scene.transport.seed = 0; scene.transport.seed < seeds; ++scene.transport.seed) {
        const Column part =
            column(meters.stage, scene, 0, meters.first, meters.first + meters.count);
        for (std::size_t i = 0; i < meters.count; ++i) {
            const double x = places[i].p.x, y = places[i].p.y;
            const double E = factor(1 - x, 1 - y) + factor(1 - x, 1 + y) - factor(-2 * x, 1 - y) -
                             factor(-2 * x, 1 + y);
            const double off = std::abs(static_cast<double>(part.E[i]) - E);
            if (off <= 1.96 * static_cast<double>(part.standard_error[i])) { within += 1.0; }
        }
    }
    cases.absolute("truth within +-1.96 standard errors, share over 200 seeds",
                   "0.92 <= share <= 0.98", 0.95,
                   within / static_cast<double>(seeds * meters.count), 0.03);
}

}  // namespace relight
