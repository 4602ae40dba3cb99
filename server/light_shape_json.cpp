#include "server/light_shape_json.h"

#include <numbers>

#include "server/file_source.h"
#include "server/json_text.h"

namespace relight {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double largest_scale = 1e6;
constexpr Range radius_range{0.0, largest_coordinate, "length units"};

constexpr PowerField point_powers[] = {{"flux_w", "W", Units::Radiometric, true},
                                       {"flux_lm", "lm", Units::Photometric, true},
                                       {"intensity_w_sr", "W/sr", Units::Radiometric, false},
                                       {"intensity_cd", "cd", Units::Photometric, false}};
constexpr PowerField directional_powers[] = {{"irradiance_w_m2", "W/m2", Units::Radiometric, false},
                                             {"illuminance_lx", "lx", Units::Photometric, false}};
constexpr PowerField area_powers[] = {{"radiance_w_m2_sr", "W/(m2 sr)", Units::Radiometric, false},
                                      {"luminance_cd_m2", "cd/m2", Units::Photometric, false},
                                      {"flux_w", "W", Units::Radiometric, true},
                                      {"flux_lm", "lm", Units::Photometric, true}};
constexpr auto environment_powers = std::span(area_powers).first<2>();  // a sky has no flux
constexpr PowerField sky_type{"type", "cd/m2", Units::Photometric, false};
constexpr PowerField ies_profile{"profile", "cd", Units::Photometric, false};

Vec3 parse_edge(Fields& fields, std::string_view name)
{
    return fields.point(name).value_or(Point3{}) - Point3{};
}

ParsedShape parse_point(Fields& fields)
{
    fields.need({"position"});
    return {PointLight{fields.point("position").value_or(Point3{}), {}}, point_powers};
}

ParsedShape parse_spot(Fields& fields)
{
    fields.need({"position", "direction"});
    SpotLight spot;
    spot.position = fields.point("position").value_or(Point3{});
    spot.axis = fields.direction("direction").value_or(Dir3{});
    const double outer = fields.number("outer_cone_deg", {0, 90, "degrees", true}).value_or(45.0);
    const double inner = fields.number("inner_cone_deg", {0, 90, "degrees"}).value_or(0.0);
    if (inner > outer) {
        fields.fail(Fault::OutOfRange, "inner_cone_deg",
                    "found " + decimal(inner) + "; at most outer_cone_deg, which is " +
                        decimal(outer) + " degrees");
    }
    spot.inner_cone = inner * degree;
    spot.outer_cone = outer * degree;
    return {spot, point_powers};
}

ParsedShape parse_directional(Fields& fields)
{
    constexpr double hard = 1e-6;  // [degrees] a disc below it casts the shadow of a direction, and
                                   // its radiance, E over its solid angle, would outgrow numbers
    fields.need({"direction"});
    DirectionalLight sun{fields.direction("direction").value_or(Dir3{})};
    const double angle = fields.number("angle_deg", {0, 180, "degrees"}).value_or(0.0);
    if (angle >= hard) { sun.half_angle = 0.5 * angle * degree; }
    return {sun, directional_powers};
}

ParsedShape parse_rect(Fields& fields)
{
    fields.need({"center", "edge_u", "edge_v"});
    RectLight rect;
    rect.center = fields.point("center").value_or(Point3{});
    rect.edge_u = parse_edge(fields, "edge_u");
    rect.edge_v = parse_edge(fields, "edge_v");
    rect.two_sided = fields.flag("two_sided").value_or(false);
    return {rect, area_powers};
}

ParsedShape parse_disk(Fields& fields)
{
    fields.need({"center", "normal", "radius"});
    return {DiskLight{fields.point("center").value_or(Point3{}),
                      fields.direction("normal").value_or(Dir3{}),
                      fields.number("radius", radius_range).value_or(0.0)},
            area_powers};
}

ParsedShape parse_sphere(Fields& fields)
{
    fields.need({"center", "radius"});
    return {SphereLight{fields.point("center").value_or(Point3{}),
                        fields.number("radius", radius_range).value_or(0.0)},
            area_powers};
}

/// "image" or "profile": a file stored before or sent along.
void parse_file(ParsedShape& parsed, Fields& fields, std::string_view field, std::string_view what,
                std::string_view route)
{
    auto file = fields.object(field, std::string(what));
    if (!file) { return; }
    parsed.file = parse_file_source(*file, route);
    parsed.file_field = field;
    if (parsed.file) { return; }
    file->finish();
    fields.fail(Fault::MissingField, field,
                std::string(what) + R"( is {"id": …}, as )" + std::string(route) +
                    R"( answered, or {"part": …}, a file of this multipart request)");
}

ParsedShape parse_environment(Fields& fields)
{
    ParsedShape parsed{EnvironmentLight{}, environment_powers};
    if (!fields.has("image")) {
        for (const std::string_view name : {"rotation_deg", "scale"}) {
            if (!fields.has(name)) { continue; }
            fields.fail(Fault::ConflictingFields, name,
                        "it goes with an \"image\"; a sky that is the same everywhere has "
                        "radiance_w_m2_sr or luminance_cd_m2 alone");
        }
        return parsed;
    }
    parse_file(parsed, fields, "image", "an environment's image", "POST /v1/environments");
    for (const PowerField& constant : environment_powers) {
        if (!fields.has(constant.name)) { continue; }
        fields.fail(Fault::ConflictingFields, constant.name,
                    "\"image\" is given too; an environment is an image (times \"scale\") or the "
                    "same radiance everywhere");
    }
    const double rotation = fields.number("rotation_deg", {-360, 360, "degrees"}).value_or(0.0);
    parsed.shape = EnvironmentLight{nullptr, rotation * degree};
    parsed.scale = fields.number("scale", {0.0, largest_scale, {}}).value_or(1.0);
    parsed.powers = {};
    return parsed;
}

ParsedShape parse_ies(Fields& fields)
{
    constexpr double parallel = 1e-9;  // sine of the angle between up and direction
    fields.need({"position", "direction", "profile"});
    IesLight light;
    light.position = fields.point("position").value_or(Point3{});
    light.axis = fields.direction("direction").value_or(Dir3{});
    light.h0 = frame_around(light.axis).x;
    if (const auto up = fields.direction("up")) {
        if (light.axis && length(cross(*up, light.axis)) < parallel) {
            fields.fail(Fault::ConflictingFields, "up",
                        "it lies along \"direction\" and says nothing of how the lamp is turned; "
                        "any other vector does, or leave it out");
        }
        light.h0 = normalize(Vec3(*up) - Vec3(light.axis) * dot(*up, light.axis));
    }
    ParsedShape parsed{light, {}};
    parse_file(parsed, fields, "profile", "a photometric profile", "POST /v1/profiles");
    parsed.scale = fields.number("scale", {0.0, largest_scale, {}}).value_or(1.0);
    parsed.implied = &ies_profile;
    return parsed;
}

/// "sun_direction", or the place and time that it follows from. "No direction" if neither is sound.
Dir3 parse_sun(Fields& fields)
{
    const auto direction = fields.direction("sun_direction");
    const auto latitude = fields.number("latitude_deg", {-90, 90, "degrees"});
    const auto longitude = fields.number("longitude_deg", {-180, 180, "degrees"});
    constexpr std::size_t longest_time = 64;
    const auto time = fields.text("time", longest_time);
    bool placed = false;
    for (const std::string_view name : {"latitude_deg", "longitude_deg", "time"}) {
        if (!fields.has(name)) { continue; }
        placed = true;
        if (fields.has("sun_direction")) {
            fields.fail(Fault::ConflictingFields, name,
                        "\"sun_direction\" is given too; the sun stands there, or where "
                        "latitude_deg, longitude_deg and time put it");
        }
    }
    if (placed) {
        fields.need({"latitude_deg", "longitude_deg", "time"});
    } else if (!fields.has("sun_direction")) {
        fields.fail(
            Fault::MissingField, "sun_direction",
            "a sky needs \"sun_direction\" (toward the sun; +Y is up), or where and when it "
            "is seen: latitude_deg, longitude_deg and time");
    }
    if (direction || !latitude || !longitude || !time) { return direction.value_or(Dir3{}); }
    const auto seconds = rfc3339(*time);
    if (!seconds) {
        fields.fail(Fault::UnknownValue, "time",
                    "found \"" + printable(*time) +
                        "\"; a time is written as RFC 3339 has it, with its zone: "
                        "\"2026-06-21T12:00:00+02:00\" or \"2026-06-21T10:00:00Z\"");
        return {};
    }
    return toward_sun(*latitude * degree, *longitude * degree, *seconds);
}

ParsedShape parse_sky(Fields& fields)
{
    const Dir3 sun = parse_sun(fields);
    const double turbidity =
        fields.number("turbidity", {least_turbidity, largest_turbidity, {}}).value_or(3.0);
    ParsedShape parsed{SkyLight{}, {}};
    parsed.sky = ClearSky{0, sun, turbidity};
    parsed.implied = &sky_type;
    return parsed;
}

ParsedShape parse_from_mesh(Fields& /*fields*/)
{
    return {MeshLight{}, {}};
}

}  // namespace

ParsedShape parse_shape(std::string_view type, Fields& fields)
{
    constexpr std::pair<std::string_view, ParsedShape (*)(Fields&)> parsers[] = {
        {"point", parse_point},
        {"spot", parse_spot},
        {"directional", parse_directional},
        {"rect", parse_rect},
        {"disk", parse_disk},
        {"sphere", parse_sphere},
        {"ies", parse_ies},
        {"environment", parse_environment},
        {"sky", parse_sky},
        {"from_mesh", parse_from_mesh}};
    for (const auto& [name, parse] : parsers) {
        if (name == type) { return parse(fields); }
    }
    return {};
}

}  // namespace relight
