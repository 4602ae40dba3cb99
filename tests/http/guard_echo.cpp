// The guarded connection with as little behind it as the hostile tests need.
#include <signal.h>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>

#include "server/guard.h"

namespace {

using namespace std::chrono_literals;

std::string problem(int status, relight::Fault fault, const std::string& detail)
{
    const std::string code(relight::fault_code(fault));
    std::string escaped;
    for (const char c : detail) {
        if (c == '"') { escaped += '\\'; }
        escaped += c;
    }
    return R"({"type":"/problems/)" + code + R"(","title":")" + code + R"(","status":)" +
           std::to_string(status) + R"(,"detail":")" + escaped + R"(","code":")" + code + "\"}";
}

/// Counts a body without keeping it: {"bytes":5,"crc32":907060870}.
void echo(const httplib::Request&, httplib::Response& response,
          const httplib::ContentReader& content_reader)
{
    std::size_t bytes = 0;
    uLong crc = crc32(0, nullptr, 0);
    const bool whole = content_reader([&](const char* data, std::size_t size) {
        bytes += size;
        crc = crc32_z(crc, reinterpret_cast<const Bytef*>(data), size);
        return true;
    });
    if (!whole) { return; }
    response.set_content(
        "{\"bytes\":" + std::to_string(bytes) + ",\"crc32\":" + std::to_string(crc) + "}",
        "application/json");
}

/// "--key value" pairs.
std::map<std::string, std::string> flags(int argc, char** argv)
{
    std::map<std::string, std::string> found;
    for (int i = 1; i + 1 < argc; i += 2) { found[argv[i]] = argv[i + 1]; }
    return found;
}

void routes(relight::GuardedServer& http)
{
    http.Get("/healthz", [](const auto&, httplib::Response& response) {
        response.set_content("{\"status\":\"ok\"}", "application/json");
    });
    http.Get("/big", [](const auto&, httplib::Response& response) {
        response.set_content_provider(10'000'000, "application/octet-stream",
                                      [](std::size_t, std::size_t left, httplib::DataSink& sink) {
                                          static const std::string piece(std::size_t{1} << 20, 'x');
                                          return sink.write(piece.data(),
                                                            std::min(left, piece.size()));
                                      });
    });
    http.Get("/stream", [](const auto&, httplib::Response& response) {
        response.set_chunked_content_provider("text/plain",
                                              [](std::size_t, httplib::DataSink& sink) {
                                                  sink.write("part", 4);
                                                  sink.done();
                                                  return true;
                                              });
    });
    http.Get("/throw", [](const auto&, auto&) { throw std::runtime_error("secret"); });
    http.Get("/throw-late", [](const auto&, httplib::Response& response) {
        response.set_content_provider(
            100, "text/plain",
            [](std::size_t, std::size_t, httplib::DataSink&) -> bool { throw 1; });
    });
    http.Get("/slow", [](const auto&, httplib::Response& response) {
        std::this_thread::sleep_for(1s);
        response.set_content("slow", "text/plain");
    });
    http.Get("/headers", [](const httplib::Request& request, httplib::Response& response) {
        std::string text;
        for (const auto& [name, value] : request.headers) {
            text.append(name).append("=").append(value).append("\n");
        }
        response.set_content(text + request.target, "text/plain");
    });
    http.Post("/echo", echo);
    http.Post("/v1/meshes", echo);
    http.Post("/unread", [](const auto&, httplib::Response& response, const auto&) {
        response.set_content("unread", "text/plain");
    });
}

}  // namespace

int main(int argc, char** argv)
{
    sigset_t stop;
    sigemptyset(&stop);
    sigaddset(&stop, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &stop, nullptr);

    auto given = flags(argc, argv);
    relight::GuardLimits limits;
    const auto number = [&](const char* flag, auto& limit) {
        if (given.count(flag) != 0) {
            limit = std::remove_reference_t<decltype(limit)>(std::stol(given[flag]));
        }
    };
    number("--head-time-ms", limits.head_time);
    number("--idle-time-ms", limits.idle_time);
    number("--grace-ms", limits.grace);
    number("--max-upload-bytes", limits.body_bytes);
    number("--max-connections", limits.connections);

    relight::GuardedServer http(limits, problem);
    routes(http);
    const int port = http.bind("127.0.0.1", std::stoi(given["--port"]));
    if (port < 0) { return 1; }
    std::cout << "relightd listening on http://127.0.0.1:" << port << std::endl;
    std::thread stopper([&] {
        int signal = 0;
        sigwait(&stop, &signal);
        http.drain(30s);
    });
    const bool served = http.run();
    stopper.join();
    return served ? 0 : 1;
}
