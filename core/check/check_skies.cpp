#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"
#include "core/light/temperature.h"

// Skies: constant, tabulated, clear with a sun; black bodies.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int width = 32, height = 16;
constexpr std::size_t texels = 512;  // of both

std::shared_ptr<const EnvironmentMap> map_of(const std::vector<double>& values)
{
    Image image{width, height, {}, {}};
    for (const double L : values) { image.pixels.push_back(to_float(Rgb::grey(L))); }
    return std::make_shared<const EnvironmentMap>(image);
}

/// int cos dw of a row (of all its columns) about the zenith: pi (sin^2 below - sin^2 above).
double row_about_zenith(int row)
{
    const double above = std::sin(pi * row / height), below = std::sin(pi * (row + 1) / height);
    return pi * (below * below - above * above);
}

/// Up is +Y; the ground beneath, with a block far off so that rays are asked.
Drawn read_up(const Light& light, unsigned samples)
{
    Mesh ground = floor_with_block();
    for (Point3& p : ground.positions) { p = {p.y, p.z, p.x}; }
    return read(ground, {{{0, 0, 0}, {0, 1, 0}}}, lit_by({light}, samples))[0].E;
}

void check_constant(Cases& cases)
{
    cases.group("sky", "W/m2");
    const double L = 0.8;
    const Mesh ground = quads({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}});
    const auto on_plane = [&](const Light& light) {
        return read(ground, {Meter{}}, lit_by({light}, 1024))[0].E;
    };
    const Light constant = light_of(EnvironmentLight{}, L);
    cases.relative("constant sky on an open plane", "E = pi L", pi * L, on_plane(constant).value);
    const Light image =
        light_of(EnvironmentLight{map_of(std::vector<double>(texels, 1.0)), 0.4}, L);
    cases.relative("image of one colour on an open plane", "E = pi L", pi * L,
                   on_plane(image).value);
    cases.relative("constant sky on a slope above nothing", "E = pi L", pi * L,
                   read(speck(), {{{0, 0, 0}, {1, 2, -3}}}, lit_by({constant}, 1024))[0].E.value);
}

void check_tabulated(Cases& cases)
{
    std::vector<double> rows, one(texels, 0.0);
    double E = 0.0;
    for (int i = 0; i < width * height; ++i) {
        const int row = i / width;
        rows.push_back(0.25 + static_cast<double>((5 * row) % 7));
        if (row < height / 2) { E += rows.back() * row_about_zenith(row) / width; }
    }
    cases.drawn("sky that differs from row to row", "E = sum L_i pi (sin^2 below - sin^2 above)", E,
                read_up(light_of(EnvironmentLight{map_of(rows), 0.7}), 16384), 2e-4);
    const int bright = 3;
    one[bright * width + 11] = 1e4;
    cases.drawn("one shining texel in a black sky",
                "E = L pi (sin^2 below - sin^2 above) / columns",
                1e4 * row_about_zenith(bright) / width,
                read_up(light_of(EnvironmentLight{map_of(one), 0.0}), 4096), 1e-4);
    const auto map = map_of(rows);
    double angle = 0.0, density = 0.0;
    for (int row = 0; row < height; ++row) {
        angle += width * map->texel_solid_angle(row);
        for (int column = 0; column < width; ++column) {
            // The density is even within a texel: its middle stands for it.
            const double theta = pi * (row + 0.5) / height;
            const double phi = 2.0 * pi * (column + 0.5) / width - pi;
            density += map->pdf({std::sin(theta) * std::cos(phi), std::cos(theta),
                                 std::sin(theta) * std::sin(phi)}) *
                       2.0 * pi / width *
                       (std::cos(pi * row / height) - std::cos(pi * (row + 1) / height));
        }
    }
    cases.group("sky", "sr");
    cases.relative("solid angles of an image's texels", "sum Omega = 4 pi", 4.0 * pi, angle, 1e-12);
    cases.group("sky", "1");
    cases.relative("density of an image's samples", "int pdf dw = 1", 1.0, density, 1e-9);
}

void check_clear_sky(Cases& cases)
{
    cases.group("sky", "lx");
    const SkyLight sky = make_sky(normalize({1, 1, 0}), 3.0);
    double E = sky.sun_E_perp.r * std::sqrt(0.5);
    const Image& dome = sky.dome->image();
    for (int row = 0; row < dome.height / 2; ++row) {
        const double above = std::sin(pi * row / dome.height);
        const double below = std::sin(pi * (row + 1) / dome.height);
        for (int column = 0; column < dome.width; ++column) {
            E += static_cast<double>(dome.pixels[dome.at(column, row)][0]) * pi / dome.width *
                 (below * below - above * above);
        }
    }
    cases.drawn("clear sky: its dome and its sun", "E = sum L Omega cos + E_perp cos", E,
                read_up(light_of(sky), 4096), 1e-4);
}

void check_harmonics(Cases& cases)
{
    cases.group("sh", "sr");
    const Meters meter(quads({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}), {Meter{}});
    Progress unseen;
    const Transport transport = trace(meter.stage, lit_by({}), {.sh = true, .threads = 1}, unseen);
    const auto T = [&](std::size_t k) {
        return static_cast<double>(transport.sky->sh[9 * meter.first + k]);
    };
    cases.relative("open plane lets in the constant harmonic", "T_00 = sqrt(pi) / 2",
                   0.5 * std::sqrt(pi), T(0));
    cases.relative("open plane lets in the linear harmonic of its normal", "T_10 = sqrt(pi / 3)",
                   std::sqrt(pi / 3.0), T(2));
    cases.relative("open plane lets in the quadratic harmonic of its normal",
                   "T_20 = sqrt(5 pi) / 8", std::sqrt(5.0 * pi) / 8.0, T(6));
    cases.absolute("open plane is even about its normal", "T_11 = 0", 0.0, T(3), 1e-7);
}

void check_temperature(Cases& cases)
{
    cases.group("temperature", "1");
    // Planck's radiator at 6500 K has the CIE 1931 chromaticity x = .3135, y = .3237; turned into
    // Rec.709 by its published matrix.
    const double X = 0.3135 / 0.3237, Y = 1.0, Z = (1.0 - 0.3135 - 0.3237) / 0.3237;
    const Rgb white = blackbody(6500.0);
    cases.relative("red of a black body at 6500 K", "3.2410 X - 1.5374 Y - 0.4986 Z",
                   3.2410 * X - 1.5374 * Y - 0.4986 * Z, white.r, 0.01);
    cases.relative("green of a black body at 6500 K", "-0.9692 X + 1.8760 Y + 0.0416 Z",
                   -0.9692 * X + 1.8760 * Y + 0.0416 * Z, white.g, 0.01);
    cases.relative("blue of a black body at 6500 K", "0.0556 X - 0.2040 Y + 1.0570 Z",
                   0.0556 * X - 0.2040 * Y + 1.0570 * Z, white.b, 0.01);
    cases.relative("luminance of a black body at 2700 K", "0.2126 R + 0.7152 G + 0.0722 B = 1", 1.0,
                   luminance(blackbody(2700.0)), 1e-9);
}

}  // namespace

void check_skies(Cases& cases)
{
    check_constant(cases);
    check_tabulated(cases);
    check_clear_sky(cases);
    check_harmonics(cases);
    check_temperature(cases);
}

}  // namespace relight
