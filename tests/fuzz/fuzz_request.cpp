// The request's parser on any bytes: an answer or an error, never a crash.
#include "server/multipart.h"
#include "server/problem.h"
#include "server/scene_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto request = relight::parse_request(text, {}, true);
    if (!request) { relight::problem_json(request.error()); }
    relight::MultipartParser parser("B", {});
    const std::size_t half = size / 2;
    if (parser.feed(text.substr(0, half))) { parser.feed(text.substr(half)); }
    static_cast<void>(std::move(parser).finish());
    return 0;
}
