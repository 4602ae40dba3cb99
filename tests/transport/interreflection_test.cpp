// Light between surfaces against closed forms computed independently.
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "core/base/random.h"
#include "core/base/warp.h"
#include "core/transport/transport.h"
#include "tests/oracle.h"
#include "tests/scenes.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using nlohmann::json;
using test::NormalisedErrors;
using test::oracle;
using test::point_of;
using test::rgb_of;
using test::vec_of;

constexpr double pi = std::numbers::pi;
constexpr double tessellation = 0.005;  // what flat faces may cost, of the value

/// E of the first light, bounces included, and its standard error, at meters beside a mesh.
struct Reading {
    std::vector<Rgb> E, direct, standard_error;
};
Reading read(const test::Meters& meters, const Scene& scene)
{
    const Column c = meters.read(scene);
    const auto at = [](const std::vector<float>& v, unsigned bands, std::size_t i) {
        const auto band = [&](unsigned b) {
            return static_cast<double>(v[i * bands + std::min(b, bands - 1)]);
        };
        return Rgb{band(0), band(1), band(2)};
    };
    Reading reading;
    const Rgb power = scene.lights[0].power;
    for (std::size_t i = 0; i < meters.count; ++i) {
        reading.direct.push_back(at(c.E, c.bands, i) * power);
        reading.E.push_back(reading.direct.back());
        if (!c.E_bounced.empty()) { reading.E.back() += at(c.E_bounced, 3, i) * power; }
        const unsigned bands = c.E_bounced.empty() ? c.bands : 3;
        reading.standard_error.push_back(
            c.standard_error.empty() ? Rgb{} : at(c.standard_error, bands, i) * power);
    }
    return reading;
}

Scene scene_of(Light light, Rgb albedo, unsigned bounces, unsigned samples = 256)
{
    Scene scene;
    scene.lights = {std::move(light)};
    scene.materials = {Lambert{albedo}};
    scene.transport.bounces = bounces;
    scene.transport.samples = samples;
    return scene;
}

std::vector<json> cases_of(const std::string& kind)
{
    const json file = oracle("interreflection");
    std::vector<json> found;
    for (const json& c : file["cases"]) {
        if (c["kind"] == kind) { found.push_back(c); }
    }
    EXPECT_FALSE(found.empty()) << kind;
    return found;
}

Light mesh_light(const Mesh& mesh, const std::vector<Rgb>& radiance_of_triangle)
{
    std::vector<Emitter> emitters;
    for (std::size_t t = 0; t < radiance_of_triangle.size(); ++t) {
        Emitter emitter;
        for (std::size_t c = 0; c < 3; ++c) {
            emitter.corners[c] = mesh.positions[mesh.faces.indices[3 * t + c]];
        }
        emitter.primitive = static_cast<std::uint32_t>(t);
        emitter.L = radiance_of_triangle[t];
        emitters.push_back(emitter);
    }
    return test::light_of(MeshLight{std::make_shared<const EmitterTable>(std::move(emitters))});
}

TEST(Interreflection, EveryKindOfCaseIsTested)
{
    const std::set<std::string> known{"integrating_sphere",  "furnace_enclosure",
                                      "parallel_rectangles", "perpendicular_rectangles",
                                      "coaxial_disks",       "ground_bounce",
                                      "infinite_plates",     "spherical_cavity"};
    const json file = oracle("interreflection");
    for (const json& c : file["cases"]) { EXPECT_TRUE(known.contains(c["kind"])) << c["kind"]; }
}

