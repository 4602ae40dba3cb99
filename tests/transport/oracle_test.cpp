// Direct light with occluders against expected values computed independently.
#include "tests/oracle.h"

#include <gtest/gtest.h>

#include "core/transport/transport.h"
#include "tests/scenes.h"

namespace relight {
namespace {

using nlohmann::json;
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

Light light_of(const json& j)
{
    if (j["type"] == "point") {
        return test::light_of(PointLight{point_of(j["position"]), {}},
                              Rgb::grey(j["intensity"].get<double>()));
    }
    return test::light_of(DirectionalLight{normalize(vec_of(j["travel_direction"]))},
                          Rgb::grey(j["E_perp"].get<double>()));
}

bool is_punctual(const json& light)
{
    return light["type"] == "point" || light["type"] == "directional";
}

TEST(Occlusion, PunctualLightIsBlockedExactlyWhereGeometrySaysSo)
{
    const json file = oracle("occlusion");
    int cases = 0;
    for (const json& c : file["cases"]) {
        if (!is_punctual(c["light"])) { continue; }  // areas and skies: not built yet
        ++cases;
        Mesh occluders = c.contains("analytic_blocker") ? disc(c["analytic_blocker"]) : Mesh{};
        for (const json& part : c["meshes"]) { add_mesh(occluders, part); }
        std::vector<Point3> places;
        std::vector<Vec3> normals;
        for (const json& r : c["receivers"]) {
            places.push_back(point_of(r["p"]));
            normals.push_back(vec_of(r["n"]));
        }
        const std::size_t first = occluders.positions.size();
        const Stage stage = test::staged(test::with_receivers(occluders, places, normals));
        const Light light = light_of(c["light"]);
        const Column column = direct_column(stage, light, {}, 1.0, first, first + places.size());
        const test::Tolerance tolerance(file["tolerance"]);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const json& expected = c["receivers"][i];
            const double E = light.power.r * static_cast<double>(column.E[i]);
            EXPECT_EQ(column.visible[i], expected["V"].get<int>()) << c["id"] << " receiver " << i;
            EXPECT_TRUE(tolerance.holds(E, expected["E"].get<double>()))
                << c["id"] << " receiver " << i << ": " << E << " for " << expected["E"];
        }
    }
    EXPECT_EQ(cases, 12);
}

TEST(VertexScenes, EveryPunctualLightOnEveryVertexOfTheGrid)
{
    const json file = oracle("vertex_scenes");
    const test::Tolerance tolerance(file["tolerance"]);
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
        const std::size_t first = occluders.positions.size();
        const Stage stage = test::staged(test::with_receivers(occluders, places, normals));
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
                                           Rgb::grey(l["directional"]["E_perp"].get<double>()))}};
        for (const auto& [name, light] : lights) {
            const Column column =
                direct_column(stage, light, {}, 1.0, first, first + places.size());
            for (std::size_t i = 0; i < places.size(); ++i) {
                const double E = light.power.r * static_cast<double>(column.E[i]);
                const double expected = c["vertices"][i]["E"][name];
                EXPECT_TRUE(tolerance.holds(E, expected)) << c["id"] << " " << name << " vertex "
                                                          << i << ": " << E << " for " << expected;
                ++vertices;
            }
        }
    }
    EXPECT_EQ(vertices, 6 * 3 * 49);
}

}  // namespace
}  // namespace relight
