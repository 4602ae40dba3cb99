// The request's parser on any bytes, and what completes a request once its mesh is known: an answer
// or an error, never a crash.
#include "core/base/progress.h"
#include "server/multipart.h"
#include "server/problem.h"
#include "server/scene_json.h"

namespace {

/// What a request that brings no mesh is completed with.
relight::Mesh two_groups()
{
    relight::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}};
    mesh.faces.indices = {0, 1, 2, 0, 1, 3};
    mesh.colors.resize(mesh.positions.size());
    mesh.materials = {"a/b~", "2"};
    mesh.face_materials = {0, 1};
    return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace relight;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto request = parse_request(text, {}, true);
    if (!request) {
        problem_json(request.error());
    } else if (request->skies.empty()) {  // their tables would be all the fuzzer's time
        const Mesh* given = std::get_if<Mesh>(&request->mesh);
        const Mesh mesh = given == nullptr ? two_groups() : *given;
        Progress progress;
        static_cast<void>(complete(*request, {mesh, {}, {}}, mesh, prepare(mesh, 1, progress)));
    }
    MultipartParser parser("B", {});
    const std::size_t half = size / 2;
    if (parser.feed(text.substr(0, half))) { parser.feed(text.substr(half)); }
    static_cast<void>(std::move(parser).finish());
    return 0;
}
