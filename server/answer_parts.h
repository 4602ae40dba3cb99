#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/display/display.h"
#include "core/scene.h"

/// What answers have in common, whatever their format.
namespace relight {

struct UnitNames {
    std::string_view irradiance, radiance;
};
UnitNames unit_names(Units units);

/// Each light's name as a property or file name: letters, digits, '_'; still unique.
std::vector<std::string> property_names(const std::vector<Light>& lights);

/// "units", "view" and "display" of JSON answers.
std::string units_json(Units units);
std::string view_json(const Scene& scene);
std::string display_json(const Display& display);

std::string_view tone_map_name(ToneMap map);

inline std::span<const float> floats(std::span<const Rgbf> values)
{
    return {values.empty() ? nullptr : values.front().data(), values.size() * 3};
}

}  // namespace relight
