#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace relight_preview {

/// Posts the mesh file with the request to the server's /v1/relight and gives back the lit mesh:
/// PLY with sRGB bytes per vertex. Throws std::runtime_error with the server's own explanation.
std::string fetch_lit_mesh(const std::string& server, const std::string& mesh_file,
                           nlohmann::json request);

}  // namespace relight_preview
