#include "server/import/gltf_plan.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "server/import/gltf_accessor.h"

namespace relight::gltf {
namespace {

/// The accessors of EXT_mesh_gpu_instancing that move something.
struct Instancing {
    std::string where;
    std::uint64_t count = 1;
    std::optional<Accessor> translation, rotation, scale;
};

Instancing read_instancing(File& file, const Node& extension)
{
    const Node attributes = extension.at("attributes");
    Instancing result;
    result.where = attributes.where();
    bool first = true;
    const auto read = [&](const std::string& name, std::size_t width) {
        const auto index = attributes.index(name);
        if (!index) { return std::optional<Accessor>{}; }
        const std::string where = attributes.where() + "/" + name;
        Accessor found = accessor(file, *index, where);
        if (found.layout.columns != 1 || found.layout.rows != width ||
            (!first && found.count != result.count)) {
            refuse(Fault::MalformedBody, where,
                   "must have " + std::to_string(width) +
                       " numbers an instance, and as many instances as the others");
        }
        first = false;
        result.count = found.count;
        return std::optional(std::move(found));
    };
    result.translation = read("TRANSLATION", 3);
    result.rotation = read("ROTATION", 4);
    result.scale = read("SCALE", 3);
    return result;
}

std::vector<Affine> unfold(const Instancing& instancing, const Affine& to_world)
{
    const auto numbers = [](const std::optional<Accessor>& accessor) {
        return accessor ? floats(*accessor) : std::vector<float>{};
    };
    const auto translations = numbers(instancing.translation);
    const auto rotations = numbers(instancing.rotation), scales = numbers(instancing.scale);
    std::vector<Affine> result;
    result.reserve(instancing.count);
    for (std::size_t i = 0; i < instancing.count; ++i) {
        std::array<double, 3> translation{}, scale{1, 1, 1};
        std::array<double, 4> rotation{0, 0, 0, 1};
        for (std::size_t k = 0; k < 3 && !translations.empty(); ++k) {
            translation[k] = translations[3 * i + k];
        }
        for (std::size_t k = 0; k < 4 && !rotations.empty(); ++k) {
            rotation[k] = rotations[4 * i + k];
        }
        for (std::size_t k = 0; k < 3 && !scales.empty(); ++k) { scale[k] = scales[3 * i + k]; }
        result.push_back(compose(
            to_world, from_trs(translation, rotation, scale, instancing.where + "/ROTATION")));
    }
    return result;
}

/// `total` + `count` `times` over, if that is at most `limit`.
std::optional<std::uint64_t> add(std::uint64_t total, std::uint64_t count, std::uint64_t times,
                                 std::uint64_t limit)
{
    if (count > 0 && times > (limit - total) / count) { return std::nullopt; }
    return total + count * times;
}

}  // namespace

Plan make_plan(File& file, const SceneGraph& scene, const GltfLimits& limits)
{
    constexpr std::uint64_t most_indexed = std::numeric_limits<std::uint32_t>::max();
    const std::uint64_t most_vertices = std::min(limits.vertices, most_indexed);
    const std::uint64_t most_faces = std::min(limits.faces, most_indexed);
    Plan plan;
    for (const std::uint32_t at : scene.shown) {
        const Node node = file.root().item("nodes", at);
        const auto index = node.index("mesh");
        if (!index) { continue; }
        const Node mesh = file.element("meshes", *index, node.where() + "/mesh");
        const auto number = static_cast<std::uint32_t>(*index);
        const auto [found, is_new] = plan.meshes.try_emplace(number);
        std::vector<PrimitiveShape>& shapes = found->second;
        if (is_new) {
            for (const Node& primitive : mesh.items("primitives")) {
                shapes.push_back(primitive_shape(file, primitive));
            }
        }
        if (shapes.empty()) { continue; }
        const auto extension = node.extension("EXT_mesh_gpu_instancing");
        const Instancing instancing = extension ? read_instancing(file, *extension) : Instancing{};
        std::uint64_t vertices = plan.vertices, faces = plan.faces;
        for (const PrimitiveShape& shape : shapes) {
            const auto more = add(vertices, shape.vertices, instancing.count, most_vertices);
            if (!more) {
                refuse(Fault::TooManyVertices, node.where(),
                       "with it the scene has more than " + std::to_string(most_vertices) +
                           " vertices, instances unfolded; that is the limit");
            }
            vertices = *more;
            const auto more_faces = add(faces, shape.faces, instancing.count, most_faces);
            if (!more_faces) {
                refuse(Fault::TooManyFaces, node.where(),
                       "with it the scene has more than " + std::to_string(most_faces) +
                           " faces, instances unfolded; that is the limit");
            }
            faces = *more_faces;
        }
        const std::vector<Affine> places = unfold(instancing, scene.to_world[at]);
        for (std::uint32_t instance = 0; instance < places.size(); ++instance) {
            for (std::uint32_t primitive = 0; primitive < shapes.size(); ++primitive) {
                plan.pieces.push_back(
                    {at, number, primitive, instance, places[instance], plan.vertices, plan.faces});
                plan.vertices += shapes[primitive].vertices;
                plan.faces += shapes[primitive].faces;
            }
        }
    }
    if (plan.vertices == 0) {
        refuse(Fault::NoGeometry, "", "has a scene whose nodes show no mesh with vertices");
    }
    return plan;
}

}  // namespace relight::gltf
