#include "server/import/gltf_primitive.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <utility>

#include "server/import/gltf_accessor.h"
#include "server/import/gltf_draco.h"

namespace relight::gltf {
namespace {

constexpr std::string_view draco_name = "KHR_draco_mesh_compression";

enum Mode : std::uint64_t { points_mode, triangles_mode = 4, strip_mode, fan_mode };

std::uint64_t mode_of(const Node& primitive)
{
    const std::uint64_t mode = primitive.count("mode", triangles_mode);
    if (mode > fan_mode) {
        refuse(Fault::OutOfRange, primitive.where() + "/mode",
               "is " + std::to_string(mode) + ", and must be from 0 to 6");
    }
    return mode;
}

/// The attributes of a primitive or of a morph target, each of which has one element a vertex.
class Attributes {
  public:
    Attributes(File& file, const Node& object, std::uint64_t vertices,
               const DracoMesh* unpacked = nullptr)
        : file_(file), object_(object), vertices_(vertices), unpacked_(unpacked)
    {
    }

    bool has(const std::string& name) const { return object_.has(name); }

    /// Nothing if the primitive does not have it. Its values lie in the file, or in `unpacked`.
    std::optional<Accessor> find(const std::string& name, std::size_t least, std::size_t most) const
    {
        const auto index = object_.index(name);
        if (!index) { return std::nullopt; }
        const std::string where = object_.where() + "/" + name;
        Accessor result = accessor(file_, *index, where);
        Layout& layout = result.layout;
        if (layout.columns != 1 || layout.rows < least || layout.rows > most) {
            refuse(Fault::MalformedBody, where,
                   "must have " + std::to_string(least) +
                       (most > least ? " or " + std::to_string(most) : "") + " numbers a vertex");
        }
        if (result.count != vertices_) {
            refuse(Fault::MalformedBody, where,
                   "has " + std::to_string(result.count) + " elements, and the positions have " +
                       std::to_string(vertices_));
        }
        if (unpacked_ == nullptr) { return result; }
        const auto found = unpacked_->attributes.find(name);
        if (found == unpacked_->attributes.end()) { return result; }
        if (found->second.width != layout.rows || result.sparse) {
            refuse(Fault::MalformedBody, where, "does not fit its Draco data");
        }
        layout.component = found->second.component;
        layout.stride = layout.element_bytes();
        layout.bytes = found->second.bytes;
        return result;
    }

    std::vector<float> numbers(const std::string& name, std::size_t width) const
    {
        const auto found = find(name, width, width);
        return found ? floats(*found) : std::vector<float>{};
    }

    /// Integers that can only mean [0, 1], whether or not the accessor remembers to say so.
    std::vector<float> fractions(const std::string& name, std::size_t least, std::size_t most,
                                 std::size_t& width) const
    {
        auto found = find(name, least, most);
        if (!found) { return {}; }
        found->layout.normalized = true;
        if (found->sparse) { found->sparse->values.normalized = true; }
        width = found->layout.rows;
        return floats(*found);
    }

