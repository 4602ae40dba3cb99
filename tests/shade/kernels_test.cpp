// The kernels against the scalar formulas in double, on every instruction set that is here.
#include "core/shade/kernels.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <functional>
#include <tuple>

#include "core/base/random.h"
#include "core/shade/shade.h"
#include "tests/scenes.h"

namespace relight {
namespace {

/// Runs `body` once for each instruction set that this machine has.
void on_every_target(const std::function<void(const char* name)>& body)
{
    for (const auto target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        body(hwy::TargetName(target));
    }
    hwy::SetSupportedTargetsForTest(0);
}

double random(std::uint64_t v, std::uint64_t dimension)
{
    return uniform(3, v, 0, dimension);
}

Vec3 random_direction(std::uint64_t v, std::uint64_t dimension)
{
    const double z = 2.0 * random(v, dimension) - 1.0;
    const double phi = 2.0 * std::numbers::pi * random(v, dimension + 1);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

const Point3 eye{1.0, 2.0, 3.0};
const Point3 lamp{-2.0, 1.0, 2.5};

/// A meter somewhere between lamp and eye, turned in one of the ways that are hard: anyhow; within
/// 1e-6 to 1 of the mirror's direction; nearly in the plane of the light, of the viewer, of both.
Vec3 hard_normal(Point3 p, std::uint64_t v)
{
    const Vec3 wi = normalize(lamp - p), wo = normalize(eye - p);
    const double off = std::pow(10.0, -6.0 * random(v, 3));
    const Vec3 by_chance = random_direction(v, 4);
    switch (v % 5) {
        case 0:
            return by_chance;
        case 1:
            return Vec3(normalize(wi + wo)) + by_chance * off;
        case 2:
            return Vec3(normalize(wo - wi * dot(wi, wo))) + wi * off;
        case 3:
            return Vec3(normalize(wi - wo * dot(wi, wo))) + wo * off;
        default:
            return Vec3(normalize(cross(wi, wo))) + (wi + wo) * off;
    }
}

const Stage& hard_places()
{
    static const Stage stage = [] {
        std::vector<Point3> places;
        std::vector<Vec3> normals;
        for (std::uint64_t v = 0; v < 1003; ++v) {  // no whole number of vectors
            places.push_back({4.0 * random(v, 0) - 2.0, 4.0 * random(v, 1) - 1.0, random(v, 2)});
            normals.push_back(normalize(hard_normal(places.back(), v)));
        }
        return test::staged(test::with_receivers({}, places, normals));
    }();
    return stage;
}

/// Radiance by core/bsdf, in double.
Rgb by_scalar(const Stage& stage, const Transport& transport, const Scene& scene,
              std::span<const std::uint32_t> materials, std::size_t v)
{
    const auto seen = seen_vertex(stage, scene, v);
    if (!seen) { return {}; }
    const LocalMaterial material = vertex_material(stage, scene, materials, v);
    const Rgb color = vertex_color(stage, v);
    const bool front = dot(seen->receiver.frame.n, stage.surface->normals[v]) > 0.0;
    Rgb L = front ? emission(*material, seen->wo.z) : Rgb{};
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        const Column* column = transport.columns[l].get();
        if (column == nullptr) { continue; }
        if (E_tells_radiance(scene, *material)) {
            L += diffuse_albedo(*material, color) * irradiance(*column, light.power, v) *
                 std::numbers::inv_pi;
            continue;
        }
        if (const auto& drawn = transport.drawn[l]) {
            const float* Lo = drawn->Lo.data() + 3 * v;
            L += light.power * to_double({Lo[0], Lo[1], Lo[2]});
        }
        if (!is_delta(light.shape)) { continue; }
        Vec3 wi = seen->receiver.frame.to_local(arrive(light.shape, seen->receiver.p).wi);
        if (seen->both_sides) { wi.z = std::abs(wi.z); }
        L += f(*material, wi, seen->wo, color).value *
             (light.power * static_cast<double>(column->E[v]));
    }
    return L;
}

/// A column of random numbers in [0, 1).
SharedColumn random_column(std::uint64_t seed, std::size_t vertices, unsigned bands, bool bounced)
{
    std::uint64_t n = 0;
    const auto some = [&](std::size_t count) {
        std::vector<float> values(count);
        for (float& x : values) { x = static_cast<float>(uniform(seed, n++, 1, 0)); }
        return values;
    };
    Column column;
    column.bands = bands;
    column.E = some(vertices * bands);
    if (bounced) { column.E_bounced = some(vertices * 3); }
    column.standard_error = some(vertices * (bounced ? 3 : bands));
    return std::make_shared<const Column>(std::move(column));
}

struct Lighting {
    Scene scene;
    Transport transport;

