#pragma once

#include <atomic>

#include "server/byte_budget.h"
#include "server/cache.h"
#include "server/compute.h"
#include "server/guard.h"
#include "server/options.h"
#include "server/server_log.h"
#include "server/sessions.h"
#include "server/store.h"

namespace relight {

/// What the handlers share; all of it outlives the server.
struct ServerState {
    const Options& options;
    Store& meshes;
    Store& environments;
    Store& profiles;
    Cache& cache;
    ComputePool& pool;
    Sessions& sessions;
    ByteBudget& arriving;
    Log& log;
    std::atomic<bool> stopping{false};
};

/// Registers every route of the API.
void add_routes(GuardedServer& server, ServerState& state);

void add_stored_routes(GuardedServer& server, ServerState& state);
void add_relight_route(GuardedServer& server, ServerState& state);
void add_check_route(GuardedServer& server, ServerState& state);

}  // namespace relight
