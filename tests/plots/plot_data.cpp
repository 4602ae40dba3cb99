// Prints, as JSON, what the README's plots show: directional albedos and the fall of errors.
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>

#include "core/base/random.h"
#include "core/base/warp.h"
#include "core/transport/receiver.h"
#include "tests/scenes.h"

namespace relight {
namespace {

using test::light_of;
using test::Meters;

/// Share of the light from everywhere that leaves toward wo: mean of f cos / pdf over draws.
double albedo(const Material& material, double cos_o)
{
    constexpr std::uint32_t draws = 1U << 15U;
    const Vec3 wo{std::sqrt(1.0 - cos_o * cos_o), 0.0, cos_o};
    const Sequence sequence(1, 0, 0, 0);
    double sum = 0.0;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const BsdfSample s =
            sample(material, wo, Rgb::grey(1.0), sequence.at(i, 0), sequence.at(i, 1).u);
        if (s.wi.z > 0.0 && s.pdf > 0.0) {
            sum += f(material, s.wi, wo, Rgb::grey(1.0)).value.g * s.wi.z / s.pdf;
        }
    }
    return sum / draws;
}

void print_albedo(const std::string& name, const Material& material, bool last = false)
{
    std::printf("    {\"name\": \"%s\", \"cos\": [", name.c_str());
    constexpr int steps = 24;
    for (int i = 1; i <= steps; ++i) {
        std::printf("%s%.4f", i > 1 ? ", " : "", static_cast<double>(i) / steps);
    }
    std::printf("], \"albedo\": [");
    for (int i = 1; i <= steps; ++i) {
        std::printf("%s%.5f", i > 1 ? ", " : "", albedo(material, static_cast<double>(i) / steps));
    }
    std::printf("]}%s\n", last ? "" : ",");
}

Material facets(double alpha, bool multiscatter)
{
    CookTorrance material;
    material.fresnel = SchlickF0{Rgb::grey(1.0)};
    material.alpha_x = material.alpha_y = alpha;
    material.multiscatter = multiscatter;
    return make_cook_torrance(std::move(material));
}

/// Root mean square of `error(seed)` over seeds.
double rms(const std::function<double(std::uint64_t)>& error)
{
    constexpr std::uint64_t seeds = 200;
    double squares = 0.0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const double e = error(seed);
        squares += e * e / seeds;
    }
    return std::sqrt(squares);
}

constexpr unsigned counts[] = {16, 64, 256, 1024, 4096};

void print_fall(const std::string& name,
                const std::function<double(unsigned, std::uint64_t)>& error, bool last = false)
{
    std::printf("    {\"name\": \"%s\", \"samples\": [16, 64, 256, 1024, 4096], \"rms\": [",
                name.c_str());
    for (const unsigned n : counts) {
        std::printf("%s%.6g", n == counts[0] ? "" : ", ",
                    rms([&](std::uint64_t seed) { return error(n, seed); }));
    }
    std::printf("]}%s\n", last ? "" : ",");
}

/// Relative error of one meter under one light, drawn as the service draws.
double drawn(const Meters& meter, const Light& light, double truth, unsigned samples,
             std::uint64_t seed)
{
    Scene scene;
    scene.lights = {light};
    scene.transport.samples = samples;
    scene.transport.seed = seed;
    return static_cast<double>(meter.read(scene).E[0]) / truth - 1.0;
}

/// The same by independent random numbers and no closed form: plain Monte Carlo.
double plain(const Meters& meter, const Light& light, double truth, unsigned samples,
             std::uint64_t seed)
{
    const Receiver receiver = vertex_receiver(meter.stage, meter.first);
    const auto* sky = std::get_if<EnvironmentLight>(&light.shape);
    double sum = 0.0;
    for (unsigned i = 0; i < samples; ++i) {
        const auto u = [&](std::uint64_t d) { return uniform(seed + 77, 0, i, d); };
        LightSample there;
        if (sky != nullptr) {
            const Vec3 w = warp::cosine_hemisphere({u(0), u(1)});
            there = look(light.shape, receiver.p, normalize(receiver.frame.to_world(w)));
            there.pdf = warp::cosine_hemisphere_pdf(w.z);
        } else {
            there = sample(light.shape, receiver.p, {u(0), u(1)}, u(2));
        }
        const double cosine = there.wi ? dot(receiver.frame.n, there.wi) : 0.0;
        if (!(cosine > 0.0)) { continue; }
        const ShadowRay ray = shadow_ray(*meter.stage.bvh, receiver, there.wi, there.distance, {});
        std::uint8_t blocked = 0;
        meter.stage.bvh->occluded({&ray, 1}, {&blocked, 1});
        if (blocked == 0) { sum += there.L.r * cosine / there.pdf; }
    }
    return sum / samples / truth - 1.0;
}

