#include "server/fields.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/mesh.h"
#include "server/json_text.h"
#include "server/nearest.h"

namespace relight {
namespace {

template <class Words>
std::string listed(const Words& words)
{
    std::string list;
    for (const auto& word : words) { list.append(list.empty() ? "" : ", ").append(word); }
    return list;
}

}  // namespace

std::string description_of(const Range& range)
{
    const std::string unit = range.unit.empty() ? "" : " " + std::string(range.unit);
    const bool low = is_finite(range.low);
    const bool high = is_finite(range.high);
    if (low && high) {
        return (range.low_open ? "more than " + decimal(range.low) + " and at most "
                               : decimal(range.low) + "..") +
               decimal(range.high) + unit;
    }
    if (low) { return (range.low_open ? "more than " : "at least ") + decimal(range.low) + unit; }
    return "any finite number" + (unit.empty() ? unit : " of" + unit);
}

Fields::Fields(const Json& json, std::string pointer, std::string what, FirstError& errors)
    : object_(std::get_if<JsonObject>(&json.value)),
      pointer_(std::move(pointer)),
      what_(std::move(what)),
      errors_(&errors)
{
    if (object_ == nullptr) {
        errors_->report(make_error(
            Fault::WrongType, "found " + description_of(json) + "; " + what_ + " is an object {…}",
            pointer_));
    }
}

const Json* Fields::find(std::string_view name)
{
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) {
        known_.emplace_back(name);
    }
    if (object_ == nullptr) { return nullptr; }
    const auto at = std::find_if(object_->begin(), object_->end(),
                                 [&](const JsonMember& member) { return member.name == name; });
    return at == object_->end() ? nullptr : &at->value;
}

bool Fields::is_null(std::string_view name)
{
    const Json* json = find(name);
    return json != nullptr && std::holds_alternative<std::nullptr_t>(json->value);
}

void Fields::fail(Fault fault, std::string_view name, std::string detail)
{
    errors_->report(make_error(fault, std::move(detail), pointer_to(name)));
}

void Fields::wrong_type(std::string_view name, const Json& found, std::string_view allowed)
{
    fail(Fault::WrongType, name,
         "found " + description_of(found) + "; " + std::string(name) + " is " +
             std::string(allowed));
}

std::optional<bool> Fields::flag(std::string_view name)
{
    const Json* json = find(name);
    if (json == nullptr) { return {}; }
    if (const bool* value = std::get_if<bool>(&json->value)) { return *value; }
    wrong_type(name, *json, "true or false");
    return {};
}

std::optional<double> Fields::number(std::string_view name, const Range& range)
{
    const Json* json = find(name);
    if (json == nullptr) { return {}; }
    const double* value = std::get_if<double>(&json->value);
    if (value == nullptr) {
        wrong_type(name, *json, "a number, " + description_of(range));
        return {};
    }
    if (*value < range.low || *value > range.high || (range.low_open && *value == range.low)) {
        fail(Fault::OutOfRange, name,
             "found " + decimal(*value) + "; allowed: " + description_of(range));
        return {};
    }
    return *value;
}

std::optional<std::int64_t> Fields::integer(std::string_view name, std::int64_t low,
                                            std::int64_t high)
{
    const Json* json = find(name);
    const double* given = json == nullptr ? nullptr : std::get_if<double>(&json->value);
    if (given != nullptr && *given != std::floor(*given)) {
        wrong_type(name, *json, "a whole number");
        return {};
    }
    const auto value = number(name, {static_cast<double>(low), static_cast<double>(high), {}});
    if (!value) { return {}; }
    return static_cast<std::int64_t>(*value);
}

std::optional<std::string> Fields::text(std::string_view name, std::size_t longest)
{
    const Json* json = find(name);
    if (json == nullptr) { return {}; }
    const std::string* value = std::get_if<std::string>(&json->value);
    if (value == nullptr) {
        wrong_type(name, *json, "a string");
        return {};
    }
    if (value->empty() || value->size() > longest) {
        fail(Fault::WrongLength, name,
             "found " + std::to_string(value->size()) + " bytes; allowed: 1 to " +
                 std::to_string(longest));
        return {};
    }
    return *value;
}

