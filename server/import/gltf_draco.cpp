// KHR_draco_mesh_compression, by libdraco.
#include "server/import/gltf_draco.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

namespace relight::gltf {
namespace {

std::optional<Component> component_of(draco::DataType type)
{
    switch (type) {
        case draco::DT_INT8:
            return Component::I8;
        case draco::DT_UINT8:
            return Component::U8;
        case draco::DT_INT16:
            return Component::I16;
        case draco::DT_UINT16:
            return Component::U16;
        case draco::DT_UINT32:
            return Component::U32;
        case draco::DT_FLOAT32:
            return Component::F32;
        default:
            return std::nullopt;  // types that glTF has not
    }
}

/// Null if the bytes are no mesh.
std::unique_ptr<draco::Mesh> decode(std::span<const std::byte> bytes)
{
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    try {
        auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
        return decoded.ok() ? std::move(decoded).value() : nullptr;
    } catch (const std::length_error&) {
        return nullptr;  // counts that no std::vector holds
    }
}

/// The values of one attribute, vertex by vertex. The decoder's maps and buffers are not trusted to
/// fit each other.
std::optional<DracoMesh::Attribute> copy(const draco::PointAttribute& attribute,
                                         std::uint32_t vertices)
{
    const auto component = component_of(attribute.data_type());
    if (!component || attribute.buffer() == nullptr) { return std::nullopt; }
    DracoMesh::Attribute result{*component, attribute.num_components(), {}};
    const std::size_t size = result.width * bytes_of(*component);
    const auto stride = static_cast<std::uint64_t>(attribute.byte_stride());
    const auto offset = static_cast<std::uint64_t>(attribute.byte_offset());
    const std::uint64_t held = attribute.buffer()->data_size();
    const bool mapped = !attribute.is_mapping_identity();
    if (size == 0 || stride < size || stride > held || offset > held || size > held - offset ||
        (mapped && attribute.indices_map_size() < vertices)) {
        return std::nullopt;
    }
    const std::uint64_t values = (held - offset - size) / stride + 1;
    const auto* const data = reinterpret_cast<const std::byte*>(attribute.buffer()->data());
    result.bytes.resize(vertices * size);
    for (std::uint32_t i = 0; i < vertices; ++i) {
        const std::uint64_t value = attribute.mapped_index(draco::PointIndex(i)).value();
        if (value >= values) { return std::nullopt; }
        std::copy_n(data + offset + value * stride, size,
                    result.bytes.begin() + static_cast<std::ptrdiff_t>(i * size));
    }
    return result;
}

}  // namespace

DracoMesh unpack_draco(File& file, const Node& extension, std::uint64_t vertices,
                       std::uint64_t faces)
{
    const Node asked = extension.at("bufferView");
    const auto bytes = file.view(extension.count("bufferView", 0), asked.where()).bytes;
    const std::unique_ptr<draco::Mesh> mesh = decode(bytes);
    if (mesh == nullptr) {
        refuse(Fault::MalformedBody, extension.where(), "the Draco data are corrupt, or no mesh");
    }
    if (mesh->num_points() != vertices || mesh->num_faces() != faces) {
        refuse(Fault::MalformedBody, extension.where(),
               "the Draco data hold " + std::to_string(mesh->num_points()) + " vertices and " +
                   std::to_string(mesh->num_faces()) + " faces, and the accessors say " +
                   std::to_string(vertices) + " and " + std::to_string(faces));
    }
    DracoMesh result;
    result.indices.reserve(3 * faces);
    for (std::uint32_t f = 0; f < mesh->num_faces(); ++f) {
        for (const draco::PointIndex& corner : mesh->face(draco::FaceIndex(f))) {
            if (corner.value() >= vertices) {
                refuse(Fault::IndexOutOfRange, extension.where(),
                       "face " + std::to_string(f) + " of the Draco data names vertex " +
                           std::to_string(corner.value()) + " of " + std::to_string(vertices));
            }
            result.indices.push_back(corner.value());
        }
    }
    const Node attributes = extension.at("attributes");
    if (!attributes.json().is_object()) {
        refuse(Fault::MalformedBody, attributes.where(), "must be an object");
    }
    for (const auto& [name, ignored] : attributes.json().items()) {
        const std::uint64_t id = attributes.count(name, 0);
        const draco::PointAttribute* const attribute =
            id > std::numeric_limits<std::uint32_t>::max()
                ? nullptr
                : mesh->GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
        auto values = attribute == nullptr ? std::nullopt : copy(*attribute, mesh->num_points());
        if (!values) {
            refuse(Fault::MalformedBody, attributes.where(),
                   "the Draco data have no usable attribute " + std::to_string(id) +
                       ", which stands for " + shown(name));
        }
        result.attributes.emplace(name, *std::move(values));
    }
    return result;
}

}  // namespace relight::gltf
