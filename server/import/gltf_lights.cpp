// KHR_lights_punctual.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/import/gltf_factors.h"
#include "server/import/gltf_look.h"

namespace relight::gltf {
namespace {

Point3 position(const std::array<double, 12>& to_world, std::string_view asked_at)
{
    const Point3 place{to_world[3], to_world[7], to_world[11]};
    const double farthest = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    if (!is_finite(place) || farthest > largest_coordinate) {
        refuse(Fault::CoordinateTooLarge, asked_at,
               "puts a light farther out than 1e15 scene units");
    }
    return place;
}

/// Where the node's -Z points, whatever its scale.
Dir3 direction(const std::array<double, 12>& to_world, std::string_view asked_at)
{
    const Dir3 along = normalize(-Vec3{to_world[2], to_world[6], to_world[10]});
    if (!along) {
        refuse(Fault::MalformedBody, asked_at,
               "gives a light no direction: the node's transform squeezes its z axis to nothing");
    }
    return along;
}

std::optional<double> range(const Node& light)
{
    if (!light.has("range")) { return {}; }
    const double far = light.number("range", 0.0, 0.0, std::numeric_limits<double>::max());
    if (far == 0.0) {
        refuse(Fault::OutOfRange, light.where() + "/range", "is 0, and must be more");
    }
    return far;
}

SpotLight spot_light(const Node& light, const std::array<double, 12>& to_world,
                     std::string_view asked_at)
{
    // pi/2, rounded to a float by whoever wrote the file, may be a bit more.
    constexpr double right_angle = 0.5 * std::numbers::pi, with_rounding = right_angle + 1e-6;
    const SpotLight defaults;
    SpotLight spot{position(to_world, asked_at), direction(to_world, asked_at), defaults.inner_cone,
                   defaults.outer_cone, range(light)};
    const auto cone = light.find("spot");
    if (!cone) { return spot; }
    spot.inner_cone = cone->number("innerConeAngle", spot.inner_cone, 0.0, with_rounding);
    spot.outer_cone =
        std::min(cone->number("outerConeAngle", spot.outer_cone, 0.0, with_rounding), right_angle);
    if (spot.inner_cone >= spot.outer_cone) {
        refuse(Fault::OutOfRange, cone->where(),
               "has an innerConeAngle (default 0) that is not less than its outerConeAngle "
               "(default pi/4)");
    }
    return spot;
}

/// As the server wants names of lights: at most 64 bytes, no control characters.
bool is_name(std::string_view text)
{
    return !text.empty() && text.size() <= 64 && std::none_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    });
}

}  // namespace

Light read_light(const File& file, std::uint64_t index, std::string_view asked_at,
                 const std::array<double, 12>& to_world)
{
    const auto punctual = file.root().extension("KHR_lights_punctual");
    const std::size_t count = punctual ? punctual->size("lights") : 0;
    if (index >= count) {
        refuse(
            Fault::IndexOutOfRange, asked_at,
            "names light " + std::to_string(index) + ", and the file has " + std::to_string(count));
    }
    const Node node = punctual->item("lights", index);
    Light light;
    const std::string name = node.text("name");
    light.name = is_name(name) ? name : "light_" + std::to_string(index);
    light.power =
        color(node, "color", Rgb::grey(1.0)) * node.number("intensity", 1.0, 0.0, largest_factor);
    const std::string type = node.text("type");
    if (type == "point") {
        light.shape = PointLight{position(to_world, asked_at), range(node)};
    } else if (type == "spot") {
        light.shape = spot_light(node, to_world, asked_at);
    } else if (type == "directional") {
        light.shape = DirectionalLight{direction(to_world, asked_at), 0.0};
    } else {
        refuse(Fault::MalformedBody, node.where() + "/type",
               "is " + shown(type) + ", and must be point, spot or directional");
    }
    return light;
}

}  // namespace relight::gltf
