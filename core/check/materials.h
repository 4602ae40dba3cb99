#pragma once

#include <string>
#include <vector>

#include "core/bsdf/material.h"

namespace relight {

struct NamedMaterial {
    std::string name;
    Material value;
};

/// Every model with all its lobes, but for what the texts themselves make one-way (glTF's clear
/// coat takes its Fresnel from the eye alone).
std::vector<NamedMaterial> reciprocal_materials();

}  // namespace relight
