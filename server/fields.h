#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "server/json_tree.h"

namespace relight {

/// What a number may be, and in which unit it is meant.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    std::string_view unit;  ///< "W", "degrees", or empty
    bool low_open = false;  ///< `low` itself is not allowed
};

/// The first thing found wrong with a request; what comes after it is not reported.
class FirstError {
  public:
    void report(Error error)
    {
        if (!error_) { error_ = std::move(error); }
    }
    explicit operator bool() const { return error_.has_value(); }
    Error take() && { return std::move(*error_); }

  private:
    std::optional<Error> error_;
};

/// Reads one object of the request, field by field, strictly: what is asked for is known, the rest
/// is an error when it is finished. A getter answers nothing for a field that is absent or wrong;
/// the latter is reported to `errors`.
class Fields {
  public:
    /// `what` names the object in messages: "a point light".
    Fields(const Json& json, std::string pointer, std::string what, FirstError& errors);

    bool has(std::string_view name) { return find(name) != nullptr; }
    const Json* find(std::string_view name);
    bool is_null(std::string_view name);

    std::optional<bool> flag(std::string_view name);
    std::optional<double> number(std::string_view name, const Range& range);
    std::optional<std::int64_t> integer(std::string_view name, std::int64_t low, std::int64_t high);
    std::optional<std::string> text(std::string_view name, std::size_t longest);
    /// One of `words`. A word of `later` is in the contract but not in this build.
    std::optional<std::string> choice(std::string_view name,
                                      std::initializer_list<std::string_view> words,
                                      std::initializer_list<std::string_view> later = {});
    std::optional<Rgb> color(std::string_view name, const Range& each);
    std::optional<Point3> point(std::string_view name);
    std::optional<Dir3> direction(std::string_view name);
    const JsonArray* array(std::string_view name);
    std::optional<Fields> object(std::string_view name, std::string what);

    /// These must be there.
    void need(std::initializer_list<std::string_view> names);
    /// These are in the contract, but this build does not have them: `instead` says what it has.
    void not_yet(std::initializer_list<std::string_view> names, std::string_view instead);
    /// Reports something wrong with a field's value.
    void fail(Fault fault, std::string_view name, std::string detail);
    std::string pointer_to(std::string_view name) const { return pointer_ + pointer_step(name); }
    const std::string& pointer() const { return pointer_; }
    FirstError& errors() { return *errors_; }

    /// Reports the first field that nobody asked for, naming the nearest that is known, then the
    /// first that is missing (in this order: a mistyped name is both).
    void finish();

  private:
    std::optional<Vec3> triple(std::string_view name, const Range& each, std::string_view example);
    void wrong_type(std::string_view name, const Json& found, std::string_view allowed);

    const JsonObject* object_ = nullptr;
    std::string pointer_, what_;
    FirstError* errors_;
    std::vector<std::string> known_;
    std::optional<Error> missing_;
};

/// "0..90 degrees"
std::string description_of(const Range& range);

}  // namespace relight
