#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/writers.h"

/// What every GLB of ours has in common, whether it is written from a mesh or added to a file.
namespace relight::glb {

/// Numbers of the specification.
enum ComponentType : unsigned { u16 = 5123, u32 = 5125, f32 = 5126 };
enum Target : unsigned { vertex_data = 34962, index_data = 34963 };
inline constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

/// "SCALAR", "VEC3" …
std::string_view type_name(int components);

/// The quantities under glTF's names for attributes of an application: "per_light_key" becomes
/// _PER_LIGHT_KEY, in [A-Z0-9_] and each once.
std::vector<Quantity3> attributes_of(std::span<const Quantity3> quantities);

/// COLOR_0 of 8-bit sRGB codes: linear, as glTF has it. 3 floats a colour.
std::vector<float> linear_colors(std::span<const Rgb8> codes);

/// A JSON string. What is not UTF-8 is taken for Latin-1.
std::string quoted(std::string_view text);

/// The shortest decimal that reads back exactly. `value` is finite.
std::string decimal(double value);

/// A GLB up to its binary chunk's data: the caller appends `binary` bytes (a multiple of 4; 0:
/// there is no such chunk), and other chunks of `more` bytes. Capacity for all of it is reserved.
/// Empty if a GLB cannot hold as much: its lengths are 32-bit numbers.
std::string begun(std::string_view json, std::uint64_t binary, std::uint64_t more = 0);

}  // namespace relight::glb
