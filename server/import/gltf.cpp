#include "server/import/gltf.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/geometry/precision.h"
#include "server/import/gltf_accessor.h"
#include "server/import/gltf_file.h"
#include "server/import/gltf_look.h"
#include "server/import/gltf_place.h"
#include "server/import/gltf_plan.h"
#include "server/import/gltf_scene.h"

namespace relight {
namespace gltf {
namespace {

/// Takes a skin's mesh where its joints are at rest: joint to world, after the inverse bind matrix.
std::vector<Affine> joints_at_rest(File& file, const Node& skin, const SceneGraph& scene)
{
    const std::vector<std::uint64_t> joints = skin.indices("joints");
    const std::string where = skin.where() + "/inverseBindMatrices";
    std::vector<float> inverse;
    if (const auto index = skin.index("inverseBindMatrices")) {
        const Accessor found = accessor(file, *index, where);
        if (found.layout.columns != 4 || found.count != joints.size()) {
            refuse(Fault::MalformedBody, where, "must have one MAT4 a joint");
        }
        inverse = floats(found);
    }
    std::vector<Affine> result;
    result.reserve(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) {
        file.element("nodes", joints[i], skin.where() + "/joints");
        result.push_back(scene.to_world[joints[i]]);
        if (inverse.empty()) { continue; }
        std::array<double, 16> columns{};
        std::copy_n(inverse.begin() + static_cast<std::ptrdiff_t>(16 * i), 16, columns.begin());
        result.back() = compose(result.back(), from_columns(columns, where));
    }
    if (result.empty()) { refuse(Fault::MalformedBody, skin.where(), "needs at least one joint"); }
    return result;
}

/// Weights of the node's morph targets: its own, else its mesh's; none: all 0.
std::vector<double> weights_at_rest(const Node& node, const Node& mesh, std::size_t targets)
{
    if (targets == 0) { return {}; }
    auto weights = node.numbers("weights", targets);
    if (!weights) { weights = mesh.numbers("weights", targets); }
    return weights ? *std::move(weights) : std::vector<double>{};
}

Place place_of(File& file, const Plan& plan, const Plan::Piece& piece, const SceneGraph& scene)
{
    const Node node = file.root().item("nodes", piece.node);
    const Node mesh = file.root().item("meshes", piece.mesh);
    Place place{node.where(), piece.to_world, {}, {}, piece.first_vertex, piece.first_face};
    // An instance is where its own matrix says: EXT_mesh_gpu_instancing knows no skins.
    const auto skin = node.index("skin");
    if (skin && !node.extension("EXT_mesh_gpu_instancing")) {
        place.joints =
            joints_at_rest(file, file.element("skins", *skin, node.where() + "/skin"), scene);
    }
    place.weights = weights_at_rest(node, mesh, plan.shape(piece).targets);
    return place;
}

template <class Member>
bool any_has(const Plan& plan, Member PrimitiveShape::*member)
{
    return std::any_of(plan.pieces.begin(), plan.pieces.end(), [&](const Plan::Piece& piece) {
        return static_cast<bool>(plan.shape(piece).*member);
    });
}

/// Arrays for all vertices and faces; filled with what a primitive without the attribute has.
void allocate(const Plan& plan, Mesh& mesh)
{
    mesh.positions.resize(plan.vertices);
    if (any_has(plan, &PrimitiveShape::normals)) { mesh.normals.resize(plan.vertices); }
    if (any_has(plan, &PrimitiveShape::tangents)) { mesh.tangents.resize(plan.vertices); }
    if (any_has(plan, &PrimitiveShape::colors)) {
        mesh.colors.resize(plan.vertices, Rgbf{1.0F, 1.0F, 1.0F});
    }
    if (any_has(plan, &PrimitiveShape::uvs)) { mesh.uvs.resize(plan.vertices); }
    if (any_has(plan, &PrimitiveShape::uvs_1)) { mesh.uvs_1.resize(plan.vertices); }
    mesh.faces.indices.resize(3 * plan.faces);
    mesh.face_materials.resize(plan.faces);
}

/// Each primitive is unpacked once, however many nodes show it.
void fill(File& file, const Plan& plan, const SceneGraph& scene, std::uint32_t default_material,
          Mesh& mesh)
{
    std::vector<const Plan::Piece*> by_primitive;
    by_primitive.reserve(plan.pieces.size());
    for (const Plan::Piece& piece : plan.pieces) { by_primitive.push_back(&piece); }
    const auto key = [](const Plan::Piece* piece) {
        return std::tuple(piece->mesh, piece->primitive, piece->first_vertex);
    };
    std::sort(by_primitive.begin(), by_primitive.end(),
              [&](const auto* a, const auto* b) { return key(a) < key(b); });
    Primitive primitive;
    const Plan::Piece* read = nullptr;
    for (const Plan::Piece* const piece : by_primitive) {
        const PrimitiveShape& shape = plan.shape(*piece);
        if (read == nullptr || read->mesh != piece->mesh || read->primitive != piece->primitive) {
            primitive = {};
            primitive = read_primitive(
                file, file.root().item("meshes", piece->mesh).item("primitives", piece->primitive),
                shape);
            read = piece;
        }
        put(primitive, place_of(file, plan, *piece, scene), mesh);
        const auto faces =
            mesh.face_materials.begin() + static_cast<std::ptrdiff_t>(piece->first_face);
        std::fill_n(faces, shape.faces, shape.material.value_or(default_material));
    }
}

/// The file's materials, and glTF's default one if some face has none; its index.
std::uint32_t set_materials(Look& look, const Plan& plan, Asset& asset)
{
    Mesh& mesh = asset.mesh;
    mesh.materials = std::move(look.names);
    mesh.maps = std::move(look.maps);
    mesh.textures = std::move(look.textures);
    asset.materials = std::move(look.materials);
    const bool needed =
        mesh.materials.empty() ||
        std::any_of(plan.pieces.begin(), plan.pieces.end(), [&](const Plan::Piece& piece) {
            return plan.shape(piece).faces > 0 && !plan.shape(piece).material;
        });
    if (needed) {
        std::string name = "default";
        while (std::find(mesh.materials.begin(), mesh.materials.end(), name) !=
               mesh.materials.end()) {
            name += '_';
        }
        if (mesh.maps.size() == mesh.materials.size()) { mesh.maps.emplace_back(); }
        mesh.materials.push_back(std::move(name));
        asset.materials.emplace_back();
    }
    // COLOR_0 multiplies the base colour; it is 1 where a primitive has none.
    for (MetallicRoughness& material : asset.materials) {
        material.base_color_from_vertex = any_has(plan, &PrimitiveShape::colors);
    }
    return static_cast<std::uint32_t>(mesh.materials.size() - 1);
}

std::vector<Light> read_lights(const File& file, const SceneGraph& scene)
{
    std::vector<Light> lights;
    for (const std::uint32_t at : scene.shown) {
        const auto light = file.root().item("nodes", at).extension("KHR_lights_punctual");
        if (!light) { continue; }
        const Node index = light->at("light");
        lights.push_back(
            read_light(file, light->count("light", 0), index.where(), scene.to_world[at]));
    }
    return lights;
}

/// What was read otherwise than filed, or passed over; beyond what `notes` say already.
void add_notes(const File& file, const Plan& plan, std::vector<std::string>& notes)
{
    constexpr std::size_t most_named = 16;
    std::size_t points = 0, lines = 0, flat = 0, triangles = 0, left_over = 0;
    bool morphs = false, skins = false;
    for (const Plan::Piece& piece : plan.pieces) {
        const PrimitiveShape& shape = plan.shape(piece);
        points += shape.drawn == Drawn::Points ? 1 : 0;
        lines += shape.drawn == Drawn::Lines ? 1 : 0;
        triangles += shape.drawn == Drawn::Triangles ? 1 : 0;
        flat += shape.drawn == Drawn::Triangles && !shape.normals ? 1 : 0;
        left_over += shape.left_over;
        morphs = morphs || shape.targets > 0;
        skins = skins || file.root().item("nodes", piece.node).has("skin");
    }
    const auto note_if = [&](std::size_t count, std::string_view text, std::string_view what) {
        if (count > 0) {
            notes.push_back(std::string(text) + " (" + std::string(what) + ": " +
                            std::to_string(count) + ")");
        }
    };
    note_if(lines, "lines keep their vertices and add no faces", "primitives");
    if (triangles > 0) { note_if(points, "points beside triangles cast no shadows", "primitives"); }
    note_if(flat, "normals are computed smooth where glTF asks for flat ones: none filed",
            "primitives");
    note_if(left_over, "corners behind the last whole triangle are passed over", "corners");
    if (morphs) { notes.emplace_back("morph targets are added with the weights the file has"); }
    if (skins) { notes.emplace_back("skins are shown at rest, where the file has their joints"); }
    std::size_t named = 0;
    for (const Node& used : file.root().items("extensionsUsed")) {
        if (!used.json().is_string()) {
            refuse(Fault::MalformedBody, used.where(), "must be a string");
        }
        const auto& name = used.json().get_ref<const std::string&>();
        const bool said = std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
            return note.find(name) != std::string::npos;
        });
        if (is_supported(name) || said || ++named > most_named) { continue; }
        notes.push_back("the extension " + shown(name) + " is passed over");
    }
}

Asset read_asset(std::span<const std::byte> bytes, const GltfLimits& limits)
{
    File file(bytes);
    const SceneGraph scene = read_scene(file);
    const Plan plan = make_plan(file, scene, limits);
    Look look = read_look(file, limits.pixels);
    Asset asset;
    asset.lights = read_lights(file, scene);
    Mesh& mesh = asset.mesh;
    mesh.format = file.is_glb() ? "glb" : "gltf";
    mesh.notes = std::move(look.notes);
    add_notes(file, plan, mesh.notes);
    const std::uint32_t default_material = set_materials(look, plan, asset);
    allocate(plan, mesh);
    fill(file, plan, scene, default_material, mesh);
    mesh.double_positions = float_loses_text(mesh.positions);
    mesh.pieces.reserve(plan.pieces.size());
    for (const Plan::Piece& piece : plan.pieces) {
        mesh.pieces.push_back({piece.node, piece.primitive, piece.instance,
                               static_cast<std::uint32_t>(piece.first_vertex),
                               static_cast<std::uint32_t>(plan.shape(piece).vertices)});
    }
    return asset;
}

}  // namespace
}  // namespace gltf

Result<Asset> decode_gltf(std::span<const std::byte> file, const GltfLimits& limits)
{
    try {
        return gltf::read_asset(file, limits);
    } catch (gltf::Refusal& refusal) {
        return std::move(refusal.error);
    }
}

}  // namespace relight
