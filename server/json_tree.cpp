#include "server/json_tree.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/inline_rows.h"
#include "server/json_text.h"

namespace relight {
namespace {

/// Builds the tree as the library reads; the first error stops it.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
  public:
    TreeBuilder(std::string_view text, std::uint64_t max_vertices, std::uint64_t max_faces)
        : text_(text), bulk_(parsed_.mesh, max_vertices, max_faces)
    {
    }

    Result<ParsedJson> done() &&
    {
        if (error_) { return std::move(*error_); }
        return std::move(parsed_);
    }

    bool null() override
    {
        return bulk_.is_open() ? stop(bulk_.wrong_type("null")) : add({nullptr});
    }
    bool boolean(bool v) override
    {
        return bulk_.is_open() ? stop(bulk_.wrong_type(v ? "true" : "false")) : add({v});
    }
    bool number_integer(number_integer_t v) override { return number(static_cast<double>(v)); }
    bool number_unsigned(number_unsigned_t v) override { return number(static_cast<double>(v)); }
    bool number_float(number_float_t v, const string_t& /*text*/) override { return number(v); }
    bool string(string_t& v) override
    {
        return bulk_.is_open() ? stop(bulk_.wrong_type("a string")) : add({std::move(v)});
    }
    bool binary(binary_t& /*v*/) override { return false; }  // not in JSON text

    bool start_object(std::size_t /*size*/) override
    {
        if (bulk_.is_open()) { return stop(bulk_.wrong_type("an object")); }
        return open(true);
    }
    bool start_array(std::size_t /*size*/) override
    {
        if (bulk_.is_open()) { return stop(bulk_.begin_row()); }
        const bool in_mesh = stack_.size() == 2 && stack_[0].is_object && stack_[1].is_object &&
                             stack_[0].key == "mesh";
        const Bulk kind = in_mesh ? bulk_named(stack_[1].key) : Bulk::None;
        if (kind == Bulk::None) { return open(false); }
        bulk_.open(kind);
        return true;
    }
    bool key(string_t& name) override
    {
        Frame& frame = stack_.back();
        frame.key = std::move(name);
        const auto same = [&](const JsonMember& m) { return m.name == frame.key; };
        if (std::any_of(frame.members.begin(), frame.members.end(), same)) {
            return stop(make_error(Fault::DuplicateField,
                                   std::string("\"") + printable(frame.key) +
                                       "\" stands twice in this object; once is allowed"));
        }
        if (frame.members.size() >= json_members) {
            return stop(make_error(Fault::OutOfRange, "more than " + std::to_string(json_members) +
                                                          " fields in one object"));
        }
        return true;
    }
    bool end_object() override { return close(); }
    bool end_array() override
    {
        if (!bulk_.is_open()) { return close(); }
        if (auto error = bulk_.end()) { return stop(std::move(error)); }
        return bulk_.is_open() || add({BulkArray{}});
    }

    bool parse_error(std::size_t position, const std::string& /*token*/,
                     const nlohmann::detail::exception& reason) override
    {
        constexpr int number_overflow = 406;  // the library's own number for it
        if (reason.id == number_overflow) {
            return stop(make_error(Fault::NotFinite, "this number is beyond what a double holds",
                                   bulk_.is_open() ? bulk_.place() : ""));
        }
        // The library has read one character too many to know.
        const auto before =
            text_.substr(0, std::min(std::max<std::size_t>(position, 1) - 1, text_.size()));
        const auto line =
            static_cast<std::uint64_t>(std::count(before.begin(), before.end(), '\n')) + 1;
        const std::size_t start =
            before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
        error_ = make_error(Fault::MalformedJson,
                            position > text_.size()
                                ? "the text ends where more JSON is expected"
                                : "not JSON (RFC 8259, UTF-8) at line " + std::to_string(line) +
                                      ", byte " + std::to_string(before.size() - start) + " of it",
                            {});
        error_->line = line;
        return false;
    }

  private:
    struct Frame {
        bool is_object{};
        std::string key;  // of the member being read
        JsonObject members;
        JsonArray values;
    };

    bool stop(std::optional<Error> error)
    {
        if (error) { error_ = std::move(*error).at(pointer()); }
        return !error;
    }

    std::string pointer() const
    {
        std::string place;
        for (const Frame& frame : stack_) {
            place += frame.is_object ? pointer_step(frame.key) : pointer_step(frame.values.size());
        }
        return place;
    }

    bool number(double v)
    {
        if (!is_finite(v)) {
            return stop(make_error(Fault::NotFinite, "this number is not finite"));
        }
        return bulk_.is_open() ? stop(bulk_.number(v)) : add({v});
    }

    bool open(bool is_object)
    {
        if (stack_.size() >= json_depth) {
            return stop(make_error(Fault::JsonTooDeep, "arrays and objects nest at most " +
                                                           std::to_string(json_depth) + " deep"));
        }
        stack_.push_back({is_object, {}, {}, {}});
        return true;
    }

    bool close()
    {
        Frame frame = std::move(stack_.back());
        stack_.pop_back();
        return frame.is_object ? add({std::move(frame.members)}) : add({std::move(frame.values)});
    }

    bool add(Json value)
    {
        if (++count_ > json_values) {
            return stop(
                make_error(Fault::BodyTooLarge, "more than " + std::to_string(json_values) +
                                                    " values; upload a mesh that big instead"));
        }
        if (stack_.empty()) {
            parsed_.root = std::move(value);
        } else if (Frame& frame = stack_.back(); frame.is_object) {
            frame.members.push_back({frame.key, std::move(value)});
        } else {
            frame.values.push_back(std::move(value));
        }
        return true;
    }

    std::string_view text_;
    ParsedJson parsed_;
    InlineRows bulk_;
    std::vector<Frame> stack_;
    std::size_t count_ = 0;
    std::optional<Error> error_;
};

}  // namespace

Result<ParsedJson> parse_json(std::string_view text, std::uint64_t max_vertices,
                              std::uint64_t max_faces)
{
    TreeBuilder builder(text, max_vertices, max_faces);
    // The tree is the builder's, errors too: what the library returns says no more.
    static_cast<void>(nlohmann::json::sax_parse(text.begin(), text.end(), &builder));
    return std::move(builder).done();
}

std::string pointer_step(std::string_view name)
{
    std::string step = "/";
    for (const char c : name) {
        if (c == '~') {
            step += "~0";
        } else if (c == '/') {
            step += "~1";
        } else {
            step += c;
        }
    }
    return step;
}

std::string description_of(const Json& json)
{
    struct Describe {
        std::string operator()(std::nullptr_t) const { return "null"; }
        std::string operator()(bool v) const { return v ? "true" : "false"; }
        std::string operator()(double v) const { return "the number " + decimal(v); }
        std::string operator()(const std::string& v) const
        {
            return "the string \"" + printable(v) + "\"";
        }
        std::string operator()(const JsonArray& v) const
        {
            return "an array of " + std::to_string(v.size());
        }
        std::string operator()(const JsonObject&) const { return "an object"; }
        std::string operator()(const BulkArray&) const { return "an array"; }
    };
    return std::visit(Describe{}, json.value);
}

}  // namespace relight
