// EXT_meshopt_compression: views that meshoptimizer unpacks.
#include <meshoptimizer.h>

#include "server/import/gltf_bytes.h"

namespace relight::gltf {
namespace {

using Mode = PackedShape::Mode;
using Filter = PackedShape::Filter;

/// Element sizes that the extension allows.
bool is_stride(const PackedShape& shape)
{
    if (shape.mode != Mode::Attributes) { return shape.stride == 2 || shape.stride == 4; }
    switch (shape.filter) {
        case Filter::Octahedral:
            return shape.stride == 4 || shape.stride == 8;
        case Filter::Quaternion:
            return shape.stride == 8;
        case Filter::None:
        case Filter::Exponential:
            break;
    }
    return shape.stride >= 4 && shape.stride <= 256 && shape.stride % 4 == 0;
}

}  // namespace

PackedShape packed_shape(const Node& extension)
{
    const std::string mode = extension.text("mode");
    const std::string filter = extension.text("filter", "NONE");
    PackedShape shape;
    if (mode == "ATTRIBUTES") {
        shape.mode = Mode::Attributes;
    } else if (mode == "TRIANGLES") {
        shape.mode = Mode::Triangles;
    } else if (mode == "INDICES") {
        shape.mode = Mode::Indices;
    } else {
        refuse(Fault::MalformedBody, extension.where() + "/mode",
               "is " + shown(mode) + ", and must be ATTRIBUTES, TRIANGLES or INDICES");
    }
    if (filter == "NONE") {
        shape.filter = Filter::None;
    } else if (filter == "OCTAHEDRAL" && shape.mode == Mode::Attributes) {
        shape.filter = Filter::Octahedral;
    } else if (filter == "QUATERNION" && shape.mode == Mode::Attributes) {
        shape.filter = Filter::Quaternion;
    } else if (filter == "EXPONENTIAL" && shape.mode == Mode::Attributes) {
        shape.filter = Filter::Exponential;
    } else {
        refuse(Fault::MalformedBody, extension.where() + "/filter",
               "is " + shown(filter) +
                   ", and must be NONE, or of attributes OCTAHEDRAL, QUATERNION or EXPONENTIAL");
    }
    shape.count = extension.count("count", 0);
    shape.stride = extension.count("byteStride", 0);
    if (!is_stride(shape)) {
        refuse(Fault::OutOfRange, extension.where() + "/byteStride",
               "is " + std::to_string(shape.stride) + ", which " + mode + " with the filter " +
                   filter + " cannot have");
    }
    if (shape.mode == Mode::Triangles && shape.count % 3 != 0) {
        refuse(Fault::MalformedBody, extension.where() + "/count",
               "is " + std::to_string(shape.count) + ", and must be a multiple of 3");
    }
    return shape;
}

void check_packed(const PackedShape& shape, std::size_t bytes, const Node& extension)
{
    // The codec spends at least: for attributes two bits on 16 values of one byte, so 1 : 64; for
    // triangles a byte a triangle; for indices a byte each.
    const std::uint64_t most = shape.mode == Mode::Attributes  ? 64 * bytes / shape.stride
                               : shape.mode == Mode::Triangles ? 3 * bytes
                                                               : bytes;
    if (shape.count == 0 || shape.count > most) {
        refuse(Fault::CountExceedsFile, extension.where() + "/count",
               "is " + std::to_string(shape.count) + ", and " + std::to_string(bytes) +
                   " compressed bytes can hold from 1 to " + std::to_string(most));
    }
}

std::vector<std::byte> unpack(const PackedShape& shape, std::span<const std::byte> bytes,
                              const Node& extension)
{
    std::vector<std::byte> result(shape.count * shape.stride);
    const auto* const packed = reinterpret_cast<const unsigned char*>(bytes.data());
    int failure = 0;
    switch (shape.mode) {
        case Mode::Attributes:
            failure = meshopt_decodeVertexBuffer(result.data(), shape.count, shape.stride, packed,
                                                 bytes.size());
            break;
        case Mode::Triangles:
            failure = meshopt_decodeIndexBuffer(result.data(), shape.count, shape.stride, packed,
                                                bytes.size());
            break;
        case Mode::Indices:
            failure = meshopt_decodeIndexSequence(result.data(), shape.count, shape.stride, packed,
                                                  bytes.size());
            break;
    }
    if (failure != 0) {
        refuse(Fault::MalformedBody, extension.where(),
               "the compressed bytes are corrupt or of a codec version that is not read");
    }
    switch (shape.filter) {
        case Filter::None:
            break;
        case Filter::Octahedral:
            meshopt_decodeFilterOct(result.data(), shape.count, shape.stride);
            break;
        case Filter::Quaternion:
            meshopt_decodeFilterQuat(result.data(), shape.count, shape.stride);
            break;
        case Filter::Exponential:
            meshopt_decodeFilterExp(result.data(), shape.count, shape.stride);
            break;
    }
    return result;
}

}  // namespace relight::gltf
