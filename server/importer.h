#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "server/import/protocol.h"
#include "server/import_process.h"
#include "server/shared_memory.h"

namespace relight {

/// A kind of file, as relight-import's command line has it, and what to do if it breaks on one.
struct ImportKind {
    std::string_view name, remedy;
};

/// A place among the imports that may run at once; given back with it.
struct GiveBack {
    void operator()(class ImportPlaces* places) const;
};
using ImportPlace = std::unique_ptr<ImportPlaces, GiveBack>;

/// What relight-import made of a file. Nobody can change it any more, but nothing of it has been
/// looked at: the importer may have been taken over by the file.
struct ImportAnswer {
    ImportPlace place;    ///< held until the answer is read: it may be as large as the importer was
    SharedMemory memory;  ///< that the next is in
    import_protocol::Header header{};
    std::span<const std::byte> content{};  ///< header.bytes of it, on a multiple of 8
};

/// Has relight-import decode the file, as soon as there is a place: no more of them run at once
/// than there are cores.   Errors and limits: as import_exr's (import_process.h).
Result<ImportAnswer> run_importer(const ImportKind& kind, std::span<const std::byte> file,
                                  const ImportLimits& limits, Progress& progress);

/// What to say of an importer that crashed, or whose answer is none.
Error broken_import(const ImportKind& kind);

}  // namespace relight
