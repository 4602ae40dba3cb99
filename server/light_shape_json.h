#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "core/scene.h"
#include "server/fields.h"
#include "server/request.h"

namespace relight {

/// A field that says in which unit a light's power is.
struct PowerField {
    std::string_view name, unit;
    Units units;
    bool is_flux;
};

/// What a light is, apart from what all lights have.
struct ParsedShape {
    LightShape shape;
    std::span<const PowerField> powers;  ///< exactly one must be there; empty: `scale` is the power
    double scale = 1.0;
    const PowerField* implied = nullptr;  ///< what decides the units of a light without `powers`
    std::optional<std::variant<StoredMesh, PartMesh>> file{};  ///< that the shape waits for,
    std::string_view file_field{};                             ///< and the field that names it
    std::optional<ClearSky> sky{};
};

/// The fields of a light of this type ("point", "rect" …) that say what it is. An environment's map
/// and a profile are left null for their file; a sky's dome and a MeshLight's table for complete().
ParsedShape parse_shape(std::string_view type, Fields& fields);

}  // namespace relight
