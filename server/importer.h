#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "server/import/protocol.h"
#include "server/import_process.h"

namespace relight {

/// A kind of file, as relight-import's command line has it, and what to do if it breaks on one.
struct ImportKind {
    std::string_view name, remedy;
};

/// Where the content that a header announces is to go, all of its bytes; nothing if it announces
/// what no honest importer would.
using ContentRoom =
    std::function<std::optional<std::span<std::byte>>(const import_protocol::Header&)>;

/// Has relight-import decode the file: what it says of it goes to where `room` says, and is not
/// looked at.   Errors and limits: as import_exr's (import_process.h).
Result<Done> run_importer(const ImportKind& kind, std::span<const std::byte> file,
                          const ImportLimits& limits, Progress& progress, const ContentRoom& room);

/// What to say of an importer that crashed, or whose answer is none.
Error broken_import(const ImportKind& kind);

}  // namespace relight