    UnsetVector<Rgbf> radiance(const Stage& stage, unsigned threads = 1) const
    {
        Progress progress;
        return shade(stage, transport, scene, {true, false, false, threads}, progress).radiance;
    }
};

/// E is 1 everywhere, so that radiance is f.
Lighting of_f(const Material& material, LightShape shape = PointLight{lamp, {}})
{
    Lighting lit;
    lit.scene.lights = {test::light_of(std::move(shape))};
    lit.scene.materials = {material};
    lit.scene.view = CameraView{};
    lit.scene.camera.eye = eye;
    Column column;
    column.E.assign(hard_places().mesh->positions.size(), 1.0F);
    lit.transport.columns = {std::make_shared<const Column>(std::move(column))};
    lit.transport.drawn = {nullptr};
    return lit;
}

/// A lamp, a sun, a sky and one that is switched off, with radiance drawn for two of them.
Lighting of_many(const Stage& stage, const Material& material)
{
    Lighting lit;
    lit.scene.lights = {
        test::light_of(PointLight{lamp, {}}, {3.0, 2.0, 1.0}),
        test::light_of(DirectionalLight{normalize({0.3, 0.2, -1.0})}, {1.0, 2.0, 0.3}),
        test::light_of(EnvironmentLight{}, {0.1, 0.2, 0.7}), test::light_of(PointLight{eye, {}})};
    lit.scene.materials = {material};
    lit.scene.view = CameraView{};
    lit.scene.camera.eye = eye;
    const std::size_t vertices = stage.mesh->positions.size();
    for (std::uint64_t l = 0; l < 3; ++l) {
        lit.transport.columns.push_back(random_column(l, vertices, l == 2 ? 3 : 1, l == 1));
        Column drawn;
        drawn.Lo = random_column(10 + l, vertices, 3, false)->E;
        lit.transport.drawn.push_back(l == 0 ? nullptr
                                             : std::make_shared<const Column>(std::move(drawn)));
    }
    lit.transport.columns.push_back(nullptr);
    lit.transport.drawn.push_back(nullptr);
    return lit;
}

/// The columns' row of one vertex.
Transport of_vertex(const Transport& all, std::size_t v)
{
    Transport one;
    const auto row = [&](const std::vector<float>& values, unsigned bands) {
        const auto begin = values.begin() + static_cast<std::ptrdiff_t>(v * bands);
        return values.empty() ? values : std::vector<float>(begin, begin + bands);
    };
    for (const auto& column : all.columns) {
        if (column == nullptr) {
            one.columns.push_back(nullptr);
            continue;
        }
        Column alone;
        alone.bands = column->bands;
        alone.E = row(column->E, column->bands);
        alone.E_bounced = row(column->E_bounced, 3);
        one.columns.push_back(std::make_shared<const Column>(std::move(alone)));
    }
    for (const auto& drawn : all.drawn) {
        Column alone;
        if (drawn != nullptr) { alone.Lo = row(drawn->Lo, 3); }
        one.drawn.push_back(std::make_shared<const Column>(std::move(alone)));
    }
    return one;
}

CookTorrance facets(double alpha_x, double alpha_y, Distribution distribution = Distribution::Ggx)
{
    CookTorrance m;
    m.albedo = {0.5, 0.3, 0.1};
    m.alpha_x = alpha_x;
    m.alpha_y = alpha_y;
    m.distribution = distribution;
    return m;
}

struct Model {
    std::string name;
    Material material;
    double ulps;  ///< how far a kernel may be from the scalar formula, in 2^-23 of it
};

std::vector<Model> made_models()
{
    std::vector<Model> all;
    all.push_back({"Lambert", Lambert{{0.8, 0.5, 0.2}}, 2});
    OrenNayar rough;
    rough.sigma = 0.6;
    all.push_back({"Oren-Nayar", rough, 4});
    for (const double alpha : {1e-3, 0.02, 0.3, 1.0}) {
        const std::string a = " " + std::to_string(alpha);
        for (const auto& [name, distribution, ulps] :
             {std::tuple{"Beckmann", Distribution::Beckmann, 256.0},  // its tail: exp(-40)
              std::tuple{"GGX", Distribution::Ggx, 8.0}}) {
            all.push_back({name + a, make_cook_torrance(facets(alpha, alpha, distribution)), ulps});
            CookTorrance m = facets(alpha, std::sqrt(alpha), distribution);
            m.shadowing = Shadowing::Separable;
            m.albedo = {};
            all.push_back({name + a + " anisotropic, separable", make_cook_torrance(m), ulps});
        }
        for (const double gamma : {0.5, 1.0, 4.0}) {
            CookTorrance m = facets(alpha, alpha, Distribution::Gtr);
            m.gamma = gamma;
            all.push_back(
                {"GTR" + a + " gamma " + std::to_string(gamma), make_cook_torrance(m), 16});
        }
        CookTorrance gold = facets(alpha, alpha);
        gold.albedo = {};
        gold.fresnel = ConductorEtaK{{0.18, 0.42, 1.37}, {3.42, 2.35, 1.77}};
        gold.multiscatter = true;
        all.push_back({"gold with multiscatter" + a, make_cook_torrance(gold), 64});
        Principled disney;
        disney.roughness = std::sqrt(alpha);
        all.push_back({"principled" + a, disney, 8});
        disney.anisotropic = 0.8;
        disney.subsurface = 0.5;
        disney.sheen = 0.7;
        disney.specular_tint = 0.6;
        disney.clearcoat = 1.0;
        disney.metallic = 0.3;
        disney.base_color = {0.7, 0.2, 0.0};
        all.push_back({"principled, all of it" + a, disney, 256});
        MetallicRoughness gltf;
        gltf.base_color = {0.7, 0.2, 0.0};
        gltf.metallic = 0.4;
        gltf.roughness = std::sqrt(alpha);
        all.push_back({"metallic-roughness" + a, gltf, 8});
        gltf.clearcoat = 0.8;
        gltf.clearcoat_roughness = 0.03;
        gltf.anisotropy_strength = 0.7;
        gltf.anisotropy_rotation = 0.4;
        gltf.specular = 0.7;
        gltf.specular_color = {1.0, 0.8, 0.3};
        all.push_back({"coated, anisotropic" + a, gltf, 16});
        gltf.sheen_color = {0.9, 0.6, 0.3};
        gltf.sheen_roughness = std::sqrt(alpha);
        all.push_back({"and with sheen" + a, gltf, 64});
    }
    for (const double ior : {0.7, 1.0001, 1.5, 2.4, 1e6}) {
        CookTorrance glass = facets(0.1, 0.1);
        glass.fresnel = DielectricIor{ior};
        // At the critical angle F leaves 1 as a square root.
        const double ulps = ior < 1.0 ? 1024.0 : 64.0;
        all.push_back({"dielectric " + std::to_string(ior), make_cook_torrance(glass), ulps});
    }
    return all;
}

const std::vector<Model>& models()
{
    static const std::vector<Model> made = made_models();
    return made;
}

/// Whether each is within `ulps` of what the scalar formulas give. Below 1e-20 anything counts that
/// is as small.
void expect_near_scalar(const Stage& stage, const Lighting& lit, double ulps,
                        const std::string& what)
{
    const auto L = lit.radiance(stage);
    const auto materials = vertex_materials(stage, lit.scene);
    double worst = 0.0;
    std::size_t where = 0;
    for (std::size_t v = 0; v < L.size(); ++v) {
        const Rgb e = by_scalar(stage, lit.transport, lit.scene, materials, v);
        const double expected[] = {e.r, e.g, e.b};
        for (std::size_t band = 0; band < 3; ++band) {
            const auto x = static_cast<double>(L[v][band]);
            ASSERT_TRUE(x >= 0.0 && std::isfinite(x)) << what << ", vertex " << v << ": " << x;
            const double off =
                std::abs(x - expected[band]) / std::max(expected[band], 1e-20) * 0x1p23;
            if (off > worst) {
                worst = off;
                where = v;
            }
        }
    }
    EXPECT_LE(worst, ulps) << what << ", vertex " << where;
}

TEST(Kernels, EveryModelIsTheScalarFormulaToAFewUlps)
{
    on_every_target([](const char* target) {
        for (const Model& m : models()) {
            Lighting lit = of_f(m.material);
            // Below the horizon E of an honest column is 0; one-sided Lambert believes it.
            lit.scene.transport.two_sided = is_lambertian(m.material);
            expect_near_scalar(hard_places(), lit, m.ulps, m.name + " on " + target);
        }
    });
}

TEST(Kernels, ANarrowLobeIsNoWorseWhereLightAndViewerBothGraze)
{
    // Between lamp and eye, off their line by little: what reflects one to the other grazes.
    std::vector<Point3> places;
    std::vector<Vec3> normals;
    for (std::uint64_t v = 0; v < 1003; ++v) {
        const Vec3 along = eye - lamp;
        const Vec3 off = normalize(cross(along, random_direction(v, 0)));
        const double graze = std::pow(10.0, -1.0 - 3.0 * random(v, 2));
        places.push_back(lamp + along * (0.2 + 0.6 * random(v, 3)) + off * graze);
        const Vec3 wi = normalize(lamp - places.back()), wo = normalize(eye - places.back());
        const Vec3 tilt = random_direction(v, 4) * (1e-3 * graze * random(v, 6));
        normals.push_back(normalize(Vec3(normalize(wi + wo)) + tilt));
    }
    const Stage stage = test::staged(test::with_receivers({}, places, normals));
    CookTorrance narrow;
    narrow.alpha_x = narrow.alpha_y = 1e-3;
    on_every_target([&](const char* target) {
        expect_near_scalar(stage, of_f(make_cook_torrance(narrow)), 8.0, target);
    });
}

TEST(Kernels, SunsAndDirectionsOfViewAreNoOther)
{
    for (const Model& m : models()) {
        Lighting lit = of_f(m.material, DirectionalLight{normalize({0.5, -0.2, -1.0})});
        lit.scene.view = DirectionView{normalize({0.1, 0.4, 0.8})};
        lit.scene.transport.two_sided = true;
        expect_near_scalar(hard_places(), lit, m.ulps, m.name);
    }
}

TEST(Kernels, SeenAlongTheNormalATwoSidedSurfaceShowsTheLightOfBothSides)
{
    for (const Model& m : models()) {
        Lighting lit = of_f(m.material);
        lit.scene.view = NormalView{};
        lit.scene.transport.two_sided = true;
        expect_near_scalar(hard_places(), lit, m.ulps, m.name);
    }
}

TEST(Kernels, NeverGiveAnythingButANumber)
{
    // On the lamp, on the viewer, on the line between them, in their plane, without a normal.
    std::vector<Point3> places;
    std::vector<Vec3> normals;
    for (const Point3 p : {lamp, eye, lamp + (eye - lamp) * 0.5, Point3{-2.0, 1.0, 0.0}}) {
        for (const Vec3 n : {Vec3{}, Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3(normalize(eye - lamp)),
                             Vec3(normalize(cross(eye - lamp, {0, 0, 1})))}) {
            places.push_back(p);
            normals.push_back(n);
        }
    }
    const Stage stage = test::staged(test::with_receivers({}, places, normals));
    on_every_target([&](const char* target) {
        for (const Model& m : models()) {
            for (const Rgbf& L : of_f(m.material).radiance(stage)) {
                for (const float x : L) {
                    EXPECT_TRUE(x >= 0.0F && std::isfinite(x)) << m.name << " on " << target;
                }
            }
        }
    });
}

TEST(Kernels, SumsOfColumnsAreThoseOfPlainDoublesToTheBit)
{
    on_every_target([](const char* target) {
        for (const int cells : {1, 3, 30}) {  // 4, 16 and 961 vertices: tails of every kind
            const Stage stage = test::staged(test::grid(cells));
            const Lighting lit = of_many(stage, Lambert{{0.8, 0.5, 0.2}});
            Progress progress;
            const Shaded shaded =
                shade(stage, lit.transport, lit.scene, {true, true, true, 2}, progress);
            for (std::size_t v = 0; v < shaded.irradiance.size(); ++v) {
                Rgb E, variance;
                for (std::size_t l = 0; l < 3; ++l) {
                    const Column& column = *lit.transport.columns[l];
                    const Rgb power = lit.scene.lights[l].power;
                    const Rgb one = irradiance(column, power, v);
                    E += one;
                    EXPECT_EQ(shaded.per_light[l][v], to_float(one)) << target;
                    const unsigned bands = column.E_bounced.empty() ? column.bands : 3;
                    const float* e = column.standard_error.data() + v * bands;
                    const Rgb error =
                        to_double({e[0], e[bands == 1 ? 0 : 1], e[bands == 1 ? 0 : 2]}) * power;
                    variance += error * error;
                }
                EXPECT_EQ(shaded.per_light[3][v], Rgbf{});
                EXPECT_EQ(shaded.irradiance[v], to_float(E)) << target;
                EXPECT_EQ(shaded.standard_error[v],
                          to_float({std::sqrt(variance.r), std::sqrt(variance.g),
                                    std::sqrt(variance.b)}));
                EXPECT_EQ(shaded.radiance[v],
                          to_float(by_scalar(stage, lit.transport, lit.scene, {}, v)))
                    << target;
            }
        }
    });
}

TEST(Kernels, AVertexAloneHasTheBytesThatItHasAmongOthers)
{
    const Stage& stage = hard_places();
    on_every_target([&](const char* target) {
        for (const Model& m : models()) {
            Lighting lit = of_many(stage, m.material);
            const auto all = lit.radiance(stage, 2);
            for (std::size_t v = 0; v < all.size(); v += 97) {
                const VertexRadiance parts =
                    vertex_radiance(stage, of_vertex(lit.transport, v), lit.scene, {}, v);
                Rgb L = parts.own;
                for (const Rgb one : parts.of_lights) { L += one; }
                EXPECT_EQ(to_float(L), all[v]) << m.name << " on " << target << ", vertex " << v;
            }
        }
    });
}

TEST(Kernels, MoreLightsThanAreTakenTogetherAddUp)
{
    Lighting lit = of_f(make_cook_torrance(facets(0.3, 0.3)));
    const std::size_t vertices = hard_places().mesh->positions.size();
    for (std::uint64_t l = 1; l < 11;
         ++l) {  // two groups and a part of one, one of them switched off
        lit.scene.lights.push_back(test::light_of(PointLight{lamp + random_direction(l, 40), {}},
                                                  {random(l, 42), 1.0, 2.0}));
        lit.transport.columns.push_back(l == 5 ? nullptr : random_column(l, vertices, 1, false));
        lit.transport.drawn.push_back(nullptr);
    }
    on_every_target(
        [&](const char* target) { expect_near_scalar(hard_places(), lit, 8.0, target); });
}

TEST(Kernels, WithoutLightsAMaterialShowsItsGlowAndNothingElse)
{
    Lighting lit;
    MetallicRoughness glowing;
    glowing.emissive = {1.0, 0.5, 0.1};
    lit.scene.materials = {glowing};
    on_every_target([&](const char* target) {
        for (const Rgbf& L : lit.radiance(hard_places())) {
            EXPECT_EQ(L, to_float(glowing.emissive)) << target;
        }
    });
    lit.scene.materials = {make_cook_torrance(facets(0.3, 0.3))};
    on_every_target([&](const char* target) {
        for (const Rgbf& L : lit.radiance(hard_places())) { EXPECT_EQ(L, Rgbf{}) << target; }
    });
}

TEST(Kernels, OfSeveralMaterialsInTurnsEachKeepsItsColour)
{
    Mesh mesh = test::grid(40);
    for (std::size_t face = 0; face < mesh.faces.count(); ++face) {
        mesh.face_materials.push_back(static_cast<std::uint32_t>(face / 700 % 4));  // long runs
    }
    mesh.materials.resize(4);
    const Stage stage = test::staged(mesh);
    Lighting lit = of_many(stage, Lambert{});
    CookTorrance red = facets(0.3, 0.3), green = red;
    red.albedo = {0.8, 0.1, 0.2};
    green.albedo = {0.1, 0.7, 0.3};
    MetallicRoughness glowing;
    glowing.emissive = {1.0, 0.5, 0.1};
    lit.scene.materials = {make_cook_torrance(red), glowing, make_cook_torrance(green),
                           Lambert{{0.2, 0.4, 0.6}}};
    lit.scene.material_of_group = {0, 1, 2, 3};
    expect_near_scalar(stage, lit, 8.0, "four materials in turns");
}

TEST(Kernels, EachVertexHasItsOwnMaterialColourAndGlow)
{
    Mesh mesh = test::grid(12);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        mesh.colors.push_back({static_cast<float>(random(v, 6)), static_cast<float>(random(v, 7)),
                               static_cast<float>(random(v, 8))});
    }
    for (std::size_t face = 0; face < mesh.faces.count(); ++face) {
        mesh.face_materials.push_back(static_cast<std::uint32_t>(face / 3 % 4));
    }
    mesh.materials.resize(4);
    const Stage stage = test::staged(mesh);
    Lighting lit = of_many(stage, Lambert{});
    MetallicRoughness glowing;
    glowing.emissive = {1.0, 0.5, 0.1};
    glowing.clearcoat = 1.0;
    glowing.base_color_from_vertex = true;
    Principled colored;
    colored.base_color_from_vertex = true;
    colored.sheen = 1.0;
    Lambert plain;
    plain.albedo_from_vertex = true;
    lit.scene.materials = {glowing, plain, colored, make_cook_torrance({})};
    lit.scene.material_of_group = {0, 1, 2, 3};
    expect_near_scalar(stage, lit, 8.0, "four materials");
    lit.scene.camera.eye = {0.3, 0.2, -2.0};  // the back, which does not glow
    lit.scene.transport.two_sided = true;
    expect_near_scalar(stage, lit, 8.0, "four materials from behind");
}

}  // namespace
}  // namespace relight
