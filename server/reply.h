#pragma once

#include <httplib.h>

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "server/byte_budget.h"
#include "server/routes.h"

namespace relight {

/// Of the body that this connection's thread sends, piece by piece: the log tells it.
inline thread_local std::uint64_t bytes_sent = 0;

void reply(httplib::Response& response, const Error& error);
void reply_json(httplib::Response& response, int status, std::string json);

/// Runs a handler: query parameters other than `known` are refused, exceptions become a 500 whose
/// cause only the log has, text is compressed for those who take gzip.
void answer(ServerState& state, const httplib::Request& request, httplib::Response& response,
            std::initializer_list<std::string_view> known, const std::function<void()>& handler);

/// Takes a body piece by piece; `take` says what is wrong with it. Nothing: the body was taken
/// whole. `broken` is set if the connection failed: then there is nothing to answer, the guard has.
std::optional<Error> read_body(const httplib::ContentReader& reader, ServerState& state,
                               ByteBudget::Share& share, std::uint64_t most, std::string_view limit,
                               bool& broken,
                               const std::function<std::optional<Error>(std::string_view)>& take);

}  // namespace relight
