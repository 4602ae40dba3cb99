#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"

namespace relight {

/// Bounds of what a reader accepts, on top of what the bytes can hold.
struct ReadLimits {
    std::uint64_t vertices = 100'000'000;
    std::uint64_t faces = 200'000'000;
};

enum class MeshFormat { Ply, Obj, Off, Stl, Xyz, Pts, Pcd, Las };

std::optional<MeshFormat> mesh_format_named(
    std::string_view
        name);  ///< "ply", "obj", "off", "stl", "xyz" (or "txt"), "pts", "pcd", "las" (or "laz")
std::optional<MeshFormat> mesh_format_of_media(
    std::string_view media);  ///< "model/stl", "model/obj" …
std::optional<MeshFormat> mesh_format_of_bytes(
    std::span<const std::byte> file);  ///< magic bytes, first words
std::string_view name_of(MeshFormat format);

/// Strict readers (fuzzed): bytes in, a checked Mesh or an Error with `line` or `byte` out. Counts
/// are checked against the bytes that remain before anything is allocated; linear time; no path is
/// opened, no locale asked. Vertex order and count are the file's. Errors: EmptyFile,
/// MalformedHeader, MalformedBody, Truncated, CountExceedsFile, IndexOutOfRange,
/// NonFiniteCoordinate, CoordinateTooLarge, NoGeometry, TooManyVertices, TooManyFaces, Cancelled.
/// PLY: in a file without faces a NaN coordinate marks the point as absent (Mesh::absent).
Result<Mesh> read_ply(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
Result<Mesh> read_obj(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
Result<Mesh> read_off(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
Result<Mesh> read_stl(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
/// XYZ, TXT, CSV: rows of numbers, a point each, all of as many columns, between blanks, commas or
/// semicolons; '#' and "//" begin comments. A line of names, or a comment that is one, may stand
/// first: x y z, r g b (red …), nx ny nz (normal_x …) in any order and case, others are left out.
/// Without names their number tells: 3 x y z; 4 and intensity, which is left out; 6 x y z and
/// normals if every row of those is of unit length (or zero: none), else colours if all are within
/// 0..1 or whole numbers, else normals; 7 x y z intensity r g b; 9 x y z, and of two triples the
/// one of unit length is the normal and the other the colour. Colours are linear if none is above
/// 1, else 8-bit sRGB codes.
Result<Mesh> read_xyz(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
/// As read_xyz, after a line with the number of points (several such blocks may follow each other).
Result<Mesh> read_pts(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
/// Point Cloud Library's PCD 0.5 - 0.7: ascii, binary, binary_compressed (LZF). Fields x y z,
/// normal_x normal_y normal_z (NaN: none), rgb or rgba (packed sRGB bytes) of COUNT 1. Points of
/// NaN stay in place (Mesh::absent). VIEWPOINT's translation becomes Mesh::viewpoint, but for the
/// default 0 0 0 within the bounds of the points: outside, the cloud is in its scanner's frame.
Result<Mesh> read_pcd(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
/// ASPRS LAS 1.0 - 1.4, point formats 0..10, scale and offset in double; R G B of 16 bits (sRGB),
/// or of 8 filed in 16 if none is above 255. Points of every flag and class are kept. A LAZ
/// (compressed) file is NotAvailable.
Result<Mesh> read_las(std::span<const std::byte> file, const ReadLimits& limits,
                      Progress& progress);
Result<Mesh> read_mesh(MeshFormat format, std::span<const std::byte> file, const ReadLimits& limits,
                       Progress& progress);

}  // namespace relight
