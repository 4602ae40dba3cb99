#include "tests/server/refusals.h"

namespace relight {
namespace {

using test::Refusal;
using test::with;

std::string times(int count, const std::string& text)
{
    std::string all;
    for (int i = 0; i < count; ++i) { all += text; }
    return all;
}
std::string mesh(const std::string& fields)
{
    return R"({"mesh":{)" + fields + "}}";
}
std::string transport(const std::string& fields)
{
    return with(R"("transport":{)" + fields + "}");
}
std::string display(const std::string& fields)
{
    return with(R"("display":{)" + fields + "}");
}
std::string output(const std::string& fields)
{
    return with(R"("output":{)" + fields + "}");
}

const Refusal text_and_mesh[] = {
    // the text
    {"", 400, Fault::MalformedJson, "", "ends where more"},
    {"{", 400, Fault::MalformedJson, "", "ends where more"},
    {"{} x", 400, Fault::MalformedJson, "", "not JSON"},
    {"{'a':1}", 400, Fault::MalformedJson, "", "RFC 8259"},
    {"{\"mesh\":\"\xff\"}", 400, Fault::MalformedJson, "", "UTF-8"},
    {R"({"mesh":NaN})", 400, Fault::MalformedJson, "", "line 1"},
    {R"({"mesh":{"positions":[[0,0,Infinity]]}})", 400, Fault::MalformedJson, "", "line 1"},
    {R"(// no
{})",
     400, Fault::MalformedJson, "", "line 1"},
    {"[]", 422, Fault::WrongType, "", "an object {…}"},
    {"3", 422, Fault::WrongType, "", "an object {…}"},
    {with(R"("length_unit_m":1e999)"), 422, Fault::NotFinite, "/length_unit_m", "double"},
    {with(R"("a/b~c":1)"), 422, Fault::UnknownField, "/a~1b~0c", "its fields: mesh"},
    {with(R"("view":{"type":"normal"},"view":{"type":"normal"})"), 422, Fault::DuplicateField,
     "/view", "once is allowed"},
    {std::string(40, '[') + std::string(40, ']'), 422, Fault::JsonTooDeep, times(32, "/0"),
     "at most 32 deep"},
    // the top
    {"{}", 422, Fault::MissingField, "/mesh", "needs \"mesh\""},
    {with(R"("ligths":[])"), 422, Fault::UnknownField, "/ligths", "did you mean \"lights\""},
    {with(R"("lights":{})"), 422, Fault::WrongType, "/lights", "an array"},
    {with(R"("length_unit_m":0)"), 422, Fault::OutOfRange, "/length_unit_m", "metres"},
    {with(R"("length_unit_m":"1")"), 422, Fault::WrongType, "/length_unit_m", "a number"},
    {with(R"("luminous_efficacy_lm_w":700)"), 422, Fault::OutOfRange, "/luminous_efficacy_lm_w",
     "at most 683 lm/W"},
    {with(R"("luminous_efficacy_lm_w":0)"), 422, Fault::OutOfRange, "/luminous_efficacy_lm_w",
     "more than 0"},
    {with(R"("receipt":1)"), 422, Fault::WrongType, "/receipt", "true or false"},
    // the mesh
    {R"({"mesh":"x"})", 422, Fault::WrongType, "/mesh", "an object {…}"},
    {mesh(""), 422, Fault::MissingField, "/mesh/positions", "needs \"positions\""},
    {mesh(R"("id":"../../etc/passwd")"), 422, Fault::UnknownValue, "/mesh/id",
     "64 lower-case hex digits"},
    {mesh(R"("id":")" + std::string(64, 'A') + "\""), 422, Fault::UnknownValue, "/mesh/id",
     "POST /v1/meshes"},
    {mesh(R"("id":5)"), 422, Fault::WrongType, "/mesh/id", "a string"},
    {mesh(R"("id":"x","part":"y")"), 422, Fault::ConflictingFields, "/mesh/part", "sent along"},
    {mesh(R"("id":")" + std::string(64, 'a') + R"(","positions":[[0,0,0]])"), 422,
     Fault::UnknownField, "/mesh/positions", "its fields: id, part"},
    {mesh(R"("part":"")"), 422, Fault::WrongLength, "/mesh/part", "1 to 128"},
    {mesh(R"("part":")" + std::string(129, 'p') + "\""), 422, Fault::WrongLength, "/mesh/part",
     "1 to 128"},
    {mesh(R"("positions":[])"), 422, Fault::NoGeometry, "/mesh/positions", "at least 1"},
    {mesh(R"("positions":"x")"), 422, Fault::WrongType, "/mesh/positions", "rows of 3 numbers"},
    {mesh(R"("positions":{})"), 422, Fault::WrongType, "/mesh/positions", "rows of 3 numbers"},
    {mesh(R"("positions":[0,0,0])"), 422, Fault::WrongType, "/mesh/positions/0", "3"},
    {mesh(R"("positions":[[0,0,0],[0,0]])"), 422, Fault::WrongLength, "/mesh/positions/1", "3"},
    {mesh(R"("positions":[[0,0,0,0]])"), 422, Fault::WrongLength, "/mesh/positions/0", "3"},
    {mesh(R"("positions":[[0,0,"1"]])"), 422, Fault::WrongType, "/mesh/positions/0/2", "number"},
    {mesh(R"("positions":[[0,null,0]])"), 422, Fault::WrongType, "/mesh/positions/0/1", "number"},
    {mesh(R"("positions":[[0,[1],0]])"), 422, Fault::WrongType, "/mesh/positions/0/1", "number"},
    {mesh(R"("positions":[{}])"), 422, Fault::WrongType, "/mesh/positions/0", "3"},
    {mesh(R"("positions":[[0,1e999,0]])"), 422, Fault::NotFinite, "/mesh/positions/0/1", "double"},
    {mesh(R"("positions":[[0,2e15,0]])"), 422, Fault::CoordinateTooLarge, "/mesh/positions/0/1",
     "1e15"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,1]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/0/2", "counted from 0"},
    {mesh(R"("faces":[[0,0,0],[0,3,0]],"positions":[[0,0,0]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/1/1", "counted from 0"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,-1]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/0/2", "from 0"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,4294967296]])"), 422, Fault::IndexOutOfRange,
     "/mesh/faces/0/2", "from 0"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0.5,0]])"), 422, Fault::WrongType, "/mesh/faces/0/1",
     "whole"},
    {mesh(R"("positions":[[0,0,0]],"faces":[[0,0,0,0]])"), 422, Fault::WrongLength, "/mesh/faces/0",
     "3"},
    {mesh(R"("positions":[[0,0,0]],"normals":[])"), 422, Fault::WrongLength, "/mesh/normals",
     "one row a position"},
    {mesh(R"("positions":[[0,0,0]],"normals":[[0,0,0]])"), 422, Fault::ZeroDirection,
     "/mesh/normals/0", "length"},
    {mesh(R"("positions":[[0,0,0]],"colors":[[0,0,0],[1,1,1]])"), 422, Fault::WrongLength,
     "/mesh/colors", "one row a position"},
    {mesh(R"("positions":[[0,0,0]],"colors":[[0,0,255]])"), 422, Fault::OutOfRange,
     "/mesh/colors/0/2", "1"},
    {mesh(R"("positions":[[0,0,0]],"uvs":[])"), 422, Fault::UnknownField, "/mesh/uvs",
     "its fields: "},
};

