// Radiance of glossy materials against expected values computed independently: by quadrature of f,
// by each way of sampling alone and both together, and in a picture.
#include <gtest/gtest.h>

#include "core/base/mis.h"
#include "core/base/random.h"
#include "core/shade/shade.h"
#include "tests/bsdf/quadrature.h"
#include "tests/oracle.h"
#include "tests/shade/pictures.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using nlohmann::json;
using test::NormalisedErrors;
using test::point_of;
using test::rgb_of;
using test::vec_of;

Material material_of(const json& c)
{
    const json& m = c["material"];
    if (c["model"] == "gltf") {
        MetallicRoughness gltf;
        gltf.base_color = rgb_of(m["baseColor"]);
        gltf.metallic = m["metallic"];
        gltf.roughness = m["roughness"];
        return gltf;
    }
    EXPECT_EQ(c["model"], "disney");
    Principled disney;
    disney.base_color = rgb_of(m["baseColor"]);
    disney.metallic = m["metallic"];
    disney.subsurface = m["subsurface"];
    disney.specular = m["specular"];
    disney.roughness = m["roughness"];
    disney.specular_tint = m["specularTint"];
    disney.anisotropic = m["anisotropic"];
    disney.sheen = m["sheen"];
    disney.sheen_tint = m["sheenTint"];
    disney.clearcoat = m["clearcoat"];
    disney.clearcoat_gloss = m["clearcoatGloss"];
    return disney;
}

Light light_of(const json& l)
{
    const std::string type = l["type"];
    if (type == "point") {
        return test::light_of(PointLight{point_of(l["position"]), {}}, rgb_of(l["intensity_rgb"]));
    }
    if (type == "directional") {
        return test::light_of(DirectionalLight{normalize(vec_of(l["travel_direction"]))},
                              Rgb::grey(l["E_perp"].get<double>()));
    }
    const Rgb L = Rgb::grey(l["L"].get<double>());
    if (type == "constant") { return test::light_of(EnvironmentLight{}, L); }
    EXPECT_EQ(type, "rect");
    const json& v = l["vertices"];
    return test::light_of(test::rect_of(point_of(v[0]), point_of(v[1]), point_of(v[3])), L);
}

struct Case {
    explicit Case(const json& c)
        : id(c["id"]),
          material(material_of(c)),
          light(light_of(c["light"])),
          p(point_of(c["p"])),
          frame(frame_around(normalize(vec_of(c["n"])))),
          to_viewer(normalize(vec_of(c["wo"]))),
          expected(rgb_of(c["Lo"]))
    {
        if (c.contains("eye")) {
            eye = point_of(c["eye"]);
        } else {
            EXPECT_EQ(c["view"], "normal_view");
            eye = p + Vec3(frame.n);
        }
    }

    /// f cos at unit direction wi (world).
    Rgb response(Vec3 wi) const
    {
        const Vec3 local = frame.to_local(wi);
        return f(material, local, frame.to_local(to_viewer), {}).value * std::max(0.0, local.z);
    }

    std::string id;
    Material material;
    Light light;
    Point3 p, eye;
    Frame frame;
    Dir3 to_viewer;
    Rgb expected;
};

std::vector<Case> cases()
{
    std::vector<Case> all;
    const json file = test::oracle("outgoing_radiance");
    for (const json& c : file["cases"]) { all.emplace_back(c); }
    EXPECT_EQ(all.size(), 36U);
    return all;
}

test::Tolerance tolerance()
{
    return test::Tolerance(test::oracle("outgoing_radiance")["tolerance"]);
}

