#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/camera.h"
#include "core/light/ies.h"
#include "server/import_process.h"

namespace relight {

/// An equirectangular picture as it came.
struct EnvironmentFile {
    std::string format;  ///< "hdr", "exr"
    Image image;         ///< linear, finite, not negative
    std::vector<std::string> notes;
};

/// A client's environment image: .hdr by our own reader, .exr in a process of its own. The format
/// as `named`, else by media type, else by its bytes. Errors: EmptyFile, UnknownFormat, the
/// readers' own.
Result<EnvironmentFile> read_environment(std::span<const std::byte> file,
                                         std::optional<std::string_view> named,
                                         std::string_view content_type, std::uint64_t most_pixels,
                                         Progress& progress);

/// A client's photometric profile (.ies). Errors: EmptyFile, UnknownFormat, the reader's own.
Result<IesProfile> read_profile(std::span<const std::byte> file,
                                std::optional<std::string_view> named, Progress& progress);

/// Descriptions in answers: size and mean radiance; angles, symmetry, flux.
std::string describe(const std::string& id, std::uint64_t bytes, const EnvironmentFile& file);
std::string describe(const std::string& id, std::uint64_t bytes, const IesProfile& profile);

}  // namespace relight
