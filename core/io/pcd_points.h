#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/io/coordinate.h"
#include "core/io/pcd_header.h"
#include "core/io/srgb_codes.h"

namespace relight::pcd {

/// The fields that we take, by their slot: x y z, normal_x normal_y normal_z, rgb.
using Taken = std::array<const Field*, 7>;
inline constexpr std::size_t normal_slot = 3, color_slot = 6;

/// Finds the fields that we take, and notes those left out. Normals come whole or not at all.
/// Error: MalformedHeader.
Result<Taken> take(const Header& header, std::vector<std::string>& notes);

/// The mesh as it grows.
struct Points {
    Mesh mesh;
    bool normals = false, colors = false;
    std::uint64_t non_finite = 0;  // normals and colours
    std::vector<float> table = decoded_srgb(255);

    void reserve(std::size_t count)
    {
        mesh.positions.reserve(count);
        if (normals) { mesh.normals.reserve(count); }
        if (colors) { mesh.colors.reserve(count); }
    }
    void resize(std::size_t count)
    {
        mesh.positions.resize(count);
        if (normals) { mesh.normals.resize(count); }
        if (colors) { mesh.colors.resize(count); }
    }
    /// Sees to point i, once it is there. The error has no place yet.
    std::optional<Error> check(std::size_t i)
    {
        const bool placed = is_placed(mesh.positions[i]);
        if (normals && !is_finite(mesh.normals[i])) {  // NaN is how PCL says that it has none
            mesh.normals[i] = {};
            if (placed) { ++non_finite; }
        }
        if (placed) { return {}; }
        if (is_absent(mesh.positions[i])) { mesh.absent.push_back(static_cast<std::uint32_t>(i)); }
        return misplaced(i, mesh.positions[i]);
    }
    /// 0x__RRGGBB.
    Rgbf color(std::uint32_t packed) const
    {
        return {table[packed >> 16 & 255], table[packed >> 8 & 255], table[packed & 255]};
    }
};

/// Reads the points of a binary body, which holds them all: one after the other, or, `by_field`,
/// the first field of each, then the second …. `byte` is where they lie in the file (by field:
/// where the packed ones do).
std::optional<Error> read_bytes(std::span<const std::byte> body, std::size_t byte, bool by_field,
                                const Header& header, const Taken& taken, Points& points,
                                Progress& progress);

/// Reads the points of an ascii body, a line each.
std::optional<Error> read_text(std::span<const std::byte> file, const Header& header,
                               const Taken& taken, Points& points, Progress& progress);

}  // namespace relight::pcd
