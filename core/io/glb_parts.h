#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/pieces.h"
#include "core/io/srgb_codes.h"
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

/// COLOR_0 of 8-bit sRGB codes: linear, as glTF has it.
class LinearColors {
  public:
    explicit LinearColors(std::span<const Rgb8> codes) : codes_(codes), table_(decoded_srgb(255)) {}
    Rgbf operator()(std::size_t i) const
    {
        const Rgb8& code = codes_[i];
        return {table_[code[0]], table_[code[1]], table_[code[2]]};
    }

  private:
    std::span<const Rgb8> codes_;
    std::vector<float> table_;
};

/// Zeros up to the next multiple of 4.
Piece padding_behind(std::uint64_t bytes);

/// A JSON string. What is not UTF-8 is taken for Latin-1.
std::string quoted(std::string_view text);

/// The shortest decimal that reads back exactly. `value` is finite.
std::string decimal(double value);

/// A GLB up to its binary chunk's data: `binary` bytes (a multiple of 4; 0: there is no such chunk)
/// come behind it, and other chunks of `more` bytes. Empty if a GLB cannot hold as much: its
/// lengths are 32-bit numbers.
std::string begun(std::string_view json, std::uint64_t binary, std::uint64_t more = 0);

}  // namespace relight::glb
