#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/asset.h"
#include "core/geometry/surface.h"
#include "core/io/readers.h"

namespace relight {

/// A client's mesh or cloud: glTF in a process of its own, all else by our own readers. The format
/// as `named` ("ply", "glb"), else by its media type, else by its bytes. `pixels` is for each of
/// its textures. Errors: EmptyFile, NotAvailable (LAZ), UnknownFormat, the readers' own
/// (core/io/readers.h, server/import/gltf.h).
Result<Asset> read_mesh_file(std::span<const std::byte> file, std::optional<std::string_view> named,
                             std::string_view content_type, const ReadLimits& limits,
                             std::uint64_t pixels, Progress& progress);

/// "model/obj" …: what the content of a stored file is sent as.
std::string_view media_type_of(std::string_view format);

/// The description of a mesh in answers; `intake` is the whole report.
std::string describe(const std::string& id, std::uint64_t bytes, const Asset& asset,
                     const Surface& surface, const Intake& intake);

}  // namespace relight
