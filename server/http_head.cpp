#include "server/http_head.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <set>

#include "server/http_text.h"

namespace relight {
namespace {

using namespace http_text;

class HeadParser {
  public:
    explicit HeadParser(const HeadLimits& limits) : limits_(limits) {}

    std::variant<RequestHead, Refusal> parse(std::string_view head)
    {
        const auto end = head.find("\r\n");
        if (!request_line(head.substr(0, end)) || !fields(head.substr(end + 2)) || !framing()) {
            return refusal_;
        }
        if (!accept_encoding_.empty()) { hand_on(accept_encoding_field, accept_encoding_); }
        std::string& text = head_.normalised;
        text.append(method_).append(" ").append(target_);
        text.append(http_1_0_ ? " HTTP/1.0\r\nHost: " : " HTTP/1.1\r\nHost: ").append(host_);
        text.append("\r\n").append(fields_).append("\r\n");
        return std::move(head_);
    }

  private:
    bool refuse(int status, Fault fault, const char* detail)
    {
        refusal_ = {status, fault, detail};
        return false;
    }
    bool refuse(const char* detail) { return refuse(400, Fault::BadRequest, detail); }

    bool refuse_long(const char* what, std::size_t allowed)
    {
        refusal_ = {414, Fault::HeadTooLarge,
                    std::string("the request's ") + what + " has more than " +
                        std::to_string(allowed) + " bytes"};
        return false;
    }

    bool request_line(std::string_view line)
    {
        const auto first = line.find(' ');
        const auto second = line.find(' ', first == std::string_view::npos ? first : first + 1);
        if (second == std::string_view::npos || line.find(' ', second + 1) != line.npos) {
            return refuse("the request line is not \"METHOD target HTTP/1.1\", one space between");
        }
        method_ = line.substr(0, first);
        return version(line.substr(second + 1)) && method() &&
               target(line.substr(first + 1, second - first - 1));
    }

    bool version(std::string_view text)
    {
        http_1_0_ = text == "HTTP/1.0";
        if (http_1_0_ || text == "HTTP/1.1") { return true; }
        if (text.size() == 8 && text.substr(0, 5) == "HTTP/" && is_digit(text[5]) &&
            text[6] == '.' && is_digit(text[7])) {
            return refuse(505, Fault::BadRequest, "only HTTP/1.1 and HTTP/1.0 are spoken here");
        }
        return refuse("the request line does not end in HTTP/1.1 or HTTP/1.0");
    }

    bool method()
    {
        if (!is_token(method_)) { return refuse("the method is not a token of RFC 9110"); }
        constexpr std::array<std::string_view, 7> known = {"GET",   "HEAD",   "POST",   "PUT",
                                                           "PATCH", "DELETE", "OPTIONS"};
        if (std::find(known.begin(), known.end(), method_) != known.end()) { return true; }
        return refuse(501, Fault::BadRequest,
                      "methods are GET, HEAD, POST, PUT, PATCH, DELETE and OPTIONS");
    }

    bool target(std::string_view text)
    {
        if (text.size() > limits_.target_bytes) {
            return refuse_long("target", limits_.target_bytes);
        }
        if (!is_target_text(text)) {
            return refuse("the request target holds a character or escape that no URI may hold");
        }
        if (lowered(text.substr(0, 7)) == "http://") {  // absolute form: its authority rules
            text.remove_prefix(7);
            const auto path = std::min(text.find_first_of("/?"), text.size());
            host_of_target_ = std::string(text.substr(0, path));
            if (host_of_target_->empty() || !is_authority(*host_of_target_)) {
                return refuse("the request target's authority is not host:port");
            }
            text.remove_prefix(path);
            if (text.empty() || text[0] == '?') { target_ += '/'; }
        } else if (text[0] != '/' && !(text == "*" && method_ == "OPTIONS")) {
            return refuse("the request target is not a path that starts with /");
        }
        if (text.substr(0, text.find('?')).size() > limits_.path_bytes) {
            return refuse_long("path", limits_.path_bytes);
        }
        bool in_query = false;
        for (const char c : text) {  // the library takes one '?'; a query may hold more (RFC 3986)
            if (c == '?' && in_query) {
                target_ += "%3F";
            } else {
                target_ += c;
            }
            in_query = in_query || c == '?';
        }
        return true;
    }

    bool fields(std::string_view rest)
    {
        while (rest.substr(0, 2) != "\r\n") {
            const auto end = rest.find("\r\n");
            const std::string_view line = rest.substr(0, end);
            rest.remove_prefix(end + 2);
            if (line[0] == ' ' || line[0] == '\t') {
                return refuse("a header field is folded over two lines; each takes one");
            }
            if (!is_field_line(line)) {
                return refuse("a header field is not \"Name: value\" with a token for a name");
            }
            const auto colon = line.find(':');
            if (!field(line.substr(0, colon), trimmed(line.substr(colon + 1)))) { return false; }
        }
        return true;
    }

