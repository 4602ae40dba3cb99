#include "tests/server/refusals.h"

namespace relight {
namespace {

using test::Refusal;
using test::with;
using test::with_light;
using test::with_material;

const std::string id = R"({"id":")" + std::string(64, 'b') + "\"}";

std::string point(const std::string& fields)
{
    return with_light(R"("type":"point","position":[0,0,1],)" + fields);
}
std::string spot(const std::string& fields)
{
    return with_light(R"("type":"spot","position":[0,0,1],"direction":[0,0,-1],"flux_w":1,)" +
                      fields);
}
std::string sun(const std::string& fields)
{
    return with_light(R"("type":"directional","irradiance_w_m2":1,)" + fields);
}
std::string rect(const std::string& fields)
{
    return with_light(R"("type":"rect","center":[0,0,1],"edge_u":[1,0,0],"edge_v":[0,1,0],)" +
                      fields);
}
std::string disk(const std::string& fields)
{
    return with_light(R"("type":"disk","center":[0,0,1],"luminance_cd_m2":1,)" + fields);
}
std::string sphere(const std::string& fields)
{
    return with_light(R"("type":"sphere","center":[0,0,1],)" + fields);
}
std::string environment(const std::string& fields)
{
    return with_light(R"("type":"environment",)" + fields);
}
std::string ies(const std::string& fields)
{
    return with_light(R"("type":"ies","position":[0,2,0],"direction":[0,-1,0],)" + fields);
}
std::string sky(const std::string& fields)
{
    return with_light(R"("type":"sky",)" + fields);
}
/// Beside a light of one watt.
std::string beside_watts(const std::string& fields)
{
    return with(R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1},{)" + fields + "}]");
}

