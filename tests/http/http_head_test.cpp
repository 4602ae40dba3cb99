#include "server/http_head.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "server/head_scanner.h"

namespace relight {
namespace {

/// Scans `bytes` in pieces of `step`, then parses what the scanner found.
std::variant<std::monostate, RequestHead, Refusal> read_head(const std::string& bytes,
                                                             std::size_t step)
{
    HeadScanner scanner({});
    for (std::size_t end = std::min(step, bytes.size());;
         end = std::min(end + step, bytes.size())) {
        const auto found = scanner.scan(std::string_view(bytes).substr(0, end));
        if (const auto* refused = std::get_if<Refusal>(&found)) { return *refused; }
        if (const auto* head = std::get_if<std::string_view>(&found)) {
            auto parsed = parse_head(*head, {});
            if (const auto* refused = std::get_if<Refusal>(&parsed)) { return *refused; }
            return std::get<RequestHead>(parsed);
        }
        if (end == bytes.size()) { return std::monostate{}; }
    }
}

RequestHead good(const std::string& bytes)
{
    const auto found = read_head(bytes, bytes.size());
    const auto* refused = std::get_if<Refusal>(&found);
    EXPECT_EQ(refused, nullptr) << (refused != nullptr ? refused->detail : "");
    const auto* head = std::get_if<RequestHead>(&found);
    return head != nullptr ? *head : RequestHead{};
}

int status_of(const std::string& bytes)
{
    const auto found = read_head(bytes, bytes.size());
    const auto* refused = std::get_if<Refusal>(&found);
    return refused != nullptr ? refused->status : 0;
}

const std::string get = "GET / HTTP/1.1\r\nHost: x\r\n";
const std::string post = "POST / HTTP/1.1\r\nHost: x\r\n";

TEST(HttpHead, IsReadTheSameInWhateverPiecesItArrives)
{
    const std::vector<std::string> heads = {
        get + "\r\n",
        post + "Content-Length: 5\r\n\r\nhello",
        "\r\n" + get + "\r\n",
        get + "X: a\rb\r\n\r\n",
        get + "X: a\nb\r\n\r\n",
        get + "X: a\r\r\n\r\n",
        "GET\n\n",
        post + "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n",
        get + "X"};
    for (const std::string& bytes : heads) {
        const auto whole = read_head(bytes, bytes.size());
        for (const std::size_t step : {1U, 2U, 3U, 7U}) {
            const auto pieces = read_head(bytes, step);
            ASSERT_EQ(pieces.index(), whole.index()) << bytes;
            if (const auto* head = std::get_if<RequestHead>(&whole)) {
                EXPECT_EQ(std::get<RequestHead>(pieces).normalised, head->normalised);
            }
        }
    }
}

TEST(HttpHead, GivesTheScannerEachByteOnce)
{
    // 32 KiB byte by byte: 5e8 looks if each piece began at the start again.
    std::string bytes = get;
    while (bytes.size() < 30'000) { bytes += "X: " + std::string(1000, 'a') + "\r\n"; }
    bytes += "\r\n";
    HeadScanner scanner({});
    std::size_t passed = 0;
    for (std::size_t end = 1; end < bytes.size(); ++end) {
        ASSERT_TRUE(std::holds_alternative<std::monostate>(
            scanner.scan(std::string_view(bytes).substr(0, end))));
        EXPECT_EQ(scanner.size() - passed, 1U);
        passed = scanner.size();
    }
}

TEST(HttpHead, EndsWhereTheNextRequestBegins)
{
    const std::string two = get + "\r\n" + post + "\r\n";
    HeadScanner scanner({});
    const auto found = scanner.scan(two);
    EXPECT_EQ(std::get<std::string_view>(found), get + "\r\n");
    EXPECT_EQ(scanner.size(), get.size() + 2);
}

TEST(HttpHead, FramesTheBodyFromLengthOrCodingAlone)
{
    EXPECT_EQ(good(post + "\r\n").framing, Framing::None);
    const RequestHead length = good(post + "content-LENGTH:\t0018446744073709551615 \r\n\r\n");
    EXPECT_EQ(length.framing, Framing::Length);
    EXPECT_EQ(length.content_length, 18446744073709551615U);
    const RequestHead chunked = good(post + "Transfer-Encoding: CHUNKED\r\n\r\n");
    EXPECT_EQ(chunked.framing, Framing::Chunked);
    EXPECT_EQ(chunked.content_length, 0U);
    EXPECT_EQ(status_of(post + "Content-Length: 18446744073709551616\r\n\r\n"), 413);
}

TEST(HttpHead, LeavesTheLibraryNothingToDecide)
{
    const std::string text = good(post +
                                  "Transfer-Encoding: chunked\r\nRange: bytes=0-1,2-3\r\n"
                                  "Expect: 100-continue\r\nConnection: close\r\nREMOTE_ADDR: 1\r\n"
                                  "Relight-Accept-Encoding: forged\r\nUpgrade: h2c\r\n\r\n")
                                 .normalised;
    EXPECT_EQ(text, "POST / HTTP/1.1\r\nHost: x\r\n\r\n");
}

TEST(HttpHead, KeepsAcceptEncodingUnderANameOfOurs)
{
    EXPECT_EQ(good(get + "Accept-Encoding: br\r\nAccept-encoding: gzip;q=0\r\n\r\n").normalised,
              get + "Relight-Accept-Encoding: br, gzip;q=0\r\n\r\n");
}

TEST(HttpHead, EscapesWhatTheLibraryWouldUnescapeInFields)
{
    EXPECT_EQ(good(get + "X: 100%0d%0aY: z\r\n\r\n").normalised,
              get + "X: 100%250d%250aY: z\r\n\r\n");
}

TEST(HttpHead, HidesMultipartFromTheLibraryButNotFromUs)
{
    EXPECT_EQ(good(post + "Content-Type: multipart/form-data; boundary=a\r\n\r\n").normalised,
              post + "Content-Type: Multipart/form-data; boundary=a\r\n\r\n");
}

TEST(HttpHead, TakesTheHostFromAnAbsoluteTarget)
{
    EXPECT_EQ(good("GET HTTP://y:80?q HTTP/1.1\r\nHost: x\r\n\r\n").normalised,
              "GET /?q HTTP/1.1\r\nHost: y:80\r\n\r\n");
}

TEST(HttpHead, ClosesAfterHttp10AndAfterConnectionClose)
{
    EXPECT_TRUE(good(get + "\r\n").keep_alive);
    EXPECT_TRUE(good(get + "Connection: closed, x-close\r\n\r\n").keep_alive);
    EXPECT_FALSE(good(get + "Connection: TE, Close\r\n\r\n").keep_alive);
    EXPECT_FALSE(good("GET / HTTP/1.0\r\nConnection: Keep-Alive\r\n\r\n").keep_alive);
}

TEST(HttpHead, WaitsForContinueOnlyInHttp11)
{
    EXPECT_TRUE(good(post + "Expect: 100-Continue\r\n\r\n").expects_continue);
    EXPECT_FALSE(good("POST / HTTP/1.0\r\nContent-Length: 5\r\nExpect: 100-continue\r\n\r\n")
                     .expects_continue);
}

TEST(HttpHead, IsBoundedInEveryDirection)
{
    const HeadLimits limits;
    const auto fields = [](std::size_t count, std::size_t bytes) {
        std::string text = get;
        for (std::size_t i = 0; i < count; ++i) {
            text.append("X: ").append(bytes, 'a').append("\r\n");
        }
        return text + "\r\n";
    };
    EXPECT_EQ(status_of(fields(limits.lines - 2, 1)), 0);
    EXPECT_EQ(status_of(fields(limits.lines - 1, 1)), 431);
    EXPECT_EQ(status_of(fields(1, limits.line_bytes - 5)), 0);  // "X: " and CR LF count
    EXPECT_EQ(status_of(fields(1, limits.line_bytes - 3)), 431);
    EXPECT_EQ(status_of(fields(5, limits.bytes / 5)), 431);
    const auto target = [](const std::string& text) {
        return "GET " + text + " HTTP/1.1\r\nHost: x\r\n\r\n";
    };
    EXPECT_EQ(status_of(target('/' + std::string(limits.path_bytes - 1, 'a'))), 0);
    EXPECT_EQ(status_of(target('/' + std::string(limits.path_bytes, 'a'))), 414);
    EXPECT_EQ(status_of(target("/?" + std::string(limits.target_bytes - 2, 'a'))), 0);
    EXPECT_EQ(status_of(target("/?" + std::string(limits.target_bytes - 1, 'a'))), 414);
}

TEST(HttpHead, RefusesEveryControlCharacterInEveryPlace)
{
    const std::string whole = "GET / HTTP/1.1\r\nHost: x\r\nX: ab\r\n\r\n";
    for (std::size_t at = 0; at + 4 < whole.size(); ++at) {
        for (int code = 0; code < 0x20; ++code) {
            if (code == '\t') { continue; }  // white space inside a value
            std::string bytes = whole;
            bytes.insert(at, 1, static_cast<char>(code));
            EXPECT_EQ(status_of(bytes), 400) << "code " << code << " at " << at;
        }
    }
}

TEST(HttpHead, NoPrefixOfAHeadIsAHead)
{
    const std::string whole = post + "Content-Length: 5\r\n\r\n";
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const auto found = read_head(whole.substr(0, size), whole.size());
        EXPECT_TRUE(std::holds_alternative<std::monostate>(found)) << size;
    }
}

}  // namespace
}  // namespace relight
