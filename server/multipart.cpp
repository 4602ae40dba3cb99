#include "server/multipart.h"

#include <algorithm>
#include <utility>

#include "server/json_text.h"
#include "server/json_tree.h"

namespace relight {
namespace {

std::string lower(std::string_view text)
{
    std::string out(text);
    for (char& c : out) {
        if (c >= 'A' && c <= 'Z') { c = static_cast<char>(c - 'A' + 'a'); }
    }
    return out;
}

std::string_view trimmed(std::string_view text)
{
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) { return {}; }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// `; name=value; name="value"` taken apart; nothing if it is not that.
std::optional<std::vector<std::pair<std::string, std::string>>> parameters(std::string_view text)
{
    std::vector<std::pair<std::string, std::string>> found;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        if (text.front() != ';') { return {}; }
        text = trimmed(text.substr(1));
        const auto equals = text.find('=');
        if (equals == std::string_view::npos || equals == 0) { return {}; }
        const std::string name = lower(text.substr(0, equals));
        if (name.find_first_of(" \t\";") != std::string::npos) { return {}; }
        text.remove_prefix(equals + 1);
        std::string value;
        if (!text.empty() && text.front() == '"') {
            std::size_t i = 1;
            for (; i < text.size() && text[i] != '"'; ++i) {
                if (text[i] == '\\' && i + 1 < text.size()) { ++i; }
                value += text[i];
            }
            if (i >= text.size()) { return {}; }
            text.remove_prefix(i + 1);
        } else {
            const auto end = std::min(text.find_first_of("; \t"), text.size());
            value = text.substr(0, end);
            text.remove_prefix(end);
        }
        found.emplace_back(name, std::move(value));
    }
    return found;
}

/// The one parameter of that name; nothing if there is none or more.
std::optional<std::string> parameter(std::string_view text, std::string_view name)
{
    const auto all = parameters(text);
    if (!all) { return {}; }
    std::optional<std::string> value;
    for (const auto& [key, given] : *all) {
        if (key != name) { continue; }
        if (value) { return {}; }
        value = given;
    }
    return value;
}

}  // namespace

std::optional<std::string> multipart_boundary(std::string_view content_type)
{
    const auto semicolon = std::min(content_type.find(';'), content_type.size());
    if (lower(trimmed(content_type.substr(0, semicolon))) != "multipart/form-data") { return {}; }
    auto boundary = parameter(content_type.substr(semicolon), "boundary");
    constexpr std::string_view allowed_characters =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789'()+_,-./:=? ";
    if (!boundary || boundary->empty() || boundary->size() > 70 || boundary->back() == ' ' ||
        boundary->find_first_not_of(allowed_characters) != std::string::npos) {
        return {};
    }
    return boundary;
}

MultipartParser::MultipartParser(const std::string& boundary, const MultipartLimits& limits)
    : delimiter_("\r\n--" + boundary),
      limits_(limits),
      buffer_("\r\n")  // the first delimiter needs no line end before it
{
}

bool MultipartParser::fail(Fault fault, std::string detail)
{
    error_ = make_error(fault, std::move(detail));
    return false;
}

bool MultipartParser::feed(std::string_view piece)
{
    if (error_) { return false; }
    if (state_ == State::End) { return true; }  // the epilogue says nothing
    buffer_ += piece;
    for (bool progressed = true; progressed;) {
        progressed = false;
        if (!step(progressed)) { return false; }
    }
    return true;
}

bool MultipartParser::step(bool& progressed)
{
    switch (state_) {
        case State::AfterDelimiter:
            return read_after_delimiter(progressed);
        case State::Head:
            return read_head(progressed);
        case State::Data:
            return read_data(progressed);
        case State::End:
            buffer_.clear();
            break;
    }
    return true;
}

bool MultipartParser::read_after_delimiter(bool& progressed)
{
    if (buffer_.size() < 2) { return true; }
    const std::string_view next = std::string_view(buffer_).substr(0, 2);
    if (next == "--") {
        state_ = State::End;
    } else if (next == "\r\n") {
        state_ = State::Head;
    } else {
        return fail(Fault::BadRequest, "after a multipart delimiter comes CRLF, or -- at the end");
    }
    buffer_.erase(0, 2);
    progressed = true;
    return true;
}