TEST(Interreflection, AnIntegratingSphereAddsTheSameToEveryPlaceWithEachBounce)
{
    NormalisedErrors errors;
    for (const json& c : cases_of("integrating_sphere")) {
        const json& in = c["in"];
        const Mesh sphere = test::moved(test::icosphere(6), test::upright(), in["radius"], {});
        const Light light = test::light_of(PointLight{point_of(in["light_position"]), {}},
                                           Rgb::grey(in["flux"].get<double>() / (4.0 * pi)));
        // On the round wall, stepped inside the flat faces that stand for it.
        const Point3 p = Point3{} + (point_of(in["p"]) - Point3{}) * (1.0 - 4e-4);
        const test::Meters meter(sphere, {p}, {vec_of(in["n"])});
        const json& expected = c["out"]["E_after_n_bounces"];
        for (unsigned n = 0; n < expected.size(); ++n) {
            const Scene scene = scene_of(light, Rgb::grey(in["albedo"].get<double>()), n);
            const Reading reading = read(meter, scene);
            const double truth = expected[n];
            errors.add(reading.E[0].r - truth, reading.standard_error[0].r, tessellation * truth,
                       c["id"].get<std::string>() + " bounces " + std::to_string(n));
        }
        const Scene series = scene_of(light, Rgb::grey(in["albedo"].get<double>()), 48, 1024);
        const Reading all = read(meter, series);
        const double total = c["out"]["E_total"];
        const double rho = in["albedo"];
        const double left_out = std::pow(rho, 49) * total;
        EXPECT_LT(all.standard_error[0].r, 0.02 * total);
        EXPECT_NEAR(all.E[0].r, total,
                    4.0 * all.standard_error[0].r + tessellation * total + left_out)
            << c["id"];
    }
}

TEST(Interreflection, AFurnaceIsTheSameEverywhereAndInEveryDirection)
{
    NormalisedErrors errors;
    for (const json& c : cases_of("furnace_enclosure")) {
        Mesh room = test::box({-1, -0.7, -0.5}, {1, 0.7, 0.9});
        for (std::size_t t = 0; t < room.faces.indices.size(); t += 3) {  // fronts look inside
            std::swap(room.faces.indices[t + 1], room.faces.indices[t + 2]);
        }
        const Light light =
            mesh_light(room, std::vector<Rgb>(room.faces.count(), rgb_of(c["in"]["Le"])));
        const std::vector<Point3> places{{0, 0, 0}, {0.9, 0.6, -0.4}, {-0.999, 0.1, 0.2}};
        const std::vector<Vec3> normals{{0, 0, 1}, {1, 2, 3}, {1, 0, 0}};
        const test::Meters meters(room, places, normals);
        const json& expected = c["out"]["E_after_n_bounces"];
        for (unsigned n = 0; n < expected.size(); ++n) {
            const Reading reading = read(meters, scene_of(light, rgb_of(c["in"]["albedo"]), n));
            const Rgb truth = rgb_of(expected[n]);
            for (std::size_t i = 0; i < places.size(); ++i) {
                const std::string place = c["id"].get<std::string>() + " bounces " +
                                          std::to_string(n) + " place " + std::to_string(i);
                const Rgb E = reading.E[i];
                const Rgb error = reading.standard_error[i];
                errors.add(E.r - truth.r, error.r, 1e-6 * truth.r, place);
                errors.add(E.g - truth.g, error.g, 1e-6 * truth.g, place);
                errors.add(E.b - truth.b, error.b, 1e-6 * truth.b, place);
            }
        }
        const double rho = rgb_of(c["in"]["albedo"]).g;
        const double total = c["out"]["E"][1];
        const Reading all = read(meters, scene_of(light, rgb_of(c["in"]["albedo"]), 64, 2048));
        EXPECT_LT(all.standard_error[0].g, 0.02 * total);
        EXPECT_NEAR(all.E[0].g, total, 4.0 * all.standard_error[0].g + std::pow(rho, 65) * total)
            << c["id"];
    }
    errors.expect_honest(0.5, 1.35);  // one band's error is like the other's
}

/// Mean of closed-form E over places (s, t) of a receiver, with its error by 64 independent nets.
template <class Place>
void expect_mean(const Light& light, Dir3 n, Place place, double truth, const std::string& id)
{
    constexpr unsigned replicates = 64;
    constexpr unsigned points = 256;
    double sum = 0.0;
    double squares = 0.0;
    for (unsigned r = 0; r < replicates; ++r) {
        const Sequence sequence(3, 0, 0, r);
        double mean = 0.0;
        for (unsigned i = 0; i < points; ++i) {
            mean += *closed_irradiance(light.shape, place(sequence.at(i, 0)), n) / points;
        }
        sum += mean;
        squares += mean * mean;
    }
    const double mean = sum / replicates * light.power.r;
    const double variance =
        (squares / replicates - sum * sum / replicates / replicates) / (replicates - 1);
    const double error = light.power.r * std::sqrt(std::max(0.0, variance));
    EXPECT_NEAR(mean, truth, 4.0 * error + 1e-6 * truth) << id;
    EXPECT_LT(error, 1e-3 * truth) << id;
}

