#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/io/readers.h"
#include "core/trace/stage.h"

namespace relight {

/// The format of a client's file: as `named` ("ply"), else by its media type, else by its bytes.
/// Errors: EmptyFile, NotAvailable (a format of the contract that this build cannot read),
/// UnknownFormat.
Result<MeshFormat> choose_mesh_format(std::optional<std::string_view> named,
                                      std::string_view content_type,
                                      std::span<const std::byte> file);

/// "model/obj" …: what the content of a stored file is sent as.
std::string_view media_type_of(std::string_view format);

/// The description of a mesh in answers; `intake` is the whole report.
std::string describe(const std::string& id, std::uint64_t bytes, const Mesh& mesh,
                     const Surface& surface, const Intake& intake);

}  // namespace relight
