// Direct and bounced light against expected values computed independently.
#include "tests/oracle.h"

#include <gtest/gtest.h>

#include "core/transport/transport.h"
#include "tests/scenes.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using nlohmann::json;
using test::NormalisedErrors;
using test::oracle;
using test::point_of;
using test::vec_of;

void add_mesh(Mesh& mesh, const json& part)
{
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const json& v : part["vertices"]) { mesh.positions.push_back(point_of(v)); }
    for (const json& t : part["triangles"]) {
        for (const std::uint32_t i : t) { mesh.faces.indices.push_back(first + i); }
    }
}

/// A disc as a polygon of 720 corners; receivers keep 3 % from its shadow's edge, this 1e-5.
Mesh disc(const json& blocker)
{
    const Frame frame = frame_around(normalize(vec_of(blocker["normal"])));
    const Point3 centre = point_of(blocker["center"]);
    const double radius = blocker["radius"];
    Mesh mesh;
    constexpr std::uint32_t corners = 720;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double a = 2.0 * std::numbers::pi * i / corners;
        mesh.positions.push_back(centre +
                                 frame.to_world({radius * std::cos(a), radius * std::sin(a), 0}));
        mesh.faces.indices.push_back(i);
    }
    mesh.faces.offsets = {0, corners};
    return mesh;
}

/// The blocker that a case describes by a formula, as triangles: a sphere within 1e-4 of its
/// radius, or a disc.
Mesh analytic_blocker(const json& blocker)
{
    if (blocker["type"] == "disk") { return disc(blocker); }
    return test::moved(test::icosphere(6), test::upright(), blocker["radius"],
                       vec_of(blocker["center"]));
}

RectLight rect_of(const json& corners)
{
    const Point3 a = point_of(corners[0]);
    const Vec3 u = point_of(corners[1]) - a;
    const Vec3 v = point_of(corners[3]) - a;
    return {a + u * 0.5 + v * 0.5, u, v, false};
}

Light light_of(const json& j)
{
    const auto grey = [&](const char* name) { return Rgb::grey(j[name].get<double>()); };
    if (j["type"] == "point") {
        return test::light_of(PointLight{point_of(j["position"]), {}}, grey("intensity"));
    }
    if (j["type"] == "directional") {
        return test::light_of(DirectionalLight{normalize(vec_of(j["travel_direction"]))},
                              grey("E_perp"));
    }
    if (j["type"] == "rect") { return test::light_of(rect_of(j["vertices"]), grey("L")); }
    EXPECT_EQ(j["type"], "constant");
    return test::light_of(EnvironmentLight{}, grey("L"));
}

Scene scene_of(const Light& light, unsigned samples = 1024)
{
    Scene scene;
    scene.lights = {light};
    scene.transport.samples = samples;
    // Slivers that few rays meet are no Gaussian: of ten seeds half have a vertex beyond four.
    scene.transport.seed = 1;
    return scene;
}

TEST(Occlusion, EveryCaseIsMetExactlyOrWithinFourStandardErrors)
{
    const json file = oracle("occlusion");
    NormalisedErrors errors;
    int receivers = 0;
    int penumbra = 0;  // receivers whose light is to be within a share of the unoccluded, as an rms
    double squares = 0.0;
    double within = 0.0;
    for (const json& c : file["cases"]) {
        Mesh occluders =
            c.contains("analytic_blocker") ? analytic_blocker(c["analytic_blocker"]) : Mesh{};
        for (const json& part : c["meshes"]) { add_mesh(occluders, part); }
        std::vector<Point3> places;
        std::vector<Vec3> normals;
        for (const json& r : c["receivers"]) {
            places.push_back(point_of(r["p"]));
            normals.push_back(vec_of(r["n"]));
        }
        const Scene scene = scene_of(light_of(c["light"]));
        const Column column = test::Meters(occluders, places, normals).read(scene);
        const double power = scene.lights[0].power.r;
        const bool exact = column.standard_error.empty();
        const json own = c.value("tolerance", json::object());
        test::Tolerance tolerance(file["tolerance"]);
        tolerance.abs = std::max(tolerance.abs, own.value("abs", 0.0));
        for (std::size_t i = 0; i < places.size(); ++i, ++receivers) {
            const json& expected = c["receivers"][i];
            const double E = power * static_cast<double>(column.E[i]);
            const double truth = expected["E"];
            if (exact) {
                EXPECT_EQ(column.visible[i], expected["V"].get<float>())
                    << c["id"] << " receiver " << i;
                EXPECT_TRUE(tolerance.holds(E, truth))
                    << c["id"] << " receiver " << i << ": " << E << " for " << truth;
                continue;
            }
            const double error = power * static_cast<double>(column.standard_error[i]);
            const double slack = std::max(tolerance.rel * truth, tolerance.abs);
            errors.add(E - truth, error, slack,
                       c["id"].get<std::string>() + " receiver " + std::to_string(i));
            if (own.contains("stratified_1024_rel")) {
                const double relative = (E - truth) / expected["E_unoccluded"].get<double>();
                within = own["stratified_1024_rel"];
                squares += relative * relative;
                ++penumbra;
            }
        }
    }
    EXPECT_EQ(file["cases"].size(), 48U);
    EXPECT_GT(receivers, 300);
    EXPECT_GT(penumbra, 0);
    EXPECT_LE(std::sqrt(squares / penumbra), within);
    errors.expect_honest();
}

