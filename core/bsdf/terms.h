#pragma once

#include <string>

#include "core/base/rgb.h"

namespace relight {

/// One named factor of f, for people who want to see why: "D", "G2", "F", "diffuse" ... A scalar
/// factor has three equal bands.
struct BsdfTerm {
    std::string name;
    Rgb value;
};

}  // namespace relight