TEST(Interreflection, ParallelRectanglesExchangeHowellsShare)
{
    for (const json& c : cases_of("parallel_rectangles")) {
        const double a = c["in"]["a"];
        const double b = c["in"]["b"];
        const Light light =
            test::light_of(RectLight{{0, 0, c["in"]["h"]}, {0, a, 0}, {b, 0, 0}, false},
                           Rgb::grey(c["in"]["emitter_L"].get<double>()));
        const auto place = [&](Sample2 s) { return Point3{b * (s.u - 0.5), a * (s.v - 0.5), 0}; };
        expect_mean(light, normalize({0, 0, 1}), place, c["out"]["mean_E_on_other"], c["id"]);
        Light unit = light;
        unit.power = Rgb::grey(1.0);
        expect_mean(unit, normalize({0, 0, 1}), place, pi * c["out"]["F12"].get<double>(), c["id"]);
    }
}

TEST(Interreflection, PerpendicularRectanglesExchangeHowellsShare)
{
    for (const json& c : cases_of("perpendicular_rectangles")) {
        const double depth = c["in"]["floor_depth"];
        const double edge = c["in"]["shared_edge"];
        const double height = c["in"]["wall_height"];
        // The wall stands in x = 0 and shines along +x over the floor.
        const Light light =
            test::light_of(RectLight{{0, 0, 0.5 * height}, {0, edge, 0}, {0, 0, height}, false},
                           Rgb::grey(c["in"]["wall_L"].get<double>()));
        const auto place = [&](Sample2 s) { return Point3{depth * s.u, edge * (s.v - 0.5), 0}; };
        expect_mean(light, normalize({0, 0, 1}), place, c["out"]["mean_E_on_floor"], c["id"]);
        Light unit = light;
        unit.power = Rgb::grey(1.0);
        expect_mean(unit, normalize({0, 0, 1}), place,
                    pi * c["out"]["F_floor_to_wall"].get<double>(), c["id"]);
    }
}

TEST(Interreflection, CoaxialDisksExchangeHowellsShare)
{
    for (const json& c : cases_of("coaxial_disks")) {
        const double r1 = c["in"]["r1"];
        const Light light =
            test::light_of(DiskLight{{0, 0, c["in"]["h"]}, normalize({0, 0, -1}), c["in"]["r2"]});
        const auto place = [&](Sample2 s) { return Point3{} + warp::disk(s) * r1; };
        expect_mean(light, normalize({0, 0, 1}), place, pi * c["out"]["F12"].get<double>(),
                    c["id"]);
    }
}

TEST(Interreflection, AWideGroundSendsTheSunUpward)
{
    NormalisedErrors errors;
    for (const json& c : cases_of("ground_bounce")) {
        const json& in = c["in"];
        const Mesh ground = test::moved(test::grid(1), test::upright(), 3e3, {});
        const Light sun =
            test::light_of(DirectionalLight{normalize(vec_of(in["travel_direction"]))},
                           Rgb::grey(in["E_perp"].get<double>()));
        const Scene scene = scene_of(sun, Rgb::grey(in["ground_albedo"].get<double>()), 1, 1024);
        const Reading reading =
            read({ground, {{0, 0, 1}, {0.3, 0.2, 0}}, {vec_of(in["n"]), {0, 0, 1}}}, scene);
        EXPECT_NEAR(reading.direct[0].r, c["out"]["E_direct"], 1e-5 * sun.power.r) << c["id"];
        EXPECT_NEAR(reading.E[1].r, c["out"]["E_ground"], 1e-5 * sun.power.r) << c["id"];
        const double truth = c["out"]["E_1bounce"];
        errors.add(reading.E[0].r - reading.direct[0].r - truth, reading.standard_error[0].r,
                   1e-5 * sun.power.r, c["id"]);
    }
}