const Refusal refusals[] = {
    // what all lights have
    {with(R"("lights":["sun"])"), 422, Fault::WrongType, "/lights/0", "an object {…}"},
    {with_light(R"("position":[0,0,1],"flux_w":1)"), 422, Fault::MissingField, "/lights/0/type",
     "from_mesh"},
    {with_light(R"("type":"pont")"), 422, Fault::UnknownValue, "/lights/0/type",
     "did you mean \"point\""},
    {with_light(R"("type":"area")"), 422, Fault::UnknownValue, "/lights/0/type", "rect, disk"},
    {with_light(R"("type":3)"), 422, Fault::WrongType, "/lights/0/type", "one of: point"},
    {point(R"("flux_w":1,"color":[1,1])"), 422, Fault::WrongLength, "/lights/0/color", "[r,g,b]"},
    {point(R"("flux_w":1,"color":[1,-1,1])"), 422, Fault::OutOfRange, "/lights/0/color/1",
     "0..1e+06"},
    {point(R"("flux_w":1,"color":"red")"), 422, Fault::WrongType, "/lights/0/color", "[r,g,b]"},
    {point(R"("flux_w":1,"temperature_k":999)"), 422, Fault::OutOfRange, "/lights/0/temperature_k",
     "1000..40000 K"},
    {point(R"("flux_w":1,"temperature_k":40001)"), 422, Fault::OutOfRange,
     "/lights/0/temperature_k", "1000..40000 K"},
    {point(R"("flux_w":1,"temperature_k":"warm")"), 422, Fault::WrongType,
     "/lights/0/temperature_k", "a number"},
    {point(R"("flux_w":1,"temperature_k":2700,"color":[1,1,1])"), 422, Fault::ConflictingFields,
     "/lights/0/temperature_k", "one or the other"},
    {point(R"("flux_w":1,"temperature":2700)"), 422, Fault::UnknownField, "/lights/0/temperature",
     "did you mean \"temperature_k\""},
    {point(R"("flux_w":1,"enabled":1)"), 422, Fault::WrongType, "/lights/0/enabled",
     "true or false"},
    {point(R"("flux_w":1,"cast_shadows":"no")"), 422, Fault::WrongType, "/lights/0/cast_shadows",
     "true or false"},
    {point(R"("flux_w":1,"name":"")"), 422, Fault::WrongLength, "/lights/0/name", "1 to 64"},
    {point(R"("flux_w":1,"name":7)"), 422, Fault::WrongType, "/lights/0/name", "a string"},
    {point(R"("flux_w":1,"name":"a\u0007")"), 422, Fault::UnknownValue, "/lights/0/name",
     "printable"},
    {with(R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1,"name":"a"},
                       {"type":"point","position":[0,0,1],"flux_w":1,"name":"a"}])"),
     422, Fault::ConflictingFields, "/lights/1/name", "tell lights apart"},
    {with(R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1,"name":"light_1"},
                       {"type":"point","position":[0,0,1],"flux_w":1}])"),
     422, Fault::ConflictingFields, "/lights/1/name", "tell lights apart"},
    // point
    {with_light(R"("type":"point","position":[0,0,1])"), 422, Fault::MissingField, "/lights/0",
     "flux_w, flux_lm, intensity_w_sr, intensity_cd"},
    {with_light(R"("type":"point","flux_w":1)"), 422, Fault::MissingField, "/lights/0/position",
     "needs \"position\""},
    {with_light(R"("type":"point","position":[0,1],"flux_w":1)"), 422, Fault::WrongLength,
     "/lights/0/position", "[x,y,z]"},
    {with_light(R"("type":"point","position":[0,0,1e16],"flux_w":1)"), 422, Fault::OutOfRange,
     "/lights/0/position/2", "length units"},
    {point(R"("intensty_cd":1)"), 422, Fault::UnknownField, "/lights/0/intensty_cd",
     "did you mean \"intensity_cd\""},
    {point(R"("flux_w":-1)"), 422, Fault::OutOfRange, "/lights/0/flux_w", "0..1e+12 W"},
    {point(R"("flux_w":1e13)"), 422, Fault::OutOfRange, "/lights/0/flux_w", "0..1e+12 W"},
    {point(R"("flux_w":1e400)"), 422, Fault::NotFinite, "/lights/0/flux_w", "double"},
    {point(R"("flux_w":"40")"), 422, Fault::WrongType, "/lights/0/flux_w", "0..1e+12 W"},
    {point(R"("flux_w":null)"), 422, Fault::WrongType, "/lights/0/flux_w", "a number"},
    {point(R"("flux_w":1,"intensity_w_sr":1)"), 422, Fault::ConflictingFields,
     "/lights/0/intensity_w_sr", "exactly one of"},
    {point(R"("flux_w":1,"flux_lm":1)"), 422, Fault::ConflictingFields, "/lights/0/flux_lm",
     "exactly one of"},
    {point(R"("flux_w":1,"flux_w":1)"), 422, Fault::DuplicateField, "/lights/0/flux_w", "once"},
    {point(R"("irradiance_w_m2":1)"), 422, Fault::UnknownField, "/lights/0/irradiance_w_m2",
     "its fields: "},
    {point(R"("radiance_w_m2_sr":1)"), 422, Fault::UnknownField, "/lights/0/radiance_w_m2_sr",
     "its fields: "},
    {point(R"("flux_w":1,"direction":[0,0,1])"), 422, Fault::UnknownField, "/lights/0/direction",
     "its fields: "},
    // spot
    {with_light(R"("type":"spot","position":[0,0,1],"flux_w":1)"), 422, Fault::MissingField,
     "/lights/0/direction", "needs \"direction\""},
    {spot(R"("inner_cone_deg":40,"outer_cone_deg":30)"), 422, Fault::OutOfRange,
     "/lights/0/inner_cone_deg", "at most outer_cone_deg"},
    {spot(R"("inner_cone_deg":46)"), 422, Fault::OutOfRange, "/lights/0/inner_cone_deg",
     "which is 45 degrees"},
    {spot(R"("outer_cone_deg":91)"), 422, Fault::OutOfRange, "/lights/0/outer_cone_deg",
     "found 91; allowed: more than 0 and at most 90 degrees"},
    {spot(R"("outer_cone_deg":0)"), 422, Fault::OutOfRange, "/lights/0/outer_cone_deg",
     "more than 0"},
    // directional
    {sun(R"("direction":[0,0,0])"), 422, Fault::ZeroDirection, "/lights/0/direction",
     "needs a length"},
    {sun(R"("name":"s")"), 422, Fault::MissingField, "/lights/0/direction", "needs \"direction\""},
    {with_light(R"("type":"directional","direction":[0,0,-1])"), 422, Fault::MissingField,
     "/lights/0", "irradiance_w_m2, illuminance_lx"},
    {sun(R"("direction":[0,0,-1],"illuminance_lx":1)"), 422, Fault::ConflictingFields,
     "/lights/0/illuminance_lx", "exactly one of"},
    {sun(R"("direction":[0,0,-1],"angle_deg":181)"), 422, Fault::OutOfRange, "/lights/0/angle_deg",
     "0..180 degrees"},
    {sun(R"("direction":[0,0,-1],"angle_deg":-1)"), 422, Fault::OutOfRange, "/lights/0/angle_deg",
     "0..180 degrees"},
    {sun(R"("direction":[0,0,-1],"flux_w":1)"), 422, Fault::UnknownField, "/lights/0/flux_w",
     "its fields: "},
    // rect
    {rect(R"("name":"r")"), 422, Fault::MissingField, "/lights/0",
     "radiance_w_m2_sr, luminance_cd_m2, flux_w, flux_lm"},
    {with_light(R"("type":"rect","edge_u":[1,0,0],"edge_v":[0,1,0],"flux_w":1)"), 422,
     Fault::MissingField, "/lights/0/center", "needs \"center\""},
    {with_light(R"("type":"rect","center":[0,0,1],"edge_u":[1,0,0],"flux_w":1)"), 422,
     Fault::MissingField, "/lights/0/edge_v", "needs \"edge_v\""},
    {with_light(R"("type":"rect","center":[0,0,1],"edge_u":2,"edge_v":[0,1,0],"flux_w":1)"), 422,
     Fault::WrongType, "/lights/0/edge_u", "[x,y,z]"},
    {with_light(R"("type":"rect","center":[0,0,1],"edge_u":[1,0],"edge_v":[0,1,0],"flux_w":1)"),
     422, Fault::WrongLength, "/lights/0/edge_u", "3 numbers"},
    {rect(R"("luminance_cd_m2":-5)"), 422, Fault::OutOfRange, "/lights/0/luminance_cd_m2",
     "0..1e+12 cd/m2"},
    {rect(R"("radiance_w_m2_sr":"5")"), 422, Fault::WrongType, "/lights/0/radiance_w_m2_sr",
     "W/(m2 sr)"},
    {rect(R"("radiance_w_m2_sr":5,"flux_w":1)"), 422, Fault::ConflictingFields, "/lights/0/flux_w",
     "exactly one of"},
    {rect(R"("radiance_w_m2_sr":5,"luminance_cd_m2":1)"), 422, Fault::ConflictingFields,
     "/lights/0/luminance_cd_m2", "exactly one of"},
    {rect(R"("radiance_w_m2":5)"), 422, Fault::UnknownField, "/lights/0/radiance_w_m2",
     "did you mean \"radiance_w_m2_sr\""},
    {rect(R"("radiance_w_m2_sr":5,"two_sided":"yes")"), 422, Fault::WrongType,
     "/lights/0/two_sided", "true or false"},
    {rect(R"("radiance_w_m2_sr":5,"normal":[0,0,1])"), 422, Fault::UnknownField, "/lights/0/normal",
     "its fields: "},
    {rect(R"("intensity_cd":5)"), 422, Fault::UnknownField, "/lights/0/intensity_cd",
     "its fields: "},
    {with_light(R"("type":"rect","center":[0,0,1],"edge_u":[1,0,0],"edge_v":[-2,0,0],"flux_w":1)"),
     422, Fault::OutOfRange, "/lights/0/flux_w", "Give the light an area"},
    {with_light(R"("type":"rect","center":[0,0,1],"edge_u":[0,0,0],"edge_v":[0,0,0],"flux_lm":0)"),
     422, Fault::OutOfRange, "/lights/0/flux_lm", "point light"},
    {with_light(
         R"("type":"rect","center":[0,0,1],"edge_u":[1e-9,0,0],"edge_v":[0,1e-9,0],"flux_w":1e9)"),
     422, Fault::OutOfRange, "/lights/0/flux_w", "its radiance instead"},
    // disk and sphere
    {disk(R"("normal":[0,0,1])"), 422, Fault::MissingField, "/lights/0/radius", "needs \"radius\""},
    {disk(R"("radius":1)"), 422, Fault::MissingField, "/lights/0/normal", "needs \"normal\""},
    {disk(R"("radius":1,"normal":[0,0,0])"), 422, Fault::ZeroDirection, "/lights/0/normal",
     "needs a length"},
    {disk(R"("radius":-1,"normal":[0,0,1])"), 422, Fault::OutOfRange, "/lights/0/radius",
     "length units"},
    {disk(R"("radius":1,"normal":[0,0,1],"two_sided":true)"), 422, Fault::UnknownField,
     "/lights/0/two_sided", "its fields: "},
    {with_light(R"("type":"disk","center":[0,0,1],"normal":[0,0,1],"radius":0,"flux_lm":10)"), 422,
     Fault::OutOfRange, "/lights/0/flux_lm", "Give the light an area"},
    {sphere(R"("flux_w":1)"), 422, Fault::MissingField, "/lights/0/radius", "needs \"radius\""},
    {sphere(R"("radius":0,"flux_w":1)"), 422, Fault::OutOfRange, "/lights/0/flux_w", "point light"},
    {sphere(R"("radius":"1","flux_w":1)"), 422, Fault::WrongType, "/lights/0/radius", "a number"},
    {sphere(R"("radius":1e16,"flux_w":1)"), 422, Fault::OutOfRange, "/lights/0/radius", "0..1e+15"},
    {sphere(R"("radius":1)"), 422, Fault::MissingField, "/lights/0", "exactly one of"},
    {with_light(R"("type":"sphere","position":[0,0,1],"radius":1,"flux_w":1)"), 422,
     Fault::UnknownField, "/lights/0/position", "center, radius"},
    // environment
    {environment(R"("enabled":true)"), 422, Fault::MissingField, "/lights/0", "or an image"},
    {environment(R"("radiance_w_m2_sr":-1)"), 422, Fault::OutOfRange, "/lights/0/radiance_w_m2_sr",
     "0..1e+12"},
    {environment(R"("radiance_w_m2_sr":1,"luminance_cd_m2":1)"), 422, Fault::ConflictingFields,
     "/lights/0/luminance_cd_m2", "exactly one of"},
    {environment(R"("flux_w":1)"), 422, Fault::UnknownField, "/lights/0/flux_w", "its fields: "},
    {environment(R"("radiance_w_m2_sr":1,"image":)" + id), 422, Fault::ConflictingFields,
     "/lights/0/radiance_w_m2_sr", "image"},
    {environment(R"("radiance_w_m2_sr":1,"scale":2)"), 422, Fault::ConflictingFields,
     "/lights/0/scale", "goes with an \"image\""},
    {environment(R"("radiance_w_m2_sr":1,"rotation_deg":2)"), 422, Fault::ConflictingFields,
     "/lights/0/rotation_deg", "goes with an \"image\""},
    {environment(R"("image":"sky.hdr")"), 422, Fault::WrongType, "/lights/0/image",
     "an object {…}"},
    {environment(R"("image":{})"), 422, Fault::MissingField, "/lights/0/image",
     "POST /v1/environments"},
    {environment(R"("image":{"file":"x"})"), 422, Fault::UnknownField, "/lights/0/image/file",
     "its fields: id, part"},
    {environment(R"("image":{"id":"x"})"), 422, Fault::UnknownValue, "/lights/0/image/id",
     "POST /v1/environments"},
    {environment(R"("image":{"part":5})"), 422, Fault::WrongType, "/lights/0/image/part",
     "a string"},
    {environment(R"("image":{"id":"x","part":"y"})"), 422, Fault::ConflictingFields,
     "/lights/0/image/part", "sent along"},
    {environment(R"("rotation_deg":361,"image":)" + id), 422, Fault::OutOfRange,
     "/lights/0/rotation_deg", "-360..360 degrees"},
    {environment(R"("scale":-1,"image":)" + id), 422, Fault::OutOfRange, "/lights/0/scale",
     "0..1e+06"},
    // ies
    {ies(R"("scale":1)"), 422, Fault::MissingField, "/lights/0/profile", "needs \"profile\""},
    {ies(R"("profile":{"id":"lamp.ies"})"), 422, Fault::UnknownValue, "/lights/0/profile/id",
     "POST /v1/profiles"},
    {ies(R"("profile":{})"), 422, Fault::MissingField, "/lights/0/profile", "{\"part\": …}"},
    {ies(R"("profile":["x"])"), 422, Fault::WrongType, "/lights/0/profile", "an object {…}"},
    {ies(R"("up":[0,3,0],"profile":)" + id), 422, Fault::ConflictingFields, "/lights/0/up",
     "any other vector"},
    {ies(R"("up":[0,0,0],"profile":)" + id), 422, Fault::ZeroDirection, "/lights/0/up",
     "needs a length"},
    {ies(R"("scale":1e7,"profile":)" + id), 422, Fault::OutOfRange, "/lights/0/scale", "0..1e+06"},
    {ies(R"("intensity_cd":7,"profile":)" + id), 422, Fault::UnknownField, "/lights/0/intensity_cd",
     "its fields: "},
    {with_light(R"("type":"ies","position":[0,2,0],"profile":)" + id), 422, Fault::MissingField,
     "/lights/0/direction", "needs \"direction\""},
    // sky
    {sky(R"("turbidity":3)"), 422, Fault::MissingField, "/lights/0/sun_direction",
     "latitude_deg, longitude_deg and time"},
    {sky(R"("sun_direction":[0,0,0])"), 422, Fault::ZeroDirection, "/lights/0/sun_direction",
     "needs a length"},
    {sky(R"("sun_direction":[0,1,0],"turbidity":1)"), 422, Fault::OutOfRange, "/lights/0/turbidity",
     "..10"},
    {sky(R"("sun_direction":[0,1,0],"turbidity":11)"), 422, Fault::OutOfRange,
     "/lights/0/turbidity", "..10"},
    {sky(R"("sun_direction":[0,1,0],"time":"2026-06-21T12:00:00Z")"), 422, Fault::ConflictingFields,
     "/lights/0/time", "\"sun_direction\" is given too"},
    {sky(R"("sun_direction":[0,1,0],"latitude_deg":50)"), 422, Fault::ConflictingFields,
     "/lights/0/latitude_deg", "\"sun_direction\" is given too"},
    {sky(R"("latitude_deg":50,"time":"2026-06-21T12:00:00Z")"), 422, Fault::MissingField,
     "/lights/0/longitude_deg", "needs \"longitude_deg\""},
    {sky(R"("latitude_deg":50,"longitude_deg":8)"), 422, Fault::MissingField, "/lights/0/time",
     "needs \"time\""},
    {sky(R"("latitude_deg":91,"longitude_deg":8,"time":"2026-06-21T12:00:00Z")"), 422,
     Fault::OutOfRange, "/lights/0/latitude_deg", "-90..90 degrees"},
    {sky(R"("latitude_deg":50,"longitude_deg":181,"time":"2026-06-21T12:00:00Z")"), 422,
     Fault::OutOfRange, "/lights/0/longitude_deg", "-180..180 degrees"},
    {sky(R"("latitude_deg":50,"longitude_deg":8,"time":"noon")"), 422, Fault::UnknownValue,
     "/lights/0/time", "RFC 3339"},
    {sky(R"("latitude_deg":50,"longitude_deg":8,"time":"2026-06-21T12:00:00")"), 422,
     Fault::UnknownValue, "/lights/0/time", "with its zone"},
    {sky(R"("latitude_deg":50,"longitude_deg":8,"time":"2026-02-30T12:00:00Z")"), 422,
     Fault::UnknownValue, "/lights/0/time", "RFC 3339"},
    {sky(R"("latitude_deg":50,"longitude_deg":8,"time":1782036000)"), 422, Fault::WrongType,
     "/lights/0/time", "a string"},
    {sky(R"("sun_direction":[0,1,0],"illuminance_lx":100)"), 422, Fault::UnknownField,
     "/lights/0/illuminance_lx", "sun_direction, latitude_deg"},
    {with(R"("lights":[)" +
          [] {
              std::string skies;
              for (int i = 0; i < 25; ++i) {
                  skies +=
                      std::string(i == 0 ? "" : ",") + R"({"type":"sky","sun_direction":[0,1,0]})";
              }
              return skies;
          }() +
          "]"),
     422, Fault::OutOfRange, "/lights/24/type", "at most 24"},
    // from_mesh
    {with_light(R"("type":"from_mesh","flux_w":1)"), 422, Fault::UnknownField, "/lights/0/flux_w",
     "its fields: type"},
    {with(R"("lights":[{"type":"from_mesh"},{"type":"from_mesh"}])"), 422, Fault::ConflictingFields,
     "/lights/1/type", "once"},
    // units
    {beside_watts(R"("type":"point","position":[0,0,1],"flux_lm":1)"), 422, Fault::MixedUnits,
     "/lights/1/flux_lm", "luminous_efficacy_lm_w"},
    {beside_watts(R"("type":"directional","direction":[0,0,1],"illuminance_lx":1)"), 422,
     Fault::MixedUnits, "/lights/1/illuminance_lx", "\"illuminance_lx\" (lx) beside \"flux_w\""},
    {beside_watts(R"("type":"sphere","center":[0,0,9],"radius":1,"luminance_cd_m2":1)"), 422,
     Fault::MixedUnits, "/lights/1/luminance_cd_m2", "luminous_efficacy_lm_w"},
    {beside_watts(R"("type":"environment","luminance_cd_m2":1)"), 422, Fault::MixedUnits,
     "/lights/1/luminance_cd_m2", "wholly in watts"},
    {beside_watts(R"("type":"sky","sun_direction":[0,1,0])"), 422, Fault::MixedUnits,
     "/lights/1/type", "luminous_efficacy_lm_w"},
    {beside_watts(R"("type":"ies","position":[0,2,0],"direction":[0,-1,0],"profile":)" + id), 422,
     Fault::MixedUnits, "/lights/1/profile", "\"profile\" (cd) beside"},
};

