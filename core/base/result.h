#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/base/fault.h"

namespace relight {

/// What a caller got wrong, said so that they can mend it.
struct Error {
    Fault fault{};
    std::string detail;                 ///< what was found, what is allowed, in which unit
    std::string pointer;                ///< RFC 6901 place in the request: "/lights/1/flux_w"
    std::optional<std::uint64_t> line;  ///< place in a text file, from 1
    std::optional<std::uint64_t> byte;  ///< place in a binary file, from 0

    /// The same error seen from further out: `prefix` is where the caller stands.
    Error at(const std::string& prefix) &&
    {
        pointer.insert(0, prefix);
        return std::move(*this);
    }
};

/// A value or an Error: a small stand-in for std::expected (absent in g++ 12), same member names.
template <class T>
class [[nodiscard]] Result {
  public:
    using value_type = T;
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT: as expected
    Result(Error error)
        : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: as expected

    bool has_value() const { return state_.index() == 0; }
    explicit operator bool() const { return has_value(); }
    T& value() & { return *this->operator->(); }
    const T& value() const& { return *this->operator->(); }
    T&& value() && { return std::move(*this->operator->()); }
    T& operator*() & { return *this->operator->(); }
    const T& operator*() const& { return *this->operator->(); }
    T&& operator*() && { return std::move(*this->operator->()); }
    T* operator->()
    {
        assert(has_value());
        return std::get_if<0>(&state_);
    }
    const T* operator->() const
    {
        assert(has_value());
        return std::get_if<0>(&state_);
    }
    const Error& error() const&
    {
        assert(!has_value());
        return *std::get_if<1>(&state_);
    }
    Error&& error() &&
    {
        assert(!has_value());
        return std::move(*std::get_if<1>(&state_));
    }

    /// f(value) if there is one (f returns a Result), else the error.
    template <class F>
    auto and_then(F&& f) && -> std::invoke_result_t<F, T&&>
    {
        if (!has_value()) { return std::move(*this).error(); }
        return std::forward<F>(f)(std::move(*this).value());
    }

    /// f(value) wrapped again if there is one, else the error.
    template <class F>
    auto transform(F&& f) && -> Result<std::invoke_result_t<F, T&&>>
    {
        if (!has_value()) { return std::move(*this).error(); }
        return std::forward<F>(f)(std::move(*this).value());
    }

  private:
    std::variant<T, Error> state_;
};

/// A Result with nothing to say when all is well.
struct Done {};

}  // namespace relight
