#pragma once

#include <memory>
#include <vector>

#include "server/encode.h"

namespace relight {

/// What an answer shows, beside what Transport and Shaded hold as it is sent.
struct Derived {
    std::shared_ptr<const Lit> lit;
    Display display;
    UnsetVector<Rgb8> color;
    std::vector<std::vector<float>> visible;       ///< a light: V, or empty
    std::vector<std::vector<float>> coefficients;  ///< of sh, one by one: V
    std::vector<float> normals;                    ///< V x 3
};

inline constexpr std::size_t sh_coefficients = 9;  ///< a vertex

/// The answer as JSON, member after member. `derived` must outlive it.
Encoding json_answer(const Derived& derived, const Quantities& wanted);

/// Raw arrays, and in their head what else an answer says. `derived` must outlive it.
Encoding fields_answer(const Derived& derived, const Output& output, bool last);

}  // namespace relight
