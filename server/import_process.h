#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/asset.h"
#include "core/base/camera.h"
#include "core/base/progress.h"
#include "core/base/result.h"

namespace relight {

/// What one import may take.
struct ImportLimits {
    std::string program{};                 ///< path; empty: relight-import beside this program
    std::uint64_t vertices = 100'000'000;  ///< of a mesh, instances unfolded
    std::uint64_t faces = 200'000'000;
    std::uint64_t pixels = 1ULL << 25U;      ///< of a picture or texture: 8192 x 4096
    std::uint64_t memory = 1ULL << 31U;      ///< of the process's address space [bytes]
    std::chrono::milliseconds time{20'000};  ///< from start to end, and of CPU time
};

/// A picture out of a client's file: finite, not negative, without coverage.
struct ImportedImage {
    Image image;
    std::vector<std::string> notes;  ///< what was changed: "12 values below 0 became 0"
};

/// Decodes an OpenEXR file in a process of its own (server/import), which may break: no byte of the
/// file meets a decoder in this one. Waits while as many imports run as there are cores; returns
/// within `limits.time` of its turn, and 0.1 s of being stopped; the process is gone by then.
/// Errors: EmptyFile, the decoder's (server/import/exr.h), ImportFailed (it crashed, hung, ran over
/// a limit or answered nonsense), Cancelled. Throws std::system_error if no process can be started.
Result<ImportedImage> import_exr(std::span<const std::byte> file, const ImportLimits& limits,
                                 Progress& progress);

/// Decodes a glTF or GLB file likewise (server/import/gltf.h): what comes back keeps every promise
/// of Mesh and Asset, whatever became of the importer; checking it takes about a second a gigabyte
/// more.   Errors: as import_exr's, and gltf.h's.
Result<Asset> import_gltf(std::span<const std::byte> file, const ImportLimits& limits,
                          Progress& progress);

}  // namespace relight
