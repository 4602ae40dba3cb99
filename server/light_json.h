#pragma once

#include <optional>
#include <vector>

#include "core/scene.h"
#include "server/fields.h"
#include "server/request.h"

namespace relight {

struct ParsedLights {
    Units units = Units::Radiometric;
    std::vector<Light> lights;
    std::vector<LightFile> files;  ///< that their shapes wait for
    std::vector<ClearSky> skies;   ///< likewise
};

/// "lights" of the request. With `efficacy` [lm/W] the request is photometric and watts are
/// multiplied by it; without, watts beside lumens are MixedUnits. A flux becomes radiance by the
/// light's area, which `length_unit_m` makes square metres. Errors go to `errors`.
ParsedLights parse_lights(const JsonArray& lights, std::optional<double> efficacy,
                          double length_unit_m, FirstError& errors);

/// "material" of the request, or one of its "materials". What is tabulated of a CookTorrance is
/// left to complete(): it takes milliseconds.
Material parse_material(Fields fields);

/// "materials" of the request, in the order of their appearance.
std::vector<GroupMaterial> parse_materials(const Json& json, const std::string& pointer,
                                           FirstError& errors);

}  // namespace relight
