#include "server/head_scanner.h"

namespace relight {

std::variant<std::monostate, std::string_view, Refusal> HeadScanner::scan(std::string_view buffered)
{
    const auto too_large = [](int status, const char* what, std::size_t allowed, const char* unit) {
        return Refusal{status, Fault::HeadTooLarge,
                       std::string(what) + " more than " + std::to_string(allowed) + unit};
    };
    while (at_ < buffered.size()) {
        const char c = buffered[at_];
        const bool ends_line = c == '\n';
        if (after_cr_ != ends_line) {
            return Refusal{400, Fault::BadRequest,
                           "a line of the head does not end in CR LF, or holds one of them alone"};
        }
        const auto code = static_cast<unsigned char>(c);
        if ((code < 0x20 && c != '\r' && c != '\n' && c != '\t') || code == 0x7f) {
            return Refusal{400, Fault::BadRequest, "the head holds a control character"};
        }
        after_cr_ = c == '\r';
        ++at_;
        if (at_ - begin_ > limits_.bytes) {
            return too_large(431, "the request's head has", limits_.bytes, " bytes");
        }
        if (!ends_line) {
            if (at_ - line_begin_ > limits_.line_bytes) {
                return lines_ == 0
                           ? too_large(414, "the request line has", limits_.line_bytes, " bytes")
                           : too_large(431, "a header field has", limits_.line_bytes, " bytes");
            }
            continue;
        }
        const bool empty = at_ - line_begin_ == 2;
        line_begin_ = at_;
        if (empty && lines_ > 0) { return buffered.substr(begin_, at_ - begin_); }
        if (empty && begin_ > 0) {
            return Refusal{400, Fault::BadRequest,
                           "there is more than one empty line before the request"};
        }
        if (empty) {
            begin_ = at_;
        } else if (++lines_ > limits_.lines) {
            return too_large(431, "the request's head has", limits_.lines, " lines");
        }
    }
    return std::monostate{};
}

}  // namespace relight