std::optional<std::string> Fields::choice(std::string_view name,
                                          std::initializer_list<std::string_view> words,
                                          std::initializer_list<std::string_view> later)
{
    const Json* json = find(name);
    if (json == nullptr) { return {}; }
    const std::string* value = std::get_if<std::string>(&json->value);
    if (value == nullptr) {
        wrong_type(name, *json, "one of: " + listed(words));
        return {};
    }
    if (std::find(words.begin(), words.end(), *value) != words.end()) { return *value; }
    if (std::find(later.begin(), later.end(), *value) != later.end()) {
        fail(Fault::NotAvailable, name,
             "\"" + *value + "\" is not in this build; it has: " + listed(words));
        return {};
    }
    const std::vector<std::string> known(words.begin(), words.end());
    const std::string_view meant = nearest(*value, known);
    fail(Fault::UnknownValue, name,
         "found \"" + printable(*value) + "\"" +
             (meant.empty() ? "" : "; did you mean \"" + std::string(meant) + "\"?") +
             " Allowed: " + listed(words));
    return {};
}

std::optional<Vec3> Fields::triple(std::string_view name, const Range& each,
                                   std::string_view example)
{
    const Json* json = find(name);
    if (json == nullptr) { return {}; }
    const auto* values = std::get_if<JsonArray>(&json->value);
    if (values == nullptr) {
        wrong_type(name, *json, "an array of 3 numbers " + std::string(example));
        return {};
    }
    if (values->size() != 3) {
        fail(Fault::WrongLength, name,
             "found an array of " + std::to_string(values->size()) + "; " + std::string(name) +
                 " is an array of 3 numbers " + std::string(example));
        return {};
    }
    double xyz[3] = {};
    for (std::size_t i = 0; i < 3; ++i) {
        const Json& item = (*values)[i];
        const std::string place = pointer_to(name) + pointer_step(i);
        const double* value = std::get_if<double>(&item.value);
        if (value == nullptr) {
            errors_->report(make_error(Fault::WrongType,
                                       "found " + description_of(item) + "; a number belongs here",
                                       place));
            return {};
        }
        if (*value < each.low || *value > each.high) {
            errors_->report(make_error(
                Fault::OutOfRange,
                "found " + decimal(*value) + "; allowed: " + description_of(each), place));
            return {};
        }
        xyz[i] = *value;
    }
    return Vec3{xyz[0], xyz[1], xyz[2]};
}

std::optional<Rgb> Fields::color(std::string_view name, const Range& each)
{
    const auto v = triple(name, each, "[r,g,b], linear Rec.709");
    if (!v) { return {}; }
    return Rgb{v->x, v->y, v->z};
}

std::optional<Point3> Fields::point(std::string_view name)
{
    constexpr Range coordinate_range{-largest_coordinate, largest_coordinate, "length units"};
    const auto v = triple(name, coordinate_range, "[x,y,z]");
    if (!v) { return {}; }
    return Point3{v->x, v->y, v->z};
}

std::optional<Dir3> Fields::direction(std::string_view name)
{
    const auto v = triple(name, {}, "[x,y,z]");
    if (!v) { return {}; }
    const Dir3 unit = normalize(*v);
    if (!unit) {
        fail(Fault::ZeroDirection, name,
             "found [0,0,0]; a direction needs a length (it need not be 1)");
        return {};
    }
    return unit;
}

const JsonArray* Fields::array(std::string_view name)
{
    const Json* json = find(name);
    if (json == nullptr) { return nullptr; }
    const auto* values = std::get_if<JsonArray>(&json->value);
    if (values == nullptr) { wrong_type(name, *json, "an array"); }
    return values;
}

std::optional<Fields> Fields::object(std::string_view name, std::string what)
{
    const Json* json = find(name);
    if (json == nullptr) { return {}; }
    return Fields(*json, pointer_to(name), std::move(what), *errors_);
}

void Fields::need(std::initializer_list<std::string_view> names)
{
    for (const std::string_view name : names) {
        if (find(name) == nullptr && !missing_) {
            missing_ = make_error(Fault::MissingField,
                                  what_ + " needs \"" + std::string(name) + "\"", pointer_to(name));
        }
    }
}

void Fields::not_yet(std::initializer_list<std::string_view> names, std::string_view instead)
{
    for (const std::string_view name : names) {
        if (find(name) != nullptr) {
            fail(Fault::NotAvailable, name,
                 "\"" + std::string(name) + "\" is not in this build; " + std::string(instead));
        }
    }
}

void Fields::finish()
{
    if (object_ == nullptr) { return; }
    for (const JsonMember& member : *object_) {
        if (std::find(known_.begin(), known_.end(), member.name) != known_.end()) { continue; }
        const std::string_view meant = nearest(member.name, known_);
        fail(Fault::UnknownField, member.name,
             what_ + " has no field \"" + printable(member.name) + "\"" +
                 (meant.empty() ? "; its fields: " + listed(known_)
                                : "; did you mean \"" + std::string(meant) + "\"?"));
    }
    if (missing_) { errors_->report(std::move(*missing_)); }
}

}  // namespace relight
