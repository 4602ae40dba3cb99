#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace relight::gltf_answer {

using Json = nlohmann::json;

/// Thrown where a file is not the one that the mesh came from.
struct Mismatch {};
/// Thrown where the file cannot be answered as glTF; says why.
struct Declined {
    std::string detail;
};

/// A count or an index of a file's JSON.
std::uint64_t whole(const Json& number);
/// Element `index` of the array `key`.
const Json& element(const Json& root, std::string_view key, std::uint64_t index);

/// Reads the transforms of EXT_mesh_gpu_instancing, of a file whose binary chunk is `binary`. They
/// must lie there plainly: nothing in the server unpacks what a client compressed.
class InstanceReader {
  public:
    InstanceReader(const Json& root, std::string_view binary) : root_(root), binary_(binary) {}

    /// A node's instances as the members "translation", "rotation" and "scale" of nodes of their
    /// own. There are `count` of them; throws Mismatch if the file says otherwise.
    std::vector<Json> nodes(const Json& extension, std::size_t count);

  private:
    std::string_view buffer(std::uint64_t index);
    std::vector<double> rows(std::uint64_t accessor, std::size_t components, std::size_t count);

    const Json& root_;
    std::string_view binary_;
    std::unordered_map<std::uint64_t, std::string> decoded_;  ///< buffers out of data URIs
};

}  // namespace relight::gltf_answer
