#include "server/answer_parts.h"

#include <set>

#include "server/json_text.h"

namespace relight {

std::string_view tone_map_name(ToneMap map)
{
    switch (map) {
        case ToneMap::None:
            return "none";
        case ToneMap::Reinhard:
            return "reinhard";
        case ToneMap::ReinhardExtended:
            return "reinhard_extended";
        case ToneMap::AcesNarkowicz:
            return "aces_narkowicz";
        case ToneMap::AcesHill:
            return "aces_hill";
        case ToneMap::PbrNeutral:
            return "pbr_neutral";
    }
    return "none";
}

UnitNames unit_names(Units units)
{
    if (units == Units::Photometric) { return {"lx", "cd/m2"}; }
    return {"W/m2", "W/m2/sr"};
}

std::vector<std::string> property_names(const std::vector<Light>& lights)
{
    std::vector<std::string> names;
    std::set<std::string> taken;
    for (const Light& light : lights) {
        std::string name = light.name;
        for (char& c : name) {
            const bool plain =
                (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
            if (!plain) { c = '_'; }
        }
        while (!taken.insert(name).second) { name += '_'; }
        names.push_back(std::move(name));
    }
    return names;
}

std::string units_json(Units units)
{
    const UnitNames names = unit_names(units);
    return ObjectWriter()
        .text("irradiance", names.irradiance)
        .text("radiance", names.radiance)
        .done();
}

std::string view_json(const Scene& scene)
{
    ObjectWriter json;
    if (std::holds_alternative<CameraView>(scene.view)) {
        json.text("type", "camera").raw("eye", json_of(scene.camera.eye - Point3{}));
    } else if (const auto* direction = std::get_if<DirectionView>(&scene.view)) {
        json.text("type", "direction").raw("toward_viewer", json_of(direction->toward_viewer));
    } else {
        json.text("type", "normal");
    }
    return json.done();
}

std::string display_json(const Display& display)
{
    return ObjectWriter()
        .number("exposure_ev", display.exposure_ev)
        .text("tone_map", tone_map_name(display.tone_map))
        .text("transfer", "srgb")
        .done();
}

}  // namespace relight
