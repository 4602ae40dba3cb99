#include <algorithm>
#include <charconv>
#include <limits>
#include <memory>

#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/mesh_file.h"
#include "server/relight.h"
#include "server/reply.h"
#include "server/routes.h"

namespace relight {
namespace {

constexpr std::uint64_t default_page = 100, largest_page = 1000;

Error no_such_mesh()
{
    return make_error(Fault::NotFound,
                      "no mesh is stored under this id; POST /v1/meshes stores one");
}

void reply_description(httplib::Response& response, int status, const StoredObject& object)
{
    reply_json(response, status, object.description);
    response.set_header("Location", "/v1/meshes/" + object.id);
}

/// The description of a file that arrived, from reading it whole. Refused files are errors here.
struct Examined {
    std::string format, description;
};
Result<Examined> examine(const Store::Incoming& incoming, const std::string& id,
                         std::optional<std::string_view> named, std::string_view content_type,
                         const ServerState& state, Progress& progress)
{
    const ReadLimits limits{state.options.parse.vertices, state.options.parse.faces};
    const auto mesh = parse_mesh(incoming.read_all(), named, content_type, limits, progress);
    if (!mesh) { return mesh.error(); }
    const Surface surface = prepare(*mesh, state.options.threads, progress);
    if (progress.stopped()) {
        return make_error(Fault::Cancelled, "the server is stopping; send it again later");
    }
    return Examined{mesh->format,
                    describe(id, incoming.size(), *mesh, surface, inspect(*mesh, surface))};
}

void upload(const httplib::Request& request, httplib::Response& response,
            const httplib::ContentReader& reader, ServerState& state)
{
    if (state.stopping) {
        return reply(response, make_error(Fault::Stopping, "the server is stopping"));
    }
    Store::Incoming incoming = state.store.begin();
    ByteBudget::Share share(state.arriving);
    bool broken = false;
    const auto error = read_body(reader, state, share, state.options.max_upload_bytes,
                                 "--max-upload-bytes", broken, [&](std::string_view piece) {
                                     incoming.add(piece);
                                     return std::optional<Error>();
                                 });
    if (broken) { return; }
    if (error) { return reply(response, *error); }
    const std::string id = incoming.finish();
    if (const auto held = state.store.find(id)) { return reply_description(response, 200, *held); }
    const std::string named = request.get_param_value("format");
    const auto examined = state.pool.run([&](Progress& progress) {
        return examine(
            incoming, id,
            request.has_param("format") ? std::optional<std::string_view>(named) : std::nullopt,
            request.get_header_value("Content-Type"), state, progress);
    });
    if (!examined) { return reply(response, examined.error()); }
    reply_description(
        response, 201,
        state.store.keep(std::move(incoming), id, examined->format, examined->description));
}

/// A whole number of the query; nothing if it is another or out of range.
std::optional<std::uint64_t> query_number(const std::string& text, std::uint64_t low,
                                          std::uint64_t high)
{
    std::uint64_t number = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    if (read.ec != std::errc() || read.ptr != end || number < low || number > high) { return {}; }
    return number;
}

void list(const httplib::Request& request, httplib::Response& response, ServerState& state)
{
    std::uint64_t limit = default_page;
    std::uint64_t before = std::numeric_limits<std::uint64_t>::max();
    if (request.has_param("limit")) {
        const auto given = query_number(request.get_param_value("limit"), 1, largest_page);
        if (!given) {
            return reply(response,
                         make_error(Fault::OutOfRange, "limit is a whole number, 1..1000"));
        }
        limit = *given;
    }
    if (request.has_param("cursor")) {
        const auto given = query_number(request.get_param_value("cursor"), 0, before);
        if (!given) {
            return reply(response, make_error(Fault::UnknownValue,
                                              "cursor is the next_cursor of an earlier answer"));
        }
        before = *given;
    }
    const auto page = state.store.list(limit + 1, before);
    std::string meshes = "[";
    for (std::size_t i = 0; i < std::min<std::size_t>(page.size(), limit); ++i) {
        meshes += (i == 0 ? "" : ",") + page[i].description;
    }
    const bool more = page.size() > limit;
    reply_json(response, 200,
               ObjectWriter()
                   .raw("meshes", meshes + "]")
                   .raw("next_cursor", more ? json_string(std::to_string(page[limit - 1].sequence))
                                            : std::string("null"))
                   .done());
}

void send_content(const std::string& id, httplib::Response& response, ServerState& state)
{
    const auto object = state.store.find(id);
    auto file = std::make_shared<const File>(state.store.open(id));
    if (!object || !*file) { return reply(response, no_such_mesh()); }
    const auto send = [file](std::size_t offset, std::size_t length,
                             httplib::DataSink& sink) noexcept {
        constexpr std::size_t piece_bytes = std::size_t{256} << 10U;
        try {
            std::vector<std::byte> piece(std::min(length, piece_bytes));
            const std::size_t read = file->read_at(offset, piece);
            return read > 0 && sink.write(reinterpret_cast<const char*>(piece.data()), read);
        } catch (...) {  // outside the library's own try
            return false;
        }
    };
    response.set_content_provider(static_cast<std::size_t>(object->bytes),
                                  std::string(media_type_of(object->format)), send);
}

}  // namespace

void add_mesh_routes(GuardedServer& server, ServerState& state)
{
    using httplib::Request;
    using httplib::Response;
    const std::string one = "/v1/meshes/([0-9a-f]{64})";
    server.Post("/v1/meshes", [&state](const Request& request, Response& response,
                                       const httplib::ContentReader& reader) {
        answer(state, request, response, {"format"},
               [&] { upload(request, response, reader, state); });
    });
    server.Get("/v1/meshes", [&state](const Request& request, Response& response) {
        answer(state, request, response, {"limit", "cursor"},
               [&] { list(request, response, state); });
    });
    server.Get(one, [&state](const Request& request, Response& response) {
        answer(state, request, response, {}, [&] {
            const auto object = state.store.find(request.matches[1].str());
            object ? reply_json(response, 200, object->description)
                   : reply(response, no_such_mesh());
        });
    });
    server.Get(one + "/content", [&state](const Request& request, Response& response) {
        answer(state, request, response, {},
               [&] { send_content(request.matches[1].str(), response, state); });
    });
    server.Delete(one, [&state](const Request& request, Response& response,
                                const httplib::ContentReader& /*reader*/) {
        answer(state, request, response, {}, [&] {
            const std::string id = request.matches[1].str();
            if (!state.store.erase(id)) { return reply(response, no_such_mesh()); }
            state.cache.forget(id);
            response.status = 204;
        });
    });
}

}  // namespace relight