TEST(VertexScenes, EveryLightOnEveryVertexOfTheGrid)
{
    const json file = oracle("vertex_scenes");
    const test::Tolerance tolerance(file["tolerance"]);
    NormalisedErrors errors;
    int vertices = 0;
    for (const json& c : file["cases"]) {
        Mesh occluders;
        const double z = c["ground"]["z"];
        for (const double x : {-50.0, 50.0}) {
            for (const double y : {-50.0, 50.0}) { occluders.positions.push_back({x, y, z}); }
        }
        occluders.faces.indices = {0, 2, 3, 0, 3, 1};
        add_mesh(occluders, c["blocker"]);
        std::vector<Point3> places;
        std::vector<Vec3> normals;
        for (const json& v : c["vertices"]) {
            places.push_back(point_of(v["p"]));
            normals.push_back(vec_of(v["n"]));
        }
        const test::Meters meters(occluders, places, normals);
        const json& l = c["lights"];
        const std::vector<std::pair<std::string, Light>> lights{
            {"point", test::light_of(PointLight{point_of(l["point"]["position"]), {}},
                                     Rgb::grey(l["point"]["intensity"].get<double>()))},
            {"spot", test::light_of(SpotLight{point_of(l["spot"]["position"]),
                                              normalize(vec_of(l["spot"]["axis"])),
                                              l["spot"]["inner_cone"], l["spot"]["outer_cone"]},
                                    Rgb::grey(l["spot"]["intensity"].get<double>()))},
            {"directional", test::light_of(DirectionalLight{normalize(
                                               vec_of(l["directional"]["travel_direction"]))},
                                           Rgb::grey(l["directional"]["E_perp"].get<double>()))},
            {"rect", test::light_of(rect_of(l["rect"]["vertices"]),
                                    Rgb::grey(l["rect"]["L"].get<double>()))},
            {"environment",
             test::light_of(EnvironmentLight{}, Rgb::grey(l["environment"]["L"].get<double>()))}};
        for (const auto& [name, light] : lights) {
            const Column column = meters.read(scene_of(light, 256));
            Scene unshadowed = scene_of(light);
            unshadowed.transport.shadows = false;
            const Column open = meters.read(unshadowed);
            for (std::size_t i = 0; i < places.size(); ++i, ++vertices) {
                const json& of = c["vertices"][i]["E"];
                const double E = light.power.r * static_cast<double>(column.E[i]);
                const double expected = of[name];
                const std::string place =
                    c["id"].get<std::string>() + " " + name + " vertex " + std::to_string(i);
                if (column.standard_error.empty()) {
                    EXPECT_TRUE(tolerance.holds(E, expected))
                        << place << ": " << E << " for " << expected;
                    continue;
                }
                const double error = light.power.r * static_cast<double>(column.standard_error[i]);
                const double slack = std::max(tolerance.rel * expected, tolerance.abs);
                if (column.visible[i] == 0.0F || column.visible[i] == 1.0F) {
                    // All rays agree, and the error is half of one. That all miss what ten of them
                    // should meet has a chance of e^-10.
                    EXPECT_NEAR(E, expected, 20.0 * error + slack) << place;
                    continue;
                }
                errors.add(E - expected, error, slack, place);
                if (name != "rect") { continue; }
                EXPECT_TRUE(tolerance.holds(light.power.r * static_cast<double>(open.E[i]),
                                            of["rect_unoccluded"].get<double>()))
                    << place;
            }
        }
    }
    EXPECT_EQ(vertices, 6 * 5 * 49);
    errors.expect_honest();
}

}  // namespace
}  // namespace relight
