#include "server/check_report.h"
#include "server/json_tree.h"
#include "server/reply.h"
#include "server/routes.h"

namespace relight {

void add_check_route(GuardedServer& server, ServerState& state)
{
    const auto check = [&state](Progress& progress) -> Result<std::string> {
        const auto cases = run_checks(state.options.threads, progress);
        if (progress.stopped()) {
            return make_error(Fault::Cancelled, "the server is stopping; send it again later");
        }
        return check_json(cases, RELIGHT_VERSION);
    };
    server.Get(
        "/v1/check", [&state, check](const httplib::Request& request, httplib::Response& response) {
            answer(state, request, response, {}, [&] {
                auto json = state.pool.run(check);  // computed anew each time: that is the point
                json ? reply_json(response, 200, std::move(*json)) : reply(response, json.error());
            });
        });
}

}  // namespace relight
