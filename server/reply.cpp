#include "server/reply.h"

#include <algorithm>

#include "server/gzip.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"
#include "server/problem.h"

namespace relight {
namespace {

constexpr std::size_t worth_compressing = 1024;  // bytes

void compress(const httplib::Request& request, httplib::Response& response)
{
    const std::string type = essence(response.get_header_value("Content-Type"));
    const bool text =
        type == "application/json" || type == problem_type || type.starts_with("text/");
    if (!text) { return; }
    response.set_header("Vary", "Accept-Encoding");
    if (response.body.size() < worth_compressing ||
        !accepts_gzip(request.get_header_value(accept_encoding_field))) {
        return;
    }
    response.body = gzip(response.body);
    response.set_header("Content-Encoding", "gzip");
}

std::optional<Error> check_query(const httplib::Request& request,
                                 std::initializer_list<std::string_view> known)
{
    for (const auto& [name, value] : request.params) {
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            std::string list;
            for (const std::string_view one : known) {
                list.append(list.empty() ? "" : ", ").append(one);
            }
            return make_error(Fault::UnknownField,
                              "no query parameter \"" + printable(name) +
                                  "\" here; allowed: " + (list.empty() ? "none" : list));
        }
        if (request.params.count(name) > 1) {
            return make_error(Fault::DuplicateField,
                              "the query parameter \"" + name + "\" stands twice");
        }
    }
    return {};
}

}  // namespace

void reply(httplib::Response& response, const Error& error)
{
    response.status = problem_kind(error.fault).status;
    response.body = problem_json(error);
    response.headers.erase("Content-Type");
    response.set_header("Content-Type", std::string(problem_type));
    if (response.status == 503) { response.set_header("Retry-After", "1"); }
}

void reply_json(httplib::Response& response, int status, std::string json)
{
    response.status = status;
    response.body = std::move(json);
    response.set_header("Content-Type", "application/json");
}

void answer(ServerState& state, const httplib::Request& request, httplib::Response& response,
            std::initializer_list<std::string_view> known, const std::function<void()>& handler)
{
    const auto fail = [&](std::string_view what) {
        state.log.message(std::string("500: ") + std::string(what));
        response.headers.clear();
        reply(response,
              make_error(Fault::Internal, "something failed in the server; its log says what"));
    };
    try {
        if (auto error = check_query(request, known)) {
            reply(response, *error);
        } else {
            handler();
        }
        compress(request, response);
    } catch (const std::bad_alloc&) {
        fail("out of memory");
    } catch (const std::exception& error) {
        fail(error.what());
    } catch (...) {
        fail("an exception of no known type");
    }
}

std::optional<Error> read_body(const httplib::ContentReader& reader, ServerState& state,
                               ByteBudget::Share& share, std::uint64_t most, std::string_view limit,
                               bool& broken,
                               const std::function<std::optional<Error>(std::string_view)>& take)
{
    std::optional<Error> error;
    std::uint64_t size = 0;
    const bool whole = reader([&](const char* data, std::size_t length) {
        size += length;
        if (size > most) {
            error =
                make_error(Fault::BodyTooLarge, "the body is over " + std::to_string(most) +
                                                    " bytes (limit " + std::string(limit) + ")");
        } else if (!share.grow(length)) {
            error = make_error(Fault::Overloaded,
                               "too much is being received at once (limit --max-inflight-bytes)");
        } else if (state.stopping) {
            error = make_error(Fault::Stopping, "the server is stopping; send it again later");
        } else {
            error = take({data, length});
        }
        return !error.has_value();
    });
    broken = !whole && !error;
    return error;
}

}  // namespace relight
