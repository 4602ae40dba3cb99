#include "server/gltf_owners.h"

#include <algorithm>
#include <string>

namespace relight::gltf_answer {
namespace {

constexpr const char* instancing = "EXT_mesh_gpu_instancing";

}  // namespace

Owners::Owners(Json& root, std::string_view binary, const std::vector<GltfPiece>& pieces)
    : root_(root), instances_(root, binary)
{
    for (const GltfPiece& piece : pieces) {
        auto& count = counts_[piece.node];
        count = std::max<std::uint64_t>(count, piece.instance + 1ULL);
        if (count > pieces.size()) { throw Mismatch{}; }
    }
    const Json& nodes = root.at("nodes");
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {  // other scenes' stay unlit
        if (nodes[n].contains("mesh") && !counts_.contains(n)) {
            taken_.insert(whole(nodes[n]["mesh"]));
        }
    }
}

std::uint64_t Owners::mesh_of(Showing showing)
{
    const auto [at, is_new] = meshes_.try_emplace(showing, 0);
    if (!is_new) { return at->second; }
    const Json& node = element(root_, "nodes", showing.first);
    if (node.contains("extensions") && node["extensions"].contains(instancing)) {
        unfold(showing.first);
    } else if (showing.second == 0) {
        at->second = own(whole(node.at("mesh")));
        root_["nodes"][showing.first]["mesh"] = at->second;
    } else {
        throw Mismatch{};
    }
    return at->second;
}

void Owners::forget_instancing()
{
    if (!unfolded_) { return; }
    for (const Json& node : root_.at("nodes")) {
        if (node.contains("extensions") && node["extensions"].contains(instancing)) { return; }
    }
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
        if (!root_.contains(list)) { continue; }
        Json kept = Json::array();
        for (const Json& name : root_[list]) {
            if (name != instancing) { kept.push_back(name); }
        }
        root_[list] = kept;
        if (kept.empty()) { root_.erase(list); }  // no array of glTF is empty
    }
}

/// A few hundred bytes can ask for many copies of much.
void Owners::spend(std::size_t copied)
{
    copied_ += copied;
    constexpr std::size_t most_copied = std::size_t{1} << 24U;  // of text; ten times in memory
    if (copied_ > most_copied) {
        throw Declined{
            "a mesh is copied for each node and instance that shows it, and this file's copies "
            "would take more than 16 MiB of JSON; ask for another format (\"ply\", \"vtp\", "
            "\"npz\")"};
    }
}

/// The mesh itself for the first who asks; a copy for each later one, and where a node shows it
/// that was not lit.
std::uint64_t Owners::own(std::uint64_t mesh)
{
    const Json& original = element(root_, "meshes", mesh);
    if (taken_.insert(mesh).second) { return mesh; }
    const auto [size, is_new] = sizes_.try_emplace(mesh, 0);
    if (is_new) { size->second = original.dump().size(); }
    spend(size->second);
    Json copy = original;  // pushing moves the original
    root_["meshes"].push_back(std::move(copy));
    return root_["meshes"].size() - 1;
}

/// A child for each instance, with a mesh of its own.
void Owners::unfold(std::uint32_t parent)
{
    Json node = root_["nodes"][parent];
    const std::size_t count = counts_.at(parent);
    std::vector<Json> children = instances_.nodes(node["extensions"][instancing], count);
    const std::uint64_t mesh = whole(node.at("mesh"));
    node.erase("mesh");
    node["extensions"].erase(instancing);
    if (node["extensions"].empty()) { node.erase("extensions"); }
    if (node.contains("weights")) { spend(count * node["weights"].dump().size()); }
    for (std::uint32_t i = 0; i < count; ++i) {
        Json& child = children[i];
        child["mesh"] = meshes_[{parent, i}] = own(mesh);
        for (const char* of_mesh : {"skin", "weights"}) {
            if (node.contains(of_mesh)) { child[of_mesh] = node[of_mesh]; }
        }
        node["children"].push_back(root_["nodes"].size());
        root_["nodes"].push_back(std::move(child));
    }
    node.erase("skin");
    node.erase("weights");
    root_["nodes"][parent] = std::move(node);
    unfolded_ = true;
}

}  // namespace relight::gltf_answer
