#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <iostream>
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

}  // namespace
}  // namespace relight

int main(int argc, char** argv)
{
    try {
        const relight::ParsedOptions parsed = relight::parse_options(argc, argv);
        return parsed.exit_code ? *parsed.exit_code : relight::serve(parsed.options);
    } catch (const std::exception& error) {
        std::cerr << "relightd: " << error.what() << '\n';
        return 1;
    }
}
