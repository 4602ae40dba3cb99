#include <chrono>
#include <cstdio>

#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/multipart.h"
#include "server/negotiate.h"
#include "server/relight.h"
#include "server/reply.h"
#include "server/routes.h"
#include "server/scene_json.h"

namespace relight {
namespace {

/// A request as it came: its JSON, and the files beside it.
struct Posted {
    std::string json;
    std::vector<Part> parts;
    bool has_mesh_part = false;
};

/// What came of the body.
struct Received {
    std::optional<Posted> posted;  ///< nothing: the connection failed, the guard answers
};

Result<Received> receive(const httplib::Request& request, const httplib::ContentReader& reader,
                         ServerState& state, ByteBudget::Share& share)
{
    const std::string content_type = request.get_header_value("Content-Type");
    const std::string type = essence(content_type);
    const Options& options = state.options;
    bool broken = false;
    Posted posted;
    if (type == "multipart/form-data") {
        const auto boundary = multipart_boundary(content_type);
        if (!boundary) {
            return make_error(
                Fault::BadRequest,
                "multipart/form-data needs a boundary of 1 to 70 characters (RFC 2046)");
        }
        MultipartLimits limits;
        limits.request_bytes = options.max_json_bytes;
        MultipartParser parser(*boundary, limits);
        auto error = read_body(reader, state, share, options.max_upload_bytes, "--max-upload-bytes",
                               broken, [&](std::string_view piece) -> std::optional<Error> {
                                   if (parser.feed(piece)) { return {}; }
                                   return std::move(parser).finish().error();
                               });
        if (broken) { return Received{}; }
        if (error) { return std::move(*error); }
        auto parts = std::move(parser).finish();
        if (!parts) { return std::move(parts).error(); }
        posted.json = "{}";  // a mesh alone is lit as the defaults say
        for (Part& part : *parts) {
            if (part.name == "request") {
                posted.json = std::move(part.data);
                continue;
            }
            posted.has_mesh_part = posted.has_mesh_part || part.name == "mesh";
            posted.parts.push_back(std::move(part));
        }
        return Received{std::move(posted)};
    }
    if (type != "application/json" && !type.empty()) {
        return make_error(
            Fault::UnsupportedMediaType,
            "found \"" + printable(type) +
                "\"; a relight request is application/json, or multipart/form-data with "
                "its JSON in the part \"request\"");
    }
    auto error = read_body(reader, state, share, options.max_json_bytes, "--max-json-bytes", broken,
                           [&](std::string_view piece) {
                               posted.json += piece;
                               return std::optional<Error>();
                           });
    if (broken) { return Received{}; }
    if (error) { return std::move(*error); }
    return Received{std::move(posted)};
}

/// What is to be made of a request: an answer in its format, or the reasons of some vertices.
enum class Purpose { Relight, Explain };

Result<Encoded> run(const Posted& posted, Purpose purpose, const std::string& accept,
                    ServerState& state)
{
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const Options& options = state.options;
    double parsing = 0.0;
    const auto parse = [&] {
        auto request = parse_request(posted.json, options.parse, posted.has_mesh_part,
                                     purpose == Purpose::Explain);
        parsing = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        return request;
    };
    const Workshop workshop{state.meshes,
                            state.environments,
                            state.profiles,
                            state.models,
                            state.skies,
                            options.threads,
                            {options.parse.vertices, options.parse.faces},
                            options.parse.pixels,
                            options.max_rays,
                            options.memory};
    const auto light = [&](RelightRequest&& request, Progress& progress) -> Result<Encoded> {
        if (purpose == Purpose::Explain) {
            return explain(std::move(request), posted.parts, workshop, progress);
        }
        const auto format = request.output.format ? request.output.format : format_accepted(accept);
        if (!format) {
            return make_error(
                Fault::NotAcceptable,
                "answers come as model/ply, model/gltf-binary, model/obj, model/off, "
                "application/x-vtp, "
                "application/vnd.las, application/json, application/x-npz, image/png, image/jpeg, "
                "image/x-exr or image/vnd.radiance; \"output\": {\"format\": …} goes before "
                "Accept");
        }
        return relight(std::move(request), *format, posted.parts, workshop, progress);
    };
    constexpr std::size_t small_json = std::size_t{64}
                                       << 10U;  // parsed here, so that slips cost no wait
    Result<Encoded> encoded = make_error(Fault::Internal, {});
    if (posted.json.size() <= small_json) {
        auto request = parse();
        if (!request) { return request.error(); }
        encoded = state.pool.run(
            [&](Progress& progress) { return light(std::move(*request), progress); });
    } else {
        encoded = state.pool.run([&](Progress& progress) {
            return parse().and_then(
                [&](RelightRequest&& r) { return light(std::move(r), progress); });
        });
    }
    if (encoded) {
        encoded->timings.parse += parsing;
        encoded->timings.total =
            std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    }
    return encoded;
}

std::string server_timing(const Timings& timings)
{
    std::string header;
    for (const auto& [name, ms] : {std::pair{"parse", timings.parse},
                                   {"bvh", timings.bvh},
                                   {"trace", timings.trace},
                                   {"shade", timings.shade},
                                   {"encode", timings.encode},
                                   {"total", timings.total}}) {
        char text[64];
        std::snprintf(text, sizeof text, "%s%s;dur=%.3f", header.empty() ? "" : ", ", name, ms);
        header += text;
    }
    return header;
}

void relight_posted(const httplib::Request& request, httplib::Response& response,
                    const httplib::ContentReader& reader, Purpose purpose, ServerState& state)
{
    if (state.stopping) {
        return reply(response, make_error(Fault::Stopping, "the server is stopping"));
    }
    if (request.has_param("receipt") && request.get_param_value("receipt") != "0") {
        return reply(response, make_error(Fault::NotAvailable,
                                          "receipts are not in this build; leave ?receipt out"));
    }
    ByteBudget::Share share(state.arriving);
    const auto received = receive(request, reader, state, share);
    if (!received) { return reply(response, received.error()); }
    if (!received->posted) { return; }
    auto encoded = run(*received->posted, purpose, request.get_header_value("Accept"), state);
    if (!encoded) { return reply(response, encoded.error()); }
    response.status = 200;
    response.body = std::move(encoded->bytes);
    response.set_header("Content-Type", encoded->media_type);
    response.set_header("Server-Timing", server_timing(encoded->timings));
    response.set_header("Relight-Rays", std::to_string(encoded->rays));
    std::string warnings;
    for (const std::string& warning : encoded->warnings) {
        warnings.append(warnings.empty() ? "" : "; ").append(warning);
    }
    if (!warnings.empty()) { response.set_header("Relight-Warnings", warnings); }
}

}  // namespace

void add_relight_route(GuardedServer& server, ServerState& state)
{
    for (const auto& [path, purpose] :
         {std::pair{"/v1/relight", Purpose::Relight}, {"/v1/explain", Purpose::Explain}}) {
        server.Post(path, [&state, purpose = purpose](const httplib::Request& request,
                                                      httplib::Response& response,
                                                      const httplib::ContentReader& reader) {
            answer(state, request, response, {"receipt"},
                   [&] { relight_posted(request, response, reader, purpose, state); });
        });
    }
}

}  // namespace relight