bool MultipartParser::read_head(bool& progressed)
{
    const auto end = buffer_.find("\r\n\r\n");
    if (std::min(end, buffer_.size()) > limits_.head_bytes) {
        return fail(Fault::BadRequest, "a part's header lines hold at most " +
                                           std::to_string(limits_.head_bytes) + " bytes");
    }
    if (end == std::string::npos) { return true; }
    if (!add_part(std::string_view(buffer_).substr(0, end))) { return false; }
    buffer_.erase(0, end + 4);
    state_ = State::Data;
    progressed = true;
    return true;
}

bool MultipartParser::add_part(std::string_view head)
{
    if (parts_.size() >= limits_.parts) {
        return fail(Fault::BadRequest, "at most " + std::to_string(limits_.parts) + " parts");
    }
    Part part;
    bool named = false;
    while (!head.empty()) {
        const auto end = std::min(head.find("\r\n"), head.size());
        const std::string_view line = head.substr(0, end);
        head.remove_prefix(std::min(head.size(), end + 2));
        const auto colon = line.find(':');
        if (colon == std::string_view::npos || colon == 0) {
            return fail(Fault::BadRequest, "a part's header line is not \"name: value\"");
        }
        const std::string name = lower(line.substr(0, colon));
        const std::string_view value = trimmed(line.substr(colon + 1));
        if (name == "content-disposition") {
            const auto semicolon = std::min(value.find(';'), value.size());
            const auto given = parameter(value.substr(semicolon), "name");
            if (named || lower(trimmed(value.substr(0, semicolon))) != "form-data" || !given) {
                return fail(Fault::BadRequest,
                            "a part has one Content-Disposition: form-data; name=\"…\"");
            }
            named = true;
            part.name = *given;
        } else if (name == "content-type") {
            part.content_type = value;
        } else if (name == "content-transfer-encoding" || name == "content-encoding") {
            const std::string encoding = lower(value);
            if (encoding != "binary" && encoding != "8bit" && encoding != "7bit" &&
                encoding != "identity") {
                return fail(Fault::UnsupportedEncoding, "a part comes as it is, not encoded");
            }
        }
    }
    if (!named || part.name.empty() || part.name.size() > limits_.name_bytes) {
        return fail(Fault::BadRequest, "a part needs a name of 1 to " +
                                           std::to_string(limits_.name_bytes) +
                                           " bytes: Content-Disposition: form-data; name=\"…\"");
    }
    const auto same = [&](const Part& other) { return other.name == part.name; };
    if (std::any_of(parts_.begin(), parts_.end(), same)) {
        return fail(Fault::BadRequest, "two parts are called \"" + printable(part.name) + "\"");
    }
    parts_.push_back(std::move(part));
    return true;
}

bool MultipartParser::read_data(bool& progressed)
{
    const auto at = buffer_.find(delimiter_);
    // What may be the start of a delimiter stays.
    const std::size_t kept = at != std::string::npos ? buffer_.size() - at : delimiter_.size() - 1;
    const std::size_t data = buffer_.size() - std::min(buffer_.size(), kept);
    if (before_first_ && data > 0) {
        return fail(Fault::BadRequest,
                    "the body does not start with the boundary its type announces");
    }
    if (!before_first_) {
        Part& part = parts_.back();
        part.data.append(buffer_, 0, data);
        if (part.name != "request") {
            hash_.add(std::string_view(buffer_).substr(0, data));
        } else if (part.data.size() > limits_.request_bytes) {
            return fail(Fault::BodyTooLarge, "the part \"request\" holds at most " +
                                                 std::to_string(limits_.request_bytes) + " bytes");
        }
    }
    if (at != std::string::npos) {
        buffer_.erase(0, at + delimiter_.size());
        if (!before_first_) { parts_.back().id = std::exchange(hash_, {}).hex(); }
        before_first_ = false;
        state_ = State::AfterDelimiter;
        progressed = true;
    } else {
        buffer_.erase(0, data);
    }
    return true;
}

Result<std::vector<Part>> MultipartParser::finish() &&
{
    if (error_) { return std::move(*error_); }
    if (state_ != State::End) {
        return make_error(Fault::BadRequest,
                          "the multipart body ends before its closing delimiter");
    }
    return std::move(parts_);
}

}  // namespace relight
