#include <algorithm>
#include <chrono>
#include <cstdio>

#include "server/encode.h"
#include "server/gzip.h"
#include "server/json_tree.h"
#include "server/negotiate.h"
#include "server/output_json.h"
#include "server/posted.h"
#include "server/receipt.h"
#include "server/relight.h"
#include "server/reply.h"
#include "server/routes.h"
#include "server/scene_json.h"
#include "server/sha256.h"

namespace relight {
namespace {

/// What is to be made of a request: an answer in its format, or the reasons of some vertices.
enum class Purpose { Relight, Explain };

/// A request on its way to its answer.
struct Job {
    Posted posted;
    RelightRequest request;
    Purpose purpose = Purpose::Relight;
    Format format = Format::Json;
    std::unique_ptr<ByteBudget::Share> share;
    std::unique_ptr<Sessions::Turn> turn;
};

/// The stages of a progressive answer: a quarter of the samples of the next.
std::vector<unsigned> stages_of(const RelightRequest& request)
{
    constexpr unsigned fewest = 4;
    const unsigned all = request.scene.transport.samples;
    std::vector<unsigned> stages;
    for (unsigned samples = fewest; samples < all; samples *= 4) { stages.push_back(samples); }
    stages.push_back(all);
    return stages;
}

/// The answer from so many samples.
Result<Encoded> run(const Job& job, unsigned samples, ServerState& state)
{
    const Options& options = state.options;
    const Workshop workshop{
        state.meshes,         state.environments,
        state.profiles,       state.cache,
        options.threads,      {options.parse.vertices, options.parse.faces},
        options.parse.pixels, options.max_rays,
        options.memory,       [&pool = state.pool](auto work) { pool.submit(std::move(work)); }};
    RelightRequest request = job.request;
    const bool last = samples == request.scene.transport.samples;
    request.scene.transport.samples = samples;
    auto encoded = state.pool.run(
        [&](Progress& progress) {
            return job.purpose == Purpose::Explain
                       ? explain(std::move(request), job.posted.parts, workshop, progress)
                       : relight(std::move(request), job.format, job.posted.parts, workshop,
                                 progress, last);
        },
        job.turn->progress());
    if (!encoded && encoded.error().fault == Fault::Cancelled && job.turn->superseded()) {
        return make_error(Fault::Superseded,
                          "a newer request with the same Relight-Session took this one's place");
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

void set_headers(const Encoded& encoded, httplib::Response& response)
{
    response.set_header("Server-Timing", server_timing(encoded.timings));
    response.set_header("Relight-Rays", std::to_string(encoded.rays));
    std::string warnings;
    for (const std::string& warning : encoded.warnings) {
        warnings.append(warnings.empty() ? "" : "; ").append(warning);
    }
    if (!warnings.empty()) { response.set_header("Relight-Warnings", warnings); }
}

/// Writes an answer into the library's sink; false: the client is gone, or the log says what
/// happened.
bool write(const Encoding& body, httplib::DataSink& sink, Log& log) noexcept
{
    std::uint64_t sent = 0;  // another thread may call the sink
    bool whole = false;
    try {
        whole = body.write([&](std::string_view bytes) {
            const bool taken = sink.write(bytes.data(), bytes.size());
            if (taken) { sent += bytes.size(); }
            return taken;
        });
    } catch (const std::exception& error) {  // outside the library's own try
        log.message(error.what());
    } catch (...) {
        log.message("an answer failed while it was sent");
    }
    bytes_sent += sent;
    return whole;
}

/// One answer, while it is encoded. Text whose length nobody knows yet goes in chunks, which
/// HTTP/1.0 has not.
void send(Encoded&& encoded, const httplib::Request& request, httplib::Response& response, Log& log)
{
    const bool json = encoded.media_type == "application/json";
    const bool in_chunks = encoded.body.bytes == 0 && request.version == "HTTP/1.1";
    if (json && !in_chunks) {  // answer() compresses it
        response.body = whole(encoded.body);
        response.set_header("Content-Type", encoded.media_type);
        return;
    }
    if (in_chunks) {
        if (json && accepts_gzip(request.get_header_value(accept_encoding_field))) {
            encoded.body = gzipped(std::move(encoded.body));
            response.set_header("Content-Encoding", "gzip");
        }
        response.set_chunked_content_provider(
            encoded.media_type,
            [body = std::move(encoded.body), &log](std::size_t, httplib::DataSink& sink) {
                const bool sent = write(body, sink, log);
                if (sent) { sink.done(); }
                return sent;
            });
        return;
    }
    if (encoded.body.bytes == 0) { encoded.body = sent_whole(whole(encoded.body)); }
    response.set_content_provider(
        encoded.body.bytes, encoded.media_type,
        [body = std::move(encoded.body), &log](std::size_t, std::size_t, httplib::DataSink& sink) {
            return write(body, sink, log);
        });
}

/// Message after message, each from more samples; the next is computed when the one before has been
/// sent. Ends early, without a final one, where the request is superseded or the server stops.
void send_progressively(std::shared_ptr<const Job> job, std::vector<unsigned> stages,
                        Encoded&& first, httplib::Response& response, ServerState& state)
{
    struct Stream {
        std::shared_ptr<const Job> job;
        std::vector<unsigned> stages;
        std::size_t stage = 0;
        Encoding message;
    };
    const auto stream = std::make_shared<Stream>(
        Stream{std::move(job), std::move(stages), 0, std::move(first.body)});
    response.set_chunked_content_provider(
        first.media_type, [stream, &state](std::size_t, httplib::DataSink& sink) {
            try {
                if (!write(stream->message, sink, state.log)) { return false; }
                if (++stream->stage < stream->stages.size() && !state.stopping) {
                    auto next = run(*stream->job, stream->stages[stream->stage], state);
                    if (next) {
                        stream->message = std::move(next->body);
                        return true;
                    }
                }
                sink.done();
                return true;
            } catch (...) {  // outside the library's own try
                return false;
            }
        });
}

/// What the query and headers say beside the body.
std::optional<Error> read_query(const httplib::Request& request, RelightRequest& asked)
{
    const auto flag = [&](const char* name) {
        return request.has_param(name) && request.get_param_value(name) != "0";
    };
    asked.receipt = asked.receipt || flag("receipt");
    if (request.has_param("fields")) {
        if (auto error = parse_fields_query(request.get_param_value("fields"), asked.output)) {
            return error;
        }
    }
    asked.output.progressive = flag("progressive");
    if (asked.output.progressive && (!request.has_param("fields") || asked.receipt)) {
        return make_error(Fault::ConflictingFields,
                          "?progressive=1 sends raw fields, message after message: say which by "
                          "?fields=, and ask for no receipt");
    }
    return {};
}

/// The session a request belongs to; empty: none.
Result<std::string> session_of(const httplib::Request& request)
{
    constexpr std::size_t longest = 64;
    if (!request.has_header("Relight-Session")) { return std::string(); }
    const std::string name = request.get_header_value("Relight-Session");
    const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_';
    });
    if (name.empty() || name.size() > longest || !plain) {
        return make_error(Fault::BadRequest,
                          "Relight-Session is 1 to 64 letters, digits, '-' or '_', such as a UUID");
    }
    return request.remote_addr + ' ' + name;
}

/// Everything that the request names by id is still stored.
bool all_stored(const RelightRequest& request, const ServerState& state)
{
    const auto* mesh = std::get_if<StoredMesh>(&request.mesh);
    if (mesh != nullptr && !state.meshes.find(mesh->id)) { return false; }
    return std::all_of(request.light_files.begin(), request.light_files.end(),
                       [&](const LightFile& file) {
                           const auto* stored = std::get_if<StoredMesh>(&file.source);
                           return stored == nullptr || state.environments.find(stored->id) ||
                                  state.profiles.find(stored->id);
                       });
}

Result<RelightRequest> parse(const Posted& posted, Purpose purpose, ServerState& state)
{
    constexpr std::size_t small_json = std::size_t{64} << 10U;  // parsed here: a slip costs no wait
    const auto read = [&] {
        return parse_request(posted.json, state.options.parse, posted.has_mesh_part,
                             purpose == Purpose::Explain);
    };
    if (posted.json.size() <= small_json) { return read(); }
    return state.pool.run([&](Progress& /*progress*/) { return read(); });
}

void relight_posted(const httplib::Request& request, httplib::Response& response,
                    const httplib::ContentReader& reader, Purpose purpose, ServerState& state)
{
    using Clock = std::chrono::steady_clock;
    if (state.stopping) {
        return reply(response, make_error(Fault::Stopping, "the server is stopping"));
    }
    const auto session = session_of(request);
    if (!session) { return reply(response, session.error()); }
    auto job = std::make_shared<Job>();
    job->share = std::make_unique<ByteBudget::Share>(state.arriving);
    auto received = receive(request, reader, state, *job->share);
    if (!received) { return reply(response, received.error()); }
    if (!*received) { return; }
    const auto start = Clock::now();
    const auto elapsed = [&] {
        return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    };
    job->turn = std::make_unique<Sessions::Turn>(state.sessions, *session);
    job->posted = std::move(**received);
    job->purpose = purpose;
    auto asked = parse(job->posted, purpose, state);
    if (!asked) { return reply(response, asked.error()); }
    job->request = std::move(*asked);
    if (auto error = read_query(request, job->request)) { return reply(response, *error); }
    const double parsing = elapsed();
    std::string digest;
    if (purpose == Purpose::Relight) {
        const auto& named = job->request.output.format;
        const auto format = named ? named : format_accepted(request.get_header_value("Accept"));
        if (!format) {
            return reply(
                response,
                make_error(
                    Fault::NotAcceptable,
                    "answers come as model/ply, model/gltf-binary, model/obj, model/off, "
                    "application/x-vtp, "
                    "application/vnd.las, application/json, application/x-npz, image/png, "
                    "image/jpeg, "
                    "image/x-exr or image/vnd.radiance; \"output\": {\"format\": …} goes before "
                    "Accept"));
        }
        job->format = *format;
        digest = request_digest(
            job->posted.json, job->posted.parts, *format,
            request.get_param_value("fields") + (job->request.receipt ? " receipt" : ""));
    }
    const bool progressive = job->request.output.progressive;
    const std::string tag = '"' + digest + '"';
    if (!digest.empty() && !progressive) {
        response.set_header("ETag", tag);
        if (names_tag(request.get_header_value("If-None-Match"), tag) &&
            all_stored(job->request, state)) {
            response.status = 304;
            return;
        }
    }
    const auto stages =
        progressive ? stages_of(job->request) : std::vector{job->request.scene.transport.samples};
    auto encoded = run(*job, stages.front(), state);
    if (!encoded) {
        response.headers.erase("ETag");
        return reply(response, encoded.error());
    }
    encoded->timings.parse += parsing;
    encoded->timings.total = elapsed();
    response.status = 200;
    set_headers(*encoded, response);
    if (progressive) {
        return send_progressively(std::move(job), stages, std::move(*encoded), response, state);
    }
    if (job->request.receipt && purpose == Purpose::Relight) {
        Receipt receipt = receipt_of(job->request, job->posted.parts, encoded->units, digest);
        if (job->format == Format::Json) {
            encoded->body = with_receipt(std::move(encoded->body), std::move(receipt));
        } else {
            response.set_header("Relight-Receipt", receipt.json(sha256(encoded->body)));
        }
    }
    send(std::move(*encoded), request, response, state.log);
}

}  // namespace

void add_relight_route(GuardedServer& server, ServerState& state)
{
    for (const auto& [path, purpose] :
         {std::pair{"/v1/relight", Purpose::Relight}, {"/v1/explain", Purpose::Explain}}) {
        server.Post(path, [&state, purpose = purpose](const httplib::Request& request,
                                                      httplib::Response& response,
                                                      const httplib::ContentReader& reader) {
            const auto post = [&] { relight_posted(request, response, reader, purpose, state); };
            if (purpose == Purpose::Relight) {
                answer(state, request, response, {"fields", "progressive", "receipt"}, post);
            } else {
                answer(state, request, response, {}, post);
            }
        });
    }
}

}  // namespace relight
