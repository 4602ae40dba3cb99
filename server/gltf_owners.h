#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/mesh.h"
#include "server/gltf_instances.h"

namespace relight::gltf_answer {

/// A node and the number of its instance, 0 where it has none: what shows a mesh.
using Showing = std::pair<std::uint32_t, std::uint32_t>;

/// Gives each showing of a mesh one that is its own, by copying (accessors stay shared) and by
/// unfolding instances into nodes. All throw Mismatch, Declined or Json::exception.
class Owners {
  public:
    Owners(Json& root, std::string_view binary, const std::vector<GltfPiece>& pieces);

    /// The mesh of a showing, as an index into /meshes.
    std::uint64_t mesh_of(Showing showing);

    /// The name of EXT_mesh_gpu_instancing goes with its last use.
    void forget_instancing();

  private:
    void spend(std::size_t copied);
    std::uint64_t own(std::uint64_t mesh);
    void unfold(std::uint32_t parent);

    Json& root_;
    InstanceReader instances_;
    std::map<std::uint32_t, std::uint64_t> counts_;  ///< instances of each node
    std::map<Showing, std::uint64_t> meshes_;
    std::set<std::uint64_t> taken_;
    std::map<std::uint64_t, std::size_t> sizes_;  ///< of a mesh's JSON as text
    std::size_t copied_ = 0;
    bool unfolded_ = false;
};

}  // namespace relight::gltf_answer