int main()
{
    std::printf("{\n  \"albedo\": [\n");
    for (const double alpha : {0.1, 0.4, 1.0}) {
        char name[64];
        std::snprintf(name, sizeof name, "GGX alpha %.1f, F = 1", alpha);
        print_albedo(name, facets(alpha, false));
        std::snprintf(name, sizeof name, "GGX alpha %.1f, multiscatter", alpha);
        print_albedo(name, facets(alpha, true));
    }
    MetallicRoughness gltf;
    gltf.metallic = 0.0;
    gltf.roughness = 0.6;
    print_albedo("glTF white dielectric, roughness 0.6", gltf);
    Principled disney;
    disney.base_color = Rgb::grey(1.0);
    print_albedo("Disney white", disney);
    disney.sheen = 1.0;
    print_albedo("Disney white, sheen 1", disney);
    print_albedo("Oren-Nayar white, 20 degrees", OrenNayar{Rgb::grey(1.0), false, 0.349}, true);
    std::printf("  ],\n  \"fall\": [\n");

    // Half of a window behind an edge; and a smooth sky on a meter over nothing.
    const RectLight window{{0.2, 0.1, 2.0}, {0, 1.6, 0}, {1.4, 0, 0}, false};
    const Mesh edge = test::mesh_of({{-1e2, -1e2, 1}, {0, -1e2, 1}, {0, 1e2, 1}, {-1e2, 1e2, 1}},
                                    {0, 1, 2, 0, 2, 3});
    const Point3 p{-0.15, 0.05, 0};
    const Meters shadowed(edge, {p}, {{0, 0, 1}});
    const RectLight seen{{0.5 * (0.15 + 0.9), 0.1, 2.0}, {0, 1.6, 0}, {0.9 - 0.15, 0, 0}};
    const double penumbra = irradiance(seen, p, normalize({0, 0, 1}));
    print_fall("penumbra, ours", [&](unsigned n, std::uint64_t seed) {
        return drawn(shadowed, light_of(window), penumbra, n, seed);
    });
    print_fall("penumbra, plain Monte Carlo", [&](unsigned n, std::uint64_t seed) {
        return plain(shadowed, light_of(window), penumbra, n, seed);
    });
    Image gradient{512, 256, std::vector<Rgbf>(std::size_t{512} * 256), {}};
    for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 512; ++x) {
            const double phi = 2.0 * std::numbers::pi * (x + 0.5) / 512.0;
            const double theta = std::numbers::pi * (y + 0.5) / 256.0;
            gradient.pixels[gradient.at(x, y)] =
                to_float(Rgb::grey(1.0 + 0.5 * std::sin(theta) * std::cos(phi)));
        }
    }
    const Light sky = light_of(
        EnvironmentLight{std::make_shared<const EnvironmentMap>(std::move(gradient)), 0.0});
    const Meters open(edge, {{0, 0, 5}}, {{0.6, 0, 0.8}});
    // L = 1 + (w . -x) / 2 over the map's own axes: E = pi + (2 pi / 3) (n . u) / 2.
    const double smooth = std::numbers::pi * (1.0 - 0.6 / 3.0);
    print_fall("smooth sky, ours",
               [&](unsigned n, std::uint64_t seed) { return drawn(open, sky, smooth, n, seed); });
    print_fall(
        "smooth sky, plain Monte Carlo",
        [&](unsigned n, std::uint64_t seed) { return plain(open, sky, smooth, n, seed); }, true);
    std::printf("  ]\n}\n");
    return 0;
}

}  // namespace
}  // namespace relight

int main()
{
    return relight::main();
}
