// Node: the file's JSON, read with care.
#include <array>
#include <cmath>
#include <utility>

#include "server/import/gltf_file.h"

namespace relight::gltf {
namespace {

/// Integers up to here are exact in a double, as JSON allows them to be written ("24.0").
constexpr double largest_integer = 9007199254740992.0;

std::string below(const std::string& where, std::string_view key)
{
    return where + '/' + std::string(key);
}

const Json* member(const Json& json, std::string_view key)
{
    const auto found = json.find(key);
    return found == json.end() ? nullptr : &*found;
}

std::uint64_t integer(const Json& json, const std::string& where)
{
    if (json.is_number_unsigned()) { return json.get<std::uint64_t>(); }
    if (json.is_number_float()) {
        const auto value = json.get<double>();
        if (value >= 0.0 && value <= largest_integer && value == std::floor(value)) {
            return static_cast<std::uint64_t>(value);
        }
    }
    refuse(Fault::MalformedBody, where, "must be an integer from 0 on");
}

double finite(const Json& json, const std::string& where)
{
    if (!json.is_number()) { refuse(Fault::MalformedBody, where, "must be a number"); }
    return json.get<double>();  // the parser refuses what no double holds
}

}  // namespace

void refuse(Fault fault, std::string_view where, std::string_view what)
{
    std::string detail(where.empty() ? "the file" : where);
    detail += where.empty() ? " " : ": ";
    detail += what;
    throw Refusal{Error{fault, std::move(detail), {}, {}, {}}};
}

std::string shown(std::string_view text)
{
    constexpr std::size_t longest = 60;
    std::string result = "\"";
    for (const char c : text.substr(0, longest)) { result += c >= ' ' && c <= '~' ? c : '?'; }
    return result + (text.size() > longest ? "...\"" : "\"");
}

bool Node::has(std::string_view key) const
{
    return member(*json_, key) != nullptr;
}

Node Node::at(std::string_view key) const
{
    auto found = find(key);
    if (!found) { refuse(Fault::MalformedBody, where_, "needs " + shown(key)); }
    return *std::move(found);
}

std::optional<Node> Node::find(std::string_view key) const
{
    if (!json_->is_object()) { refuse(Fault::MalformedBody, where_, "must be an object"); }
    const Json* const found = member(*json_, key);
    if (found == nullptr) { return std::nullopt; }
    return Node(*found, below(where_, key));
}

std::optional<Node> Node::extension(std::string_view name) const
{
    const auto extensions = find("extensions");
    auto found = extensions ? extensions->find(name) : std::nullopt;
    if (found && !found->json().is_object()) {
        refuse(Fault::MalformedBody, found->where(), "must be an object");
    }
    return found;
}

std::size_t Node::size(std::string_view key) const
{
    const auto array = find(key);
    if (!array) { return 0; }
    if (!array->json().is_array()) {
        refuse(Fault::MalformedBody, array->where(), "must be an array");
    }
    return array->json().size();
}

std::vector<Node> Node::items(std::string_view key) const
{
    std::vector<Node> result;
    const std::size_t count = size(key);
    result.reserve(count);
    for (std::size_t i = 0; i < count; ++i) { result.push_back(item(key, i)); }
    return result;
}

Node Node::item(std::string_view key, std::uint64_t index) const
{
    const std::size_t count = size(key);
    if (index >= count) {
        refuse(Fault::IndexOutOfRange, where_,
               "names element " + std::to_string(index) + " of " + std::string(key) +
                   ", which has " + std::to_string(count));
    }
    return {(*member(*json_, key))[index], below(below(where_, key), std::to_string(index))};
}

std::string Node::text(std::string_view key, std::string_view otherwise) const
{
    const auto found = find(key);
    if (!found) { return std::string(otherwise); }
    if (!found->json().is_string()) {
        refuse(Fault::MalformedBody, found->where(), "must be a string");
    }
    return found->json().get<std::string>();
}

bool Node::flag(std::string_view key, bool otherwise) const
{
    const auto found = find(key);
    if (!found) { return otherwise; }
    if (!found->json().is_boolean()) {
        refuse(Fault::MalformedBody, found->where(), "must be true or false");
    }
    return found->json().get<bool>();
}

double Node::number(std::string_view key, double otherwise, double low, double high) const
{
    const auto found = find(key);
    if (!found) { return otherwise; }
    const double value = finite(found->json(), found->where());
    if (!(value >= low && value <= high)) {
        std::array<char, 96> range{};
        std::snprintf(range.data(), range.size(), "is %g, and must lie in [%g, %g]", value, low,
                      high);
        refuse(Fault::OutOfRange, found->where(), range.data());
    }
    return value;
}

std::uint64_t Node::count(std::string_view key, std::uint64_t otherwise) const
{
    return index(key).value_or(otherwise);
}

std::optional<std::uint64_t> Node::index(std::string_view key) const
{
    const auto found = find(key);
    if (!found) { return std::nullopt; }
    return integer(found->json(), found->where());
}

std::vector<std::uint64_t> Node::indices(std::string_view key) const
{
    std::vector<std::uint64_t> values(size(key));
    if (values.empty()) { return values; }
    const Node array = at(key);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = integer(array.json()[i], array.where());
    }
    return values;
}

std::optional<std::vector<double>> Node::numbers(std::string_view key, std::size_t length) const
{
    const auto found = find(key);
    if (!found) { return std::nullopt; }
    if (size(key) != length) {
        refuse(Fault::MalformedBody, found->where(),
               "must have " + std::to_string(length) + " numbers, and has " +
                   std::to_string(found->json().size()));
    }
    std::vector<double> values;
    values.reserve(length);
    for (const Json& value : found->json()) { values.push_back(finite(value, found->where())); }
    return values;
}

}  // namespace relight::gltf