const Refusal the_rest[] = {
    // view and camera
    {with(R"("view":{})"), 422, Fault::MissingField, "/view/type", "needs \"type\""},
    {with(R"("view":"camera")"), 422, Fault::WrongType, "/view", "an object {…}"},
    {with(R"("view":{"type":"side"})"), 422, Fault::UnknownValue, "/view/type",
     "normal, camera, direction"},
    {with(R"("view":{"type":"direction"})"), 422, Fault::MissingField, "/view/toward_viewer",
     "needs \"toward_viewer\""},
    {with(R"("view":{"type":"direction","toward_viewer":[0,0,0]})"), 422, Fault::ZeroDirection,
     "/view/toward_viewer", "needs a length"},
    {with(R"("view":{"type":"normal","toward_viewer":[0,0,1]})"), 422, Fault::UnknownField,
     "/view/toward_viewer", "its fields: type"},
    {with(R"("camera":{"target":[0,0,0]})"), 422, Fault::MissingField, "/camera/eye",
     "needs \"eye\""},
    {with(R"("camera":{"eye":[0,0]})"), 422, Fault::WrongLength, "/camera/eye", "[x,y,z]"},
    {with(R"("camera":{"fov_y_deg":180})"), 422, Fault::OutOfRange, "/camera/fov_y_deg",
     "0.01..179 degrees"},
    {with(R"("camera":{"fov":40})"), 422, Fault::UnknownField, "/camera/fov", "its fields: eye"},
    {with(R"("camera":{"up":[0,0,0]})"), 422, Fault::ZeroDirection, "/camera/up", "needs a length"},
    // transport, points
    {transport(R"("shadows":1)"), 422, Fault::WrongType, "/transport/shadows", "true or false"},
    {transport(R"("samples":0)"), 422, Fault::OutOfRange, "/transport/samples", "1..65536"},
    {transport(R"("samples":65537)"), 422, Fault::OutOfRange, "/transport/samples", "1..65536"},
    {transport(R"("samples":1.5)"), 422, Fault::WrongType, "/transport/samples", "whole number"},
    {transport(R"("samples":"64")"), 422, Fault::WrongType, "/transport/samples", "a number"},
    {transport(R"("sample":64)"), 422, Fault::UnknownField, "/transport/sample",
     "did you mean \"samples\""},
    {transport(R"("target_standard_error":0)"), 422, Fault::OutOfRange,
     "/transport/target_standard_error", "W/m2 or lx"},
    {transport(R"("target_standard_error":-1)"), 422, Fault::OutOfRange,
     "/transport/target_standard_error", "more than 0"},
    {transport(R"("target_standard_error":"low")"), 422, Fault::WrongType,
     "/transport/target_standard_error", "a number"},
    {transport(R"("bounces":65)"), 422, Fault::OutOfRange, "/transport/bounces", "0..64"},
    {transport(R"("bounces":-1)"), 422, Fault::OutOfRange, "/transport/bounces", "0..64"},
    {transport(R"("bounces":0.5)"), 422, Fault::WrongType, "/transport/bounces", "whole number"},
    {transport(R"("bounces":true)"), 422, Fault::WrongType, "/transport/bounces", "0..64"},
    {transport(R"("seed":-1)"), 422, Fault::OutOfRange, "/transport/seed", "0.."},
    {transport(R"("seed":9007199254740994)"), 422, Fault::OutOfRange, "/transport/seed",
     "9007199254740992"},
    {transport(R"("terminator":"hard")"), 422, Fault::UnknownValue, "/transport/terminator",
     "none, smooth"},
    {transport(R"("max_distance":0)"), 422, Fault::OutOfRange, "/transport/max_distance",
     "length units"},
    {transport(R"("two_sided":"both")"), 422, Fault::WrongType, "/transport/two_sided",
     "true or false"},
    {with(R"("points":{"normals":"guess"})"), 422, Fault::UnknownValue, "/points/normals",
     "estimate"},
    {with(R"("points":{"normals":"file","viewpoint":[0,0,0]})"), 422, Fault::ConflictingFields,
     "/points/viewpoint", "leave one out"},
    {with(R"("points":{"viewpoint":[0,0]})"), 422, Fault::WrongLength, "/points/viewpoint", "3"},
    {with(R"("refine":{})"), 422, Fault::MissingField, "/refine/max_edge", "max_edge"},
    {with(R"("refine":{"max_edge":0})"), 422, Fault::OutOfRange, "/refine/max_edge", "0"},
    {with(R"("refine":{"max_edge":1,"steps":2})"), 422, Fault::UnknownField, "/refine/steps",
     "max_edge"},
    {with(R"("points":{"radius_scale":0})"), 422, Fault::OutOfRange, "/points/radius_scale",
     "local spacings"},
    // display
    {display(R"("exposure_ev":"bright")"), 422, Fault::UnknownValue, "/display/exposure_ev",
     "auto"},
    {display(R"("exposure_ev":65)"), 422, Fault::OutOfRange, "/display/exposure_ev", "-64..64 EV"},
    {display(R"("tone_map":"agx")"), 422, Fault::NotAvailable, "/display/tone_map", "reinhard"},
    {display(R"("tone_map":"reinhart")"), 422, Fault::UnknownValue, "/display/tone_map",
     "did you mean \"reinhard\""},
    {display(R"("transfer":"gamma")"), 422, Fault::UnknownValue, "/display/transfer", "srgb"},
    {display(R"("white":2)"), 422, Fault::UnknownField, "/display/white", "its fields: "},
    // output
    {output(R"("format":"fbx")"), 422, Fault::UnknownValue, "/output/format", "glb"},
    {output(R"("format":"jpeg","quality":0)"), 422, Fault::OutOfRange, "/output/quality", "100"},
    {output(R"("format":"png","quality":90)"), 422, Fault::ConflictingFields, "/output/quality",
     "jpeg"},
    {output(R"("format":"plyy")"), 422, Fault::UnknownValue, "/output/format",
     "did you mean \"ply\""},
    {output(R"("format":"exrr")"), 422, Fault::UnknownValue, "/output/format",
     "did you mean \"exr\""},
    {output(R"("quantities":[])"), 422, Fault::WrongLength, "/output/quantities", "at least 1"},
    {output(R"("quantities":"color")"), 422, Fault::WrongType, "/output/quantities", "an array"},
    {output(R"("quantities":["color","colour"])"), 422, Fault::UnknownValue, "/output/quantities/1",
     "did you mean \"color\""},
    {output(R"("quantities":["color","color"])"), 422, Fault::ConflictingFields,
     "/output/quantities/1", "twice"},
    {output(R"("quantities":["sh","irradiance","sh"])"), 422, Fault::ConflictingFields,
     "/output/quantities/2", "twice"},
    {output(R"("quantities":["ao"])"), 422, Fault::UnknownValue, "/output/quantities/0",
     "ambient_occlusion"},
    {output(R"("quantities":["standard_eror"])"), 422, Fault::UnknownValue, "/output/quantities/0",
     "did you mean \"standard_error\""},
    {output(R"("quantities":[1])"), 422, Fault::WrongType, "/output/quantities/0", "one of: color"},
    {output(R"("width":0)"), 422, Fault::OutOfRange, "/output/width", "1..8192"},
    {output(R"("width":8193)"), 422, Fault::OutOfRange, "/output/width", "1..8192"},
    {output(R"("width":8192,"height":8192)"), 422, Fault::OutOfRange, "/output/height",
     "--max-pixels"},
    {output(R"("samples":1025)"), 422, Fault::OutOfRange, "/output/samples", "1..1024"},
    {output(R"("renderer":"opengl")"), 422, Fault::UnknownValue, "/output/renderer",
     "raytrace, vtk"},
    {output(R"("background":"white")"), 422, Fault::UnknownValue, "/output/background",
     "transparent"},
    {output(R"("background":[0,0])"), 422, Fault::WrongLength, "/output/background", "[r,g,b]"},
    {output(R"("background":[0,0,-1])"), 422, Fault::OutOfRange, "/output/background/2",
     "radiance"},
};

TEST(SceneJson, RefusesWhatIsNoRequestAndSaysWhere)
{
    test::expect_refusals(text_and_mesh);
}

TEST(SceneJson, RefusesEveryFieldThatIsWrongAndSaysWhatIsAllowed)
{
    test::expect_refusals(the_rest);
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
    const std::string one_light = test::with_light(R"("type":"from_mesh")");
    EXPECT_EQ(parse_request(one_light, limits).error().pointer, "/lights");
}

TEST(SceneJson, BoundsTheTreeWhateverItHolds)
{
    std::string wide = R"({"lights":[0)";
    for (int i = 0; i < 250'000; ++i) { wide += ",0"; }
    EXPECT_EQ(parse_request(wide + "]}", {}).error().fault, Fault::BodyTooLarge);
    std::string fields = "{\"a\":0";
    for (int i = 0; i < 1024; ++i) { fields += ",\"b" + std::to_string(i) + "\":0"; }
    EXPECT_EQ(parse_request(fields + "}", {}).error().fault, Fault::OutOfRange);
    EXPECT_EQ(parse_request(std::string(1'000'000, '['), {}).error().fault, Fault::JsonTooDeep);
}

}  // namespace
}  // namespace relight
