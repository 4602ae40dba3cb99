#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/relight.h"

namespace relight {

/// Refuses what this mesh or the limits cannot serve, before the work starts.
std::optional<Error> check(const RelightRequest& request, Format format, const SetUp& made,
                           const Workshop& workshop);

/// Most rays that the request may cost on a mesh of so many vertices.
double rays_asked(const RelightRequest& request, Format format, const Scene& scene,
                  std::size_t vertices);

/// Refuses fields that the answer's format has no place for.
std::optional<Error> check_format(const Output& output, Format format);

/// Where the light of an answer was asked for: one side of each vertex, or what a camera sees.
enum class Receivers { Vertices, Pixels };

/// What a reader of the answer should know; `clamped` values were beyond single precision.
std::vector<std::string> warnings_of(const Stage& stage, const Scene& scene, std::size_t clamped,
                                     Receivers receivers);

/// Adds that the light of many vertices differs sharply from their neighbours'
/// (core/shade/sharp.h), and which.
void warn_of_thin_shadows(std::vector<std::string>& warnings, const Stage& stage,
                          std::span<const Rgbf> irradiance, unsigned threads, Progress& progress);

}  // namespace relight