/// What E_perp or L of the light makes the place shine with, by quadrature.
Rgb by_quadrature(const Case& c)
{
    const auto& shape = c.light.shape;
    if (is_delta(shape)) {
        const Arrival arrival = arrive(shape, c.p);
        return c.response(arrival.wi) * c.light.power * arrival.per_unit;
    }
    if (const auto* rect = std::get_if<RectLight>(&shape)) {
        const Vec3 normal = cross(rect->edge_u, rect->edge_v);  // its length is the area
        const auto from = [&](double s, double t) {
            const Point3 y = rect->center + rect->edge_u * (s - 0.5) + rect->edge_v * (t - 0.5);
            const Vec3 to_light = y - c.p;
            const double r2 = dot(to_light, to_light);
            const double cos_area = std::max(0.0, -dot(normal, normalize(to_light)));
            return c.response(normalize(to_light)) * (cos_area / r2);
        };
        return c.light.power * test::over_interval(
                                   [&](double s) {
                                       return test::over_interval(
                                           [&](double t) { return from(s, t); }, 0.0, 1.0, 40);
                                   },
                                   0.0, 1.0, 40);
    }
    const auto ring = [&](double cosine) {
        return test::over_interval(
            [&](double phi) { return c.response(c.frame.to_world(test::direction(cosine, phi))); },
            0.0, 2.0 * std::numbers::pi, 48);
    };
    // u = sqrt(cosine): finer at grazing, where Fresnel's fifth power lives.
    return c.light.power *
           test::over_interval([&](double u) { return ring(u * u) * (2.0 * u); }, 0.0, 1.0, 96);
}

TEST(OutgoingRadiance, IsTheIntegralOfTheMaterialOverTheLight)
{
    const test::Tolerance within = tolerance();
    for (const Case& c : cases()) {
        const Rgb L = by_quadrature(c);
        EXPECT_TRUE(within.holds(L.r, c.expected.r)) << c.id << " " << L.r << " " << c.expected.r;
        EXPECT_TRUE(within.holds(L.g, c.expected.g)) << c.id << " " << L.g << " " << c.expected.g;
        EXPECT_TRUE(within.holds(L.b, c.expected.b)) << c.id << " " << L.b << " " << c.expected.b;
    }
}

/// Estimates of one case from `count` independent samples a way: [light, surface, both].
std::array<test::Mean, 3> by_samples(const Case& c, std::uint64_t number)
{
    constexpr int count = 4096;
    std::array<Rgb, 3> sum{}, squares{};
    const Vec3 wo = c.frame.to_local(c.to_viewer);
    const auto random = [&](int i, std::uint64_t dimension) {
        return uniform(11, number, static_cast<std::uint64_t>(i), dimension);
    };
    for (int i = 0; i < count; ++i) {
        std::array<Rgb, 3> estimate{};
        const LightSample there =
            sample(c.light.shape, c.p, {random(i, 0), random(i, 1)}, random(i, 2));
        if (there.wi && there.pdf > 0.0) {
            const Rgb value = c.response(there.wi) * there.L * c.light.power / there.pdf;
            const double other = pdf(c.material, c.frame.to_local(there.wi), wo, {});
            estimate[0] = value;
            estimate[2] = value * mis::balance(1, there.pdf, 1, other);
        }
        const BsdfSample drawn =
            sample(c.material, wo, {}, {random(i, 3), random(i, 4)}, random(i, 5));
        const Dir3 wi = normalize(c.frame.to_world(drawn.wi));
        if (drawn.wi.z > 0.0 && drawn.pdf > 0.0) {
            const LightSample seen = look(c.light.shape, c.p, wi);
            const Rgb value = c.response(wi) * seen.L * c.light.power / drawn.pdf;
            estimate[1] = value;
            estimate[2] += value * mis::balance(1, drawn.pdf, 1, seen.pdf);
        }
        for (std::size_t way = 0; way < 3; ++way) {
            sum[way] += estimate[way];
            squares[way] += estimate[way] * estimate[way];
        }
    }
    std::array<test::Mean, 3> means;
    for (std::size_t way = 0; way < 3; ++way) {
        const Rgb mean = sum[way] / count;
        const Rgb variance = squares[way] / count - mean * mean;
        const auto error = [](double v) { return std::sqrt(std::max(0.0, v) / (count - 1)); };
        means[way] = {mean, {error(variance.r), error(variance.g), error(variance.b)}};
    }
    return means;
}