    bool field(std::string_view name, std::string_view value)
    {
        const std::string key = lowered(name);
        // A second one of these would be read by some and overlooked by others.
        static const std::set<std::string> single = {
            "host",         "content-length",   "transfer-encoding", "expect",
            "content-type", "content-encoding", "authorization"};
        if (single.count(key) != 0 && !seen_.insert(key).second) {
            return refuse("a header field that may stand once stands twice");
        }
        if (key == "host") {
            if (!is_authority(value)) { return refuse("Host is not host:port"); }
            host_ = value;
        } else if (key == "content-length") {
            return length(value);
        } else if (key == "transfer-encoding") {
            return coding(value);
        } else if (key == "content-encoding") {
            return refuse(415, Fault::UnsupportedEncoding,
                          "request bodies are sent as they are, without Content-Encoding");
        } else if (key == "expect") {
            if (lowered(value) != "100-continue") {
                return refuse(417, Fault::BadRequest, "Expect may only be 100-continue");
            }
            head_.expects_continue = !http_1_0_;
        } else if (key == "connection") {
            connection(value);
        } else if (key == "accept-encoding") {
            accept_encoding_.append(accept_encoding_.empty() ? "" : ", ").append(value);
        } else if (key == "content-type" && lowered(value.substr(0, 10)) == "multipart/") {
            std::string type(value);
            type[0] = 'M';
            hand_on(name, type);
        } else if (!is_dropped(key)) {
            hand_on(name, value);
        }
        return true;
    }

    bool length(std::string_view value)
    {
        if (value.empty() || !std::all_of(value.begin(), value.end(), is_digit)) {
            return refuse("Content-Length holds something other than decimal digits");
        }
        const auto end = value.data() + value.size();
        if (std::from_chars(value.data(), end, head_.content_length).ec != std::errc()) {
            return refuse(413, Fault::BodyTooLarge, "Content-Length is beyond any body taken here");
        }
        hand_on("Content-Length", value);
        return true;
    }

    bool coding(std::string_view value)
    {
        if (http_1_0_) { return refuse("HTTP/1.0 has no Transfer-Encoding"); }
        if (lowered(value) == "chunked") { return true; }
        return refuse(501, Fault::BadRequest, "the only Transfer-Encoding is chunked, once");
    }

    void connection(std::string_view value)
    {
        while (!value.empty()) {
            const auto comma = std::min(value.find(','), value.size());
            if (lowered(trimmed(value.substr(0, comma))) == "close") { head_.keep_alive = false; }
            value.remove_prefix(std::min(comma + 1, value.size()));
        }
    }

    /// Fields that are ours or the library's to set, hop-by-hop ones, and Range: ignoring it is
    /// always allowed (RFC 9110, 14.2), and the library's ranges reach past the end of an answer.
    static bool is_dropped(const std::string& key)
    {
        static const std::set<std::string> dropped = {
            "range",      "te",          "trailer",
            "upgrade",    "keep-alive",  "proxy-connection",
            "if-range",   "remote_addr", "remote_port",
            "local_addr", "local_port",  lowered(accept_encoding_field)};
        return dropped.count(key) != 0;
    }

    /// The library decodes %-escapes in values, which would turn %0d%0a into a line break; an
    /// escaped '%' comes out as the client wrote it.
    void hand_on(std::string_view name, std::string_view value)
    {
        fields_.append(name).append(": ");
        for (const char c : value) {
            if (c == '%') {
                fields_ += "%25";
            } else {
                fields_ += c;
            }
        }
        fields_ += "\r\n";
    }

    bool framing()
    {
        const bool has_length = seen_.count("content-length") != 0;
        const bool chunked = seen_.count("transfer-encoding") != 0;
        if (has_length && chunked) {
            return refuse("Content-Length and Transfer-Encoding exclude each other");
        }
        if (!http_1_0_ && seen_.count("host") == 0) { return refuse("HTTP/1.1 needs a Host"); }
        if (host_of_target_) { host_ = *host_of_target_; }
        if (http_1_0_) {
            head_.keep_alive = false;
            if (!has_length && method_[0] == 'P') {  // 1.0 may mean "until I close"
                return refuse(411, Fault::LengthRequired, "an HTTP/1.0 body needs Content-Length");
            }
        }
        head_.framing = chunked ? Framing::Chunked : has_length ? Framing::Length : Framing::None;
        return true;
    }

    const HeadLimits& limits_;
    RequestHead head_;
    Refusal refusal_;
    bool http_1_0_ = false;
    std::string method_, target_, host_, accept_encoding_, fields_;
    std::optional<std::string> host_of_target_;
    std::set<std::string> seen_;
};

}  // namespace

std::variant<RequestHead, Refusal> parse_head(std::string_view head, const HeadLimits& limits)
{
    return HeadParser(limits).parse(head);
}

bool is_field_line(std::string_view line)
{
    const auto colon = line.find(':');
    return colon != std::string_view::npos && is_token(line.substr(0, colon));
}

}  // namespace relight
