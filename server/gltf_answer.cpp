#include "server/gltf_answer.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/io/glb_parts.h"
#include "server/gltf_instances.h"

namespace relight {
namespace gltf_answer {
namespace {

constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// A client's file taken apart. Text is all JSON.
struct Container {
    std::string_view json;
    std::optional<std::string_view> binary;  ///< the BIN chunk's data
    std::string_view rest;                   ///< chunks behind it, heads included
};

std::uint32_t u32_at(std::string_view file, std::size_t at)
{
    std::uint32_t number = 0;
    if (file.size() < at + sizeof(number)) { throw Mismatch{}; }
    std::memcpy(&number, file.data() + at, sizeof(number));
    return number;
}

Container opened(std::string_view file)
{
    if (!file.starts_with("glTF")) { return {file, {}, {}}; }
    constexpr std::size_t file_head = 12, chunk_head = 8;
    file = file.substr(0, u32_at(file, 8));
    const auto chunk = [&](std::size_t at) {
        const std::size_t length = u32_at(file, at);
        if (file.size() < at + chunk_head + length) { throw Mismatch{}; }
        return file.substr(at + chunk_head, length);
    };
    Container parts{chunk(file_head), {}, {}};
    std::size_t at = file_head + chunk_head + parts.json.size();
    if (file.size() >= at + chunk_head && file.substr(at + 4, 4) == std::string_view("BIN", 4)) {
        parts.binary = chunk(at);
        at += chunk_head + parts.binary->size();
    }
    parts.rest = file.substr(std::min(at, file.size()));
    return parts;
}

/// The JSON, no deeper than the importer lets through: copying it and writing it recurse.
Json parsed(std::string_view text)
{
    constexpr int deepest = 64;
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') { ++i; }
            in_string = c != '"';
            continue;
        }
        in_string = c == '"';
        if (c == '{' || c == '[') { ++depth; }
        if (c == '}' || c == ']') { --depth; }
        if (depth > deepest) { throw Mismatch{}; }
    }
    return Json::parse(text);
}

/// A node and the number of its instance, 0 where it has none: what shows a mesh.
using Showing = std::pair<std::uint32_t, std::uint32_t>;

/// Gives each showing of a mesh one that is its own, by copying (accessors stay shared) and by
/// unfolding instances into nodes.
class Owners {
  public:
    Owners(Json& root, std::string_view binary, const std::vector<GltfPiece>& pieces)
        : root_(root), instances_(root, binary)
    {
        for (const GltfPiece& piece : pieces) {
            auto& count = counts_[piece.node];
            count = std::max(count, piece.instance + 1ULL);
            if (count > pieces.size()) { throw Mismatch{}; }
        }
    }

    /// The mesh of a showing, as an index into /meshes.
    std::uint64_t mesh_of(Showing showing)
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

    /// The extension's name goes with its last use.
    void forget_instancing()
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

  private:
    /// The mesh itself for the first who asks; a copy for each later one.
    std::uint64_t own(std::uint64_t mesh)
    {
        const Json& original = element(root_, "meshes", mesh);
        if (taken_.insert(mesh).second) { return mesh; }
        const auto [size, is_new] = sizes_.try_emplace(mesh, 0);
        if (is_new) { size->second = original.dump().size(); }
        copied_ += size->second;
        constexpr std::size_t most_copied = std::size_t{1} << 26U;  // of text; ten times in memory
        if (copied_ > most_copied) {
            throw Declined{
                "a mesh is copied for each node and instance that shows it, and this file's copies "
                "would take more than 64 MiB of JSON; ask for another format (\"ply\", \"vtp\", "
                "\"npz\")"};
        }
        Json copy = original;  // pushing moves the original
        root_["meshes"].push_back(std::move(copy));
        return root_["meshes"].size() - 1;
    }

