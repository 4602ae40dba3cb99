#include "server/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "server/json_text.h"

namespace relight {
namespace {

/// The environment's name of a flag: --max-lights is RELIGHT_MAX_LIGHTS.
std::string environment_name(std::string flag)
{
    flag.erase(0, flag.find_first_not_of('-'));
    for (char& c : flag) { c = c == '-' ? '_' : static_cast<char>(std::toupper(c)); }
    return "RELIGHT_" + flag;
}

template <class T>
CLI::Option* add(CLI::App& app, const char* flag, T& value, const char* help)
{
    return app.add_option(flag, value, help)
        ->envname(environment_name(flag))
        ->capture_default_str();
}

template <class Duration>
CLI::Option* add_time(CLI::App& app, const char* flag, Duration& value, const char* help)
{
    return app
        .add_option_function<std::int64_t>(
            flag, [&value](std::int64_t ms) { value = Duration(ms); }, help)
        ->envname(environment_name(flag))
        ->check(CLI::Range(1, 86'400'000))
        ->default_str(std::to_string(value.count()));
}

bool is_loopback(const std::string& host)
{
    return host == "localhost" || host == "::1" || host.starts_with("127.");
}

}  // namespace

ParsedOptions parse_options(int argc, const char* const* argv)
{
    ParsedOptions parsed;
    Options& o = parsed.options;
    std::string log = "text";
    CLI::App app("relightd: lights meshes and point clouds over HTTP");
    add(app, "--host", o.host, "address to listen on; loopback only");
    add(app, "--port", o.port, "port; 0 takes a free one")->check(CLI::Range(0, 65535));
    add(app, "--store", o.store, "folder of uploaded meshes");
    add(app, "--threads", o.threads, "threads of one job; 0: one a core")
        ->check(CLI::Range(0, 1024));
    add(app, "--workers", o.workers, "jobs at once")->check(CLI::Range(1, 256));
    add(app, "--queue", o.queue, "jobs that may wait; more get 503")->check(CLI::Range(1, 100'000));
    add(app, "--memory", o.memory,
        "bytes of the cache of meshes, skies and columns, and of one job's working arrays");
    add(app, "--log", log, "log lines on standard error: text or json")
        ->check(CLI::IsMember({"text", "json"}));
    add(app, "--max-upload-bytes", o.max_upload_bytes, "bytes of one upload; more get 413");
    add(app, "--max-json-bytes", o.max_json_bytes, "bytes of a request's JSON; more get 413");
    add(app, "--max-inflight-bytes", o.max_inflight_bytes,
        "bytes of all bodies being received; more get 503");
    add(app, "--max-vertices", o.parse.vertices, "vertices of a mesh");
    add(app, "--max-faces", o.parse.faces, "faces of a mesh");
    add(app, "--max-lights", o.parse.lights, "lights of a request");
    add(app, "--max-pixels", o.parse.pixels, "pixels of an image")
        ->check(CLI::Range(1, 100'000'000));  // EnvironmentMap counts no more
    add(app, "--max-rays", o.max_rays, "rays one job may ask for");
    add(app, "--max-head-bytes", o.guard.head.bytes, "bytes of a request's head; more get 431");
    add(app, "--max-connections", o.guard.connections, "connections at once; more get 503");
    add(app, "--max-connections-per-address", o.guard.connections_per_address,
        "the same from one address");
    add(app, "--max-requests-per-connection", o.guard.requests_per_connection,
        "requests of one connection, which then closes");
    add_time(app, "--head-time-ms", o.guard.head_time, "time for a request's head");
    add_time(app, "--idle-time-ms", o.guard.idle_time, "time between requests of a connection");
    add_time(app, "--transfer-time-ms", o.guard.transfer_time,
             "time for a body to come or an answer to go");
    add_time(app, "--grace-ms", o.guard.grace, "pauses a slow client may make in all");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        parsed.exit_code = app.exit(error);
        return parsed;
    }
    if (!is_loopback(o.host)) {
        std::cerr << "relightd: --host " << printable(o.host)
                  << " is not loopback, and without authentication only loopback is served: use "
                     "127.0.0.1 behind a proxy that authenticates\n";
        parsed.exit_code = 2;
    }
    o.log_json = log == "json";
    o.guard.body_bytes = std::max(o.max_upload_bytes, o.max_json_bytes);
    return parsed;
}

std::string limits_json(const Options& o)
{
    const auto ms = [](std::chrono::milliseconds time) {
        return static_cast<std::uint64_t>(time.count());
    };
    return ObjectWriter()
        .count("threads", o.threads)
        .count("workers", o.workers)
        .count("queue", o.queue)
        .count("memory", o.memory)
        .count("max_upload_bytes", o.max_upload_bytes)
        .count("max_json_bytes", o.max_json_bytes)
        .count("max_inflight_bytes", o.max_inflight_bytes)
        .count("max_vertices", o.parse.vertices)
        .count("max_faces", o.parse.faces)
        .count("max_lights", o.parse.lights)
        .count("max_pixels", o.parse.pixels)
        .count("max_rays", o.max_rays)
        .count("max_head_bytes", o.guard.head.bytes)
        .count("max_connections", o.guard.connections)
        .count("max_connections_per_address", o.guard.connections_per_address)
        .count("max_requests_per_connection", o.guard.requests_per_connection)
        .count("head_time_ms", ms(o.guard.head_time))
        .count("idle_time_ms", ms(o.guard.idle_time))
        .count("transfer_time_ms", ms(o.guard.transfer_time))
        .count("grace_ms", ms(o.guard.grace))
        .done();
}

}  // namespace relight
