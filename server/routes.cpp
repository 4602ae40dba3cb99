#include "server/routes.h"

#include <array>
#include <chrono>

#include "core/trace/bvh.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/openapi.h"
#include "server/problem.h"
#include "server/reply.h"

namespace relight {
namespace {

using Clock = std::chrono::steady_clock;

/// One path of the API and what may be done there. "{id}" is 64 hex digits.
struct Path {
    std::string_view pattern, methods;
};
constexpr Path known_paths[] = {{"/", "GET, HEAD"},
                                {"/healthz", "GET, HEAD"},
                                {"/readyz", "GET, HEAD"},
                                {"/v1/openapi.json", "GET, HEAD"},
                                {"/v1/meshes", "GET, HEAD, POST"},
                                {"/v1/meshes/{id}", "GET, HEAD, DELETE"},
                                {"/v1/meshes/{id}/content", "GET, HEAD"},
                                {"/v1/environments", "GET, HEAD, POST"},
                                {"/v1/environments/{id}", "GET, HEAD, DELETE"},
                                {"/v1/environments/{id}/content", "GET, HEAD"},
                                {"/v1/profiles", "GET, HEAD, POST"},
                                {"/v1/profiles/{id}", "GET, HEAD, DELETE"},
                                {"/v1/profiles/{id}/content", "GET, HEAD"},
                                {"/v1/check", "GET, HEAD"},
                                {"/v1/explain", "POST"},
                                {"/v1/relight", "POST"}};

bool matches(std::string_view pattern, std::string_view path)
{
    const auto brace = pattern.find("{id}");
    if (brace == std::string_view::npos) { return pattern == path; }
    const std::string_view after = pattern.substr(brace + 4);
    return path.starts_with(pattern.substr(0, brace)) && path.ends_with(after) &&
           path.size() == brace + 64 + after.size() && is_object_id(path.substr(brace, 64));
}

bool allows(std::string_view methods, const std::string& method)
{
    const auto at = methods.find(method);
    return at != std::string_view::npos && (at == 0 || methods[at - 1] == ' ') &&
           (at + method.size() == methods.size() || methods[at + method.size()] == ',');
}

/// Answers what no handler should see: unknown paths, other methods, encoded bodies.
bool turned_away(const httplib::Request& request, httplib::Response& response)
{
    std::string_view methods;
    for (const Path& path : known_paths) {
        if (matches(path.pattern, request.path)) { methods = path.methods; }
    }
    if (methods.empty()) {
        const bool stored = request.path.starts_with("/v1/meshes/") ||
                            request.path.starts_with("/v1/environments/") ||
                            request.path.starts_with("/v1/profiles/");
        reply(response, make_error(Fault::NotFound,
                                   stored ? "nothing has this id; an id is 64 lower-case hex digits"
                                          : "there is nothing at this path; /v1/openapi.json lists "
                                            "what there is"));
        return true;
    }
    if (request.method == "OPTIONS") {
        response.status = 204;
        response.set_header("Allow", std::string(methods) + ", OPTIONS");
        return true;
    }
    if (!allows(methods, request.method)) {
        reply(response, make_error(Fault::MethodNotAllowed,
                                   printable(request.method, 16) +
                                       " is not for this path; allowed: " + std::string(methods)));
        response.set_header("Allow", std::string(methods) + ", OPTIONS");
        return true;
    }
    if (request.has_header("Content-Encoding")) {
        reply(response,
              make_error(Fault::UnsupportedEncoding,
                         "send the body as it is: a request with Content-Encoding is refused"));
        return true;
    }
    return false;
}

constexpr std::string_view front_page = R"(<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Relight</title>
<h1>Relight</h1>
<p>A mesh in, a lit mesh out. This is the API; it is described in <a href="/v1/openapi.json">/v1/openapi.json</a>.</p>
<ul>
<li>POST /v1/meshes stores a mesh or point cloud (PLY, OBJ, OFF, STL); <a href="/v1/meshes">GET /v1/meshes</a> lists them</li>
<li>POST /v1/environments and /v1/profiles store skies (HDR, EXR) and lamps (IES)</li>
<li>POST /v1/relight lights one: PLY, JSON, NPZ, PNG or EXR comes back; POST /v1/explain says why a vertex is as bright as it is</li>
<li><a href="/v1/check">GET /v1/check</a> proves the formulas</li>
<li><a href="/healthz">/healthz</a> and <a href="/readyz">/readyz</a> say how the server is</li>
</ul>
</html>
)";

std::string ready_json(const ServerState& state)
{
    return ObjectWriter()
        .text("status", "ready")
        .raw("versions", ObjectWriter()
                             .text("relight", RELIGHT_VERSION)
                             .text("api", "1")
                             .text("rays", Bvh::kernel())
                             .done())
        .raw("limits", limits_json(state.options))
        .count("cache_bytes", state.cache.bytes())
        .done();
}

thread_local Clock::time_point request_start;  // a connection has one thread

void add_logging(GuardedServer& server, ServerState& state)
{
    server.set_pre_routing_handler(
        [](const httplib::Request& request, httplib::Response& response) {
            request_start = Clock::now();
            bytes_sent = 0;
            return turned_away(request, response) ? httplib::Server::HandlerResponse::Handled
                                                  : httplib::Server::HandlerResponse::Unhandled;
        });
    server.set_logger([&state](const httplib::Request& request, const httplib::Response& response) {
        const std::chrono::duration<double, std::milli> took = Clock::now() - request_start;
        state.log.access({request.remote_addr, request.method, request.path, response.status,
                          response.body.empty() ? bytes_sent : response.body.size(),
                          std::round(took.count() * 100.0) / 100.0});
    });
}

}  // namespace

void add_routes(GuardedServer& server, ServerState& state)
{
    add_logging(server, state);
    server.set_default_headers({{"X-Content-Type-Options", "nosniff"}});
    const auto get = [&](const char* path, auto respond) {
        server.Get(path,
                   [&state, respond](const httplib::Request& request, httplib::Response& response) {
                       answer(state, request, response, {}, [&] { respond(response); });
                   });
    };
    get("/", [](httplib::Response& response) {
        response.body = front_page;
        response.set_header("Content-Type", "text/html; charset=utf-8");
        response.set_header("Content-Security-Policy", "default-src 'none'");
    });
    get("/healthz",
        [](httplib::Response& response) { reply_json(response, 200, R"({"status":"ok"})"); });
    get("/readyz", [&state](httplib::Response& response) {
        if (state.stopping) {
            reply(response, make_error(Fault::Stopping, "the server finishes what runs and stops"));
        } else {
            reply_json(response, 200, ready_json(state));
        }
    });
    get("/v1/openapi.json", [](httplib::Response& response) {
        reply_json(response, 200, std::string(openapi_json()));
    });
    add_stored_routes(server, state);
    add_relight_route(server, state);
    add_check_route(server, state);
}

}  // namespace relight