    /// A child for each instance, with a mesh of its own.
    void unfold(std::uint32_t parent)
    {
        Json node = root_["nodes"][parent];
        const std::size_t count = counts_.at(parent);
        std::vector<Json> children = instances_.nodes(node["extensions"][instancing], count);
        const std::uint64_t mesh = whole(node.at("mesh"));
        node.erase("mesh");
        node["extensions"].erase(instancing);
        if (node["extensions"].empty()) { node.erase("extensions"); }
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

    Json& root_;
    InstanceReader instances_;
    std::map<std::uint32_t, std::uint64_t> counts_;  ///< instances of each node
    std::map<Showing, std::uint64_t> meshes_;
    std::set<std::uint64_t> taken_;
    std::map<std::uint64_t, std::size_t> sizes_;  ///< of a mesh's JSON as text
    std::size_t copied_ = 0;
    bool unfolded_ = false;
};

/// Where our bytes begin in buffer 0. One with a uri, or one that is not there, cannot grow: then
/// a new one comes before it.
std::uint64_t start_of_ours(Json& root, const Container& file)
{
    Json& buffers = root["buffers"];
    if (file.binary && !buffers.empty() && !buffers.at(0).contains("uri")) {
        const std::uint64_t length = whole(buffers[0].at("byteLength"));
        if (length > file.binary->size()) { throw Mismatch{}; }
        return length;
    }
    if (buffers.is_null()) { buffers = Json::array(); }
    buffers.insert(buffers.begin(), Json::object());
    if (!root.contains("bufferViews")) { return 0; }
    for (Json& view : root["bufferViews"]) {
        view.at("buffer") = whole(view.at("buffer")) + 1;
        if (!view.contains("extensions")) { continue; }
        for (Json& extension : view["extensions"]) {  // EXT_meshopt_compression and its kin
            if (extension.contains("buffer")) {
                extension["buffer"] = whole(extension["buffer"]) + 1;
            }
        }
    }
    return 0;
}

/// An attribute of all vertices: the pieces' accessors share its view.
struct Column {
    Quantity3 attribute;
    std::size_t view;
};

void set_attributes(Json& root, const GltfPiece& piece, std::uint64_t mesh,
                    const std::vector<Column>& columns)
{
    Json& primitive = root["meshes"].at(mesh).at("primitives").at(piece.primitive);
    Json& attributes = primitive.at("attributes");
    const Json& positions = element(root, "accessors", whole(attributes.at("POSITION")));
    if (whole(positions.at("count")) != piece.vertices) { throw Mismatch{}; }
    for (const Column& column : columns) {
        const std::string& name = column.attribute.name;
        const auto row = static_cast<std::uint64_t>(column.attribute.components) * sizeof(float);
        attributes[name] = root["accessors"].size();
        root["accessors"].push_back({{"bufferView", column.view},
                                     {"byteOffset", row * piece.first_vertex},
                                     {"componentType", glb::f32},
                                     {"count", piece.vertices},
                                     {"type", glb::type_name(column.attribute.components)}});
        // What Draco packed would come out instead.
        const Json::json_pointer packed("/extensions/KHR_draco_mesh_compression/attributes");
        if (primitive.contains(packed)) { primitive[packed].erase(name); }
    }
}

void add_comments(Json& root, const std::vector<std::string>& comments)
{
    Json& extras = root.at("asset")["extras"];
    if (!comments.empty() && (extras.is_null() || extras.is_object())) {
        extras["relight"] = comments;
    }
    if (extras.is_null()) { root["asset"].erase("extras"); }
}

std::string added(const Container& file, const LitMesh& lit)
{
    const std::size_t vertices = lit.mesh.positions.size();
    const std::vector<float> linear = glb::linear_colors(lit.color);
    std::vector<Quantity3> attributes = glb::attributes_of(lit.quantities);
    if (!linear.empty()) { attributes.push_back({"COLOR_0", 3, linear}); }

    Json root = parsed(file.json);
    const std::vector<GltfPiece>& pieces = lit.mesh.pieces;
    constexpr std::size_t most_accessors = 1'000'000;
    if (pieces.size() * attributes.size() > most_accessors) {
        throw Declined{"the answer would have more than a million accessors (" +
                       std::to_string(pieces.size()) + " primitives and instances); ask for " +
                       "another format (\"ply\", \"vtp\", \"npz\")"};
    }
    Owners owners(root, file.binary.value_or(std::string_view()), pieces);
    std::vector<std::uint64_t> meshes;
    for (const GltfPiece& piece : pieces) {
        if (piece.first_vertex > vertices || piece.vertices > vertices - piece.first_vertex) {
            throw Mismatch{};
        }
        meshes.push_back(owners.mesh_of({piece.node, piece.instance}));
    }
    owners.forget_instancing();
    add_comments(root, lit.comments);

    std::string_view before = file.binary.value_or(std::string_view());
    std::uint64_t end = before.size();
    std::vector<Column> columns;
    if (!attributes.empty()) {
        before = before.substr(0, start_of_ours(root, file));
        end = (before.size() + 3) / 4 * 4;
        for (Quantity3& attribute : attributes) {
            const std::size_t bytes = attribute.values.size_bytes();
            columns.push_back({std::move(attribute), root["bufferViews"].size()});
            root["bufferViews"].push_back({{"buffer", 0},
                                           {"byteOffset", end},
                                           {"byteLength", bytes},
                                           {"byteStride", bytes / vertices},
                                           {"target", glb::vertex_data}});
            end += bytes;
        }
        root["buffers"][0]["byteLength"] = end;
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        set_attributes(root, pieces[i], meshes[i], columns);
    }

    std::string out = glb::begun(root.dump(), end, file.rest.size());
    if (out.empty()) {
        throw Declined{
            "the answer is larger than 4 GiB, and a GLB cannot be; ask for another format "
            "(\"ply\", "
            "\"vtp\", \"npz\")"};
    }
    out += before;
    out.append((4 - before.size() % 4) % 4, '\0');
    for (const Column& column : columns) {
        out.append(reinterpret_cast<const char*>(column.attribute.values.data()),
                   column.attribute.values.size_bytes());
    }
    return out += file.rest;
}

}  // namespace
}  // namespace gltf_answer

Result<std::string> add_to_gltf(std::span<const std::byte> file, const LitMesh& lit)
{
    const Error not_it{
        Fault::Internal, "the stored glTF is not the one that the mesh came from", {}, {}, {}};
    try {
        return gltf_answer::added(
            gltf_answer::opened({reinterpret_cast<const char*>(file.data()), file.size()}), lit);
    } catch (const gltf_answer::Declined& declined) {
        return Error{Fault::NotAvailable, declined.detail, {}, {}, {}};
    } catch (const gltf_answer::Mismatch&) {
        return not_it;
    } catch (const gltf_answer::Json::exception&) {
        return not_it;
    }
}

}  // namespace relight
