#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/io/readers.h"
#include "core/io/sink.h"
#include "server/cache.h"
#include "server/column_key.h"
#include "server/multipart.h"
#include "server/request.h"
#include "server/store.h"

namespace relight {

/// What a relight job needs besides its request.
struct Workshop {
    const Store& meshes;
    const Store& environments;
    const Store& profiles;
    Cache& cache;
    unsigned threads = 0;  ///< of one job; 0: one a core
    ReadLimits read;
    std::uint64_t pixels = 33'554'432;   ///< of an environment or texture
    std::uint64_t rays = 4'000'000'000;  ///< one job may ask for
    std::uint64_t memory = 4ULL << 30U;  ///< bytes one job may hold beside its stage
    /// Has work done that nobody waits for, when a worker is free; none: it is left undone.
    std::function<void(std::function<void(Progress&)>)> behind{};
};

/// Milliseconds of the stages of the walk, as Server-Timing reports them.
struct Timings {
    double parse = 0, bvh = 0, trace = 0, shade = 0, encode = 0, total = 0;
};

/// An answer, ready to be sent.
struct Encoded {
    std::string media_type;
    Encoding body;
    std::uint64_t rays = 0;
    Timings timings;
    std::vector<std::string> warnings;  ///< for the client; in JSON and PLY they stand inside, too
    Units units = Units::Radiometric;   ///< of its numbers
};

/// The whole walk: mesh -> Stage -> Transport -> Shaded -> bytes. `format` is decided; `parts` are
/// the files that came with the request. Errors: NotFound and MissingField at /mesh, the readers'
/// own, NormalsRequired, OutOfRange where the work asked for is beyond a limit, ConflictingFields,
/// Cancelled. `last`: no better answer to the same request follows.
Result<Encoded> relight(RelightRequest request, Format format, const std::vector<Part>& parts,
                        const Workshop& workshop, Progress& progress, bool last = true);

/// The same request's `vertices`, one by one: for each light its cosine, distance, visibility and
/// blocker, the BRDF's terms and their product, as JSON. The lights' irradiances and radiances are
/// doubles whose sums, in order and rounded to float, are the very values that relight() gives.
/// Errors: relight()'s, IndexOutOfRange at /vertices.
Result<Encoded> explain(RelightRequest request, const std::vector<Part>& parts,
                        const Workshop& workshop, Progress& progress);

/// A request's mesh on its stage, and the scene complete with all that its files bring.
struct SetUp {
    Model model;
    Scene scene;
    FileNames names;  ///< of the files that its lights are made of
};
Result<SetUp> set_up(RelightRequest& request, const std::vector<Part>& parts,
                     const Workshop& workshop, Timings& timings, Progress& progress);

/// Counts what was asked of a model's tree. One that was built in haste is built anew, behind the
/// answers, once so much was asked of it that a good one would have come cheaper.
void count_rays(const Model& model, double radius_scale, std::uint64_t rays,
                const Workshop& workshop);

/// The bytes that a request's mesh came as; empty if it stood in the request itself.
/// Error NotFound if they were deleted meanwhile.
Result<std::vector<std::byte>> source_of(const RelightRequest& request,
                                         const std::vector<Part>& parts, const Workshop& workshop);

}  // namespace relight
