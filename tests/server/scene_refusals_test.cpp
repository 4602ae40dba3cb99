#include <gtest/gtest.h>

#include "server/problem.h"
#include "server/scene_json.h"

namespace relight {
namespace {

/// A request that is wrong in one way, and what the answer must say.
struct Refusal {
    std::string json;
    int status;
    Fault fault;
    std::string pointer;
};

std::string times(int count, const std::string& text)
{
    std::string all;
    for (int i = 0; i < count; ++i) { all += text; }
    return all;
}
std::string with(const std::string& fields)
{
    return R"({"mesh":{"positions":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]]},)" + fields + "}";
}
std::string mesh(const std::string& fields)
{
    return R"({"mesh":{)" + fields + "}}";
}
std::string light(const std::string& fields)
{
    return with(R"("lights":[{)" + fields + "}]");
}
std::string point(const std::string& fields)
{
    return light(R"("type":"point","position":[0,0,1],)" + fields);
}
std::string spot(const std::string& fields)
{
    return light(R"("type":"spot","position":[0,0,1],"direction":[0,0,-1],"flux_w":1,)" + fields);
}
std::string sun(const std::string& fields)
{
    return light(R"("type":"directional","irradiance_w_m2":1,)" + fields);
}
std::string material(const std::string& fields)
{
    return with(R"("material":{)" + fields + "}");
}
std::string facets(const std::string& fields)
{
    return material(R"("model":"cook_torrance",)" + fields);
}
std::string output(const std::string& fields)
{
    return with(R"("output":{)" + fields + "}");
}

const Refusal refusals[] = {
    // the text
    {"", 400, Fault::MalformedJson, ""},
    {"{", 400, Fault::MalformedJson, ""},
    {"{} x", 400, Fault::MalformedJson, ""},
    {"{'a':1}", 400, Fault::MalformedJson, ""},
    {"{\"mesh\":\"\xff\"}", 400, Fault::MalformedJson, ""},
    {R"({"mesh":NaN})", 400, Fault::MalformedJson, ""},
    {R"({"mesh":{"positions":[[0,0,Infinity]]}})", 400, Fault::MalformedJson, ""},
    {R"(// no
{})",
     400, Fault::MalformedJson, ""},
    {"[]", 422, Fault::WrongType, ""},
    {"3", 422, Fault::WrongType, ""},
    {with(R"("length_unit_m":1e999)"), 422, Fault::NotFinite, "/length_unit_m"},
    {with(R"("a/b~c":1)"), 422, Fault::UnknownField, "/a~1b~0c"},
    {with(R"("view":{"type":"normal"},"view":{"type":"normal"})"), 422, Fault::DuplicateField,
     "/view"},
    {std::string(40, '[') + std::string(40, ']'), 422, Fault::JsonTooDeep, times(32, "/0")},
    // the top
    {"{}", 422, Fault::MissingField, "/mesh"},
    {with(R"("ligths":[])"), 422, Fault::UnknownField, "/ligths"},
    {with(R"("lights":{})"), 422, Fault::WrongType, "/lights"},
    {with(R"("length_unit_m":0)"), 422, Fault::OutOfRange, "/length_unit_m"},
    {with(R"("length_unit_m":"1")"), 422, Fault::WrongType, "/length_unit_m"},
    {with(R"("luminous_efficacy_lm_w":700)"), 422, Fault::OutOfRange, "/luminous_efficacy_lm_w"},
    {with(R"("materials":{})"), 422, Fault::NotAvailable, "/materials"},
    {with(R"("receipt":true)"), 422, Fault::NotAvailable, "/receipt"},
    {with(R"("receipt":1)"), 422, Fault::WrongType, "/receipt"},
    // the mesh
    {R"({"mesh":"x"})", 422, Fault::WrongType, "/mesh"},
    {mesh(""), 422, Fault::MissingField, "/mesh/positions"},
    {mesh(R"("id":"../../etc/passwd")"), 422, Fault::UnknownValue, "/mesh/id"},
    {mesh(R"("id":5)"), 422, Fault::WrongType, "/mesh/id"},
    {mesh(R"("id":"x","part":"y")"), 422, Fault::ConflictingFields, "/mesh/part"},
    {mesh(R"("id":")" + std::string(64, 'a') + R"(","positions":[[0,0,0]])"), 422,
     Fault::UnknownField, "/mesh/positions"},
    {mesh(R"("part":"")"), 422, Fault::WrongLength, "/mesh/part"},
    {mesh(R"("positions":[])"), 422, Fault::NoGeometry, "/mesh/positions"},
    {mesh(R"("positions":"x")"), 422, Fault::WrongType, "/mesh/positions"},
    {mesh(R"("positions":{})"), 422, Fault::WrongType, "/mesh/positions"},
    {mesh(R"("positions":[0,0,0])"), 422, Fault::WrongType, "/mesh/positions/0"},
    {mesh(R"("positions":[[0,0,0],[0,0]])"), 422, Fault::WrongLength, "/mesh/positions/1"},
    {mesh(R"("positions":[[0,0,0,0]])"), 422, Fault::WrongLength, "/mesh/positions/0"},
    {mesh(R"("positions":[[0,0,"1"]])"), 422, Fault::WrongType, "/mesh/positions/0/2"},
    {mesh(R"("positions":[[0,null,0]])"), 422, Fault::WrongType, "/mesh/positions/0/1"},
    {mesh(R"("positions":[[0,[1],0]])"), 422, Fault::WrongType, "/mesh/positions/0/1"},
    {mesh(R"("positions":[{}])"), 422, Fault::WrongType, "/mesh/positions/0"},
    {mesh(R"("positions":[[0,1e999,0]])"), 422, Fault::NotFinite, "/mesh/positions/0/1"},
    {mesh(R"("positions":[[0,2e15,0]])"), 422, Fault::CoordinateTooLarge, "/mesh/positions/0/1"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,1]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/0/2"},
    {mesh(R"("faces":[[0,0,0],[0,3,0]],"positions":[[0,0,0]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/1/1"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,-1]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/0/2"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,4294967296]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/0/2"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0.5,0]])"), 422, Fault::WrongType,
     "/mesh/faces/0/1"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,0,0]])"), 422, Fault::WrongLength,
     "/mesh/faces/0"},
    {mesh(R"("positions":[[0,0,0]],"normals":[])"), 422, Fault::WrongLength, "/mesh/normals"},
    {mesh(R"("positions":[[0,0,0]],"normals":[[0,0,0]])"), 422, Fault::ZeroDirection,
     "/mesh/normals/0"},
    {mesh(R"("positions":[[0,0,0]],"colors":[[0,0,0],[1,1,1]])"), 422, Fault::WrongLength,
     "/mesh/colors"},
    {mesh(R"("positions":[[0,0,0]],"colors":[[0,0,255]])"), 422, Fault::OutOfRange,
     "/mesh/colors/0/2"},
    {mesh(R"("positions":[[0,0,0]],"uvs":[])"), 422, Fault::UnknownField, "/mesh/uvs"},
    // lights
    {with(R"("lights":["sun"])"), 422, Fault::WrongType, "/lights/0"},
    {light(R"("position":[0,0,1],"flux_w":1)"), 422, Fault::MissingField, "/lights/0/type"},
    {light(R"("type":"pont")"), 422, Fault::UnknownValue, "/lights/0/type"},
    {light(R"("type":3)"), 422, Fault::WrongType, "/lights/0/type"},
    {light(R"("type":"rect")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"disk")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"sphere")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"ies")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"environment")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"sky")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"from_mesh")"), 422, Fault::NotAvailable, "/lights/0/type"},
    {light(R"("type":"point","position":[0,0,1])"), 422, Fault::MissingField, "/lights/0"},
    {light(R"("type":"point","flux_w":1)"), 422, Fault::MissingField, "/lights/0/position"},
    {point(R"("intensty_cd":1)"), 422, Fault::UnknownField, "/lights/0/intensty_cd"},
    {point(R"("flux_w":-1)"), 422, Fault::OutOfRange, "/lights/0/flux_w"},
    {point(R"("flux_w":1e13)"), 422, Fault::OutOfRange, "/lights/0/flux_w"},
    {point(R"("flux_w":"40")"), 422, Fault::WrongType, "/lights/0/flux_w"},
    {point(R"("flux_w":null)"), 422, Fault::WrongType, "/lights/0/flux_w"},
    {point(R"("flux_w":1,"intensity_w_sr":1)"), 422, Fault::ConflictingFields,
     "/lights/0/intensity_w_sr"},
    {point(R"("flux_w":1,"flux_lm":1)"), 422, Fault::ConflictingFields, "/lights/0/flux_lm"},
    {point(R"("irradiance_w_m2":1)"), 422, Fault::UnknownField, "/lights/0/irradiance_w_m2"},
    {point(R"("flux_w":1,"direction":[0,0,1])"), 422, Fault::UnknownField, "/lights/0/direction"},
    {point(R"("flux_w":1,"color":[1,1])"), 422, Fault::WrongLength, "/lights/0/color"},
    {point(R"("flux_w":1,"color":[1,-1,1])"), 422, Fault::OutOfRange, "/lights/0/color/1"},
    {point(R"("flux_w":1,"color":"red")"), 422, Fault::WrongType, "/lights/0/color"},
    {point(R"("flux_w":1,"temperature_k":6500)"), 422, Fault::NotAvailable,
     "/lights/0/temperature_k"},
    {point(R"("flux_w":1,"enabled":1)"), 422, Fault::WrongType, "/lights/0/enabled"},
    {point(R"("flux_w":1,"cast_shadows":"no")"), 422, Fault::WrongType, "/lights/0/cast_shadows"},
    {point(R"("flux_w":1,"name":"")"), 422, Fault::WrongLength, "/lights/0/name"},
    {point(R"("flux_w":1,"name":"a\u0007")"), 422, Fault::UnknownValue, "/lights/0/name"},
    {light(R"("type":"point","position":[0,1],"flux_w":1)"), 422, Fault::WrongLength,
     "/lights/0/position"},
    {light(R"("type":"point","position":[0,0,1e16],"flux_w":1)"), 422, Fault::OutOfRange,
     "/lights/0/position/2"},
    {light(R"("type":"spot","position":[0,0,1],"flux_w":1)"), 422, Fault::MissingField,
     "/lights/0/direction"},
    {spot(R"("inner_cone_deg":40,"outer_cone_deg":30)"), 422, Fault::OutOfRange,
     "/lights/0/inner_cone_deg"},
    {spot(R"("inner_cone_deg":46)"), 422, Fault::OutOfRange, "/lights/0/inner_cone_deg"},
    {spot(R"("outer_cone_deg":91)"), 422, Fault::OutOfRange, "/lights/0/outer_cone_deg"},
    {spot(R"("outer_cone_deg":0)"), 422, Fault::OutOfRange, "/lights/0/outer_cone_deg"},
    {sun(R"("direction":[0,0,0])"), 422, Fault::ZeroDirection, "/lights/0/direction"},
    {sun(R"("direction":[0,0,-1],"illuminance_lx":1)"), 422, Fault::ConflictingFields,
     "/lights/0/illuminance_lx"},
    {sun(R"("direction":[0,0,-1],"angle_deg":0.53)"), 422, Fault::NotAvailable,
     "/lights/0/angle_deg"},
    {with(R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1},
                       {"type":"point","position":[0,0,1],"flux_lm":1}])"),
     422, Fault::MixedUnits, "/lights/1/flux_lm"},
    {with(R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1,"name":"a"},
                       {"type":"point","position":[0,0,1],"flux_w":1,"name":"a"}])"),
     422, Fault::ConflictingFields, "/lights/1/name"},
    // material
    {with(R"("material":"lambert")"), 422, Fault::WrongType, "/material"},
    {material(R"("albedo":[1,1,1])"), 422, Fault::MissingField, "/material/model"},
    {material(R"("model":"lambrt")"), 422, Fault::UnknownValue, "/material/model"},
    {material(R"("model":"principled")"), 422, Fault::NotAvailable, "/material/model"},
    {material(R"("model":"lambert","albedo":[1,1,1.5])"), 422, Fault::OutOfRange,
     "/material/albedo/2"},
    {material(R"("model":"lambert","albedo":"texture")"), 422, Fault::UnknownValue,
     "/material/albedo"},
    {material(R"("model":"lambert","roughness":1)"), 422, Fault::UnknownField,
     "/material/roughness"},
    {facets(R"("roughness":2)"), 422, Fault::OutOfRange, "/material/roughness"},
    {facets(R"("f0":[0,0,0],"ior":1.5)"), 422, Fault::ConflictingFields, "/material/ior"},
    {facets(R"("eta":[1,1,1])"), 422, Fault::MissingField, "/material/k"},
    {facets(R"("ior":0.5)"), 422, Fault::OutOfRange, "/material/ior"},
    {facets(R"("distribution":"phong")"), 422, Fault::UnknownValue, "/material/distribution"},
    {facets(R"("gamma":2)"), 422, Fault::UnknownField, "/material/gamma"},
    {facets(R"("distribution":"gtr","gamma":0)"), 422, Fault::OutOfRange, "/material/gamma"},
    {facets(R"("multiscatter":true)"), 422, Fault::NotAvailable, "/material/multiscatter"},
    // view and camera
    {with(R"("view":{})"), 422, Fault::MissingField, "/view/type"},
    {with(R"("view":{"type":"side"})"), 422, Fault::UnknownValue, "/view/type"},
    {with(R"("view":{"type":"direction"})"), 422, Fault::MissingField, "/view/toward_viewer"},
    {with(R"("view":{"type":"normal","toward_viewer":[0,0,1]})"), 422, Fault::UnknownField,
     "/view/toward_viewer"},
    {with(R"("camera":{"target":[0,0,0]})"), 422, Fault::MissingField, "/camera/eye"},
    {with(R"("camera":{"fov_y_deg":180})"), 422, Fault::OutOfRange, "/camera/fov_y_deg"},
    {with(R"("camera":{"up":[0,0,0]})"), 422, Fault::ZeroDirection, "/camera/up"},
    // transport, points
    {with(R"("transport":{"shadows":1})"), 422, Fault::WrongType, "/transport/shadows"},
    {with(R"("transport":{"samples":0})"), 422, Fault::OutOfRange, "/transport/samples"},
    {with(R"("transport":{"samples":1.5})"), 422, Fault::WrongType, "/transport/samples"},
    {with(R"("transport":{"bounces":1})"), 422, Fault::NotAvailable, "/transport/bounces"},
    {with(R"("transport":{"seed":-1})"), 422, Fault::OutOfRange, "/transport/seed"},
    {with(R"("transport":{"seed":9007199254740994})"), 422, Fault::OutOfRange, "/transport/seed"},
    {with(R"("transport":{"terminator":"hard"})"), 422, Fault::UnknownValue,
     "/transport/terminator"},
    {with(R"("transport":{"max_distance":0})"), 422, Fault::OutOfRange, "/transport/max_distance"},
    {with(R"("points":{"normals":"estimate"})"), 422, Fault::NotAvailable, "/points/normals"},
    {with(R"("points":{"radius_scale":0})"), 422, Fault::OutOfRange, "/points/radius_scale"},
    // display and output
    {with(R"("display":{"exposure_ev":"bright"})"), 422, Fault::UnknownValue,
     "/display/exposure_ev"},
    {with(R"("display":{"exposure_ev":65})"), 422, Fault::OutOfRange, "/display/exposure_ev"},
    {with(R"("display":{"tone_map":"agx"})"), 422, Fault::NotAvailable, "/display/tone_map"},
    {with(R"("display":{"tone_map":"reinhart"})"), 422, Fault::UnknownValue, "/display/tone_map"},
    {with(R"("display":{"transfer":"gamma"})"), 422, Fault::UnknownValue, "/display/transfer"},
    {with(R"("display":{"white":2})"), 422, Fault::UnknownField, "/display/white"},
    {output(R"("format":"glb")"), 422, Fault::NotAvailable, "/output/format"},
    {output(R"("format":"plyy")"), 422, Fault::UnknownValue, "/output/format"},
    {output(R"("quantities":[])"), 422, Fault::WrongLength, "/output/quantities"},
    {output(R"("quantities":"color")"), 422, Fault::WrongType, "/output/quantities"},
    {output(R"("quantities":["color","colour"])"), 422, Fault::UnknownValue,
     "/output/quantities/1"},
    {output(R"("quantities":["color","color"])"), 422, Fault::ConflictingFields,
     "/output/quantities/1"},
    {output(R"("quantities":["sh"])"), 422, Fault::NotAvailable, "/output/quantities/0"},
    {output(R"("quantities":[1])"), 422, Fault::WrongType, "/output/quantities/0"},
    {output(R"("width":0)"), 422, Fault::OutOfRange, "/output/width"},
    {output(R"("width":8193)"), 422, Fault::OutOfRange, "/output/width"},
    {output(R"("width":8192,"height":8192)"), 422, Fault::OutOfRange, "/output/height"},
    {output(R"("samples":1025)"), 422, Fault::OutOfRange, "/output/samples"},
    {output(R"("renderer":"opengl")"), 422, Fault::UnknownValue, "/output/renderer"},
    {output(R"("background":"white")"), 422, Fault::UnknownValue, "/output/background"},
    {output(R"("background":[0,0,-1])"), 422, Fault::OutOfRange, "/output/background/2"},
};