TEST(OutgoingRadiance, SamplesOfTheLightOfTheSurfaceAndOfBothAgree)
{
    std::array<NormalisedErrors, 3> errors;
    std::uint64_t number = 0;
    for (const Case& c : cases()) {
        for (int repeat = 0; repeat < 5 && !is_delta(c.light.shape); ++repeat) {
            const auto means = by_samples(c, ++number);
            for (std::size_t way = 0; way < 3; ++way) {
                errors[way].add(means[way].value.g - c.expected.g, means[way].error.g,
                                1e-5 * c.expected.g, c.id + " way " + std::to_string(way));
            }
        }
    }
    for (const NormalisedErrors& way : errors) { way.expect_honest(); }
}

TEST(OutgoingRadiance, IsWhatAPictureShows)
{
    const test::Tolerance exact(2e-5, 1e-7);  // of what the pinhead's own size changes
    NormalisedErrors errors;
    for (const Case& c : cases()) {
        Scene scene;
        scene.lights = {c.light};
        scene.materials[0] = c.material;
        scene.camera = test::pinhead(c.eye, c.p);
        const Vec3 x = c.frame.x, y = c.frame.y;
        const Stage stage = test::staged(
            test::mesh_of({c.p - x - y, c.p + x * 2.0 - y, c.p + y * 2.0 - x}, {0, 1, 2}));
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            // Few directions meet a light through a narrow lobe: fewer samples err by fewer, larger
            // steps than a normal distribution has.
            constexpr int samples = 2048;
            const Rendered rendered = test::picture(stage, scene, {2, 2, samples, {}, seed, 2});
            for (const float covered : rendered.image.coverage) { EXPECT_EQ(covered, 1.0F); }
            const test::Mean L = test::mean_of(rendered, samples);
            const double values[] = {L.value.r, L.value.g, L.value.b};
            const double expected[] = {c.expected.r, c.expected.g, c.expected.b};
            const double error[] = {L.error.r, L.error.g, L.error.b};
            for (std::size_t band = 0; band < 3; ++band) {
                const double e = expected[band];
                if (is_delta(c.light.shape)) {
                    EXPECT_TRUE(exact.holds(values[band], e)) << c.id << " " << values[band];
                } else {
                    errors.add(values[band] - e, error[band], 2e-5 * e, c.id);
                }
            }
        }
    }
    errors.expect_honest();
}

TEST(OutgoingRadiance, AVertexSendsItTowardItsViewer)
{
    NormalisedErrors errors;
    for (const Case& c : cases()) {
        const Stage stage = test::staged(test::with_receivers({}, {c.p}, {c.frame.n}));
        Scene scene;
        scene.lights = {c.light};
        scene.materials = {c.material};
        scene.view = CameraView{};
        scene.camera.eye = c.eye;
        scene.transport.shadows = false;
        constexpr std::uint64_t seeds = 32;
        double sum = 0.0;
        double squares = 0.0;
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            scene.transport.seed = seed;
            Progress progress;
            TransportWanted wanted;
            wanted.radiance = true;
            const Transport transport = trace(stage, scene, wanted, progress);
            const Shaded shaded = shade(stage, transport, scene, {}, progress);
            const auto L = static_cast<double>(shaded.radiance[0][1]);
            sum += L;
            squares += L * L;
        }
        const double mean = sum / seeds;
        const double error =
            std::sqrt(std::max(0.0, squares / seeds - mean * mean) / (seeds - 1.0));
        errors.add(mean - c.expected.g, error, 1e-5 * c.expected.g + 1e-7, c.id);
    }
    errors.expect_honest();
}

}  // namespace
}  // namespace relight