std::string facets(const std::string& fields)
{
    return with_material(R"("model":"cook_torrance",)" + fields);
}
std::string disney(const std::string& fields)
{
    return with_material(R"("model":"principled",)" + fields);
}
std::string gltf(const std::string& fields)
{
    return with_material(R"("model":"metallic_roughness",)" + fields);
}
std::string groups(const std::string& fields)
{
    return with(R"("materials":{)" + fields + "}");
}

const Refusal material_refusals[] = {
    {with(R"("material":"lambert")"), 422, Fault::WrongType, "/material", "an object {…}"},
    {with_material(R"("albedo":[1,1,1])"), 422, Fault::MissingField, "/material/model",
     "metallic_roughness"},
    {with_material(R"("model":"lambrt")"), 422, Fault::UnknownValue, "/material/model",
     "did you mean \"lambert\""},
    {with_material(R"("model":"phong")"), 422, Fault::UnknownValue, "/material/model",
     "oren_nayar"},
    {with_material(R"("model":5)"), 422, Fault::WrongType, "/material/model", "one of: lambert"},
    {with_material(R"("model":"lambert","albedo":[1,1,1.5])"), 422, Fault::OutOfRange,
     "/material/albedo/2", "0..1"},
    {with_material(R"("model":"lambert","albedo":0.5)"), 422, Fault::WrongType, "/material/albedo",
     "[r,g,b]"},
    {with_material(R"("model":"lambert","albedo":"texture")"), 422, Fault::UnknownValue,
     "/material/albedo", "vertex"},
    {with_material(R"("model":"lambert","roughness":1)"), 422, Fault::UnknownField,
     "/material/roughness", "its fields: "},
    {with_material(R"("model":"lambert","base_color":[1,1,1])"), 422, Fault::UnknownField,
     "/material/base_color", "its fields: "},
    {with_material(R"("model":"oren_nayar","sigma_deg":91)"), 422, Fault::OutOfRange,
     "/material/sigma_deg", "0..90 degrees"},
    {with_material(R"("model":"oren_nayar","sigma":0.5)"), 422, Fault::UnknownField,
     "/material/sigma", "sigma_deg"},
    {with_material(R"("model":"oren_nayar","sigma_deg":"rough")"), 422, Fault::WrongType,
     "/material/sigma_deg", "a number"},
    // cook_torrance
    {facets(R"("roughness":2)"), 422, Fault::OutOfRange, "/material/roughness", "0..1"},
    {facets(R"("f0":[0,0,0],"ior":1.5)"), 422, Fault::ConflictingFields, "/material/ior",
     "exactly one of: f0"},
    {facets(R"("f0":[0,0,0],"eta":[1,1,1],"k":[1,1,1])"), 422, Fault::ConflictingFields,
     "/material/eta", "exactly one of: f0"},
    {facets(R"("eta":[1,1,1])"), 422, Fault::MissingField, "/material/k", "needs \"k\""},
    {facets(R"("k":[1,1,1])"), 422, Fault::MissingField, "/material/eta", "needs \"eta\""},
    {facets(R"("ior":0.5)"), 422, Fault::OutOfRange, "/material/ior", "1..10"},
    {facets(R"("eta":[0,1,1],"k":[1,1,1])"), 422, Fault::OutOfRange, "/material/eta/0",
     "0.001..100"},
    {facets(R"("distribution":"phong")"), 422, Fault::UnknownValue, "/material/distribution",
     "beckmann, ggx, gtr"},
    {facets(R"("gamma":2)"), 422, Fault::UnknownField, "/material/gamma", "its fields: "},
    {facets(R"("distribution":"gtr","gamma":0)"), 422, Fault::OutOfRange, "/material/gamma",
     "0.1..10"},
    {facets(R"("multiscatter":1)"), 422, Fault::WrongType, "/material/multiscatter",
     "true or false"},
    {facets(R"("metallic":1)"), 422, Fault::UnknownField, "/material/metallic", "its fields: "},
    // principled
    {disney(R"("metallic":1.1)"), 422, Fault::OutOfRange, "/material/metallic", "0..1"},
    {disney(R"("subsurface":-0.1)"), 422, Fault::OutOfRange, "/material/subsurface", "0..1"},
    {disney(R"("specular":2)"), 422, Fault::OutOfRange, "/material/specular", "0..1"},
    {disney(R"("roughness":-1)"), 422, Fault::OutOfRange, "/material/roughness", "0..1"},
    {disney(R"("specular_tint":[1,1,1])"), 422, Fault::WrongType, "/material/specular_tint",
     "a number"},
    {disney(R"("anisotropic":2)"), 422, Fault::OutOfRange, "/material/anisotropic", "0..1"},
    {disney(R"("sheen":2)"), 422, Fault::OutOfRange, "/material/sheen", "0..1"},
    {disney(R"("sheen_tint":2)"), 422, Fault::OutOfRange, "/material/sheen_tint", "0..1"},
    {disney(R"("clearcoat":2)"), 422, Fault::OutOfRange, "/material/clearcoat", "0..1"},
    {disney(R"("clearcoat_gloss":2)"), 422, Fault::OutOfRange, "/material/clearcoat_gloss", "0..1"},
    {disney(R"("base_color":[0,2,0])"), 422, Fault::OutOfRange, "/material/base_color/1", "0..1"},
    {disney(R"("clearcoatGloss":1)"), 422, Fault::UnknownField, "/material/clearcoatGloss",
     "did you mean \"clearcoat_gloss\""},
    {disney(R"("anisotropy":1)"), 422, Fault::UnknownField, "/material/anisotropy",
     "did you mean \"anisotropic\""},
    // metallic_roughness
    {gltf(R"("metallic":"yes")"), 422, Fault::WrongType, "/material/metallic", "0..1"},
    {gltf(R"("roughness":1.5)"), 422, Fault::OutOfRange, "/material/roughness", "0..1"},
    {gltf(R"("ior":0.5)"), 422, Fault::OutOfRange, "/material/ior", "1..10, or 0"},
    {gltf(R"("ior":-1)"), 422, Fault::OutOfRange, "/material/ior", "0..10"},
    {gltf(R"("specular":1.5)"), 422, Fault::OutOfRange, "/material/specular", "0..1"},
    {gltf(R"("specular_color":[1,1,-1])"), 422, Fault::OutOfRange, "/material/specular_color/2",
     "0..1000"},
    {gltf(R"("clearcoat":2)"), 422, Fault::OutOfRange, "/material/clearcoat", "0..1"},
    {gltf(R"("clearcoat_roughness":2)"), 422, Fault::OutOfRange, "/material/clearcoat_roughness",
     "0..1"},
    {gltf(R"("sheen_color":[1,2,1])"), 422, Fault::OutOfRange, "/material/sheen_color/1", "0..1"},
    {gltf(R"("sheen_color":1)"), 422, Fault::WrongType, "/material/sheen_color", "[r,g,b]"},
    {gltf(R"("sheen_roughness":2)"), 422, Fault::OutOfRange, "/material/sheen_roughness", "0..1"},
    {gltf(R"("anisotropy_strength":-1)"), 422, Fault::OutOfRange, "/material/anisotropy_strength",
     "0..1"},
    {gltf(R"("anisotropy_rotation_deg":361)"), 422, Fault::OutOfRange,
     "/material/anisotropy_rotation_deg", "-360..360 degrees"},
    {gltf(R"("anisotropy_rotation":1)"), 422, Fault::UnknownField, "/material/anisotropy_rotation",
     "did you mean \"anisotropy_rotation_deg\""},
    {gltf(R"("emissive":[2,1,1])"), 422, Fault::OutOfRange, "/material/emissive/0", "0..1"},
    {gltf(R"("emissive":"white")"), 422, Fault::WrongType, "/material/emissive", "[r,g,b]"},
    {gltf(R"("emissive_strength":-1)"), 422, Fault::OutOfRange, "/material/emissive_strength",
     "cd/m2 or W/(m2 sr)"},
    {gltf(R"("base_color":"vertices")"), 422, Fault::UnknownValue, "/material/base_color",
     "vertex"},
    {gltf(R"("albedo":[1,1,1])"), 422, Fault::UnknownField, "/material/albedo", "its fields: "},
    // materials
    {with(R"("materials":[])"), 422, Fault::WrongType, "/materials", "{\"name or index\": {…}}"},
    {groups(R"("red":"lambert")"), 422, Fault::WrongType, "/materials/red", "an object {…}"},
    {groups(R"("red":{})"), 422, Fault::MissingField, "/materials/red/model", "lambert"},
    {groups(R"("a/b":{"model":"lambert","albedo":[0,0,7]})"), 422, Fault::OutOfRange,
     "/materials/a~1b/albedo/2", "0..1"},
    {groups(R"("red":{"model":"lambert"},"red":{"model":"lambert"})"), 422, Fault::DuplicateField,
     "/materials/red", "once"},
};

TEST(LightJson, RefusesEveryFieldThatIsWrongAndSaysWhatIsAllowed)
{
    test::expect_refusals(refusals);
}

TEST(MaterialJson, RefusesEveryFieldThatIsWrongAndSaysWhatIsAllowed)
{
    test::expect_refusals(material_refusals);
}

TEST(MaterialJson, BoundsTheNumberOfMaterials)
{
    std::string many = R"("m":{"model":"lambert"})";
    for (int i = 0; i < 1024; ++i) {
        many += ",\"" + std::to_string(i) + R"(":{"model":"lambert"})";
    }
    const auto request = parse_request(groups(many), {});
    ASSERT_FALSE(request);
    EXPECT_EQ(request.error().pointer, "/materials/1023");  // the first too many
    EXPECT_NE(request.error().detail.find("1024"), std::string::npos) << request.error().detail;
}

}  // namespace
}  // namespace relight