TEST(SceneJson, RefusesEveryFieldThatIsWrongAndSaysWhere)
{
    for (const Refusal& row : refusals) {
        const auto request = parse_request(row.json, {});
        ASSERT_FALSE(request) << row.json;
        const Error& error = request.error();
        EXPECT_EQ(fault_code(error.fault), fault_code(row.fault)) << row.json << '\n'
                                                                  << error.detail;
        EXPECT_EQ(problem_kind(error.fault).status, row.status) << row.json;
        EXPECT_EQ(error.pointer, row.pointer) << row.json << '\n' << error.detail;
        EXPECT_GE(error.detail.size(), 10U) << row.json;
    }
}

TEST(SceneJson, SaysWhatWasMeantByAMistypedField)
{
    const auto request = parse_request(point(R"("intensty_cd":1)"), {});
    ASSERT_FALSE(request);
    EXPECT_NE(request.error().detail.find("did you mean \"intensity_cd\""), std::string::npos)
        << request.error().detail;
}

TEST(SceneJson, NamesTheUnitOfARange)
{
    const auto request = parse_request(spot(R"("outer_cone_deg":91)"), {});
    ASSERT_FALSE(request);
    EXPECT_NE(request.error().detail.find("91"), std::string::npos);
    EXPECT_NE(request.error().detail.find("degrees"), std::string::npos);
}

