#pragma once

#include <optional>
#include <vector>

#include "core/scene.h"
#include "server/fields.h"

namespace relight {

struct ParsedLights {
    Units units = Units::Radiometric;
    std::vector<Light> lights;
};

/// "lights" of the request. With `efficacy` [lm/W] the request is photometric and watts are
/// multiplied by it; without, watts beside lumens are MixedUnits. Errors go to `errors`.
ParsedLights parse_lights(const JsonArray& lights, std::optional<double> efficacy,
                          FirstError& errors);

/// "material" of the request.
Material parse_material(Fields fields);

}  // namespace relight
