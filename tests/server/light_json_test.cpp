// Lights and materials that are right: what each field becomes.
#include <numbers>

#include "core/light/temperature.h"
#include "tests/server/refusals.h"

namespace relight {
namespace {

using test::with;
using test::with_light;
using test::with_material;

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
const std::string id(64, 'c');

RelightRequest parsed(const std::string& json)
{
    auto request = parse_request(json, {});
    EXPECT_TRUE(request) << json << '\n'
                         << (request ? ""
                                     : request.error().pointer + ": " + request.error().detail);
    return request ? std::move(*request) : RelightRequest{};
}
/// The one light of a request with these fields; `more` stands beside "lights".
Light light(const std::string& fields, const std::string& more = "")
{
    const auto request = parsed(with(more + R"("lights":[{)" + fields + "}]"));
    EXPECT_EQ(request.scene.lights.size(), 1U);
    return request.scene.lights.empty() ? Light{} : request.scene.lights[0];
}
template <class Shape>
Shape shape(const std::string& fields)
{
    const Light one = light(fields);
    EXPECT_TRUE(std::holds_alternative<Shape>(one.shape)) << fields;
    const Shape* found = std::get_if<Shape>(&one.shape);
    return found == nullptr ? Shape{} : *found;
}
template <class Model>
Model material(const std::string& fields)
{
    const Material one = parsed(with_material(fields)).scene.materials.at(0);
    EXPECT_TRUE(std::holds_alternative<Model>(one)) << fields;
    const Model* found = std::get_if<Model>(&one);
    return found == nullptr ? Model{} : *found;
}
void expect_near(Vec3 a, Vec3 b)
{
    EXPECT_LT(length(a - b), 1e-12) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(LightJson, ReadsTheShapesOfAreaLights)
{
    const auto rect = shape<RectLight>(
        R"("type":"rect","center":[1,2,3],"edge_u":[4,0,0],"edge_v":[0,0,-5],
           "radiance_w_m2_sr":5,"two_sided":true)");
    EXPECT_EQ(rect.center, (Point3{1, 2, 3}));
    EXPECT_EQ(rect.edge_u, (Vec3{4, 0, 0}));
    EXPECT_EQ(rect.edge_v, (Vec3{0, 0, -5}));
    EXPECT_TRUE(rect.two_sided);
    EXPECT_FALSE(shape<RectLight>(R"("type":"rect","center":[0,0,0],"edge_u":[1,0,0],
                                     "edge_v":[0,1,0],"flux_w":5)")
                     .two_sided);
    const auto disk = shape<DiskLight>(
        R"("type":"disk","center":[1,2,3],"normal":[0,-2,0],"radius":0.5,"luminance_cd_m2":7)");
    EXPECT_EQ(disk.center, (Point3{1, 2, 3}));
    EXPECT_EQ(disk.normal.y(), -1);
    EXPECT_EQ(disk.radius, 0.5);
    const auto sphere =
        shape<SphereLight>(R"("type":"sphere","center":[1,2,3],"radius":0.25,"flux_lm":800)");
    EXPECT_EQ(sphere.center, (Point3{1, 2, 3}));
    EXPECT_EQ(sphere.radius, 0.25);
}

TEST(LightJson, TakesRadianceAsItIs)
{
    for (const char* power : {R"("radiance_w_m2_sr":6)", R"("luminance_cd_m2":6)"}) {
        for (const char* where :
             {R"("type":"rect","center":[0,0,0],"edge_u":[3,0,0],"edge_v":[0,1,0],)",
              R"("type":"disk","center":[0,0,0],"normal":[0,1,0],"radius":3,)",
              R"("type":"sphere","center":[0,0,0],"radius":3,)", R"("type":"environment",)"}) {
            EXPECT_EQ(light(std::string(where) + power, R"("length_unit_m":0.01,)").power,
                      Rgb::grey(6))
                << where << power;
        }
    }
}

TEST(LightJson, SpreadsFluxOverTheAreaInSquareMetres)  // contract section 1: L = Phi / (pi A)
{
    struct Case {
        std::string fields;
        double area;  ///< of all that shines, length units squared
    };
    const Case cases[] = {
        {R"("type":"rect","center":[0,0,0],"edge_u":[3,0,0],"edge_v":[1,2,0],)", 6},
        {R"("type":"rect","center":[0,0,0],"edge_u":[3,0,0],"edge_v":[1,2,0],"two_sided":true,)",
         12},
        {R"("type":"disk","center":[0,0,0],"normal":[0,1,0],"radius":3,)", pi * 9},
        {R"("type":"sphere","center":[0,0,0],"radius":3,)", 4 * pi * 9}};
    for (const Case& one : cases) {
        for (const char* flux : {R"("flux_w":40)", R"("flux_lm":40)"}) {
            for (const double unit : {1.0, 0.001, 25.4}) {
                const Light lit = light(one.fields + R"("color":[1,0.5,0],)" + flux,
                                        R"("length_unit_m":)" + std::to_string(unit) + ",");
                const double L = 40 / (pi * one.area * unit * unit);
                EXPECT_NEAR(lit.power.r, L, 1e-9 * L) << one.fields;
                EXPECT_NEAR(lit.power.g, 0.5 * L, 1e-9 * L) << one.fields;
                EXPECT_EQ(lit.power.b, 0) << one.fields;
            }
        }
    }
}

TEST(LightJson, KnowsNoLengthForThePowerOfAPoint)
{
    const char* point = R"("type":"point","position":[0,0,1],"flux_w":40)";
    EXPECT_EQ(light(point).power, light(point, R"("length_unit_m":0.001,)").power);
}

TEST(LightJson, ALightWithoutAreaMayHaveRadiance)
{
    EXPECT_EQ(light(R"("type":"sphere","center":[0,0,0],"radius":0,"radiance_w_m2_sr":5)").power,
              Rgb::grey(5));
    EXPECT_EQ(light(R"("type":"rect","center":[0,0,0],"edge_u":[1,0,0],"edge_v":[2,0,0],
                       "luminance_cd_m2":5)")
                  .power,
              Rgb::grey(5));
    EXPECT_EQ(light(R"("type":"disk","center":[0,0,0],"normal":[0,0,1],"radius":0,
                       "luminance_cd_m2":0)")
                  .power,
              Rgb::grey(0));
}

TEST(LightJson, ReadsTheSunsDiscAsAFullAngle)
{
    const std::string sun = R"("type":"directional","direction":[0,-2,0],"illuminance_lx":3)";
    EXPECT_EQ(shape<DirectionalLight>(sun).half_angle, 0);
    EXPECT_EQ(shape<DirectionalLight>(sun + R"(,"angle_deg":0)").half_angle, 0);
    EXPECT_DOUBLE_EQ(shape<DirectionalLight>(sun + R"(,"angle_deg":0.53)").half_angle,
                     0.265 * degree);
    EXPECT_DOUBLE_EQ(shape<DirectionalLight>(sun + R"(,"angle_deg":180)").half_angle, pi / 2);
    EXPECT_EQ(shape<DirectionalLight>(sun + R"(,"angle_deg":1e-300)").half_angle, 0);
    EXPECT_EQ(shape<DirectionalLight>(sun).travel.y(), -1);
}

TEST(LightJson, NamesTheFilesThatLightsNeed)
{
    const auto request = parsed(with(R"("lights":[
        {"type":"environment","luminance_cd_m2":1},
        {"type":"environment","image":{"part":"sky"},"rotation_deg":90,"scale":2,"color":[1,0.5,0]},
        {"type":"environment","image":{"id":")" +
                                     id + R"("}},
        {"type":"ies","position":[0,2,0],"direction":[0,-1,0],"profile":{"part":"lamp"},"scale":3}])"));
    const auto& lights = request.scene.lights;
    const auto& files = request.light_files;
    ASSERT_EQ(lights.size(), 4U);
    ASSERT_EQ(files.size(), 3U);
    EXPECT_EQ(files[0].light, 1U);
    EXPECT_EQ(files[0].pointer, "/lights/1/image");
    EXPECT_EQ(std::get<PartMesh>(files[0].source).part, "sky");
    EXPECT_EQ(files[1].light, 2U);
    EXPECT_EQ(std::get<StoredMesh>(files[1].source).id, id);
    EXPECT_EQ(files[2].light, 3U);
    EXPECT_EQ(files[2].pointer, "/lights/3/profile");
    EXPECT_EQ(std::get<PartMesh>(files[2].source).part, "lamp");
    EXPECT_EQ(lights[1].power, (Rgb{2, 1, 0}));  // scale x color
    EXPECT_DOUBLE_EQ(std::get<EnvironmentLight>(lights[1].shape).rotation, pi / 2);
    EXPECT_EQ(lights[2].power, Rgb::grey(1));
    EXPECT_EQ(std::get<EnvironmentLight>(lights[2].shape).rotation, 0);
    EXPECT_EQ(lights[3].power, Rgb::grey(3));
}

TEST(LightJson, TurnsALampByItsUp)  // h0: up, made perpendicular to direction
{
    const std::string lamp =
        R"("type":"ies","position":[1,2,3],"direction":[0,-3,0],"profile":{"part":"p"})";
    const auto turned = shape<IesLight>(lamp + R"(,"up":[5,-7,0])");
    EXPECT_EQ(turned.position, (Point3{1, 2, 3}));
    expect_near(turned.axis, {0, -1, 0});
    expect_near(turned.h0, {1, 0, 0});
    const auto alone = shape<IesLight>(lamp);
    EXPECT_NEAR(dot(alone.axis, alone.h0), 0, 1e-12);
    EXPECT_NEAR(length(alone.h0), 1, 1e-12);
}

TEST(LightJson, PutsTheSkysSunWhereItIsToldOrWhereTheTimeSays)
{
    const auto sky = [](const std::string& fields) {
        const auto request = parsed(with_light(R"("type":"sky",)" + fields));
        EXPECT_EQ(request.skies.size(), 1U);
        return request.skies.empty() ? ClearSky{} : request.skies[0];
    };
    const ClearSky told = sky(R"("sun_direction":[0,2,2])");
    expect_near(told.toward_sun, {0, std::sqrt(0.5), std::sqrt(0.5)});
    EXPECT_EQ(told.turbidity, 3);
    EXPECT_EQ(sky(R"("sun_direction":[0,2,2],"turbidity":5)").turbidity, 5);
    // At the equinox the sun passes overhead on the equator: at Greenwich about noon.
    const std::string equator = R"("latitude_deg":0,"time":"2026-03-20T14:07:00+02:00",)";
    EXPECT_GT(sky(equator + R"("longitude_deg":0)").toward_sun.y(), std::cos(1.0 * degree));
    EXPECT_LT(sky(equator + R"("longitude_deg":180)").toward_sun.y(), -std::cos(1.0 * degree));
    const Dir3 tropic =
        sky(R"("latitude_deg":23.44,"longitude_deg":0,"time":"2026-06-21T12:02:00Z")").toward_sun;
    EXPECT_GT(tropic.y(), std::cos(1.0 * degree));
    const auto second = parsed(with(R"("lights":[{"type":"from_mesh"},
                                       {"type":"sky","sun_direction":[0,1,0]}])"));
    EXPECT_EQ(second.skies.at(0).light, 1U);
}

TEST(LightJson, ColoursLightsByTemperature)
{
    const Light warm = light(
        R"("type":"directional","direction":[0,0,-1],"illuminance_lx":10,"temperature_k":2700)");
    EXPECT_EQ(warm.power, blackbody(2700) * 10);
    EXPECT_GT(warm.power.r, warm.power.b);
    const Light mesh = light(R"("type":"from_mesh","temperature_k":6500)");
    EXPECT_EQ(mesh.power, blackbody(6500));
}

TEST(LightJson, LeavesTheFacesOfTheMeshToTheMesh)
{
    EXPECT_EQ(shape<MeshLight>(R"("type":"from_mesh","name":"own","enabled":false)").table,
              nullptr);
    EXPECT_EQ(light(R"("type":"from_mesh")").power, Rgb::grey(1));
}

TEST(LightJson, TakesItsUnitsFromTheLightsThatHaveSome)
{
    const auto units = [](const std::string& lights, const std::string& more = "") {
        return parsed(with(more + R"("lights":[)" + lights + "]")).scene.units;
    };
    const std::string mesh = R"({"type":"from_mesh"})";
    const std::string image = R"({"type":"environment","image":{"part":"p"}})";
    const std::string watts = R"({"type":"environment","radiance_w_m2_sr":1})";
    const std::string lumens = R"({"type":"sphere","center":[0,0,9],"radius":1,"flux_lm":1})";
    const std::string sky = R"({"type":"sky","sun_direction":[0,1,0]})";
    const std::string lamp =
        R"({"type":"ies","position":[0,0,9],"direction":[0,0,-1],"profile":{"part":"p"}})";
    EXPECT_EQ(units(mesh), Units::Photometric);
    EXPECT_EQ(units(sky), Units::Photometric);
    EXPECT_EQ(units(lamp), Units::Photometric);
    EXPECT_EQ(units(image), Units::Radiometric);
    EXPECT_EQ(units(mesh + "," + watts), Units::Radiometric);
    EXPECT_EQ(units(image + "," + lumens + "," + sky + "," + lamp), Units::Photometric);
    EXPECT_EQ(units(watts + "," + sky, R"("luminous_efficacy_lm_w":683,)"), Units::Photometric);
}

TEST(LightJson, ConvertsWattsAloneByTheEfficacy)
{
    const auto request = parsed(with(R"("luminous_efficacy_lm_w":100,"lights":[
        {"type":"environment","radiance_w_m2_sr":2},
        {"type":"environment","luminance_cd_m2":2},
        {"type":"sphere","center":[0,0,9],"radius":1,"flux_w":2},
        {"type":"environment","image":{"part":"p"},"scale":2},
        {"type":"ies","position":[0,0,9],"direction":[0,0,-1],"profile":{"part":"p"},"scale":2},
        {"type":"from_mesh"}])"));
    const auto& lights = request.scene.lights;
    ASSERT_EQ(lights.size(), 6U);
    EXPECT_EQ(lights[0].power.r, 200);
    EXPECT_EQ(lights[1].power.r, 2);
    EXPECT_NEAR(lights[2].power.r, 200 / (4 * pi * pi), 1e-12);
    EXPECT_EQ(lights[3].power.r, 2);
    EXPECT_EQ(lights[4].power.r, 2);
    EXPECT_EQ(lights[5].power.r, 1);
}

TEST(MaterialJson, ReadsOrenNayar)
{
    const auto rough =
        material<OrenNayar>(R"("model":"oren_nayar","albedo":[0.1,0.2,0.3],"sigma_deg":30)");
    EXPECT_EQ(rough.albedo, (Rgb{0.1, 0.2, 0.3}));
    EXPECT_DOUBLE_EQ(rough.sigma, 30 * degree);
    EXPECT_EQ(material<OrenNayar>(R"("model":"oren_nayar")").sigma, 0);
    EXPECT_TRUE(
        material<OrenNayar>(R"("model":"oren_nayar","albedo":"vertex")").albedo_from_vertex);
}

TEST(MaterialJson, ReadsCookTorrance)
{
    const auto facets = material<CookTorrance>(
        R"("model":"cook_torrance","albedo":[0,0,0],"f0":[0.9,0.8,0.7],"roughness":0.3,
           "distribution":"gtr","gamma":1.5,"multiscatter":true)");
    EXPECT_EQ(std::get<SchlickF0>(facets.fresnel).F0, (Rgb{0.9, 0.8, 0.7}));
    EXPECT_EQ(facets.distribution, Distribution::Gtr);
    EXPECT_EQ(facets.gamma, 1.5);
    EXPECT_DOUBLE_EQ(facets.alpha_x, 0.09);
    EXPECT_TRUE(facets.multiscatter);
    EXPECT_FALSE(material<CookTorrance>(R"("model":"cook_torrance")").multiscatter);
    const auto glass = material<CookTorrance>(R"("model":"cook_torrance","ior":1.7)");
    EXPECT_EQ(std::get<DielectricIor>(glass.fresnel).ior, 1.7);
}

TEST(MaterialJson, ReadsEveryScalarOfDisneysModel)
{
    const auto m = material<Principled>(
        R"("model":"principled","base_color":[0.1,0.2,0.3],"metallic":0.01,"subsurface":0.02,
           "specular":0.03,"roughness":0.04,"specular_tint":0.05,"anisotropic":0.06,"sheen":0.07,
           "sheen_tint":0.08,"clearcoat":0.09,"clearcoat_gloss":0.11)");
    EXPECT_EQ(m.base_color, (Rgb{0.1, 0.2, 0.3}));
    EXPECT_EQ(m.metallic, 0.01);
    EXPECT_EQ(m.subsurface, 0.02);
    EXPECT_EQ(m.specular, 0.03);
    EXPECT_EQ(m.roughness, 0.04);
    EXPECT_EQ(m.specular_tint, 0.05);
    EXPECT_EQ(m.anisotropic, 0.06);
    EXPECT_EQ(m.sheen, 0.07);
    EXPECT_EQ(m.sheen_tint, 0.08);
    EXPECT_EQ(m.clearcoat, 0.09);
    EXPECT_EQ(m.clearcoat_gloss, 0.11);
    EXPECT_FALSE(m.base_color_from_vertex);
    const auto plain = material<Principled>(R"("model":"principled","base_color":"vertex")");
    EXPECT_TRUE(plain.base_color_from_vertex);
    EXPECT_EQ(plain.roughness, Principled{}.roughness);
}

TEST(MaterialJson, ReadsEveryFactorOfGltfsModel)
{
    const auto m = material<MetallicRoughness>(
        R"("model":"metallic_roughness","base_color":[0.1,0.2,0.3],"metallic":0.01,
           "roughness":0.02,"ior":1.3,"specular":0.04,"specular_color":[0.5,1.5,2.5],
           "clearcoat":0.06,"clearcoat_roughness":0.07,"sheen_color":[0.8,0.9,1],
           "sheen_roughness":0.11,"anisotropy_strength":0.12,"anisotropy_rotation_deg":-90,
           "emissive":[0.3,0.2,0.1],"emissive_strength":1400)");
    EXPECT_EQ(m.base_color, (Rgb{0.1, 0.2, 0.3}));
    EXPECT_EQ(m.metallic, 0.01);
    EXPECT_EQ(m.roughness, 0.02);
    EXPECT_EQ(m.ior, 1.3);
    EXPECT_EQ(m.specular, 0.04);
    EXPECT_EQ(m.specular_color, (Rgb{0.5, 1.5, 2.5}));
    EXPECT_EQ(m.clearcoat, 0.06);
    EXPECT_EQ(m.clearcoat_roughness, 0.07);
    EXPECT_EQ(m.sheen_color, (Rgb{0.8, 0.9, 1}));
    EXPECT_EQ(m.sheen_roughness, 0.11);
    EXPECT_EQ(m.anisotropy_strength, 0.12);
    EXPECT_DOUBLE_EQ(m.anisotropy_rotation, -pi / 2);
    EXPECT_EQ(m.emissive, (Rgb{0.3, 0.2, 0.1}));
    EXPECT_EQ(m.emissive_strength, 1400);
    EXPECT_EQ(material<MetallicRoughness>(R"("model":"metallic_roughness","ior":0)").ior, 0);
    const auto plain = material<MetallicRoughness>(R"("model":"metallic_roughness")");
    EXPECT_EQ(plain.base_color, Rgb::grey(1));
    EXPECT_EQ(plain.ior, 1.5);
    EXPECT_EQ(plain.emissive_strength, 1);
}

TEST(MaterialJson, KeepsTheOrderOfTheGroups)
{
    const auto request = parsed(with(R"("material":{"model":"lambert","albedo":[0,0,1]},
        "materials":{"z":{"model":"principled"},"":{"model":"lambert"},"0":{"model":"oren_nayar"}})"));
    EXPECT_EQ(request.scene.materials.size(), 1U);
    ASSERT_EQ(request.materials.size(), 3U);
    EXPECT_EQ(request.materials[0].group, "z");
    EXPECT_TRUE(std::holds_alternative<Principled>(request.materials[0].material));
    EXPECT_EQ(request.materials[1].group, "");
    EXPECT_EQ(request.materials[2].group, "0");
}

}  // namespace
}  // namespace relight
