#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>
#include <memory>

#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/light_file.h"
#include "server/mesh_file.h"
#include "server/relight.h"
#include "server/reply.h"
#include "server/routes.h"

namespace relight {
namespace {

constexpr std::uint64_t default_page = 100, largest_page = 1000;

/// What examining a file that arrived came to. Refused files are errors before.
struct Examined {
    std::string format, description;
};

/// A kind of file that clients store: where it is kept, and how it is read when it arrives.
struct Kind {
    std::string path;  ///< "/v1/meshes"
    std::string noun;  ///< "mesh"
    std::string list;  ///< name of the array in a listing
    Store& store;
    std::function<Result<Examined>(const Store::Incoming& incoming, const std::string& id,
                                   std::optional<std::string_view> named,
                                   std::string_view content_type, Progress& progress)>
        examine;
};

Error no_such(const Kind& kind)
{
    return make_error(Fault::NotFound, "no " + kind.noun + " is stored under this id; POST " +
                                           kind.path + " stores one");
}

Error stopped()
{
    return make_error(Fault::Cancelled, "the server is stopping; send it again later");
}

void reply_description(const Kind& kind, httplib::Response& response, int status,
                       const StoredObject& object)
{
    reply_json(response, status, object.description);
    response.set_header("Location", kind.path + "/" + object.id);
}

Result<Examined> examine_mesh(const Store::Incoming& incoming, const std::string& id,
                              std::optional<std::string_view> named, std::string_view content_type,
                              const ServerState& state, Progress& progress)
{
    const ReadLimits limits{state.options.parse.vertices, state.options.parse.faces};
    const auto asset = read_mesh_file(incoming.read_all(), named, content_type, limits,
                                      state.options.parse.pixels, progress);
    if (!asset) { return asset.error(); }
    const Mesh& mesh = asset->mesh;
    const Surface surface = prepare(mesh, state.options.threads, progress, {false, mesh.viewpoint});
    if (progress.stopped()) { return stopped(); }
    const Intake intake = inspect(mesh, surface, progress);
    if (progress.stopped()) { return stopped(); }
    return Examined{mesh.format, describe(id, incoming.size(), *asset, surface, intake)};
}

void upload(const Kind& kind, const httplib::Request& request, httplib::Response& response,
            const httplib::ContentReader& reader, ServerState& state)
{
    if (state.stopping) {
        return reply(response, make_error(Fault::Stopping, "the server is stopping"));
    }
    Store::Incoming incoming = kind.store.begin();
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
    if (const auto held = kind.store.find(id)) {
        return reply_description(kind, response, 200, *held);
    }
    const std::string format = request.get_param_value("format");
    const std::string content_type = request.get_header_value("Content-Type");
    const auto examined = state.pool.run([&](Progress& progress) {
        const auto named =
            request.has_param("format") ? std::optional<std::string_view>(format) : std::nullopt;
        return kind.examine(incoming, id, named, content_type, progress);
    });
    if (!examined) { return reply(response, examined.error()); }
    reply_description(
        kind, response, 201,
        kind.store.keep(std::move(incoming), id, examined->format, examined->description));
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

void list(const Kind& kind, const httplib::Request& request, httplib::Response& response)
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
    const auto page = kind.store.list(limit + 1, before);
    std::string items = "[";
    for (std::size_t i = 0; i < std::min<std::size_t>(page.size(), limit); ++i) {
        items += (i == 0 ? "" : ",") + page[i].description;
    }
    const bool more = page.size() > limit;
    reply_json(response, 200,
               ObjectWriter()
                   .raw(kind.list, items + "]")
                   .raw("next_cursor", more ? json_string(std::to_string(page[limit - 1].sequence))
                                            : std::string("null"))
                   .done());
}

void send_content(const Kind& kind, const std::string& id, httplib::Response& response)
{
    const auto object = kind.store.find(id);
    auto file = std::make_shared<const File>(kind.store.open(id));
    if (!object || !*file) { return reply(response, no_such(kind)); }
    const auto send = [file](std::size_t offset, std::size_t length,
                             httplib::DataSink& sink) noexcept {
        constexpr std::size_t piece_bytes = std::size_t{256} << 10U;
        try {
            std::vector<std::byte> piece(std::min(length, piece_bytes));
            const std::size_t read = file->read_at(offset, piece);
            if (read == 0 || !sink.write(reinterpret_cast<const char*>(piece.data()), read)) {
                return false;
            }
            bytes_sent += read;
            return true;
        } catch (...) {  // outside the library's own try
            return false;
        }
    };
    response.set_content_provider(static_cast<std::size_t>(object->bytes),
                                  std::string(media_type_of(object->format)), send);
}

void add_kind(GuardedServer& server, ServerState& state, const std::shared_ptr<const Kind>& kind)
{
    using httplib::Request;
    using httplib::Response;
    const std::string one = kind->path + "/([0-9a-f]{64})";
    server.Post(kind->path, [&state, kind](const Request& request, Response& response,
                                           const httplib::ContentReader& reader) {
        answer(state, request, response, {"format"},
               [&] { upload(*kind, request, response, reader, state); });
    });
    server.Get(kind->path, [&state, kind](const Request& request, Response& response) {
        answer(state, request, response, {"limit", "cursor"},
               [&] { list(*kind, request, response); });
    });
    server.Get(one, [&state, kind](const Request& request, Response& response) {
        answer(state, request, response, {}, [&] {
            const auto object = kind->store.find(request.matches[1].str());
            object ? reply_json(response, 200, object->description)
                   : reply(response, no_such(*kind));
        });
    });
    server.Get(one + "/content", [&state, kind](const Request& request, Response& response) {
        answer(state, request, response, {},
               [&] { send_content(*kind, request.matches[1].str(), response); });
    });
    server.Delete(one, [&state, kind](const Request& request, Response& response,
                                      const httplib::ContentReader& /*reader*/) {
        answer(state, request, response, {}, [&] {
            const std::string id = request.matches[1].str();
            if (!kind->store.erase(id)) { return reply(response, no_such(*kind)); }
            state.cache.forget(id);
            response.status = 204;
        });
    });
}

}  // namespace

void add_stored_routes(GuardedServer& server, ServerState& state)
{
    using Named = std::optional<std::string_view>;
    const auto meshes = [&state](const Store::Incoming& incoming, const std::string& id,
                                 Named named, std::string_view type, Progress& progress) {
        return examine_mesh(incoming, id, named, type, state, progress);
    };
    const auto environments = [&state](const Store::Incoming& incoming, const std::string& id,
                                       Named named, std::string_view type, Progress& progress) {
        return read_environment(incoming.read_all(), named, type, state.options.parse.pixels,
                                progress)
            .transform([&](const EnvironmentFile& file) {
                return Examined{file.format, describe(id, incoming.size(), file)};
            });
    };
    const auto profiles = [](const Store::Incoming& incoming, const std::string& id, Named named,
                             std::string_view /*type*/, Progress& progress) {
        return read_profile(incoming.read_all(), named, progress)
            .transform([&](const IesProfile& profile) {
                return Examined{"ies", describe(id, incoming.size(), profile)};
            });
    };
    const auto keep = [&](Kind kind) {
        add_kind(server, state, std::make_shared<const Kind>(std::move(kind)));
    };
    keep({"/v1/meshes", "mesh", "meshes", state.meshes, meshes});
    keep({"/v1/environments", "environment", "environments", state.environments, environments});
    keep({"/v1/profiles", "profile", "profiles", state.profiles, profiles});
}

}  // namespace relight
