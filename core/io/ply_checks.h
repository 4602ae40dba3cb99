#pragma once

#include <string>
#include <vector>

#include "core/io/ply_header.h"
#include "core/io/readers.h"

namespace relight::ply {

/// Holds what the header announces against the size of the file and the limits, before anything is
/// allocated. Errors: CountExceedsFile, TooManyVertices, TooManyFaces.
Result<Done> check_counts(const Header& header, std::size_t file_size, const ReadLimits& limits);

/// "skipped properties of 'vertex': 'confidence', 'intensity'", or nothing; `used` says which are
/// not.
std::optional<std::string> skipped_note(const Element& element, const std::vector<bool>& used);

/// What is skipped of faces and of other elements, for the mesh's notes.
std::vector<std::string> skipped_notes(const Header& header);

}  // namespace relight::ply
