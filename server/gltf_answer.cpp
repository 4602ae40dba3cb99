#include "server/gltf_answer.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "core/io/glb_parts.h"
#include "server/gltf_instances.h"
#include "server/gltf_owners.h"

namespace relight {
namespace gltf_answer {
namespace {

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
    if (file.size() >= at + chunk_head && u32_at(file, at + 4) == glb::binary_chunk) {
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
    std::string name;
    int components;
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
        const std::string& name = column.name;
        const auto row = static_cast<std::uint64_t>(column.components) * sizeof(float);
        attributes[name] = root["accessors"].size();
        root["accessors"].push_back({{"bufferView", column.view},
                                     {"byteOffset", row * piece.first_vertex},
                                     {"componentType", glb::f32},
                                     {"count", piece.vertices},
                                     {"type", glb::type_name(column.components)}});
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

/// What is added: names, components, and all vertices' numbers.
struct Attribute {
    std::string name;
    int components;
    Piece array;
};

std::vector<Attribute> attributes_of(const LitMesh& lit)
{
    std::vector<Attribute> attributes;
    for (Quantity3& quantity : glb::attributes_of(lit.quantities)) {
        attributes.push_back(
            {std::move(quantity.name), quantity.components, span_piece(quantity.values)});
    }
    if (!lit.color.empty()) {
        attributes.push_back(
            {"COLOR_0", 3, rows_piece(lit.color.size(), glb::LinearColors(lit.color))});
    }
    return attributes;
}

Encoding added(const Container& file, const LitMesh& lit)
{
    const std::size_t vertices = lit.mesh.positions.size();
    std::vector<Attribute> attributes = attributes_of(lit);

    Json root = parsed(file.json);
    const std::vector<GltfPiece>& pieces = lit.mesh.pieces;
    constexpr std::size_t most_accessors = 250'000;
    if (pieces.size() * attributes.size() > most_accessors) {
        throw Declined{"the answer would have more than 250000 accessors (" +
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
    if (!attributes.empty()) { before = before.substr(0, start_of_ours(root, file)); }
    std::uint64_t end = (before.size() + 3) / 4 * 4;
    std::vector<Piece> out{span_piece(std::span(before)), glb::padding_behind(before.size())};
    std::vector<Column> columns;
    if (!attributes.empty()) {
        for (Attribute& attribute : attributes) {
            const std::uint64_t bytes = attribute.array.bytes;
            columns.push_back(
                {std::move(attribute.name), attribute.components, root["bufferViews"].size()});
            root["bufferViews"].push_back({{"buffer", 0},
                                           {"byteOffset", end},
                                           {"byteLength", bytes},
                                           {"byteStride", bytes / vertices},
                                           {"target", glb::vertex_data}});
            end += bytes;
            out.push_back(std::move(attribute.array));
        }
        root["buffers"][0]["byteLength"] = end;
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        set_attributes(root, pieces[i], meshes[i], columns);
    }

    std::string head = glb::begun(root.dump(), end, file.rest.size());
    if (head.empty()) {
        throw Declined{
            "the answer is larger than 4 GiB, and a GLB cannot be; ask for another format "
            "(\"ply\", "
            "\"vtp\", \"npz\")"};
    }
    out.insert(out.begin(), text_piece(std::move(head)));
    out.push_back(span_piece(std::span(file.rest)));
    return joined(std::move(out));
}

}  // namespace
}  // namespace gltf_answer

Result<Encoding> add_to_gltf(std::span<const std::byte> file, const LitMesh& lit)
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