TEST(SceneJson, CountsTheLinesOfMalformedText)
{
    const auto request = parse_request("{\n\n  \"mesh\": tru\n}", {});
    ASSERT_FALSE(request);
    EXPECT_EQ(request.error().line, 3U);
}

TEST(SceneJson, KeepsItsLimits)
{
    ParseLimits limits;
    limits.vertices = 2;
    EXPECT_EQ(parse_request(with(""), limits).error().fault, Fault::TooManyVertices);
    limits = {};
    limits.faces = 0;
    EXPECT_EQ(parse_request(with(""), limits).error().fault, Fault::TooManyFaces);
    limits = {};
    limits.lights = 0;
    EXPECT_EQ(parse_request(point(R"("flux_w":1)"), limits).error().pointer, "/lights");
}

TEST(SceneJson, BoundsTheTreeWhateverItHolds)
{
    std::string wide = R"({"lights":[0)";
    for (int i = 0; i < 250'000; ++i) { wide += ",0"; }
    EXPECT_EQ(parse_request(wide + "]}", {}).error().fault, Fault::BodyTooLarge);
    std::string fields = "{\"a\":0";
    for (int i = 0; i < 300; ++i) { fields += ",\"b" + std::to_string(i) + "\":0"; }
    EXPECT_EQ(parse_request(fields + "}", {}).error().fault, Fault::OutOfRange);
    EXPECT_EQ(parse_request(std::string(1'000'000, '['), {}).error().fault, Fault::JsonTooDeep);
}

}  // namespace
}  // namespace relight