  private:
    File& file_;
    Node object_;
    std::uint64_t vertices_;
    const DracoMesh* unpacked_;
};

/// Corners of triangles from those of a list, strip or fan.   glTF 2.0, 3.7.2.1
std::vector<std::uint32_t> as_triangles(std::vector<std::uint32_t> corners, std::uint64_t mode,
                                        std::uint64_t faces)
{
    if (mode == triangles_mode) {
        corners.resize(3 * faces);
        return corners;
    }
    std::vector<std::uint32_t> result;
    result.reserve(3 * faces);
    for (std::uint64_t i = 0; i < faces; ++i) {
        if (mode == strip_mode) {  // every other triangle of a strip is wound the other way round
            const std::uint64_t odd = i % 2;
            for (const std::uint64_t at : {i, i + 1 + odd, i + 2 - odd}) {
                result.push_back(corners[at]);
            }
        } else {
            for (const std::uint64_t at : {i + 1, i + 2, std::uint64_t{0}}) {
                result.push_back(corners[at]);
            }
        }
    }
    return result;
}

std::vector<std::uint32_t> corners_of(File& file, const Node& primitive, std::uint64_t vertices)
{
    std::vector<std::uint32_t> corners;
    const auto index = primitive.index("indices");
    if (!index) {
        corners.resize(vertices);
        for (std::uint32_t i = 0; std::uint32_t & corner : corners) { corner = i++; }
        return corners;
    }
    const std::string where = primitive.where() + "/indices";
    corners = integers(accessor(file, *index, where));
    std::uint32_t greatest = 0;
    for (const std::uint32_t i : corners) { greatest = std::max(greatest, i); }
    if (greatest < vertices) { return corners; }
    const auto bad = std::find_if(corners.begin(), corners.end(),
                                  [&](std::uint32_t i) { return i >= vertices; });
    refuse(Fault::IndexOutOfRange, where,
           "element " + std::to_string(bad - corners.begin()) + " names vertex " +
               std::to_string(*bad) + " of " + std::to_string(vertices) +
               " (from 0; glTF has no primitive restart)");
}

/// JOINTS_0, WEIGHTS_0, JOINTS_1 ... side by side.
void read_influences(const Attributes& attributes, std::uint64_t vertices, Primitive& result)
{
    constexpr std::size_t width = 4;
    std::size_t sets = 0;
    while (attributes.has("JOINTS_" + std::to_string(sets))) { ++sets; }
    result.influences = width * sets;
    result.joints.resize(vertices * result.influences);
    result.weights.resize(vertices * result.influences);
    for (std::size_t set = 0; set < sets; ++set) {
        const std::string number = std::to_string(set);
        std::size_t ignored = 0;
        const auto joints = integers(*attributes.find("JOINTS_" + number, width, width));
        const auto weights = attributes.fractions("WEIGHTS_" + number, width, width, ignored);
        for (std::uint64_t i = 0; i < (weights.empty() ? 0 : vertices); ++i) {
            for (std::size_t k = 0; k < width; ++k) {
                const std::size_t to = i * result.influences + width * set + k;
                result.joints[to] = joints[i * width + k];
                result.weights[to] = std::max(weights[i * width + k], 0.0F);
            }
        }
    }
}

std::vector<float> read_colors(const Attributes& attributes, std::uint64_t vertices)
{
    std::size_t width = 0;
    const std::vector<float> filed = attributes.fractions("COLOR_0", 3, 4, width);
    std::vector<float> colors;
    if (filed.empty()) { return colors; }
    colors.resize(3 * vertices);
    for (std::uint64_t i = 0; i < vertices; ++i) {
        for (std::size_t band = 0; band < 3; ++band) {
            colors[3 * i + band] = std::clamp(filed[i * width + band], 0.0F, 1.0F);
        }
    }
    return colors;
}

}  // namespace

PrimitiveShape primitive_shape(File& file, const Node& primitive)
{
    const Node attributes = primitive.at("attributes");
    const Node positions = attributes.at("POSITION");
    PrimitiveShape shape;
    shape.vertices = accessor(file, attributes.count("POSITION", 0), positions.where()).count;
    shape.normals = attributes.has("NORMAL");
    shape.tangents = attributes.has("TANGENT");
    shape.colors = attributes.has("COLOR_0");
    shape.uvs = attributes.has("TEXCOORD_0");
    shape.uvs_1 = attributes.has("TEXCOORD_1");
    shape.targets = primitive.size("targets");
    if (const auto material = primitive.index("material")) {
        file.element("materials", *material, primitive.where() + "/material");
        shape.material = static_cast<std::uint32_t>(*material);
    }
    const std::uint64_t mode = mode_of(primitive);
    if (mode < triangles_mode) {
        shape.drawn = mode == points_mode ? Drawn::Points : Drawn::Lines;
        return shape;
    }
    shape.drawn = Drawn::Triangles;
    const auto index = primitive.index("indices");
    const std::uint64_t corners =
        index ? accessor(file, *index, primitive.where() + "/indices").count : shape.vertices;
    if (mode == triangles_mode) {
        shape.faces = corners / 3;
        shape.left_over = corners % 3;
    } else {
        shape.faces = corners < 3 ? 0 : corners - 2;
        shape.left_over = corners < 3 ? corners : 0;
    }
    return shape;
}

Primitive read_primitive(File& file, const Node& primitive, const PrimitiveShape& shape)
{
    std::optional<DracoMesh> unpacked;
    if (const auto extension = primitive.extension(draco_name)) {
        if (mode_of(primitive) != triangles_mode) {
            refuse(Fault::NotAvailable, primitive.where() + "/mode",
                   "must be 4 (triangles) where Draco compresses; export it as triangles");
        }
        unpacked = unpack_draco(file, *extension, shape.vertices, shape.faces);
    }
    const Attributes attributes(file, primitive.at("attributes"), shape.vertices,
                                unpacked ? &*unpacked : nullptr);
    Primitive result;
    result.positions = attributes.numbers("POSITION", 3);
    result.normals = attributes.numbers("NORMAL", 3);
    result.tangents = attributes.numbers("TANGENT", 4);
    result.uvs = attributes.numbers("TEXCOORD_0", 2);
    result.uvs_1 = attributes.numbers("TEXCOORD_1", 2);
    result.colors = read_colors(attributes, shape.vertices);
    read_influences(attributes, shape.vertices, result);
    for (const Node& target : primitive.items("targets")) {
        const Attributes moved(file, target, shape.vertices);
        result.targets.push_back({moved.numbers("POSITION", 3), moved.numbers("NORMAL", 3),
                                  moved.numbers("TANGENT", 3)});
    }
    if (unpacked) {
        result.indices = std::move(unpacked->indices);
    } else if (shape.drawn == Drawn::Triangles) {
        result.indices = as_triangles(corners_of(file, primitive, shape.vertices),
                                      mode_of(primitive), shape.faces);
    }
    return result;
}

}  // namespace relight::gltf
