#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <system_error>
#include <thread>

#include "server/options.h"
#include "server/problem.h"
#include "server/routes.h"

namespace relight {
namespace {

constexpr std::chrono::seconds stop_patience{30};  // for what runs when we are asked to stop

/// The flags behind a refusal of the connection's own, which knows numbers only.
std::string_view limits_behind(Fault fault)
{
    switch (fault) {
        case Fault::BodyTooLarge:
            return " (limit --max-upload-bytes)";
        case Fault::HeadTooLarge:
            return " (limit --max-head-bytes)";
        case Fault::RequestTimeout:
            return " (limits --head-time-ms, --grace-ms, --transfer-time-ms)";
        case Fault::Overloaded:
            return " (limits --max-connections, --max-connections-per-address)";
        default:
            return "";
    }
}

/// Waits for SIGTERM or SIGINT, then stops gracefully: no new work, what runs may finish.
void stop_on_signal(sigset_t signals, GuardedServer& server, ServerState& state)
{
    int signal = 0;
    while (sigwait(&signals, &signal) != 0) {}
    state.log.message("stopping: finishing what runs");
    state.stopping = true;
    if (!server.drain(stop_patience)) { state.pool.stop_all(); }
}

int serve(const Options& options)
{
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // every thread inherits it; sigwait takes them
    ::signal(SIGPIPE, SIG_IGN);

    Log log(options.log_json);
    const std::filesystem::path folder(options.store);
    Store meshes(folder);
    Store environments(folder / "environments");
    Store profiles(folder / "profiles");
    Cache cache(options.memory);
    ComputePool pool(options.workers, options.queue);
    Sessions sessions;
    ByteBudget arriving(options.max_inflight_bytes);
    ServerState state{options, meshes,   environments, profiles, cache,
                      pool,    sessions, arriving,     log};
    GuardedServer server(options.guard, [](int status, Fault fault, const std::string& detail) {
        return problem_json({fault, detail + std::string(limits_behind(fault)), {}, {}, {}},
                            status);
    });
    add_routes(server, state);
    const int port = server.bind(options.host, options.port);
    if (port < 0) {
        std::cerr << "relightd: cannot listen on " << options.host << ':' << options.port
                  << "; is it taken? --port 0 takes a free one\n";
        return 1;
    }
    const std::string host =
        options.host.find(':') == std::string::npos ? options.host : '[' + options.host + ']';
    std::thread stopper(stop_on_signal, signals, std::ref(server), std::ref(state));
    std::cout << "relightd listening on http://" << host << ':' << port << std::endl;
    const bool served = server.run();
    if (!served) { ::kill(::getpid(), SIGTERM); }  // wakes the stopper
    stopper.join();
    return served ? 0 : 1;
}

/// Starts the program again with glibc told to give large arrays huge pages and to keep what is
/// freed for the next request: a fault for each 4 KiB costs more than most of what is done with
/// them (a tree over 2 M triangles is built in 0.22 s instead of 0.42). Only the environment can
/// say so, and before the program starts. Who has set it otherwise is left alone.
void want_huge_pages(char** argv)
{
    if (std::getenv("GLIBC_TUNABLES") != nullptr) { return; }
    ::setenv("GLIBC_TUNABLES",
             "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=1073741824:"
             "glibc.malloc.trim_threshold=1073741824",
             0);
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    ::execv(program.c_str(), argv);  // returns only if it could not: then all is as it was
}

}  // namespace
}  // namespace relight

int main(int argc, char** argv)
{
    relight::want_huge_pages(argv);
    try {
        const relight::ParsedOptions parsed = relight::parse_options(argc, argv);
        return parsed.exit_code ? *parsed.exit_code : relight::serve(parsed.options);
    } catch (const std::exception& error) {
        std::cerr << "relightd: " << error.what() << '\n';
        return 1;
    }
}
