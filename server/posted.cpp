#include "server/posted.h"

#include <utility>

#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"
#include "server/reply.h"

namespace relight {

Result<std::optional<Posted>> receive(const httplib::Request& request,
                                      const httplib::ContentReader& reader, ServerState& state,
                                      ByteBudget::Share& share)
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
        if (broken) { return std::optional<Posted>(); }
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
        return std::optional(std::move(posted));
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
    if (broken) { return std::optional<Posted>(); }
    if (error) { return std::move(*error); }
    return std::optional(std::move(posted));
}

}  // namespace relight