TEST(Interreflection, InfinitePlatesHandOnTheProductOfTheirAlbedos)
{
    constexpr unsigned bounces = 24;
    for (const json& c : cases_of("infinite_plates")) {
        const json& in = c["in"];
        Mesh below = test::moved(test::grid(1), test::upright(), 1e3, {});
        Mesh above = test::moved(test::grid(1), test::upright(), 1e3, {0, 0, 1});
        Mesh plates = test::joined(below, above);
        plates.materials = {"one", "two"};
        plates.face_materials = {0, 0, 1, 1};
        const Rgb Le = Rgb::grey(in["Le_1"].get<double>());
        Scene scene = scene_of(mesh_light(plates, {Le, Le}), {}, bounces, 1024);
        scene.materials = {Lambert{Rgb::grey(in["albedo_1"].get<double>())},
                           Lambert{Rgb::grey(in["albedo_2"].get<double>())}};
        scene.material_of_group = {0, 1};
        const Reading reading =
            read({plates, {{0, 0, 0.999}, {0.1, 0, 0.001}}, {{0, 0, -1}, {0, 0, 1}}}, scene);
        const double q = in["albedo_1"].get<double>() * in["albedo_2"].get<double>();
        const double on_2 = c["out"]["E_on_2"].get<double>() * (1.0 - std::pow(q, bounces / 2 + 1));
        const double on_1 = c["out"]["E_on_1"].get<double>() * (1.0 - std::pow(q, bounces / 2));
        const double slack = 1e-5 * on_2;  // plates end a thousand gaps away
        EXPECT_NEAR(reading.direct[0].r, c["out"]["E_on_2_direct_only"],
                    4.0 * reading.standard_error[0].r + slack)
            << c["id"];
        EXPECT_NEAR(reading.E[0].r, on_2, 4.0 * reading.standard_error[0].r + slack) << c["id"];
        EXPECT_NEAR(reading.E[1].r, on_1, 4.0 * reading.standard_error[1].r + slack) << c["id"];
        EXPECT_LT(reading.standard_error[0].r, 0.02 * on_2) << c["id"];
    }
}

/// A sphere without the cap around +z of that half angle.
Mesh bowl(double radius, double half_angle)
{
    constexpr int rings = 96;
    constexpr int sectors = 192;
    Mesh mesh;
    for (int i = 0; i <= rings; ++i) {
        const double theta = half_angle + (pi - half_angle) * i / rings;
        for (int j = 0; j < sectors; ++j) {
            const double phi = 2.0 * pi * j / sectors;
            mesh.positions.push_back({radius * std::sin(theta) * std::cos(phi),
                                      radius * std::sin(theta) * std::sin(phi),
                                      radius * std::cos(theta)});
        }
    }
    const auto at = [&](int i, int j) {
        return static_cast<std::uint32_t>(i * sectors + j % sectors);
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < sectors; ++j) {
            mesh.faces.indices.insert(mesh.faces.indices.end(),
                                      {at(i, j), at(i, j + 1), at(i + 1, j), at(i, j + 1),
                                       at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh;
}

TEST(Interreflection, ABowlUnderTheSkyGlowsAlikeEverywhere)
{
    constexpr unsigned bounces = 32;
    NormalisedErrors errors;
    for (const json& c : cases_of("spherical_cavity")) {
        const json& in = c["in"];
        const double half = in["hole_half_angle"];
        const double R = in["radius"];
        std::vector<Point3> places;
        std::vector<Vec3> normals;
        for (const double theta : {pi, 0.5 * (half + pi), half + 0.1}) {
            const Vec3 out{std::sin(theta), 0, std::cos(theta)};
            places.push_back(Point3{} + out * (R * (1.0 - 1e-3)));
            normals.push_back(-out);
        }
        const double rho = in["albedo"];
        const Scene scene =
            scene_of(test::light_of(EnvironmentLight{}, Rgb::grey(in["sky_L"].get<double>())),
                     Rgb::grey(rho), bounces, 1024);
        const Reading reading = read({bowl(R, half), places, normals}, scene);
        const double f = 0.5 * (1.0 - std::cos(half));
        const double total =
            c["out"]["E_total"].get<double>() * (1.0 - std::pow(rho * (1.0 - f), bounces + 1));
        for (std::size_t i = 0; i < places.size(); ++i) {
            const std::string place = c["id"].get<std::string>() + " place " + std::to_string(i);
            errors.add(reading.E[i].r - total, reading.standard_error[i].r, tessellation * total,
                       place);
            EXPECT_NEAR(reading.direct[i].r, c["out"]["E_direct_mean"].get<double>(),
                        4.0 * reading.standard_error[i].r + tessellation * total)
                << place;
        }
    }
}

}  // namespace
}  // namespace relight
